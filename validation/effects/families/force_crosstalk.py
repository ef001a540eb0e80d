"""`force-crosstalk`."""

from __future__ import annotations

from validation.effects.family import FORCES, Family
from validation.effects.sizes import RATIO

FAMILY = Family(
    name="force-crosstalk",
    side=FORCES,
    what="a resultant shows in the channels along another axis; zx is x seen in z",
    targets=("pair of axes",),
    sizes=RATIO,
    example="force-crosstalk:zx=0.02",
)
