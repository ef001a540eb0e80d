"""`pendulum-amplitude`."""

from __future__ import annotations

from validation.effects.family import PENDULUM, Family

FAMILY = Family(name="pendulum-amplitude", side=PENDULUM, what="an error of a pendulum's period", example="pendulum-amplitude")
