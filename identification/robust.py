"""Robust weights: equations that do not fit the others lose their say (iteratively reweighted least squares).

Equations come in groups of s complex numbers that belong together, whitened: the size of a group is the rms of its residuals, 1
where nothing is wrong but the noise. The scale by which sizes are divided comes from their median, which half of the groups may
spoil without moving it far. Huber's weights fall off as 1/size and never to zero, so that there is one minimum; Tukey's biweight
takes gross errors out altogether (Huber, Robust Statistics, 1981; Holland and Welsch, Commun. Statist. A6, 1977).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np

from geometry.arrays import Array


def huber(size: Array, corner: float = 1.5) -> Array:
    """Weights of groups of this `size`: 1 up to the corner, then falling as 1/size."""
    return np.asarray(corner / np.maximum(size, corner))


def tukey(size: Array, corner: float = 4.0) -> Array:
    """Weights of groups of this `size`: smoothly from 1 to 0 at the corner, 0 beyond."""
    return np.asarray(np.square(1 - np.square(np.minimum(size / corner, 1))))


WEIGHTS: Mapping[str, Callable[[Array], Array]] = MappingProxyType({"": np.ones_like, "huber": huber, "tukey": tukey})
"""Robust weights by name; the empty name weighs all alike."""


def scale(size: Array, together: int) -> float:
    """The size of a sound group of `together` complex numbers from the median of all.

    The mean square of s complex normal numbers has the median (1 - 1/(9 s))³ (Wilson and Hilferty, PNAS 17, 1931).
    """
    return float(np.median(size) / (1 - 1 / (9 * together)) ** 1.5)
