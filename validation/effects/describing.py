"""Describing functions: what a channel that is not linear reads of a sine, as a share of what it should read.

The fundamental alone: a slow sweep is a sine at every moment, and its harmonics appear at other lines, where the sweep is at
another time. They are not predicted; a full-record spectrum holds them at three times the frequency, small as they are.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from geometry.arrays import Array
from validation.effects.family import Values
from validation.effects.stages import Reading

TINY = float(np.finfo(np.float64).tiny)

WARP = {"1": (1, -1, 1, -1), "2": (-1, 1, -1, 1), "3": (1, -1, 1, -1), "4": (-1, 1, -1, 1)}
"""What four cells on a square, numbered around, can carry against each other without any resultant."""

CELLS = ("fmd-z1", "fmd-z2", "fmd-z3", "fmd-z4")


def saturated(reading: Reading, targets: tuple[str, ...], values: Values) -> Reading:
    """``y (1 - 3/4 s (a / y_p)²)``, a the amplitude at a line and y_p the peak of the run at nominal level."""
    k = reading.column(targets[0])
    a = amplitude_of(reading, k)
    peak = reading.peak[k] if reading.peak.size else np.max(a, initial=0.0)
    rows = np.array(reading.rows)
    rows[:, k] *= (1 - 0.75 * values[""] * (a / max(peak, TINY)) ** 2)[:, None]
    return replace(reading, rows=rows)


def lifted(reading: Reading, targets: tuple[str, ...], values: Values) -> Reading:
    """A cell pulls no more than its preload. What it lacks goes to the other three, in the one pattern that has no resultant."""
    cell = reading.column(CELLS[int(targets[0]) - 1])
    lost = 1 - clipped(values[""], amplitude_of(reading, cell))
    rows, missing = np.array(reading.rows), lost[:, None] * reading.rows[:, cell]
    for name, share in zip(CELLS, WARP[targets[0]], strict=True):
        rows[:, reading.column(name)] -= share * missing
    return replace(reading, rows=rows)


def clipped(preload: float, amplitude: Array) -> Array:
    """(n,) share of the fundamental that is left of a sine of `amplitude` (n,) cut off at -`preload` on one side."""
    p = np.divide(np.minimum(preload, amplitude), amplitude, out=np.ones_like(amplitude), where=amplitude > 0)
    return np.asarray(0.5 + (np.arcsin(p) + p * np.sqrt(1 - p**2)) / np.pi)


def amplitude_of(reading: Reading, column: int) -> Array:
    """(n,) amplitude in time of a channel; zeros where the run does not state it."""
    return reading.amplitude[:, column] if reading.amplitude.size else np.zeros(len(reading.frequency))
