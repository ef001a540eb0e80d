from geometry.sensors import Tolerances
from validation.effects.effect import ACCELERATIONS, ACCELEROMETER, DELAY, Family
from validation.effects.plants import at

FAMILY = Family(
    name="accelerometer-delay",
    side=ACCELERATIONS,
    what="an accelerometer is late",
    targets=(ACCELEROMETER,),
    sizes=DELAY,
    example="accelerometer-delay:cover-z3=200e-6",
    tolerance=Tolerances().delay,
    equation="y' = y exp(-i ω τ)",
    mistaken_for=("board-delay", "force-delay", "structural-damping"),
    confirmed_by="one generator on all inputs at once; a phase against its neighbours that grows in proportion to frequency",
    reference="shift theorem of the Fourier transform",
    sentence="The accelerometer {target} is recorded a little later than the others: its filter lags, or it rings at a resonance "
    "of its mounting far above the band.",
    plant=at("chain", "delay"),
)
