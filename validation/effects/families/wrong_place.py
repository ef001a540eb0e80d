from validation.effects.effect import ACCELEROMETER, MISTAKE, PLACE, THERE, Family

FAMILY = Family(
    name="wrong-place",
    side=MISTAKE,
    what="a pick-up sits at another place of the structure",
    targets=(ACCELEROMETER, PLACE),
    sizes=THERE,
    example="wrong-place:cover-z3:mast-top",
    equation="y' = dᵀ u(p'), at another place p' than stated",
    mistaken_for=("channel-swap", "accelerometer-position"),
    confirmed_by="a look at the structure; a tap beside the pick-up",
    reference="definition of the place in the test's description",
    sentence="The pick-up {target} sits at another place of the structure than the description of the test says.",
)
