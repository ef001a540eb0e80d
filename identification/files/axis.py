"""The common axis: is it evenly sampled, and at what rate, when the file says so in a few digits only?"""

from __future__ import annotations

import numpy as np

from geometry.arrays import Array
from geometry.errors import BadInput

UNEVEN = 0.05
"""How far a time stamp may lie from its place, in sampling intervals: the rounding of printed digits, never a lost sample."""

CLOSEST = 1e-9
"""Relative rounding that sums of binary fractions leave on an axis."""


def roundest(low: float, high: float) -> float:
    """The number of fewest decimal digits from `low` to `high`, both positive: what somebody set before it was rounded."""
    middle = (low + high) / 2
    for digits in range(17):
        candidate = float(f"{middle:.{digits}e}")
        if low <= candidate <= high:
            return candidate
    return middle


def printed_rounding(value: float, fewest: int = 5) -> float:
    """Half a unit of the last digit that `value` was printed with, at least `fewest` decimals behind an exponent."""
    digits = next((d for d in range(fewest, 17) if float(f"{value:.{d}e}") == value), 17)
    return float(0.5 * 10.0 ** (np.floor(np.log10(abs(value))) - digits))


def rate_of_increment(increment: float) -> tuple[float, float]:
    """Least and largest sampling rate [Hz] that a printed time `increment` [s], positive, may stand for."""
    rounding = printed_rounding(increment)
    return 1 / (increment + rounding), 1 / (increment - rounding)


def rate_of_times(time: Array, source: str, field: str) -> float:
    """The sampling rate [Hz] behind time stamps (n,) [s].

    Raises
    ------
    BadInput : NaN, not ascending, or not evenly spaced: where, and by how much.
    """

    def refused(problem: str) -> BadInput:
        return BadInput(source=source, field=field, problem=problem, remedy="Record at one rate and export every sample")

    if len(time) < 2:
        raise refused(f"holds {len(time)} time stamps, and at least two are needed")
    if not np.all(np.isfinite(time)):
        raise refused(f"is not finite in row {int(np.argmin(np.isfinite(time))) + 1}")
    step = float(np.median(np.diff(time)))
    if step <= 0:
        raise refused(f"must ascend, found a median step of {step:g} s")
    span = float(time[-1] - time[0])
    step = span / (len(time) - 1) if abs(span / step - (len(time) - 1)) < 0.5 else step
    off = np.abs(time - time[0] - step * np.arange(len(time)))
    worst = int(np.argmax(off > UNEVEN * step))
    if off[worst] > UNEVEN * step:
        where = f"is sampled unequally: row {worst + 1} stands at {time[worst]:.9g} s, expected {time[0] + step * worst:.9g} s"
        raise refused(where)
    rounding = max(2 * float(off.max()), CLOSEST * 1e-6 * span)
    return roundest((len(time) - 1) / (span + rounding), (len(time) - 1) / max(span - rounding, span / 2))


def require_lines(frequency: Array, source: str, field: str) -> None:
    """Refuse a frequency axis (n,) [Hz] that is not finite, negative, or does not ascend.

    Raises
    ------
    BadInput : the first line that is wrong.
    """
    good = np.isfinite(frequency) & (frequency >= 0)
    good[1:] &= np.diff(frequency, prepend=0.0)[1:] > 0
    if not np.all(good):
        k = int(np.argmin(good))
        problem = f"must be finite, not negative and ascend, found {frequency[k]:g} Hz in line {k + 1}"
        raise BadInput(source=source, field=field, problem=problem, remedy="Correct the frequency axis")
