"""Where a structure that is taken for rigid still nearly is: below the first resonance that its dynamic mass shows.

The dynamic mass of a rigid body is the same at every line (Eq. 1). One diagonal entry that has grown by half is on its way to a
resonance, and the largest value before it falls again is where it stands; one that grows up to the last line resonates beyond it.
Elasticity raises the dynamic mass by about (f / f1)² below it, so that a few per cent remain in a band that ends well below.
"""

from __future__ import annotations

import numpy as np

from geometry.dynamic_mass import DynamicMass
from geometry.frames import Array
from identification.elastic.fit import fit

GROWN = 1.5
"""Of its size at the low end, from which an entry of the dynamic mass rises towards a resonance: no sensor is as wrong."""

FALLEN = 0.7
"""Of its largest value so far, below which an entry has passed its peak: noise alone does not throw it down so far."""

STOP = 0.6
"""Where a rigid band ends, as a share of the first resonance."""

LOW_END = 0.05
"""Share of the lines that is their low end."""

FEWEST = 10
"""Lines that a band keeps however low the resonance: fewer cannot tell how far the result still moves with the band."""


def first_resonance(dynamic_mass: DynamicMass) -> float | None:
    """The lowest frequency [Hz] at which a diagonal entry of `dynamic_mass` peaks; the last line where one grows to the end.

    None where nothing resonates in sight of the band.
    """
    size = np.abs(np.diagonal(dynamic_mass.matrix, axis1=1, axis2=2))
    found = [at for at in map(_peak, size.T) if at is not None]
    return float(dynamic_mass.frequency[min(found)]) if found else None


def stop_below(resonance: float, frequency: Array) -> float:
    """Where a rigid band on the lines `frequency` (n,) [Hz] ends [Hz]."""
    return max(STOP * resonance, float(frequency[min(FEWEST, len(frequency)) - 1]))


def _peak(size: Array) -> int | None:
    """Index of the first maximum of an entry's size (n,) after it has grown."""
    level = float(np.median(size[: max(int(LOW_END * len(size)), 3)]))
    grown = np.flatnonzero(size > GROWN * level)
    if not len(grown):
        return None
    rising = size[grown[0] :]
    fallen = np.flatnonzero(rising < FALLEN * np.maximum.accumulate(rising))
    return int(grown[0] + np.argmax(rising[: fallen[0]] if len(fallen) else rising))


# What a rigid-body fit of an elastic structure is off by: how far it moves when only the lowest lines are left.
#
# A rigid body has the same ten parameters in every band, with the same errors of the measurement chain. Elasticity grows with
# omega² below the first resonance and has any size beyond, so that the fit over the band differs from that over its low end. The
# difference is taken for one standard deviation, in the direction in which it points, where it exceeds the scatter of the low
# end.


LOW_END_SHARE = 0.1
"""Share of the band that is its low end."""

LOW_END_LINES = 5
"""Lines at least that make a low end."""


SIGNIFICANT = 18.3
"""Square of the difference in its scatter, 95th percentile of ten."""


def drift(dynamic_mass: DynamicMass, floor: float) -> Array:
    """(10,) rigid fit over all lines of `dynamic_mass` less that over its low end; zero where noise alone differs as much."""
    f = dynamic_mass.frequency
    high = max(float(f[0] + LOW_END_SHARE * (f[-1] - f[0])), float(f[min(LOW_END_LINES, len(f)) - 1]))
    whole, low = (fit(dynamic_mass, modes=0, floor=floor, band=band) for band in (None, (float(f[0]), high)))
    moved = np.asarray(whole.parameters - low.parameters)
    scatter = low.covariance * min(low.misfit, 1.0)
    size = np.sqrt(np.maximum(np.diag(scatter), np.finfo(np.float64).tiny))
    distance = moved / size @ np.linalg.pinv(scatter / np.outer(size, size), hermitian=True) @ (moved / size)
    return moved if distance > SIGNIFICANT else np.zeros(10)
