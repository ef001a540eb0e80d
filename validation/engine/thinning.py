"""Which lines a fit uses: few where nothing happens, more where the level of the channels turns quickly with frequency.

Beside resonances the model's own error is strongly correlated from line to line, so that neighbours add time and false certainty
(identification/self_calibration/lines.py). Lines are therefore spread evenly over a measure of what happens: half of it is the
frequency itself, half the turning of the levels, each line counted no more than `STEEPEST`. Phases turn with the sweep.
"""

from __future__ import annotations

import numpy as np

from geometry.arrays import Array
from identification.self_calibration.elimination import smoothed_level
from validation.engine.measured import Measured
from validation.engine.prediction import Lines

AT_MOST = 100
"""Lines of one data set that a fit uses."""

STEEPEST = 0.3
"""Relative change from one line to the next beyond which steeper is no steeper: a resonance between two lines."""


def chosen(measured: Measured, *, at_most: int = AT_MOST) -> Lines:
    """(m,) indices of at most `at_most` lines that fits use, the same whatever the model: parent and child stay comparable."""
    count = len(measured.frequency)
    if count <= at_most:
        return np.arange(count, dtype=np.int64)
    turned = _turning(smoothed_level(measured.frequency, measured.values).transpose(1, 0, 2))
    even = np.diff(measured.frequency) / (measured.frequency[-1] - measured.frequency[0])
    share = 0.5 * even + 0.5 * (turned / turned.sum() if turned.sum() > 0 else even)
    along = np.concatenate([[0.0], np.cumsum(share)])
    wanted = np.linspace(0.0, along[-1], at_most)
    return np.unique(np.round(np.interp(wanted, along, np.arange(count))).astype(np.int64))


def _turning(level: Array) -> Array:
    """(n - 1,) relative change of `level` (n, r, c) from line to line, rms over runs and channels."""
    flat = level.reshape(len(level), -1)
    highest = np.maximum(np.maximum(flat[1:], flat[:-1]), np.finfo(np.float64).tiny)
    relative = np.abs(np.diff(flat, axis=0)) / highest
    return np.asarray(np.minimum(np.sqrt(np.mean(relative**2, axis=1)), STEEPEST))
