"""Gravity has two halves: the weight of a tilted body, and the tilt that accelerometers feel. Here is the one that is missing.

What an accelerometer reads is a - g in its own axes, the *apparent* acceleration, and a body that tilts with the base answers to
just that: f = H u with apparent u has no term of gravity. A *kinematic* motion - optical, or the table's control - lacks it:

    u_apparent = (1 + g/omega² E) u_kinematic,    E[x, beta] = 1, E[y, alpha] = -1

A dynamic mass against kinematic motions is H (1 + g/omega² E), not symmetric any more; E² = 0, so its inverse is 1 - g/omega² E.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array
from geometry.dynamic_mass import MOTIONS, DynamicMass
from geometry.errors import BadInput

TILT = np.zeros((6, 6))
"""E, the one place where its signs stand."""
TILT[MOTIONS.index("x"), MOTIONS.index("beta")] = 1.0
TILT[MOTIONS.index("y"), MOTIONS.index("alpha")] = -1.0
TILT.setflags(write=False)


def tilt(frequency: npt.ArrayLike, gravity: float) -> Array:
    """(n, 6, 6) apparent from kinematic accelerations at `frequency` (n,) [Hz], `gravity` [m/s²].

    Raises
    ------
    BadInput : a line at 0 Hz, where an acceleration tells no tilt.
    """
    lines = np.atleast_1d(np.asarray(frequency, dtype=np.float64))
    if gravity and not np.all(lines > 0):
        problem = f"a tilt follows from an acceleration above 0 Hz only, found {lines.min():g} Hz"
        raise BadInput(source="gravity", field="frequency", problem=problem, remedy="Leave the line out")
    share = np.divide(gravity, (2 * np.pi * lines) ** 2, out=np.zeros_like(lines), where=lines > 0)
    return np.asarray(np.eye(6) + share[:, None, None] * TILT)


def against_apparent(dynamic_mass: DynamicMass, gravity: float) -> DynamicMass:
    """A dynamic mass measured against kinematic motions, as it is against apparent ones."""
    H = dynamic_mass.matrix @ np.linalg.inv(tilt(dynamic_mass.frequency, gravity))
    return DynamicMass(frequency=dynamic_mass.frequency, matrix=H, reference_point=dynamic_mass.reference_point)
