"""`accelerometer-delay`."""

from __future__ import annotations

from validation.effects.family import ACCELERATIONS, Family
from validation.effects.sizes import DELAY
from validation.effects.targets import ACCELEROMETER

FAMILY = Family(
    name="accelerometer-delay",
    side=ACCELERATIONS,
    what="an accelerometer is late",
    targets=(ACCELEROMETER,),
    sizes=DELAY,
    example="accelerometer-delay:cover-z3=200e-6",
)
