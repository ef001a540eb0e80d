"""`gravity-stiffness`: the weight that a structure carries softens what stands and stiffens what hangs."""

from dataclasses import replace

from validation.effects.effect import STRUCTURE, STRUCTURE_STAGE, Family, SizeSpec, Values
from validation.effects.stages import Matrices


def change(stage: Matrices, targets: tuple[str, ...], values: Values) -> Matrices:
    """``K += s K_G``."""
    return replace(stage, stiffness=stage.stiffness + values[""] * stage.geometric)


FAMILY = Family(
    name="gravity-stiffness",
    side=STRUCTURE,
    what="share of gravity that acts in the stiffness",
    sizes=(SizeSpec(unit="1", low=-2.0, high=10.0, plausible=1.0, stated=1.0),),
    example="gravity-stiffness=1",
    stage=STRUCTURE_STAGE,
    change=change,
    equation="K += s K_G, of a storey K_G = -β W/h (r_above - r_below)ᵀ(r_above - r_below), β = 6/5 between clamps, 1 on hinges",
    mistaken_for=("modulus", "support-stiffness", "connection-compliance"),
    confirmed_by="its size, which is 1 where the weights are right; more weight on top: the frequencies fall by more than the "
    "mass explains",
    reference="J. S. Przemieniecki, Theory of Matrix Structural Analysis, 1968, chapter 15 (geometric stiffness); R. W. Clough "
    "and J. Penzien, Dynamics of Structures, 1975, section 10-5",
    sentence="The weight that leans on a column as it sways pushes it further: what stands is softer, what hangs is stiffer than "
    "without gravity.",
)
