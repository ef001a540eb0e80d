"""`force-delay`."""

from __future__ import annotations

from validation.effects.family import FORCES, Family
from validation.effects.sizes import DELAY
from validation.effects.targets import FORCE

FAMILY = Family(
    name="force-delay",
    side=FORCES,
    what="a force channel is late",
    targets=(FORCE,),
    sizes=DELAY,
    example="force-delay:fmd-z2=200e-6",
)
