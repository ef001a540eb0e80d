"""`accelerometer-misalignment`."""

from __future__ import annotations

from validation.effects.family import ACCELERATIONS, Family
from validation.effects.sizes import ANGLE
from validation.effects.targets import ACCELEROMETER

FAMILY = Family(
    name="accelerometer-misalignment",
    side=ACCELERATIONS,
    what="an accelerometer is turned about an axis",
    targets=(ACCELEROMETER, "axis"),
    sizes=ANGLE,
    example="accelerometer-misalignment:cover-z3:x=0.02",
)
