from fem.structure import limits_of_shift
from geometry.sensors import Tolerances
from validation.effects.effect import ACCELERATIONS, ACCELEROMETER, LENGTH, Family
from validation.effects.plants import at

FAMILY = Family(
    name="accelerometer-position",
    side=ACCELERATIONS,
    what="an accelerometer sits elsewhere than stated",
    targets=(ACCELEROMETER, "axis"),
    sizes=LENGTH,
    example="accelerometer-position:cover-z3:x=0.01",
    tolerance=Tolerances().position,
    limits=limits_of_shift,
    equation="y' = dᵀ [G(p + dp)] u, that is y + dᵀ (θ x dp)",
    mistaken_for=("accelerometer-gain", "accelerometer-misalignment", "force-plane-offset"),
    confirmed_by="a ruler; rotation sweeps, which alone show it; more pick-ups on the same plate",
    reference="paper Eq. 3: acceleration of a point of a rigid body, with small rotations",
    sentence="The accelerometer {target} is not where the channel table says. When the plate rotates it reads too much or too "
    "little; when the plate only shifts nothing is seen.",
    plant=at("chain", "position"),
)
