from validation.effects.effect import ACCELERATIONS, Family, SizeSpec

FAMILY = Family(
    name="exponential-window",
    side=ACCELERATIONS,
    what="inverse time constant of an exponential window that was not taken off",
    sizes=(SizeSpec(unit="1/s", low=0.0, high=1e4, plausible=3.0),),
    example="exponential-window=1.5",
    equation="A'(s) = A(s + v), of modes ζ' = ζ + v / ω",
    mistaken_for=("structural-damping", "leakage"),
    confirmed_by="the settings of the analyser; the same blows evaluated in a longer block without a window",
    reference="W. G. Halvorsen and D. L. Brown, Sound and Vibration 11 (1977), 8",
    sentence="The records were multiplied by a decaying exponential and nobody took its damping off again: all modes lose the "
    "same amount per second too much, the lowest the largest share.",
)
