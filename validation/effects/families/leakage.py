from validation.effects.effect import ACCELERATIONS, Family, SizeSpec

FAMILY = Family(
    name="leakage",
    side=ACCELERATIONS,
    what="share of what a Hann window of the lines' own resolution smears, 1 for all of it",
    sizes=(SizeSpec(unit="1", low=0.0, high=2.0, plausible=0.5),),
    example="leakage=1",
    equation="A' = A + v (A * |W|² - A), W of blocks as long as one over the distance of lines",
    mistaken_for=("structural-damping", "exponential-window"),
    confirmed_by="blocks of twice the length: a peak that grows and narrows was not resolved",
    reference="J. S. Bendat and A. G. Piersol, Random Data, 2010, chapter 11 (bias of averaged spectra); D. J. Ewins, Modal "
    "Testing, 2000, chapter 3",
    sentence="The lines lie too far apart for a lightly damped mode: blocks ended before it had rung down, and its peak is lower "
    "and wider than it is.",
)
