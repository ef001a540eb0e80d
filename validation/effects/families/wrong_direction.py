from validation.effects.effect import ACCELEROMETER, MISTAKE, THERE, Family

FAMILY = Family(
    name="wrong-direction",
    side=MISTAKE,
    what="a pick-up reads along another axis",
    targets=(ACCELEROMETER, "axis"),
    sizes=THERE,
    example="wrong-direction:cover-z3:x",
    equation="y' = eᵀ u, with another axis e than stated",
    mistaken_for=("accelerometer-misalignment", "channel-swap", "polarity"),
    confirmed_by="a tap along each axis of the pick-up",
    reference="definition of the direction in the test's description",
    sentence="The pick-up {target} reads along another axis than the description of the test says: two cables of a triaxial "
    "one are exchanged, or its direction was typed wrongly.",
)
