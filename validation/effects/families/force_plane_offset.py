from validation.effects.effect import FORCES, LENGTH, Family
from validation.effects.plants import at

FAMILY = Family(
    name="force-plane-offset",
    side=FORCES,
    what="height of a lateral force whose moment the cells miss",
    targets=("lateral axis",),
    sizes=LENGTH,
    example="force-plane-offset:x=0.004",
    equation="M_y' = M_y - h F_x  ·  M_x' = M_x + h F_y",
    mistaken_for=("force-crosstalk", "rigid-inertia", "accelerometer-position"),
    confirmed_by="two masses at two heights: the offset stays while the centre of gravity moves; a drawing of the cells",
    reference="moment of a force moved to a parallel line, as in paper Eq. 7",
    sentence="The load cells feel the force along {target} in another plane than the one the moments are counted from. The whole "
    "article then seems to sit higher or lower by that distance.",
    plant=at("chain", "plane_offset"),
)
