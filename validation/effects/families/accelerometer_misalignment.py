from geometry.sensors import Tolerances
from validation.effects.effect import ACCELERATIONS, ACCELEROMETER, ANGLE, Family
from validation.effects.plants import at

FAMILY = Family(
    name="accelerometer-misalignment",
    side=ACCELERATIONS,
    what="an accelerometer is turned about an axis",
    targets=(ACCELEROMETER, "axis"),
    sizes=ANGLE,
    example="accelerometer-misalignment:cover-z3:x=0.02",
    tolerance=Tolerances().angle,
    equation="y' = (R(v e) d)ᵀ [G(p)] u",
    mistaken_for=("accelerometer-position", "orientation", "force-crosstalk"),
    confirmed_by="the pick-up turned by 180 degrees about its own axis: cross-sensitivity turns with it, a slant does not",
    reference="paper Eq. 3; transverse sensitivity of an accelerometer is the same equation (ISO 16063-31)",
    sentence="The accelerometer {target} does not point quite along its axis: it reads a share of the motion across it. The "
    "transverse sensitivity of its data sheet does exactly the same.",
    plant=at("chain", "misalignment"),
)
