"""What a rigid-body fit of an elastic structure is off by: how far it moves when only the lowest lines are left.

A rigid body has the same ten parameters in every band, with the same errors of the measurement chain. Elasticity grows with
omega² below the first resonance and has any size beyond, so that the fit over the band differs from that over its low end. The
difference is taken for one standard deviation, in the direction in which it points, where it exceeds the scatter of the low end.
"""

from __future__ import annotations

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import DynamicMass
from identification.elastic.fit import fit

LOW_END = 0.1
"""Share of the band that is its low end."""

FEWEST = 5
"""Lines at least that make a low end."""


SIGNIFICANT = 18.3
"""Square of the difference in its scatter, 95th percentile of ten."""


def drift(dynamic_mass: DynamicMass, floor: float) -> Array:
    """(10,) rigid fit over all lines of `dynamic_mass` less that over its low end; zero where noise alone differs as much."""
    f = dynamic_mass.frequency
    high = max(float(f[0] + LOW_END * (f[-1] - f[0])), float(f[min(FEWEST, len(f)) - 1]))
    whole, low = (fit(dynamic_mass, modes=0, floor=floor, band=band) for band in (None, (float(f[0]), high)))
    moved = np.asarray(whole.parameters - low.parameters)
    scatter = low.covariance * min(low.misfit, 1.0)
    size = np.sqrt(np.maximum(np.diag(scatter), np.finfo(np.float64).tiny))
    distance = moved / size @ np.linalg.pinv(scatter / np.outer(size, size), hermitian=True) @ (moved / size)
    return moved if distance > SIGNIFICANT else np.zeros(10)
