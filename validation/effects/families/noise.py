"""`noise`."""

from __future__ import annotations

from validation.effects.family import PROCESSING, Family, Size
from validation.effects.targets import CHANNEL

FAMILY = Family(
    name="noise",
    side=PROCESSING,
    what="root mean square of more noise on a channel, in its SI unit",
    targets=(CHANNEL,),
    sizes=(Size(unit="m/s^2 or N", low=0.0, high=1e6),),
    example="noise:cover-z3=0.05",
)
