"""`unit`."""

from __future__ import annotations

from validation.effects.family import MISTAKE, Family, Size
from validation.effects.targets import CHANNEL

FAMILY = Family(
    name="unit",
    side=MISTAKE,
    what="factor by which the numbers of a channel are wrong, or the unit that they really are in",
    targets=(CHANNEL,),
    sizes=(Size(unit="1", low=1e-6, high=1e6),),
    example="unit:cover-z3=0.102, or unit:cover-z3=g",
)
