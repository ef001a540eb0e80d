"""`mounting-offset`."""

from __future__ import annotations

from validation.effects.family import STRUCTURE, Family
from validation.effects.sizes import LENGTH

FAMILY = Family(
    name="mounting-offset",
    side=STRUCTURE,
    what="the article shifted on the cover plate",
    targets=("lateral axis",),
    sizes=LENGTH,
    example="mounting-offset:x=0.002",
)
