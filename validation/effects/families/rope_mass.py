import numpy as np

from validation.effects.effect import PENDULUM, PERIOD_STAGE, Family, SizeSpec, Values
from validation.effects.stages import PendulumSwing


def change(swing: PendulumSwing, targets: tuple[str, ...], values: Values) -> PendulumSwing:
    """``M q / 3`` more inertia, ``M q / 2`` more of m s1 s2, M the mass of all ropes."""
    square = swing.square
    mean = values[""] * float(np.mean(swing.radii**2))
    turning, pulling = mean / (3 * swing.stated("inertia")), mean / (2 * swing.stated("mass") * square)
    return swing.times(np.sqrt((1 + turning) / (1 + pulling)))


FAMILY = Family(
    name="rope-mass",
    side=PENDULUM,
    what="mass of all ropes of a pendulum together",
    sizes=(SizeSpec(unit="kg", low=0.0, high=100.0, plausible=0.3),),
    example="rope-mass=0.3",
    stage=PERIOD_STAGE,
    change=change,
    equation="T = T₀ √((1 + M q / (3 I)) / (1 + M q / (2 m s_1 s_2))), q the mean square of the radii",
    mistaken_for=("pendulum-amplitude", "pendulum-damping", "rope-elasticity", "air-inertia", "off-centre-suspension"),
    confirmed_by="the ropes on a balance; lighter ropes of the same length",
    reference="kinetic and potential energy of uniform ropes that stay straight (validation.classical.pendulum)",
    sentence="The ropes swing along and pull along: their mass adds to what turns and to what pulls back, and the two nearly "
    "cancel.",
)
