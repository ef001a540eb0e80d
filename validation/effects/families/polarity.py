from validation.effects.effect import CHANNEL, CHANNEL_STAGE, MISTAKE, Family, Values
from validation.effects.plants import at
from validation.effects.stages import ChannelResponse


def change(reading: ChannelResponse, targets: tuple[str, ...], values: Values) -> ChannelResponse:
    """``-y``"""
    return reading.times(targets[0], -1.0)


FAMILY = Family(
    name="polarity",
    side=MISTAKE,
    what="a channel is inverted",
    targets=(CHANNEL,),
    example="polarity:fmd-z2",
    stage=CHANNEL_STAGE,
    change=change,
    equation="y' = -y",
    mistaken_for=("channel-swap",),
    confirmed_by="a push by hand in a known direction; the sign of one line of one sweep",
    reference="definition of the channel's direction in the campaign file",
    sentence="The channel {target} has the wrong sign: the pick-up is mounted the other way round, or its direction was typed "
    "with the other sign.",
    plant=at("chain", "polarity"),
)
