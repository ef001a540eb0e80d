"""`mass`: a part is heavier or lighter than drawn. Opened: the density of the part leaves its tolerance."""

from validation.effects.effect import OPENED, STRUCTURE, Family, relative

FAMILY = Family(
    name="mass",
    side=STRUCTURE,
    what="relative change of a part's density",
    targets=("part",),
    sizes=relative(-0.9, 9.0, 0.15),
    example="mass:mast=0.05",
    stage=OPENED,
    tolerance=0.01,
    equation="M += d M_part",
    mistaken_for=("point-mass", "modulus", "thickness"),
    confirmed_by="weigh the part, or the whole before and after it is taken off; response functions above the modes, whose mass "
    "line no stiffness moves",
    reference="R. L. Fox and M. P. Kapoor, AIAA Journal 6 (1968), 2426 (rates of change)",
    sentence="{target} is heavier (positive) or lighter than drawn by this share, all over it: another material, a coating, "
    "contents that the model has not.",
)
