"""The common axis: is it evenly sampled, and at what rate, when the file says so in a few digits only?"""

from __future__ import annotations

import numpy as np

from geometry.arrays import Array
from geometry.errors import BadInput

UNEVEN = 0.3
"""How far a time stamp may lie from its place at most, in sampling intervals, when its printed digits have no more to say."""

EVEN = 1e-4
"""How far it may lie with all digits there: clocks agree better, and a lost sample is off by one."""

LARGEST = 1e12
"""Seconds or hertz: no axis goes beyond."""

MOST_DECIMALS = 9
"""Time stamps of more decimals are taken as complete."""


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
    good = np.abs(time) < LARGEST
    if not np.all(good):
        k = int(np.argmin(good))
        raise refused(f"must be a time in row {k + 1}, found {time[k]:g} s")
    steps, span, count = np.diff(time), float(time[-1] - time[0]), len(time) - 1
    usual = float(np.median(steps))
    if usual <= 0 or span <= 0:
        raise refused(f"must ascend, found a median step of {usual:g} s")
    off = np.abs(time - time[0] - span / count * np.arange(len(time)))
    if np.any(off > np.clip(2 * _rounding(time), EVEN * usual, UNEVEN * usual)):
        k = int(np.argmax(np.abs(steps - usual)))
        raise refused(
            f"is sampled unequally: row {k + 2} comes {steps[k]:.6g} s after the one before it, most come {usual:.6g} s after"
        )
    ends = float(_rounding(time)[[0, -1]].sum())
    return roundest(count / (span + ends), count / max(span - ends, span / 2))


def _rounding(time: Array) -> Array:
    """Half a unit of the last digit that each of the time stamps (n,) [s] was printed with: so many decimals, or six digits."""
    largest = float(np.abs(time).max())
    binary = 4 * np.finfo(np.float64).eps * largest
    for decimals in range(MOST_DECIMALS):
        if np.all(np.abs(np.round(time, decimals) - time) <= binary):
            return np.full(len(time), 0.5 * 10.0**-decimals)
    if all(float(f"{one:.5e}") == one for one in time.tolist()):
        return 5e-6 * np.abs(time)
    return np.full(len(time), binary)


def require_lines(frequency: Array, source: str, field: str) -> None:
    """Refuse a frequency axis (n,) [Hz] that is not finite, negative, or does not ascend.

    Raises
    ------
    BadInput : the first line that is wrong.
    """
    good = (frequency < LARGEST) & (frequency >= 0)
    good[1:] &= frequency[1:] > frequency[:-1]
    if not np.all(good):
        k = int(np.argmin(good))
        problem = f"must be finite, not negative and ascend, found {frequency[k]:g} Hz in line {k + 1}"
        raise BadInput(source=source, field=field, problem=problem, remedy="Correct the frequency axis")
