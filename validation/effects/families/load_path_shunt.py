from validation.effects.effect import FORCES, Family, relative
from validation.effects.plants import at

FAMILY = Family(
    name="load-path-shunt",
    side=FORCES,
    what="share of the force along an axis that passes the cells by",
    targets=("axis",),
    sizes=relative(0.0, 0.95, 0.05),
    example="load-path-shunt:x=0.03",
    equation="y' = (1 - s) y in every channel along the axis",
    mistaken_for=("force-gain", "rigid-inertia"),
    confirmed_by="a calibration mass: all channels of the axis are short by one share; cables and seals taken off",
    reference="parallel springs: a path of stiffness k_s beside cells of k takes the share k_s / (k + k_s)",
    sentence="Part of the force along {target} goes from the article to the table without passing a load cell: through the "
    "pre-stressing bolts, a cable or a seal. The article looks lighter along this axis than along the others.",
    plant=at("chain", "shunt"),
)
