"""`modulus`: a part is stiffer or softer than drawn. Opened: the modulus of the part leaves its tolerance."""

from validation.effects.effect import OPENED, STRUCTURE, Family, relative
from validation.effects.plants import at

FAMILY = Family(
    name="modulus",
    side=STRUCTURE,
    what="relative change of a part's modulus of elasticity",
    targets=("part",),
    sizes=relative(-0.999, 9.0, 0.15),
    example="modulus:mast=0.05",
    stage=OPENED,
    tolerance=0.025,
    equation="K += (eᵈ - 1) K_part, eᵈ = 1 + the relative change",
    mistaken_for=("joint-compliance", "point-mass"),
    confirmed_by="another configuration of the article, with the part and without it; higher modes of the part, which tell it "
    "from a neighbouring one; a tensile test or the ultrasonic speed of the material",
    reference="R. L. Fox and M. P. Kapoor, AIAA Journal 6 (1968), 2426 (rates of change); J. E. Mottershead and M. I. Friswell, "
    "J. Sound and Vibration 167 (1993), 347 (model updating)",
    sentence="{target} is stiffer (positive) or softer than drawn by this share: another material, another thickness, or a "
    "weakness of the model where it joins.",
    plant=at("parts", "modulus"),
)
