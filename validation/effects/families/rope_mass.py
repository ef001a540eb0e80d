"""`rope-mass`."""

from __future__ import annotations

from validation.effects.family import PENDULUM, Family

FAMILY = Family(name="rope-mass", side=PENDULUM, what="an error of a pendulum's period", example="rope-mass")
