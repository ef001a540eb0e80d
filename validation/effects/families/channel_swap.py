from dataclasses import replace

import numpy as np

from validation.effects.effect import CHANNEL, CHANNEL_STAGE, MISTAKE, Family, Values
from validation.effects.plants import at
from validation.effects.stages import ChannelResponse


def change(reading: ChannelResponse, targets: tuple[str, ...], values: Values) -> ChannelResponse:
    """Each of two channels reads what the other would."""
    order = np.arange(len(reading.channels))
    one, other = (reading.column(name) for name in targets)
    order[[one, other]] = other, one
    amplitude, peak = (one[..., order] if one.size else one for one in (reading.amplitude, reading.peak))
    return replace(reading, rows=reading.rows[:, order], amplitude=amplitude, peak=peak)


FAMILY = Family(
    name="channel-swap",
    side=MISTAKE,
    what="the plugs of two channels are swapped",
    targets=(CHANNEL, CHANNEL),
    example="channel-swap:cover-z1:cover-z2",
    stage=CHANNEL_STAGE,
    change=change,
    equation="y_A' = y_B, y_B' = y_A",
    mistaken_for=("polarity", "accelerometer-position"),
    confirmed_by="a tap on one pick-up at a time",
    reference="definition of the channels in the campaign file",
    sentence="The plugs of {targets} were crossed: each of the two channels holds what the other measured.",
    plant=at("record", "swap"),
)
