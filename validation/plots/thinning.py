"""As many lines as a figure has pixels for, the worst of those that share one."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from geometry.arrays import Array

MOST = 280
"""Columns of a map."""


class Thinned(NamedTuple):
    """Lines in columns.

    Attributes
    ----------
    middle : (m,) [Hz] of each column
    values : (m, ...) the greatest of each column; NaN where all of it is
    at : (m, ...) [Hz] of the line that has it
    """

    middle: Array
    values: Array
    at: Array


def worst(frequency: Array, values: Array, most: int = MOST) -> Thinned:
    """`frequency` (n,) [Hz] and `values` (n, ...) in at most `most` columns; a value that is NaN hides no other."""
    n = len(frequency)
    edges = np.arange(n + 1) if n <= most else np.unique(np.linspace(0, n, most + 1).astype(int))
    known = np.where(np.isnan(values), -np.inf, values)
    lines = np.array([a + np.argmax(known[a:b], axis=0) for a, b in pairwise(edges)])
    middle = np.array([frequency[(a + b - 1) // 2] for a, b in pairwise(edges)])
    return Thinned(middle, np.take_along_axis(values, lines, axis=0), frequency[lines])
