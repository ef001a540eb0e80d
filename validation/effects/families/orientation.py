"""`orientation`: the article stands turned."""

from dataclasses import replace
from math import pi

import numpy as np

from geometry.frames import rotation_about
from validation.effects.effect import BODY_STAGE, STRUCTURE, Family, SizeSpec, Values
from validation.effects.plants import at
from validation.effects.stages import MountedDynamicMass


def change(stage: MountedDynamicMass, targets: tuple[str, ...], values: Values) -> MountedDynamicMass:
    """``R H R^T`` about the article's own z axis; before a `mounting-offset`, which would otherwise turn with it."""
    R = np.kron(np.eye(2), rotation_about(targets[0], values[""]))
    return replace(stage, matrix=R @ stage.matrix @ R.T)


FAMILY = Family(
    name="orientation",
    side=STRUCTURE,
    what="the article turned on the cover plate",
    targets=("turning axis",),
    sizes=(SizeSpec(unit="rad", low=-pi, high=pi, plausible=0.03),),
    example="orientation:z=0.01",
    stage=BODY_STAGE,
    change=change,
    equation="R H Rᵀ",
    mistaken_for=("rigid-inertia:Ixy", "force-crosstalk", "accelerometer-misalignment"),
    confirmed_by="mount it again, turned by 90° and by 180°: the angle changes, a product of inertia turns along",
    reference="paper Eq. 3 and section 2.1 (axes of the reference point); R. M. Murray, Z. Li and S. S. Sastry, A Mathematical "
    "Introduction to Robotic Manipulation, 1994, chapter 2",
    sentence="The article was bolted on turned about {target} by this angle.",
    plant=at("rig", "orientation"),
)
