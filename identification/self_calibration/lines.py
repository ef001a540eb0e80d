"""Which lines the joint fit uses: few where H is smooth, all of them across a resonance.

Model error is strongly correlated from line to line, so neighbours add time and no information. A resonance of width 2 zeta f is
told by the lines within a few widths of it.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array
from identification.elastic.terms import ElasticTerms

SMOOTH = 60
"""Lines over the band where nothing resonates."""

WIDTHS = 4.0
"""Half-power widths to either side of a pole within which every line counts."""

AT_MOST = 200
"""Lines in all: across resonances every second or third is taken where there are more."""

Indices = npt.NDArray[np.int64]


def chosen(frequency: Array, terms: ElasticTerms | None = None, *, smooth: int = SMOOTH, at_most: int = AT_MOST) -> Indices:
    """Indices of the lines of `frequency` (n,) [Hz] to use, ascending."""
    even = np.unique(np.round(np.linspace(0, len(frequency) - 1, min(smooth, len(frequency)))).astype(np.int64))
    if terms is None or not len(terms.frequency):
        return even
    width = 2 * terms.damping_ratio * terms.frequency
    near = np.any(np.abs(frequency[:, None] - terms.frequency) <= WIDTHS * width, axis=1)
    resonant = np.setdiff1d(np.flatnonzero(near), even)
    step = max(int(np.ceil(len(resonant) / max(at_most - len(even), 1))), 1)
    closest = np.argmin(np.abs(frequency[:, None] - terms.frequency), axis=0)
    return np.unique(np.concatenate([even, resonant[::step], closest])).astype(np.int64)
