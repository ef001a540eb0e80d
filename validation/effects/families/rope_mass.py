"""`rope-mass`."""

from __future__ import annotations

from validation.effects.effect import PENDULUM, PERIOD_STAGE, Family, SizeSpec
from validation.effects.stages import heavy_ropes

FAMILY = Family(
    name="rope-mass",
    side=PENDULUM,
    what="mass of all ropes of a pendulum together",
    sizes=(SizeSpec(unit="kg", low=0.0, high=100.0, plausible=0.3),),
    example="rope-mass=0.3",
    stage=PERIOD_STAGE,
    change=heavy_ropes,
    equation="T = T₀ √((1 + M q / (3 I)) / (1 + M q / (2 m s_1 s_2))), q the mean square of the radii",
    mistaken_for=("pendulum-amplitude", "pendulum-damping", "rope-elasticity", "air-inertia", "off-centre-suspension"),
    confirmed_by="the ropes on a balance; lighter ropes of the same length",
    reference="kinetic and potential energy of uniform ropes that stay straight (validation.classical.pendulum)",
    sentence="The ropes swing along and pull along: their mass adds to what turns and to what pulls back, and the two nearly "
    "cancel.",
)
