"""`force-plane-offset`."""

from __future__ import annotations

from validation.effects.family import FORCES, Family
from validation.effects.sizes import LENGTH

FAMILY = Family(
    name="force-plane-offset",
    side=FORCES,
    what="height of a lateral force whose moment the cells miss",
    targets=("lateral axis",),
    sizes=LENGTH,
    example="force-plane-offset:x=0.004",
)
