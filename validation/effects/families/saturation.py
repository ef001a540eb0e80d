from dataclasses import replace

import numpy as np

from validation.effects.effect import AMPLITUDE, CHANNEL, CHANNEL_STAGE, Family, Values, relative
from validation.effects.plants import at
from validation.effects.stages import ChannelResponse

# A describing function: of a slow sweep, a sine at every moment, the fundamental alone. Its harmonics appear at other lines,
# where the sweep is at another time; a full-record spectrum holds them at three times the frequency, small as they are.

TINY = float(np.finfo(np.float64).tiny)


def change(reading: ChannelResponse, targets: tuple[str, ...], values: Values) -> ChannelResponse:
    """``y (1 - 3/4 s (a / y_p)²)``, a the amplitude at a line and y_p the peak of the run at nominal level."""
    k = reading.column(targets[0])
    a = reading.amplitude_of(k)
    peak = reading.peak[k] if reading.peak.size else np.max(a, initial=0.0)
    rows = np.array(reading.rows)
    rows[:, k] *= (1 - 0.75 * values[""] * (a / max(peak, TINY)) ** 2)[:, None]
    return replace(reading, rows=rows)


FAMILY = Family(
    name="saturation",
    side=AMPLITUDE,
    what="share of its peak that a channel loses there, by a cubic term",
    targets=(CHANNEL,),
    sizes=relative(-0.3, 0.3, 0.05),
    example="saturation:fmd-z1=0.05",
    stage=CHANNEL_STAGE,
    change=change,
    equation="y' = y (1 - s (y / y_p)²); of a sine of amplitude a: y (1 - 3/4 s (a / y_p)²)",
    mistaken_for=("force-gain", "accelerometer-gain", "structural-damping", "gap"),
    confirmed_by="the same run at half the level: a quarter of the loss is left; third harmonics in the time record",
    reference="describing function of a cubic characteristic (Gelb and Vander Velde, Multiple-Input Describing Functions)",
    sentence="The channel {target} is driven to its limit and rounds off its peaks, so it reads too little where it is loud and "
    "right where it is quiet. At one level that is a gain that depends on frequency.",
    plant=at("signals", "saturation"),
)
