"""`appendage`."""

from __future__ import annotations

from validation.effects.family import STRUCTURE, Family
from validation.effects.sizes import resonator

FAMILY = Family(
    name="appendage",
    side=STRUCTURE,
    what="a resonator on the cover plate",
    targets=("axis",),
    sizes=resonator(100.0),
    example="appendage:z=m:0.05,f:21,zeta:0.01",
)
