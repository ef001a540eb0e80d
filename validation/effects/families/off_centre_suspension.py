"""`off-centre-suspension`."""

from __future__ import annotations

from validation.effects.family import PENDULUM, Family

FAMILY = Family(
    name="off-centre-suspension", side=PENDULUM, what="an error of a pendulum's period", example="off-centre-suspension"
)
