"""Equations of what happens to whole channels, each linear in the rows that it gets."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from validation.effects.family import Values
from validation.effects.stages import Reading


def inverted(reading: Reading, targets: tuple[str, ...], values: Values) -> Reading:
    """``-y``"""
    return times(reading, targets[0], -1.0)


def scaled(reading: Reading, targets: tuple[str, ...], values: Values) -> Reading:
    """``factor y``"""
    return times(reading, targets[0], values[""])


def swapped(reading: Reading, targets: tuple[str, ...], values: Values) -> Reading:
    """Each of two channels reads what the other would."""
    order = np.arange(len(reading.channels))
    one, other = (reading.column(name) for name in targets)
    order[[one, other]] = other, one
    amplitude, peak = (one[..., order] if one.size else one for one in (reading.amplitude, reading.peak))
    return replace(reading, rows=reading.rows[:, order], amplitude=amplitude, peak=peak)


def times(reading: Reading, channel: str, factor: float) -> Reading:
    """`reading` with one channel multiplied."""
    factors = np.ones(len(reading.channels))
    factors[reading.column(channel)] = factor
    amplitude, peak = (one * np.abs(factors) if one.size else one for one in (reading.amplitude, reading.peak))
    return replace(reading, rows=reading.rows * factors[:, None], amplitude=amplitude, peak=peak)
