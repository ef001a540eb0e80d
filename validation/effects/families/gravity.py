"""`gravity`: the structure's half of gravity. Opened: a parameter of the measurement chain, which knows both halves."""

from validation.effects.effect import OPENED, STRUCTURE, SWITCH, Family
from validation.effects.plants import at

FAMILY = Family(
    name="gravity",
    side=STRUCTURE,
    what="the structure's half of gravity, 1 on or 0 off",
    sizes=SWITCH,
    example="gravity=0",
    stage=OPENED,
    equation="f = H (I + g/ω² E) ü with kinematic ü: E[x,β] = 1, E[y,α] = -1; f_x/β̈ += m g/ω², f_y/α̈ -= m g/ω²",
    mistaken_for=("accelerometer-tilt", "cable", "force-highpass"),
    confirmed_by="rotation sweeps at low frequency; sensors that do not feel tilt (optical) beside those that do",
    reference="paper Eq. 1, whose m g acts by its tilt alone; IEEE Std 1293, 1998 (accelerometers read a - g)",
    sentence="A table that turns lets the article's weight pull sideways; this says whether the loads contain that share.",
    plant=at("chain", "gravity"),
)
