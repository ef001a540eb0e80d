"""A frame of rigid floors that shift sideways, as the engine takes it: masses and springs put on their modes."""

from __future__ import annotations

import numpy as np

from geometry.frames import Array
from validation.effects.stages import Matrices
from validation.model.model import StructureTolerances
from validation.prediction import effects as prediction_effects
from validation.prediction.effects import Nuisances

FLOORS = ("floor-1", "floor-2", "floor-3")


def on_modes(mass: Array, stiffness: Array, damping_ratio: float, known: StructureTolerances) -> Nuisances:
    """`mass` [kg] and `stiffness` [N/m], (3, 3) in the shifts of the floors, on their modes; all of K is that of the legs."""
    from scipy.linalg import eigh

    squares, shapes = eigh(stiffness, mass)
    omega, none = np.sqrt(squares), np.zeros((3, 3))
    places = {floor: np.vstack([row, np.zeros((2, 3))]) for floor, row in zip(FLOORS, shapes, strict=True)}
    K, C = np.diag(squares), np.diag(2 * damping_ratio * omega)
    made = Matrices(base=0, mass=np.eye(3), stiffness=K, viscous=C, structural=none, places=places, parts={"legs": K})
    return prediction_effects.nuisances("frame", made, omega / (2 * np.pi), {}, known)
