"""`force-gain`."""

from __future__ import annotations

from validation.effects.family import FORCES, Family
from validation.effects.sizes import GAIN
from validation.effects.targets import FORCE

FAMILY = Family(
    name="force-gain",
    side=FORCES,
    what="relative gain of a force channel",
    targets=(FORCE,),
    sizes=GAIN,
    example="force-gain:fmd-z2=0.08",
)
