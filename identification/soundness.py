"""Signals that cannot be true: NaN, infinite, dead, clipped. One channel at a time, named, with what to do."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array
from geometry.errors import BadInput

FLAT = 3
"""Samples in a row at the largest value from which a record may be clipped; rounding alone does that near a slow peak, too."""

OVERSHOOT = 4.0
"""Steps of resolution by which the signal, continued as it arrived, would have passed the flat top: beyond, it was cut off."""


LARGEST = 1e15
"""In the unit of the file: numbers whose bytes came in another order are of any size at all."""


def require_finite(values: npt.NDArray[Any], name: str, source: str) -> None:
    """Refuse NaN, infinity, and what no sensor reads in the samples (n,) of a channel.

    Raises
    ------
    BadInput : how many there are, and where the first stands.
    """
    bad = ~((np.abs(values.real) < LARGEST) & (np.abs(values.imag) < LARGEST))
    if np.any(bad):
        what = "NaN" if np.any(np.isnan(values)) else f"infinite or beyond {LARGEST:g}, which no sensor reads"
        problem = (
            f"holds {int(bad.sum())} samples that are {what}, the first is number {int(np.argmax(bad)) + 1} of {len(values)}"
        )
        raise BadInput(source=source, field=name, problem=problem, remedy="Export it again, or repeat the run")


def require_alive(values: npt.NDArray[Any], name: str, source: str) -> None:
    """Refuse a channel whose samples (n,) are all the same.

    Raises
    ------
    BadInput : it is constant.
    """
    if len(values) and np.all(values == values[0]):
        problem = f"is dead: all {len(values)} samples are {values[0]:g}"
        remedy = "Check cable and amplifier, or take the channel out of campaign.toml and of every file"
        raise BadInput(source=source, field=name, problem=problem, remedy=remedy)


def clipped(values: Array) -> int:
    """How many samples (n,) of a time history lie on a flat top where the signal was cut off; 0 when it was not.

    Rounding to the steps of a converter leaves short flat tops, too, but the signal arrives there slowly. What was cut off
    arrives at full speed: continued, it would have passed the top by more than `OVERSHOOT` steps.
    """
    return max(_cut_off(values), _cut_off(-values))


def _cut_off(values: Array) -> int:
    at_top = values == values.max()
    if at_top.sum() < FLAT:
        return 0
    edges = np.flatnonzero(np.diff(np.concatenate([[False], at_top, [False]]).astype(np.int8)))
    starts, ends = edges[::2], edges[1::2]
    long = (ends - starts >= FLAT) & (starts >= 2)
    starts, ends = starts[long], ends[long]
    if not len(starts):
        return 0
    speed = values[starts - 1] - values[starts - 2]
    passed = speed * (ends - starts) / 4  # a parabola through the arrival, over the flat stretch
    cut = passed > OVERSHOOT * _resolution(values)
    return int(np.sum((ends - starts)[cut]))


def _resolution(values: Array) -> float:
    """The smallest difference between two different samples: the converter's step, or rounding."""
    steps = np.diff(np.unique(values))
    return float(steps.min()) if len(steps) else 0.0
