"""`accelerometer-gain`."""

from __future__ import annotations

from validation.effects.family import ACCELERATIONS, Family
from validation.effects.sizes import GAIN
from validation.effects.targets import ACCELEROMETER

FAMILY = Family(
    name="accelerometer-gain",
    side=ACCELERATIONS,
    what="relative gain of an accelerometer",
    targets=(ACCELEROMETER,),
    sizes=GAIN,
    example="accelerometer-gain:cover-z3=0.05",
)
