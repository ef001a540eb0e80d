"""`thickness`: a sheet or a beam is thicker or thinner than drawn. Opened: the thickness of the part leaves its tolerance."""

from validation.effects.effect import OPENED, STRUCTURE, Family, relative

FAMILY = Family(
    name="thickness",
    side=STRUCTURE,
    what="relative change of the thickness of a shell or beam",
    targets=("part",),
    sizes=relative(-0.9, 9.0, 0.1),
    example="thickness:mast=0.05",
    stage=OPENED,
    tolerance=0.01,
    equation="K += d K_1 + (τ³ - 1) K_3, M += d M_part, τ = 1 + d",
    mistaken_for=("modulus", "mass"),
    confirmed_by="calipers, or an ultrasonic gauge; weigh it: a thicker sheet is heavier, a stiffer one is not",
    reference="S. P. Timoshenko and S. Woinowsky-Krieger, Theory of Plates and Shells, 1959, chapter 1 (D = E t³ / 12 (1 - ν²))",
    sentence="{target} is thicker (positive) or thinner than drawn by this share: it stretches as the share says, bends as its "
    "cube, and weighs as the share.",
)
