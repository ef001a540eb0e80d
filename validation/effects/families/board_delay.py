from validation.effects.effect import DELAY, FORCES, Family
from validation.effects.plants import at

FAMILY = Family(
    name="board-delay",
    side=FORCES,
    what="all channels of a board are late",
    targets=("board",),
    sizes=DELAY,
    example="board-delay:force=200e-6",
    equation="y' = y exp(-i ω τ) in every channel of the board",
    mistaken_for=("force-delay", "accelerometer-delay", "structural-damping"),
    confirmed_by="one generator on an input of every board; all channels of one board lag alike",
    reference="shift theorem of the Fourier transform",
    sentence="All channels of the {target} board are recorded a little later than those of the other boards: the boards are not "
    "started or clocked together. If all boards lag alike, nobody can see it, and it does no harm.",
    plant=at("chain", "board_delay"),
)
