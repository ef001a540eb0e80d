"""Equations of what happens to whole channels, each linear in the rows that it gets."""

from __future__ import annotations

from collections.abc import Callable
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
    return replace(reading, rows=reading.rows[:, order], **of_amplitude(reading, lambda amplitude: amplitude[:, order]))


def times(reading: Reading, channel: str, factor: float) -> Reading:
    """`reading` with one channel multiplied."""
    k, rows = reading.column(channel), np.array(reading.rows)
    rows[:, k] *= factor

    def louder(amplitude: np.ndarray) -> np.ndarray:
        changed = np.array(amplitude)
        changed[:, k] *= abs(factor)
        return changed

    return replace(reading, rows=rows, **of_amplitude(reading, louder))


def of_amplitude(reading: Reading, change: Callable[[np.ndarray], np.ndarray]) -> dict[str, np.ndarray]:
    """The amplitudes after `change`, where the run states them."""
    return {"amplitude": change(reading.amplitude)} if reading.amplitude.size else {}
