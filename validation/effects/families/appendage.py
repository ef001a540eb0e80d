"""`appendage`: something that swings on the cover plate, beside the article."""

from dataclasses import replace

import numpy as np

from geometry.frames import rigid_transformation
from validation.effects.effect import AXES, BODY_STAGE, STRUCTURE, Family, Values, resonator
from validation.effects.plants import at
from validation.effects.stages import MountedDynamicMass


def change(stage: MountedDynamicMass, targets: tuple[str, ...], values: Values) -> MountedDynamicMass:
    """The dynamic mass of a resonator along an axis at F, which lies at minus the seat, seen from where the article stands."""
    m, zeta = values["m"], values["zeta"]
    omega, own = 2 * np.pi * stage.frequency, 2 * np.pi * values["f"]
    spring = own**2 + 2j * zeta * own * omega
    row = rigid_transformation(-stage.seat)[AXES.index(targets[0])]
    return replace(stage, matrix=stage.matrix + (m * spring / (spring - omega**2))[:, None, None] * np.outer(row, row))


FAMILY = Family(
    name="appendage",
    side=STRUCTURE,
    what="a resonator on the cover plate",
    targets=("axis",),
    sizes=resonator(100.0),
    example="appendage:z=m:0.05,f:21,zeta:0.01",
    stage=BODY_STAGE,
    change=change,
    equation="H_kk += m (ω_a² + 2iζω_aω) / (ω_a² - ω² + 2iζω_aω)",
    mistaken_for=("slosh", "absorber", "point-mass"),
    confirmed_by="the FMD with nothing on it: it is still there, and a mode that the model lacks is not; "
    "look for loose cables and covers that swing at that frequency",
    reference="J. P. Den Hartog, Mechanical Vibrations, 1956, section 3.2; paper Eq. 8",
    sentence="Something that is not the article swings along {target} on the cover plate: a cover, a connector, a loose cable.",
    plant=at("rig", "appendage"),
)
