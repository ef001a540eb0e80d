"""`layer-damping`: the silicone layer in a blade loses more than the model says."""

from dataclasses import replace

from validation.effects.effect import STRUCTURE, STRUCTURE_STAGE, Family, SizeSpec, Values
from validation.effects.plants import at
from validation.effects.stages import Matrices

LAYER = "-silicone"
"""Ending of the part of a blade that is its layer."""


def change(stage: Matrices, targets: tuple[str, ...], values: Values) -> Matrices:
    """``S += eta K_layer``, beside the loss factor that the layer has, of which every mode loses its own share."""
    return replace(stage, structural=stage.structural + values[""] * stage.lost(f"{targets[0]}{LAYER}"))


FAMILY = Family(
    name="layer-damping",
    side=STRUCTURE,
    what="loss factor added to the layer in a blade",
    targets=("part with a layer",),
    sizes=(SizeSpec(unit="1", low=0.0, high=1.0, plausible=0.3),),
    example="layer-damping:upper-short=0.03",
    stage=STRUCTURE_STAGE,
    change=change,
    equation="D += i η K_layer",
    mistaken_for=("structural-damping", "sweep-bias"),
    confirmed_by="level and width of the resonances of that blade; the same at another temperature, which silicone feels and "
    "steel does not",
    reference="E. M. Kerwin, J. Acoustical Society of America 31 (1959), 952; D. Ross, E. E. Ungar and E. M. Kerwin, Structural "
    "Damping, 1959; loss factors of damping rubbers from 0.05 to 1: A. D. Nashif, D. I. G. Jones and J. P. Henderson, Vibration "
    "Damping, 1985, chapter 3",
    sentence="The soft layer inside {target} takes more energy out of the blade's bending than the model says.",
    plant=at("parts", "layer_damping"),
)
