"""Which lines the joint fit uses: few where H is smooth, all of them across a resonance.

Beside resonances the model's own error is strongly correlated from line to line, so that neighbours add time and little else. A
resonance of width 2 zeta f is told by the lines within a few widths of it. A set-up without any is told by its noise, which more
lines average out: with 240 instead of 60 the moments of Cuboid and disc came out twice as well.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array
from identification.elastic.terms import ElasticTerms

SMOOTH = 60
"""Lines over the band beside resonances."""

RIGID = 240
"""Lines over the band of a set-up in which nothing resonates."""

WIDTHS = 4.0
"""Half-power widths to either side of a pole within which every line counts."""

AT_MOST = 200
"""Lines in all: across resonances every second or third is taken where there are more."""

Indices = npt.NDArray[np.int64]


def chosen(frequency: Array, terms: ElasticTerms | None = None, *, smooth: int = SMOOTH, at_most: int = AT_MOST) -> Indices:
    """Indices of the lines of `frequency` (n,) [Hz] to use, ascending."""
    rigid = terms is None or not len(terms.frequency)
    count = min(max(smooth, RIGID) if rigid else smooth, len(frequency))
    even = np.unique(np.round(np.linspace(0, len(frequency) - 1, count)).astype(np.int64))
    if terms is None or rigid:
        return even
    width = 2 * terms.damping_ratio * terms.frequency
    near = np.any(np.abs(frequency[:, None] - terms.frequency) <= WIDTHS * width, axis=1)
    resonant = np.setdiff1d(np.flatnonzero(near), even)
    step = max(int(np.ceil(len(resonant) / max(at_most - len(even), 1))), 1)
    closest = np.argmin(np.abs(frequency[:, None] - terms.frequency), axis=0)
    return np.unique(np.concatenate([even, resonant[::step], closest])).astype(np.int64)
