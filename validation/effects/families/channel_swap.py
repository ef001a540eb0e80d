"""`channel-swap`."""

from __future__ import annotations

from validation.effects.effect import CHANNEL, CHANNEL_STAGE, MISTAKE, Family
from validation.effects.plants import at
from validation.effects.stages import swapped

FAMILY = Family(
    name="channel-swap",
    side=MISTAKE,
    what="the plugs of two channels are swapped",
    targets=(CHANNEL, CHANNEL),
    example="channel-swap:cover-z1:cover-z2",
    stage=CHANNEL_STAGE,
    change=swapped,
    equation="y_A' = y_B, y_B' = y_A",
    mistaken_for=("polarity", "accelerometer-position"),
    confirmed_by="a tap on one pick-up at a time",
    reference="definition of the channels in the campaign file",
    sentence="The plugs of {targets} were crossed: each of the two channels holds what the other measured.",
    plant=at("record", "swap"),
)
