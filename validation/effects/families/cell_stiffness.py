"""`cell-stiffness`."""

from __future__ import annotations

from validation.effects.family import FORCES, Family
from validation.effects.sizes import relative

FAMILY = Family(
    name="cell-stiffness",
    side=FORCES,
    what="relative change of one cell's stiffness",
    targets=("cell and axis",),
    sizes=relative(-0.99, 99.0),
    example="cell-stiffness:1x=0.3",
)
