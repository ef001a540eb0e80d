from dataclasses import replace

import numpy as np

from validation.effects.effect import NOISE_STAGE, PROCESSING, Family, SizeSpec, Values
from validation.effects.plants import at
from validation.effects.stages import NoiseModel


def change(floor: NoiseModel, targets: tuple[str, ...], values: Values) -> NoiseModel:
    """The ordinary hum is in the noise that was measured: more of it adds, less takes off, and never all."""
    if not floor.hum.size:
        return floor
    factor = values[""]
    more = (factor**2 - 1) * floor.hum**2
    variance = np.maximum(floor.deviation**2 + more, (min(factor, 1.0) * floor.deviation) ** 2)
    return replace(floor, deviation=np.sqrt(variance), hum=factor * floor.hum)


FAMILY = Family(
    name="mains",
    side=PROCESSING,
    what="mains hum in every channel, as a factor on the ordinary one",
    sizes=(SizeSpec(unit="1", low=0.0, high=1e4, null=1.0),),
    example="mains=5",
    stage=NOISE_STAGE,
    change=change,
    equation="σ'² = σ² + (factor² - 1) h², h = a / (2√2 π |f - f_m|) the leak of the ordinary hum into a line",
    mistaken_for=("noise",),
    confirmed_by="a narrow line at 50 or 60 Hz and its odd multiples, also while nothing moves",
    reference="leakage of a sine into a rectangular record (Harris, Proc. IEEE 66 (1978) 51-83)",
    sentence="The mains hum gets into the channels more than usual: an earth loop or a missing screen. Inside the band only its "
    "leak is seen, weak and the same whatever is driven.",
    plant=at("chain", "mains"),
)
