from validation.effects.effect import ACCELERATIONS, Family, SizeSpec

FAMILY = Family(
    name="transducer-mass",
    side=ACCELERATIONS,
    what="mass of a pick-up that goes from point to point with what it reads",
    sizes=(SizeSpec(unit="kg", low=0.0, high=10.0, plausible=0.05),),
    example="transducer-mass=0.02",
    equation="A_ij' = A_ij - m a_i (1 + m A_ii)⁻¹ A_ij",
    mistaken_for=("point-mass", "accelerometer-gain", "mass"),
    confirmed_by="a pick-up of half the mass, or a second one on top: resonances that differ from response to response "
    "are one again",
    reference="D. J. Ewins, Modal Testing, 2000, chapter 3 (mass cancellation); J. Sherman and W. J. Morrison, Annals of "
    "Mathematical Statistics 21 (1950), 124",
    sentence="The pick-up weighs something, and it was moved from point to point: each response function is one of another "
    "structure, heavier where it was read.",
)
