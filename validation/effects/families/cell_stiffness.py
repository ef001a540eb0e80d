from geometry.sensors import Tolerances
from validation.effects.effect import FORCES, Family, relative
from validation.effects.plants import at

FAMILY = Family(
    name="cell-stiffness",
    side=FORCES,
    what="relative change of one cell's stiffness",
    targets=("cell and axis",),
    sizes=relative(-0.99, 99.0, 0.5),
    example="cell-stiffness:1x=0.3",
    tolerance=Tolerances().cell_stiffness,
    equation="cells carry K_c B (Bᵀ K_c B)⁻¹ F, k of one cell times (1 + v)",
    mistaken_for=("force-gain", "gap", "force-crosstalk"),
    confirmed_by="the sums fmd-z1 + fmd-z3 and fmd-z2 + fmd-z4, which share by stiffness alone; torque of that cell's bolt",
    reference="statically indeterminate plate on springs: loads share by stiffness, and none is lost",
    sentence="One load cell, {target} by number and axis, is softer or stiffer than the other three and takes another share of "
    "the load. The resultants stay right: only the single channels, and the balance between them, tell.",
    plant=at("chain", "cell_stiffness"),
)
