import numpy as np

from validation.effects.effect import PENDULUM, PERIOD_STAGE, Family, SizeSpec, Values
from validation.effects.stages import PendulumSwing


def change(swing: PendulumSwing, targets: tuple[str, ...], values: Values) -> PendulumSwing:
    """Air that turns along with the body."""
    return swing.times(np.sqrt(1 + values[""] / swing.stated("inertia")))


FAMILY = Family(
    name="air-inertia",
    side=PENDULUM,
    what="moment of inertia of the air that swings along with a pendulum",
    sizes=(SizeSpec(unit="kg m^2", low=0.0, high=100.0, plausible=0.005),),
    example="air-inertia=0.002",
    stage=PERIOD_STAGE,
    change=change,
    equation="T = T₀ √(1 + I_air / I)",
    mistaken_for=("pendulum-amplitude", "pendulum-damping", "rope-mass", "rope-elasticity", "off-centre-suspension"),
    confirmed_by="the same swing with light plates of cardboard added, or in a posture in which the plates cut the air",
    reference="added mass of a body in an ideal fluid (Lamb, Hydrodynamics, chapter VI); of a disc of radius a turning about "
    "its diameter 16/45 ρ a⁵",
    sentence="Wide flat parts, such as blades, take air along when they swing, and the air's inertia is measured with the "
    "article's.",
)
