from validation.effects.effect import ACCELERATIONS, SWITCH, Family
from validation.effects.plants import at

FAMILY = Family(
    name="accelerometer-tilt",
    side=ACCELERATIONS,
    what="the sensors' half of gravity, 1 on or 0 off",
    sizes=SWITCH,
    example="accelerometer-tilt=0",
    equation="x pick-ups read + g β'' / ω², y pick-ups - g α'' / ω²",
    mistaken_for=("gravity", "rigid-inertia", "force-plane-offset"),
    confirmed_by="rotation sweeps at the low end of the band; a pick-up tilted by hand that reads 1 g senses gravity",
    reference="an accelerometer reads a - g in its own axes; the two halves cancel for a rigid body (identification.base_motion)",
    sentence="Whether accelerometers feel gravity when the plate tilts, as all real ones do. Optical sensors and a table's own "
    "control do not; calling one the other shifts the height of the centre of gravity by g / ω², 15.5 mm at 4 Hz.",
    plant=at("chain", "tilt"),
)
