from dataclasses import replace

import numpy as np

from validation.effects.effect import CHANNEL, NOISE_STAGE, PROCESSING, Family, SizeSpec, Values
from validation.effects.plants import at
from validation.effects.stages import NoiseModel


def change(floor: NoiseModel, targets: tuple[str, ...], values: Values) -> NoiseModel:
    """Variances of independent noise add."""
    k, deviation = floor.channels.index(targets[0]), np.array(floor.deviation)
    deviation[:, k] = np.hypot(deviation[:, k], values[""] * floor.per_rms[k])
    return replace(floor, deviation=deviation)


FAMILY = Family(
    name="noise",
    side=PROCESSING,
    what="root mean square of more noise on a channel, in its SI unit",
    targets=(CHANNEL,),
    sizes=(SizeSpec(unit="m/s^2 or N", low=0.0, high=1e6),),
    example="noise:cover-z3=0.05",
    stage=NOISE_STAGE,
    change=change,
    equation="σ'² = σ² + n² S_1, S_1 that of a broadband noise of 1 rms",
    mistaken_for=("mains", "force-highpass"),
    confirmed_by="the quiet part of the record; the same run twice",
    reference="variances of independent noise add; Bendat and Piersol, Random Data, chapter 9",
    sentence="The channel {target} is noisier than its noise floor says: a bad cable, a range too large, a loose screw. It "
    "shifts nothing on average, but what is concluded from it is less certain.",
    plant=at("chain", "noise"),
)
