"""`structural-damping`: a part loses more than the model says."""

from dataclasses import replace

from validation.effects.effect import STRUCTURE, STRUCTURE_STAGE, Family, SizeSpec, Values
from validation.effects.plants import at
from validation.effects.stages import Matrices


def change(stage: Matrices, targets: tuple[str, ...], values: Values) -> Matrices:
    """``S += eta K_part``, beside the loss factor that the part has, of which every mode loses its own share."""
    return replace(stage, structural=stage.structural + values[""] * stage.lost(targets[0]))


FAMILY = Family(
    name="structural-damping",
    side=STRUCTURE,
    what="loss factor added to a part",
    targets=("part",),
    sizes=(SizeSpec(unit="1", low=0.0, high=1.0, plausible=0.05),),
    example="structural-damping:mast=0.01",
    stage=STRUCTURE_STAGE,
    change=change,
    equation="D += i η K_part",
    mistaken_for=("layer-damping", "friction", "sweep-bias"),
    confirmed_by="level and width of several resonances of the same part, where the damping of a mode moves "
    "one; the part alone, hung on threads, ringing down",
    reference="A. D. Nashif, D. I. G. Jones and J. P. Henderson, Vibration Damping, 1985, chapter 2; of built-up "
    "structures E. E. Ungar, J. Sound and Vibration 26 (1973), 141",
    sentence="{target} takes more energy out of the motion than the model says: every resonance in which it bends is "
    "lower and wider.",
    plant=at("parts", "damping"),
)
