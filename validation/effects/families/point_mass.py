"""`point-mass`: a cable clamp, a forgotten screw, a sensor that nobody weighed, at one place of the article."""

from fem.structure import limits_of_mass
from validation.effects.effect import MASS, PLACE, STRUCTURE, STRUCTURE_STAGE, Family, Values
from validation.effects.plants import at
from validation.effects.stages import Matrices, heavier


def change(stage: Matrices, targets: tuple[str, ...], values: Values) -> Matrices:
    """``M += m phi^T phi``; the base is among the coordinates, and with it L and M_F."""
    phi = stage.places[targets[0]]
    return heavier(stage, values[""] * phi.T @ phi)


FAMILY = Family(
    name="point-mass",
    side=STRUCTURE,
    what="a mass at a place",
    targets=(PLACE,),
    sizes=MASS,
    example="point-mass:mast-top=0.5",
    stage=STRUCTURE_STAGE,
    change=change,
    limits=limits_of_mass,
    equation="M += m φᵀφ, L += m φᵀΓ, M_F += m ΓᵀΓ",
    mistaken_for=("rigid-inertia", "joint-compliance", "absorber"),
    confirmed_by="weigh the article again; modes with a node at the place, which do not move and tell it from a neighbouring one",
    reference="Rayleigh, The Theory of Sound, 1877, chapter 4 (small changes of a system); D. J. Ewins, Modal Testing, 2000",
    sentence="Something of this mass sits at {target} that the model does not have, or is missing there when "
    "the figure is negative.",
    plant=at("rig", "point_mass"),
)
