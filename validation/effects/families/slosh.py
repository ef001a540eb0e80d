"""`slosh`: a liquid that swings in a tank of the article."""

from validation.effects.effect import PLACE, STRUCTURE, STRUCTURE_STAGE, Family, Values, resonator
from validation.effects.plants import at
from validation.effects.stages import ALONG, Matrices, with_resonators


def change(stage: Matrices, targets: tuple[str, ...], values: Values) -> Matrices:
    """Two alike, along x and y; what of the liquid does not swing belongs to the article."""
    return with_resonators(stage, targets[0], ALONG["lateral"], values)


FAMILY = Family(
    name="slosh",
    side=STRUCTURE,
    what="a liquid that swings along x and y at a place",
    targets=(PLACE,),
    sizes=resonator(100.0),
    example="slosh:mast-top=m:0.5,f:6,zeta:0.02",
    stage=STRUCTURE_STAGE,
    change=change,
    equation="equal resonators along x and y at a height",
    mistaken_for=("appendage", "absorber"),
    confirmed_by="both lateral axes alike and the vertical one not; drain the tank, or fill it",
    reference="H. N. Abramson (ed.), The Dynamic Behavior of Liquids in Moving Containers, NASA SP-106, 1966; R. A. Ibrahim, "
    "Liquid Sloshing Dynamics, 2005",
    sentence="A liquid swings sideways at {target}, as strongly along x as along y.",
    plant=at("rig", "slosh"),
)
