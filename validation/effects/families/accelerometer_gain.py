from geometry.sensors import Tolerances
from validation.effects.effect import ACCELERATIONS, ACCELEROMETER, GAIN, Family
from validation.effects.plants import at

FAMILY = Family(
    name="accelerometer-gain",
    side=ACCELERATIONS,
    what="relative gain of an accelerometer",
    targets=(ACCELEROMETER,),
    sizes=GAIN,
    example="accelerometer-gain:cover-z3=0.05",
    tolerance=Tolerances().gain,
    equation="y' = (1 + g) y",
    mistaken_for=("accelerometer-position", "fmd-compliance", "cover-plate-flexibility", "unit"),
    confirmed_by="a calibrator, or the pick-up changed for its neighbour: the error moves with it",
    reference="paper Eq. 6: a rigid plate moves in six ways, and eight pick-ups check each other",
    sentence="The accelerometer {target} reads too much or too little by a constant share: its sensitivity is not the one that "
    "was typed in. A plate that only shifts then seems to tilt too, and the tilt gets the blame for forces.",
    plant=at("chain", "gain"),
)
