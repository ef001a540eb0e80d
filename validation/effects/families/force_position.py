from fem.structure import limits_of_shift
from validation.effects.effect import DRIVE, FORCES, LENGTH, Family

FAMILY = Family(
    name="force-position",
    side=FORCES,
    what="a blow or a shaker acts beside its point",
    targets=(DRIVE, "axis"),
    sizes=LENGTH,
    example="force-position:tip-z:x=0.01",
    limits=limits_of_shift,
    equation="A' = dᵀ A (n + v ∂n/∂p)",
    mistaken_for=("force-gain", "force-misalignment", "accelerometer-position"),
    confirmed_by="blows on a mark, each at its own side of it; reciprocity with an accelerometer at that point",
    reference="D. J. Ewins, Modal Testing, 2000, chapter 3 (impact testing)",
    sentence="At {target} the force acted beside the stated point: where the structure turns, a force beside its point is "
    "another one.",
)
