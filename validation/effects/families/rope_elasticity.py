import numpy as np

from validation.effects.effect import PENDULUM, PERIOD_STAGE, Family, SizeSpec, Values
from validation.effects.stages import PendulumSwing


def change(swing: PendulumSwing, targets: tuple[str, ...], values: Values) -> PendulumSwing:
    """Each rope is longer by ``c m g / n``, c [m/N] of one rope; where they share the weight alike."""
    longer = values[""] * swing.stated("mass") * swing.gravity / swing.stated("radii")
    return swing.times(np.sqrt(1 + longer / swing.stated("length")))


FAMILY = Family(
    name="rope-elasticity",
    side=PENDULUM,
    what="by how much one rope of a pendulum stretches for a newton",
    sizes=(SizeSpec(unit="m/N", low=0.0, high=1e-2, plausible=5e-6),),
    example="rope-elasticity=2e-6",
    stage=PERIOD_STAGE,
    change=change,
    equation="T = T₀ √(1 + c m g / (n l)): each of n ropes is longer by c m g / n",
    mistaken_for=("pendulum-amplitude", "pendulum-damping", "rope-mass", "air-inertia", "off-centre-suspension"),
    confirmed_by="a ruler, with and without the load: a length measured under load holds it already",
    reference="Hooke's law, c = l / (E A), in paper Eq. 5",
    sentence="The ropes are longer under the load than they were measured without it. A length that was measured with the "
    "article on them holds it already.",
)
