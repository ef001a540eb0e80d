from validation.effects.effect import ANGLE, DRIVE, FORCES, Family

FAMILY = Family(
    name="force-misalignment",
    side=FORCES,
    what="a blow or a shaker pushes askew, turned about an axis",
    targets=(DRIVE, "axis"),
    sizes=ANGLE,
    example="force-misalignment:tip-z:x=0.05",
    equation="A' = dᵀ A R(v e) n",
    mistaken_for=("force-gain", "force-position", "accelerometer-misalignment"),
    confirmed_by="the blow again along a guide; a response across the direction, which a straight blow at a plane of symmetry "
    "does not move",
    reference="D. J. Ewins, Modal Testing, 2000, chapter 3 (a load cell reads along its own axis, whatever it is held to)",
    sentence="At {target} the force did not act quite along the stated direction: a share of it pushed across.",
)
