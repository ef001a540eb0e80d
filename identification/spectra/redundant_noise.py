"""Noise of spectra that come without a quiet part: what redundant channels contradict each other by, from line to line.

Eight accelerometers tell six motions, eight force channels six resultants. What is left over is noise, and gains, positions and
angles that are off. The latter are transfer functions: as shares of the driven motion they go smoothly over the lines, while
noise does not. The fourth difference of neighbouring lines leaves noise alone.
"""

from __future__ import annotations

from dataclasses import replace
from math import comb

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import LEVELS, MOTIONS, ComplexArray
from geometry.errors import BadInput
from identification.base_motion import BaseMotion, base_motion
from identification.resultants import resultants
from identification.spectra.line_spectra import Spectra

ORDER = 4
"""Of the difference: what changes over five lines like a cubic is no noise."""

FEWEST = 20
"""Lines that an estimate takes."""

ROUNDING = 1e-12
"""Share of the level of a channel below which a difference is rounding, and its noise counts as 0."""

NOMINAL = np.array([LEVELS[axis] for axis in MOTIONS])


def of_redundancy(spectra: Spectra, gravity: float) -> Array:
    """(r, n, c) standard deviation, E|noise|² = sd²: one for the accelerometers and one for the force channels of every run.

    0 for channels of a quantity that is not redundant, and where there are too few lines.
    """
    noise = np.zeros(spectra.values.shape)
    if len(spectra.frequency) < FEWEST:
        return noise
    even = replace(spectra, noise=np.ones(spectra.values.shape))
    try:
        motion, load = base_motion(even, gravity=gravity), resultants(even)
    except BadInput:  # channels that do not tell six of each: whoever needs them says which
        return noise
    driven = _driven(motion)
    for quantity, left, expected in (("acceleration", motion.residual, motion.expected), ("force", load.parity, load.expected)):
        chosen = list(spectra.table.select(quantity=quantity))
        if left.shape[2] and chosen and np.any(expected > 0):
            noise[:, :, chosen] = _sd(left, expected, driven)[:, None, None]
    level = np.sqrt(np.mean(np.square(np.abs(spectra.values)), axis=(0, 1)))
    return np.where(noise > ROUNDING * level, noise, 0.0)


def _driven(motion: BaseMotion) -> ComplexArray:
    """(r, n) the motion of every run that is largest by its nominal level."""
    largest = np.argmax(np.mean(np.abs(motion.values / NOMINAL), axis=1), axis=1)
    return motion.values[np.arange(len(largest)), :, largest]


def _sd(left: ComplexArray, expected: Array, driven: ComplexArray) -> Array:
    """(r,) from what is left over (r, n, k), `expected` of channels with noise of 1; the median of complex noise is sd √ln 2."""
    size = np.maximum(np.abs(driven), np.finfo(np.float64).tiny)[:, :, None]
    share = left * (driven.conj() / np.abs(size[..., 0]) ** 2)[:, :, None]
    weight = np.sqrt(sum(comb(ORDER, k) ** 2 for k in range(ORDER + 1)))
    middle = slice(ORDER // 2, -(ORDER // 2))
    noisy = np.abs(np.diff(share, n=ORDER, axis=1)) / weight * size[:, middle] / np.sqrt(np.log(2))
    seen = np.maximum(np.median(expected, axis=1), np.finfo(np.float64).tiny)
    return np.asarray(np.median(np.median(noisy, axis=1) / seen, axis=1))
