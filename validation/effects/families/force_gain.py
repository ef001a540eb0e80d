from geometry.sensors import Tolerances
from validation.effects.effect import FORCE, FORCES, GAIN, Family
from validation.effects.plants import at

FAMILY = Family(
    name="force-gain",
    side=FORCES,
    what="relative gain of a force channel",
    targets=(FORCE,),
    sizes=GAIN,
    example="force-gain:fmd-z2=0.08",
    tolerance=Tolerances().gain,
    equation="y' = (1 + g) y",
    mistaken_for=("load-path-shunt", "rigid-inertia", "cell-stiffness", "point-mass", "unit"),
    confirmed_by="a known mass: on the cover plate, or hung up and struck with that hammer; a known force beside that cell",
    reference="paper Eq. 7: resultants are sums of channels, so a gain of one channel is a false force and a false moment",
    sentence="The force channel {target} reads too much or too little by a constant share: its charge amplifier, its cell or its "
    "calibration value is off. Near a mass line this looks like another mass and a shifted centre of gravity.",
    plant=at("chain", "gain"),
)
