"""`mounting-offset`: the article stands beside its place."""

from dataclasses import replace

import numpy as np

from geometry.frames import rigid_transformation_6
from validation.effects.effect import AXES, BODY_STAGE, LENGTH, STRUCTURE, Family, Values
from validation.effects.plants import at
from validation.effects.stages import MountedDynamicMass


def change(stage: MountedDynamicMass, targets: tuple[str, ...], values: Values) -> MountedDynamicMass:
    """``T^T H T``: the drawn place of the article's origin sees it from beside."""
    T = rigid_transformation_6(values[""] * np.eye(3)[AXES.index(targets[0])])
    return replace(stage, matrix=T.T @ stage.matrix @ T)


FAMILY = Family(
    name="mounting-offset",
    side=STRUCTURE,
    what="the article shifted on the cover plate",
    targets=("lateral axis",),
    sizes=LENGTH,
    example="mounting-offset:x=0.002",
    stage=BODY_STAGE,
    change=change,
    equation="Tᵀ H T",
    mistaken_for=("rigid-inertia:mx", "rigid-inertia:my", "force-gain", "accelerometer-position"),
    confirmed_by="mount it again, turned by 180°: the offset stays where it was, a shifted centre of gravity turns along",
    reference="paper Eq. 3; J. Wittenburg, Dynamics of Multibody Systems, 2008, section 3.1 (parallel axes)",
    sentence="The article stands beside its place by this much along {target}.",
    plant=at("rig", "offset"),
)
