"""`pendulum-damping`."""

from __future__ import annotations

from validation.effects.effect import PENDULUM, PERIOD_STAGE, Family, SizeSpec
from validation.effects.stages import damped

FAMILY = Family(
    name="pendulum-damping",
    side=PENDULUM,
    what="damping ratio of a pendulum's swing",
    sizes=(SizeSpec(unit="1", low=0.0, high=0.9, plausible=0.02),),
    example="pendulum-damping=0.01",
    stage=PERIOD_STAGE,
    change=damped,
    equation="T = T₀ / √(1 - ζ²)",
    mistaken_for=("pendulum-amplitude", "rope-mass", "rope-elasticity", "air-inertia", "off-centre-suspension"),
    confirmed_by="the decay of the swing: ln of the ratio of two peaks one period apart is 2π ζ",
    reference="free vibration with viscous damping, any textbook; validation.classical.pendulum",
    sentence="Air and joints slow the swing down a little. Weak damping hardly matters: 5 % lengthen the period by 0.13 %.",
)
