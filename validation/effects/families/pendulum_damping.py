import numpy as np

from validation.effects.effect import PENDULUM, PERIOD_STAGE, Family, SizeSpec, Values
from validation.effects.stages import PendulumSwing


def change(swing: PendulumSwing, targets: tuple[str, ...], values: Values) -> PendulumSwing:
    """``1 / sqrt(1 - zeta²)``"""
    return swing.times(1 / np.sqrt(1 - values[""] ** 2))


FAMILY = Family(
    name="pendulum-damping",
    side=PENDULUM,
    what="damping ratio of a pendulum's swing",
    sizes=(SizeSpec(unit="1", low=0.0, high=0.9, plausible=0.02),),
    example="pendulum-damping=0.01",
    stage=PERIOD_STAGE,
    change=change,
    equation="T = T₀ / √(1 - ζ²)",
    mistaken_for=("pendulum-amplitude", "rope-mass", "rope-elasticity", "air-inertia", "off-centre-suspension"),
    confirmed_by="the decay of the swing: ln of the ratio of two peaks one period apart is 2π ζ",
    reference="free vibration with viscous damping, any textbook; validation.classical.pendulum",
    sentence="Air and joints slow the swing down a little. Weak damping hardly matters: 5 % lengthen the period by 0.13 %.",
)
