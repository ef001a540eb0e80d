"""`layer-damping`."""

from __future__ import annotations

from validation.effects.family import STRUCTURE, Family
from validation.effects.sizes import relative

FAMILY = Family(
    name="layer-damping",
    side=STRUCTURE,
    what="loss factor added to the layer in a blade",
    targets=("part with a layer",),
    sizes=relative(0.0, 1.0),
    example="layer-damping:upper-short=0.03",
)
