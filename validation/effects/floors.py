"""Equations of the noise that is expected."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from geometry.arrays import Array
from validation.effects.family import Values
from validation.effects.stages import Floor

NEAREST = 0.1
"""[Hz] from the mains, within which their frequency wanders."""


def louder(floor: Floor, targets: tuple[str, ...], values: Values) -> Floor:
    """Variances of independent noise add."""
    k, deviation = floor.channels.index(targets[0]), np.array(floor.deviation)
    deviation[:, k] = np.hypot(deviation[:, k], values[""] * floor.per_rms[k])
    return replace(floor, deviation=deviation)


def humming(floor: Floor, targets: tuple[str, ...], values: Values) -> Floor:
    """The ordinary hum is in the noise that was measured: more of it adds, less takes off, and never all."""
    if not floor.hum.size:
        return floor
    factor = values[""]
    change = (factor**2 - 1) * floor.hum**2
    variance = np.maximum(floor.deviation**2 + change, (min(factor, 1.0) * floor.deviation) ** 2)
    return replace(floor, deviation=np.sqrt(variance), hum=factor * floor.hum)


def leak(frequency: Array, mains: float = 50.0) -> Array:
    """(n,) [1/Hz] standard deviation of what a hum of amplitude 1 at `mains` [Hz] leaves at a line of a full record.

    A record of whole or half periods leaves nothing or twice as much; how it is cut is not known, and the mean square is taken.
    Lines closer than `NEAREST` are as those at that distance.
    """
    away = np.maximum(np.abs(frequency - mains), NEAREST)
    return np.asarray(1 / (2 * np.sqrt(2) * np.pi * away))
