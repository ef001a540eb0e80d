"""Gravity in what accelerometers read: apparent and kinematic base accelerations.

A pick-up that tilts reads a - g along its direction. For a small rotation of the base at the angular frequency omega its angle is
-alpha/omega², so that the six *apparent* accelerations of the base, those that accelerometers read, are

    x' = x + g/omega² beta,   y' = y - g/omega² alpha,   all others as they are

wherever on the base they sit. The load on a structure, its weight included, follows from the apparent motion as if there were no
gravity (`physics.md`). A kinematic pick-up - optical, or a control signal of the table - reads the motion without the dash.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array
from geometry.dynamic_mass import MOTIONS


def kinematic_of_apparent(frequency: npt.ArrayLike, gravity: float) -> Array:
    """(n, 6, 6): the kinematic base accelerations from the apparent ones, order of `MOTIONS`.

    Parameters
    ----------
    frequency : (n,) [Hz], above 0
    gravity : [m/s²]
    """
    omega = 2 * np.pi * np.atleast_1d(np.asarray(frequency, dtype=np.float64))
    tilt = np.broadcast_to(np.eye(6), (len(omega), 6, 6)).copy()
    tilt[:, MOTIONS.index("x"), MOTIONS.index("beta")] = -gravity / omega**2
    tilt[:, MOTIONS.index("y"), MOTIONS.index("alpha")] = gravity / omega**2
    return tilt
