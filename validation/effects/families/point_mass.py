"""`point-mass`."""

from __future__ import annotations

from validation.effects.family import STRUCTURE, Family
from validation.effects.sizes import MASS
from validation.effects.targets import PLACE

FAMILY = Family(
    name="point-mass", side=STRUCTURE, what="a mass at a place", targets=(PLACE,), sizes=MASS, example="point-mass:mast-top=0.5"
)
