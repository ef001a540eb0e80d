"""`rigid-inertia`: one of the article's ten inertia parameters is not what the drawing says."""

import numpy as np

from geometry.frames import rigid_transformation_6
from geometry.inertia import PARAMETERS, Inertia
from validation.effects.effect import FIRST, MASS, SECOND, STRUCTURE, STRUCTURE_STAGE, Family, Values
from validation.effects.plants import at
from validation.effects.stages import Matrices, heavier


def change(stage: Matrices, targets: tuple[str, ...], values: Values) -> Matrices:
    """``M += dp R^T E_k R``, E_k the mass matrix of a unit of the parameter about the centre of gravity, moved to the origin.

    R says what each coordinate moves the body as a whole: those of the base, or of a structure that floats.
    """
    unit = np.array([float(one == targets[0]) for one in PARAMETERS])
    E = Inertia(parameters=unit, reference_point=np.zeros(3)).mass_matrix
    G = rigid_transformation_6(stage.cog) @ stage.rigid
    return heavier(stage, values[""] * G.T @ E @ G)


FAMILY = Family(
    name="rigid-inertia",
    side=STRUCTURE,
    what="a parameter of the article, about its centre of gravity",
    targets=("parameter",),
    sizes=SECOND,
    varying={"m": MASS, "mx": FIRST, "my": FIRST, "mz": FIRST},
    example="rigid-inertia:Ixx=0.2",
    stage=STRUCTURE_STAGE,
    change=change,
    equation="H += Σ_k dp_k E_k, ten constant matrices about the centre of gravity",
    mistaken_for=("force-gain", "point-mass", "mounting-offset", "force-plane-offset"),
    confirmed_by="weigh it, hang it for its centre of gravity, swing it on a pendulum; the Cuboid on the same FMD",
    reference="paper Eqs. 1 and 4; C. G. Atkeson, C. H. An and J. M. Hollerbach, Int. J. Robotics Research 5 (1986), 101",
    sentence="The article's inertia parameter {target} differs from the drawing by this much, with no effect on how it bends.",
    plant=at("rig", "rigid_inertia"),
)
