"""How a deviation depends on frequency, where that is plain: a share that is constant, grows, falls, or a resonance.

Each candidate is fitted by weighted least squares with one real number, a resonance with two complex ones, and is named only
when it explains nearly all of the deviation. What follows nothing plain gets no name.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray
from validation.comparing.modes import NamedMode

EXPLAINED = 0.9
"""Share of the deviation, in squares of standard deviations, that a name must explain."""

AROUND = 0.3
"""Share of a mode's frequency to either side in which a deviation may follow it."""

LONGEST = 3.0
"""[Hz] to either side that count at most."""

SHIFTED = 0.12
"""Share of its frequency by which a mode may lie elsewhere."""

WIDTHS = 6
"""Damping ratios to either side of a peak within which the mode is sought that makes it."""

SHARES: Mapping[str, tuple[complex, int]] = {
    "the same share at all frequencies": (1, 0),
    "a share that grows with frequency, as of a delay": (1j, 1),
    "a share that falls with frequency, as of a high-pass": (1j, -1),
    "a share that grows with the square of frequency": (1, 2),
    "a share that falls with the square of frequency": (1, -2),
}
"""Of what a channel reads: factor and power of the frequency."""

LOADS: Mapping[str, tuple[complex, int]] = {
    "constant over frequency, as of a mass": (1, 0),
    "grows with the square of frequency, as of a compliance": (1, 2),
    "falls with the square of frequency, as of a spring to ground or of gravity": (1, -2),
    "falls with frequency, as of a damper to ground": (1j, -1),
}
"""Of the motion that a run drives."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Course:
    """A deviation over frequency.

    Attributes
    ----------
    frequency : (n,) [Hz]
    deviation : (n,) complex
    expected : (n,) standard deviation
    reading : (n,) complex, what was expected to be read
    motion : (n,) complex, what the run drives
    of_load : whether it is a load's, not a channel's
    """

    frequency: Array
    deviation: ComplexArray
    expected: Array
    reading: ComplexArray
    motion: ComplexArray
    of_load: bool


def follows(course: Course, modes: Sequence[NamedMode], band: tuple[float, float], peak: float) -> str:
    """What the deviation follows, in words; empty where nothing plain. It stands out in `band` [Hz], most at `peak`."""
    weight = 1 / np.maximum(course.expected, np.finfo(np.float64).tiny)
    y, f = weight * course.deviation, course.frequency
    if not np.any(np.abs(y) > 0):
        return ""
    functions, driver = (LOADS, course.motion) if course.of_load else (SHARES, course.reading)
    shares = {name: _explained(y, [factor * weight * driver * f**power]) for name, (factor, power) in functions.items()}
    best = max(shares, key=lambda name: shares[name])
    return best if shares[best] >= EXPLAINED else _resonance(f, y, weight * course.motion, modes, band, peak)


def _resonance(
    frequency: Array,
    y: ComplexArray,
    motion: ComplexArray,
    modes: Sequence[NamedMode],
    band: tuple[float, float],
    peak: float,
) -> str:
    """The mode near `band` whose resonance the deviation follows: as it is predicted and as it would be a little elsewhere."""
    found = {}
    for mode in modes:
        if band[0] / (1 + SHIFTED) <= mode.frequency <= band[1] * (1 + SHIFTED):
            near = np.abs(frequency - mode.frequency) <= min(AROUND * mode.frequency, LONGEST)
            tried = [(mode.frequency, mode.damping_ratio), *_elsewhere(peak, mode.damping_ratio)]
            found[mode.name] = max(_beside(frequency[near], y[near], motion[near], mode, other) for other in tried)
    best = max(found, key=lambda name: found[name], default="")
    return f"follows the {best}" if best and found[best] >= EXPLAINED else ""


def _elsewhere(peak: float, zeta: float) -> Iterator[tuple[float, float]]:
    """Frequencies [Hz] about `peak` and damping ratios that a mode might have there."""
    for times in (0.25, 0.5, 1.0, 2.0):
        for width in np.linspace(-WIDTHS, WIDTHS, 4 * WIDTHS + 1):
            yield peak * (1 + width * times * zeta), times * zeta


def _beside(frequency: Array, y: ComplexArray, motion: ComplexArray, mode: NamedMode, other: tuple[float, float]) -> float:
    """What a resonance explains as predicted and as it might be, frequency and damping; where they are one, its derivative."""
    L, second = (_resonates(frequency / f, zeta) for f, zeta in ((mode.frequency, mode.damping_ratio), other))
    if other == (mode.frequency, mode.damping_ratio):
        second = L**2
    return _explained(y, [factor * motion * of for factor in (1, 1j) for of in (L, second)])


def _resonates(ratio: Array, zeta: float) -> ComplexArray:
    return np.asarray(1 / (1 - ratio**2 + 2j * zeta * ratio))


def _explained(y: ComplexArray, basis: Sequence[ComplexArray]) -> float:
    """Share of the square of y (n,) that real multiples of the `basis` explain; 0 of fewer lines than would show anything."""
    columns, flat = _real(np.stack(basis, axis=1)), _real(y)
    if len(flat) < 4 * columns.shape[1] or not np.any(flat):
        return 0.0
    columns = columns / np.maximum(np.linalg.norm(columns, axis=0), np.finfo(np.float64).tiny)
    found, *_ = np.linalg.lstsq(columns, flat, rcond=None)
    left = flat - columns @ found
    return float(1 - (left @ left) / (flat @ flat))


def _real(values: ComplexArray) -> Array:
    """Complex values (n, ...) as (2 n, ...) real ones."""
    return np.concatenate([values.real, values.imag])
