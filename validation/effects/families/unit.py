from validation.effects.effect import CHANNEL, CHANNEL_STAGE, MISTAKE, Family, SizeSpec, Values
from validation.effects.plants import at
from validation.effects.stages import ChannelResponse


def change(reading: ChannelResponse, targets: tuple[str, ...], values: Values) -> ChannelResponse:
    """``factor y``"""
    return reading.times(targets[0], values[""])


FAMILY = Family(
    name="unit",
    side=MISTAKE,
    what="factor by which the numbers of a channel are wrong, or the unit that they really are in",
    targets=(CHANNEL,),
    sizes=(SizeSpec(unit="1", low=1e-6, high=1e6, null=1.0, plausible=5.0, logarithmic=True),),
    example="unit:cover-z3=0.102, or unit:cover-z3=g",
    stage=CHANNEL_STAGE,
    change=change,
    equation="y' = factor y",
    mistaken_for=("force-gain", "accelerometer-gain"),
    confirmed_by="the factor itself: 9.81, 1000, 4.45 and their inverses are units, 1.07 is a gain",
    reference="definition of the units (SI brochure); g_n = 9.80665 m/s², 1 lbf = 4.4482216 N",
    sentence="The numbers of {target} are in another unit than the file says: g taken for m/s², mm for m, pounds for newtons.",
    plant=at("record", "unit"),
)
