"""`connection-compliance`: a joint between two parts gives more than the model says."""

from dataclasses import replace

import numpy as np

from geometry.dynamic_mass import MOTIONS
from validation.effects.effect import BETWEEN, EVERY, SHIFTING, STRUCTURE, STRUCTURE_STAGE, TURNING, Family, Values
from validation.effects.stages import Matrices


def change(stage: Matrices, targets: tuple[str, ...], values: Values) -> Matrices:
    """``K -= c p p^T / (1 + c k)``: a spring of 1/c in series with k, p what the joint carries along the direction."""
    names, d, c = stage.joints if targets[0] == EVERY else (targets[0],), MOTIONS.index(targets[1]), values[""]
    stiffness = np.array(stage.stiffness)
    for name in names:
        joint = stage.joints[name]
        share = np.trace(stage.parts[name]) / joint.trace  # what a modulus has made of it
        p, k = share * joint.loads[d], share * joint.stiffness[d]
        stiffness -= c / (1 + c * k) * np.outer(p, p)
    return replace(stage, stiffness=stiffness)


FAMILY = Family(
    name="connection-compliance",
    side=STRUCTURE,
    what="compliance of a joint between two parts, or of every joint alike",
    targets=(BETWEEN, "direction at a joint"),
    sizes=SHIFTING,
    varying=dict.fromkeys(MOTIONS[3:], TURNING),
    example="connection-compliance:bolt:z=1e-8",
    stage=STRUCTURE_STAGE,
    change=change,
    equation="1/k' = 1/k + c, K += (k' - k) g gᵀ",
    mistaken_for=("modulus", "joint-compliance", "support-stiffness"),
    confirmed_by="torque the bolts again; two accelerometers, one on either side of the joint",
    reference="R. A. Ibrahim and C. L. Pettit, J. Sound and Vibration 279 (2005), 857 (bolted joints); J. Sherman and W. J. "
    "Morrison, Annals of Mathematical Statistics 21 (1950), 124 (change of a matrix by one product)",
    sentence="The parts that {target} joins give against each other more than the model says.",
)
