"""`accelerometer-position`."""

from __future__ import annotations

from validation.effects.family import ACCELERATIONS, Family
from validation.effects.sizes import LENGTH
from validation.effects.targets import ACCELEROMETER

FAMILY = Family(
    name="accelerometer-position",
    side=ACCELERATIONS,
    what="an accelerometer sits elsewhere than stated",
    targets=(ACCELEROMETER, "axis"),
    sizes=LENGTH,
    example="accelerometer-position:cover-z3:x=0.01",
)
