"""`absorber`."""

from __future__ import annotations

from validation.effects.family import STRUCTURE, Family
from validation.effects.sizes import resonator
from validation.effects.targets import PLACE

FAMILY = Family(
    name="absorber",
    side=STRUCTURE,
    what="a resonator at a place of the article",
    targets=(PLACE,),
    sizes=resonator(100.0),
    example="absorber:mast-top=m:0.05,f:21,zeta:0.01",
)
