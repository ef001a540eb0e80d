"""`pendulum-damping`."""

from __future__ import annotations

from validation.effects.family import PENDULUM, Family

FAMILY = Family(name="pendulum-damping", side=PENDULUM, what="an error of a pendulum's period", example="pendulum-damping")
