import numpy as np

from geometry.errors import BadInput
from validation.effects.effect import PENDULUM, PERIOD_STAGE, Family, SizeSpec, Values
from validation.effects.stages import PendulumSwing


def change(swing: PendulumSwing, targets: tuple[str, ...], values: Values) -> PendulumSwing:
    """``1 / sqrt(1 - e² / s²)``: with the CoG off the middle of the ropes by e, sum F_i r_i² = m g (s² - e²)."""
    share = values[""] ** 2 / swing.square
    if share >= 1:
        problem = f"a CoG {values['']:g} m beside the middle of the ropes, {np.sqrt(swing.square):g} m from them, would fall over"
        raise BadInput("pendulum", "off-centre-suspension", problem, "Give a smaller distance")
    return swing.times(1 / np.sqrt(1 - share))


FAMILY = Family(
    name="off-centre-suspension",
    side=PENDULUM,
    what="distance of the centre of gravity from the middle of the ropes",
    sizes=(SizeSpec(unit="m", low=0.0, high=0.5, plausible=0.01),),
    example="off-centre-suspension=0.02",
    stage=PERIOD_STAGE,
    change=change,
    equation="T = T₀ / √(1 - e² / s²), s² = s_1 s_2 of two ropes, the square of the radius of three and more",
    mistaken_for=("pendulum-amplitude", "pendulum-damping", "rope-mass", "rope-elasticity", "air-inertia"),
    confirmed_by="the ropes' shares of the weight, by balances; hung again half a turn on",
    reference="statics of the hanging body: sum F_i r_i² = m g (s² - e²) where sum F_i r_i = 0 (validation.classical.pendulum)",
    sentence="The centre of gravity does not hang on the axis that the radii were measured from. The ropes share the weight "
    "unevenly and pull the twist back less.",
)
