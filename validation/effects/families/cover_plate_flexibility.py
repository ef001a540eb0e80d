from validation.effects.effect import ACCELERATIONS, Family, SizeSpec
from validation.effects.plants import at

FAMILY = Family(
    name="cover-plate-flexibility",
    side=ACCELERATIONS,
    what="the cover plate gives under the vertical force",
    sizes=(SizeSpec(unit="m/N", low=0.0, high=1e-4, plausible=1e-8),),
    example="cover-plate-flexibility=1e-9",
    equation="vertical pick-ups of the cover plate read y - ω² c f_z",
    mistaken_for=("joint-compliance", "accelerometer-gain", "fmd-compliance"),
    confirmed_by="the same load at the centre and above a corner; a pick-up on the article's flange beside those of the plate",
    reference="static deflection of an elastic plate under its load, quasi-static below its first mode",
    sentence="The cover plate bends under the article, and its pick-ups ride on the dent: they no longer tell how the article's "
    "foot moves. The error grows with the square of frequency and with the vertical load.",
    plant=at("signals", "flexible_cover"),
)
