"""Gravity in the chain: what a tilt adds to the acceleration that a structure feels and that an accelerometer reads.

A body that has turned by phi carries its axes with it: in them the free fall that it lacks, a - g, has gained -g (phi x e_z)
along x and y. With phi = -alpha'' / omega² and so on, one matrix holds the whole effect for every place of the body:

    apparent u = (I + g/omega² E) u,      E[x, beta] = 1,  E[y, alpha] = -1,  E² = 0.

The latent u of the chain is the apparent acceleration that drives the *structure*. A sensor that tilts reads the same, and
gravity cancels; a kinematic one reads (I - g/omega² E) u.
"""

from __future__ import annotations

import numpy as np

from geometry.arrays import Array
from identification.gravity import TILT

STRUCTURE = "gravity"
SENSOR = "accelerometer-tilt"


def turned(rows: Array) -> Array:
    """``rows @ E`` of rows (..., 6)."""
    return np.asarray(rows @ TILT)
