from validation.effects.effect import ACCELEROMETER, DRIVE, MISTAKE, THERE, Family

FAMILY = Family(
    name="wrong-reference",
    side=MISTAKE,
    what="the force acted where another pick-up reads",
    targets=(DRIVE, ACCELEROMETER),
    sizes=THERE,
    example="wrong-reference:tip-z:cover-z3",
    equation="A_r' = A n', at another point and direction n' than stated",
    mistaken_for=("force-position", "force-misalignment"),
    confirmed_by="reciprocity; at the point that was struck the imaginary part of the acceleration has one sign at all "
    "resonances",
    reference="definition of the reference in the test's description",
    sentence="The functions of {target} are not those of a force there: it acted at another point, along the direction in which "
    "that is read.",
)
