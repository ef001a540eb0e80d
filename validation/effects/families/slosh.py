"""`slosh`."""

from __future__ import annotations

from validation.effects.family import STRUCTURE, Family
from validation.effects.sizes import resonator
from validation.effects.targets import PLACE

FAMILY = Family(
    name="slosh",
    side=STRUCTURE,
    what="a liquid that swings along x and y at a place",
    targets=(PLACE,),
    sizes=resonator(100.0),
    example="slosh:mast-top=m:0.5,f:6,zeta:0.02",
)
