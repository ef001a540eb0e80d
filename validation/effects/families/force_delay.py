from geometry.sensors import Tolerances
from validation.effects.effect import DELAY, FORCE, FORCES, Family
from validation.effects.plants import at

FAMILY = Family(
    name="force-delay",
    side=FORCES,
    what="a force channel is late",
    targets=(FORCE,),
    sizes=DELAY,
    example="force-delay:fmd-z2=200e-6",
    tolerance=Tolerances().delay,
    equation="y' = y exp(-i ω τ)",
    mistaken_for=("board-delay", "force-highpass", "structural-damping"),
    confirmed_by="one generator on all inputs at once; a phase that grows in proportion to frequency",
    reference="shift theorem of the Fourier transform",
    sentence="The force channel {target} is recorded a little later than the others: its filter or its sampling board lags. "
    "Forces and accelerations then turn against each other, which looks like damping that grows with frequency.",
    plant=at("chain", "delay"),
)
