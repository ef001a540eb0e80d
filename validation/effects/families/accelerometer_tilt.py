"""`accelerometer-tilt`."""

from __future__ import annotations

from validation.effects.family import ACCELERATIONS, Family
from validation.effects.sizes import SWITCH

FAMILY = Family(
    name="accelerometer-tilt",
    side=ACCELERATIONS,
    what="the sensors' half of gravity, 1 on or 0 off",
    sizes=SWITCH,
    example="accelerometer-tilt=0",
)
