"""`modulus`."""

from __future__ import annotations

from validation.effects.family import STRUCTURE, Family
from validation.effects.sizes import relative

FAMILY = Family(
    name="modulus",
    side=STRUCTURE,
    what="relative change of a part's modulus of elasticity",
    targets=("part",),
    sizes=relative(-0.9, 9.0),
    example="modulus:mast=0.05",
)
