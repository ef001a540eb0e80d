"""`joint-compliance`: the flange is not rigid on the cover plate."""

from dataclasses import replace

import numpy as np

from validation.effects.effect import BODY_STAGE, SHIFTING, STRUCTURE, TURNING, Family, Values
from validation.effects.plants import at
from validation.effects.stages import MountedDynamicMass

DIRECTIONS = {"lateral": (0, 1), "vertical": (2,), "rotation": (3, 4), "torsion": (5,)}
"""Which of x, y, z, alpha, beta, gamma a direction means."""


def change(stage: MountedDynamicMass, targets: tuple[str, ...], values: Values) -> MountedDynamicMass:
    """``H' = (I - omega² H C)^-1 H``: under the load f the article lags behind its base by C f, without loss."""
    C = np.zeros((6, 6))
    gives = list(DIRECTIONS[targets[0]])
    C[gives, gives] = values[""]
    omega = 2 * np.pi * stage.frequency[:, None, None]
    H = np.linalg.solve(np.eye(6) - omega**2 * stage.matrix @ C, stage.matrix)
    return replace(stage, matrix=np.asarray(H, dtype=np.complex128))


FAMILY = Family(
    name="joint-compliance",
    side=STRUCTURE,
    what="compliance of the joint between flange and cover plate",
    targets=("direction of the joint",),
    sizes=SHIFTING,
    varying={"rotation": TURNING, "torsion": TURNING},
    example="joint-compliance:rotation=1e-6",
    stage=BODY_STAGE,
    change=change,
    equation="H' = (I - ω² H C)⁻¹ H",
    mistaken_for=("modulus", "fmd-compliance", "cover-plate-flexibility"),
    confirmed_by="one blade against four, which load one joint differently; torque the bolts again; a model that keeps the "
    "residual mass of its truncated modes, without which it shows up as a vertical joint",
    reference="D. de Klerk, D. J. Rixen and S. N. Voormeeren, AIAA Journal 46 (2008), 1169 (coupling through a compliance); "
    "R. A. Ibrahim and C. L. Pettit, J. Sound and Vibration 279 (2005), 857 (bolted joints)",
    sentence="Between the article's flange and the cover plate something gives ({target}): every frequency falls a little, those "
    "that load the joint most.",
    plant=at("rig", "joint"),
)
