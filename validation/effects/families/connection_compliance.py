"""`connection-compliance`: a joint between two parts gives more than the model says."""

from dataclasses import replace

import numpy as np

from geometry.dynamic_mass import MOTIONS
from validation.effects.effect import BETWEEN, SHIFTING, STRUCTURE, STRUCTURE_STAGE, TURNING, Family, Values, joints_named
from validation.effects.stages import Matrices


def change(stage: Matrices, targets: tuple[str, ...], values: Values) -> Matrices:
    """``K -= c p p^T / (1 + c k)``: a spring of 1/c in series with k, p what the joint carries along the direction.

    The joint then has what is left of k, so that another compliance of it is in series with both, and loses its share of that.
    """
    names, d, c = joints_named(targets[0], tuple(stage.joints)), MOTIONS.index(targets[1]), values[""]
    stiffness, structural, joints = np.array(stage.stiffness), np.array(stage.structural), dict(stage.joints)
    for name in names:
        joint = stage.joints[name]
        share = np.trace(stage.parts[name]) / joint.trace  # what a modulus has made of it
        p, k = share * joint.loads[d], share * joint.stiffness[d]
        gone = c / (1 + c * k) * np.outer(p, p)
        stiffness -= gone
        structural -= stage.losses.get(name, 0.0) * stage.as_lost[:, None] * gone * stage.as_lost
        left = np.where(np.arange(6) == d, 1 / (1 + c * k), 1.0)
        joints[name] = replace(joint, loads=left[:, None] * joint.loads, stiffness=left * joint.stiffness)
    return replace(stage, stiffness=stiffness, structural=structural, joints=joints)


def straight(stage: Matrices, targets: tuple[str, ...], values: Values) -> float:
    """The compliance that the stiffest of the joints has of itself and by `values`."""
    names, d = joints_named(targets[0], tuple(stage.joints)), MOTIONS.index(targets[1])
    stiffest = max((stage.joints[name].stiffness[d] for name in names), default=0.0)
    return values[""] + 1 / stiffest if stiffest else np.inf


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
    straight=straight,
    equation="1/k' = 1/k + c, K += (1 + i η) (k' - k) g gᵀ",
    mistaken_for=("modulus", "joint-compliance", "support-stiffness"),
    confirmed_by="torque the bolts again; two accelerometers, one on either side of the joint",
    reference="R. A. Ibrahim and C. L. Pettit, J. Sound and Vibration 279 (2005), 857 (bolted joints); J. Sherman and W. J. "
    "Morrison, Annals of Mathematical Statistics 21 (1950), 124 (change of a matrix by one product)",
    sentence="The parts that {target} joins give against each other more than the model says.",
)
