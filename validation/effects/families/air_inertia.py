"""`air-inertia`."""

from __future__ import annotations

from validation.effects.family import PENDULUM, Family

FAMILY = Family(name="air-inertia", side=PENDULUM, what="an error of a pendulum's period", example="air-inertia")
