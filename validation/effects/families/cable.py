"""`cable`."""

from __future__ import annotations

from validation.effects.family import STRUCTURE, Family, Size
from validation.effects.targets import PLACE

FAMILY = Family(
    name="cable",
    side=STRUCTURE,
    what="a spring from a place to the ground",
    targets=(PLACE, "direction of a cable"),
    optional=True,
    sizes=(Size(unit="N/m", low=1e-3, high=1e9),),
    example="cable:mast-top:lateral=1000",
)
