"""As many lines as a figure has pixels for, the worst of those that share one."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from geometry.arrays import Array

MOST = 280
"""Columns of a map."""


def worst(frequency: Array, values: Array, most: int = MOST) -> tuple[Array, Array]:
    """`frequency` (n,) and `values` (n, ...) in at most `most` columns: the middle of each, and the greatest value in it."""
    n = len(frequency)
    if n <= most:
        return frequency, values
    edges = np.unique(np.linspace(0, n, most + 1).astype(int))
    middle = np.array([frequency[(a + b - 1) // 2] for a, b in pairwise(edges)])
    return middle, np.maximum.reduceat(values, edges[:-1], axis=0)
