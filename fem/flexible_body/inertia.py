"""The door to exudyn: the inertia of a rigid body, there and back.

Exudyn's `RigidBodyInertia` holds the mass, the centre of mass and the tensor about the body's reference point, products as matrix
entries; its list of six orders them Jxx, Jyy, Jzz, Jyz, Jxz, Jxy. Asked for something impossible it prints a line and goes on, so
what enters is judged first and what it says to the console is held back: standard output belongs to the user's result.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import numpy.typing as npt

from geometry.consistency import require_physical
from geometry.inertia import Inertia

ORDER_OF_SIX = [0, 1, 2, 5, 4, 3]
"""Exudyn's xx, yy, zz, yz, xz, xy read as xx, yy, zz, xy, xz, yz; the exchange is its own inverse."""

ExudynInertia = Any
"""An `exudyn.rigidBodyUtilities.RigidBodyInertia`; the library has no types of its own."""


@contextmanager
def quiet() -> Iterator[Any]:
    """The exudyn module with its console output held back, restored at the end."""
    import exudyn

    before = exudyn.config.printToConsole
    exudyn.config.printToConsole = False
    try:
        yield exudyn
    finally:
        exudyn.config.printToConsole = before


def to_exudyn(inertia: Inertia, source: str = "inertia") -> ExudynInertia:
    """`inertia` as exudyn's `RigidBodyInertia`; the body's reference point there is `inertia.reference_point`.

    Raises
    ------
    BadInput : no body has these parameters; `source` says where they came from. Exudyn itself would only print a line.
    """
    body = require_physical(inertia, source)
    with quiet():
        from exudyn import rigidBodyUtilities

        make: Any = rigidBodyUtilities.RigidBodyInertia
        return make(mass=body.mass, inertiaTensor=body.tensor, com=body.first_moment / body.mass)


def from_exudyn(body: ExudynInertia, reference_point: npt.ArrayLike = (0.0, 0.0, 0.0)) -> Inertia:
    """A `RigidBodyInertia` as `Inertia`; its reference point lies at `reference_point` (3,) [m] of the body's frame."""
    six = np.asarray(body.GetInertia6D(), dtype=np.float64)[ORDER_OF_SIX]
    parameters = np.concatenate([[body.Mass()], body.Mass() * np.asarray(body.COM()), six])
    return Inertia(parameters=parameters, reference_point=np.asarray(reference_point, dtype=np.float64))
