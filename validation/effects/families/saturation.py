"""`saturation`."""

from __future__ import annotations

from validation.effects.effect import AMPLITUDE, CHANNEL, CHANNEL_STAGE, Family, relative
from validation.effects.plants import at
from validation.effects.stages import saturated

FAMILY = Family(
    name="saturation",
    side=AMPLITUDE,
    what="share of its peak that a channel loses there, by a cubic term",
    targets=(CHANNEL,),
    sizes=relative(-0.3, 0.3, 0.05),
    example="saturation:fmd-z1=0.05",
    stage=CHANNEL_STAGE,
    change=saturated,
    equation="y' = y (1 - s (y / y_p)²); of a sine of amplitude a: y (1 - 3/4 s (a / y_p)²)",
    mistaken_for=("force-gain", "accelerometer-gain", "structural-damping", "gap"),
    confirmed_by="the same run at half the level: a quarter of the loss is left; third harmonics in the time record",
    reference="describing function of a cubic characteristic (Gelb and Vander Velde, Multiple-Input Describing Functions)",
    sentence="The channel {target} is driven to its limit and rounds off its peaks, so it reads too little where it is loud and "
    "right where it is quiet. At one level that is a gain that depends on frequency.",
    plant=at("signals", "saturation"),
)
