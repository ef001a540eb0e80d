"""`structural-damping`."""

from __future__ import annotations

from validation.effects.family import STRUCTURE, Family
from validation.effects.sizes import relative

FAMILY = Family(
    name="structural-damping",
    side=STRUCTURE,
    what="loss factor added to a part",
    targets=("part",),
    sizes=relative(0.0, 1.0),
    example="structural-damping:mast=0.01",
)
