"""`saturation`."""

from __future__ import annotations

from validation.effects.family import AMPLITUDE, Family
from validation.effects.sizes import relative
from validation.effects.targets import CHANNEL

FAMILY = Family(
    name="saturation",
    side=AMPLITUDE,
    what="share of its peak that a channel loses there, by a cubic term",
    targets=(CHANNEL,),
    sizes=relative(-0.3, 0.3),
    example="saturation:fmd-z1=0.05",
)
