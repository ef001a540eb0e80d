"""The period of a pendulum: from counted cycles, from a list of passage times, or from a recorded signal."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array
from geometry.errors import BadInput
from geometry.quantities import tagged

if TYPE_CHECKING:
    from uncertainties import UFloat

LEAST_CYCLES = 3
"""A record must show this many cycles before a period, a drift and a decay can be told apart."""

LEAST_SAMPLES = 5
"""Samples a cycle below which a record is refused; a sinusoid needs more than two, a decaying one on a drift some to spare."""

NOISE_REFUSED, NOISE_WARNED = 0.5, 0.1
"""Residual over signal, both root mean square: above the first it is no decaying sinusoid, above the second it is said."""


LEFT_OVER = 0.01
"""Residual over signal above which a correlated residual is said; a clean undamped swing of 1 rad leaves 0.7 %."""

ROUNDING = 1e-6
"""Residual over signal below which the residual is the rounding of the record's digits, and its correlation means nothing."""

GROWTH_REFUSED = 0.2
"""Logarithm of the growth over the record above which it is no free decay; noise alone may show a little growth."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Decay:
    """A decaying sinusoid fitted to a record.

    Attributes
    ----------
    period : [s], of the damped oscillation
    damping_ratio : [1]
    amplitude : root mean square over the record of the peak amplitude, in the signal's unit
    cycles : in the record
    fitted : (n,) the sinusoid with its drift, at the samples
    notes : what the user should know (noise, drift, correlated residuals), sentences
    """

    period: UFloat
    damping_ratio: UFloat
    amplitude: float
    cycles: float
    fitted: Array
    notes: tuple[str, ...]


def from_cycles(count: int, time: UFloat, source: str) -> UFloat:
    """Period [s] from the `time` [s] of `count` cycles.

    Raises
    ------
    BadInput : fewer than one cycle, or no positive time.
    """
    if count < 1:
        raise BadInput(source=source, field="cycles", problem=f"at least one cycle is needed, found {count}", remedy="Count them")
    return require_positive(time / count, "time", source)


def from_times(times: Sequence[UFloat], source: str) -> UFloat:
    """Period [s] from `times` [s] of successive passages in one direction: the slope of their regression line.

    The tolerance holds that of each reading and, from the scatter about the line, that of the slope.

    Raises
    ------
    BadInput : fewer than three times, or times that do not increase; both would hide a missed passage, and so does a gap that is
        more than half a period off the line.
    """
    t = np.array([time.nominal_value for time in times])
    if len(t) < 3 or np.any(np.diff(t) <= 0):
        problem = f"at least three increasing times are needed, found {t.tolist()}"
        raise BadInput(source=source, field="times", problem=problem, remedy="List every passage in one direction")
    index = np.arange(len(t)) - (len(t) - 1) / 2
    weight = index / np.sum(index**2)
    period = sum(w * time for w, time in zip(weight, times, strict=True))
    residual = t - t.mean() - period.nominal_value * index
    if np.ptp(np.diff(t)) > 0.5 * np.median(np.diff(t)):
        problem = f"a passage seems to be missing or doubled: intervals from {np.diff(t).min():.4g} to {np.diff(t).max():.4g} s"
        raise BadInput(source=source, field="times", problem=problem, remedy="List every passage in one direction")
    scatter = float(np.sqrt(np.sum(residual**2) / (len(t) - 2) / np.sum(index**2)))
    return period + tagged(0.0, scatter, "scatter of the times")


def from_signal(time: npt.ArrayLike, signal: npt.ArrayLike, source: str) -> Decay:
    """Period and damping of a recorded free decay: least squares of ``exp(-δt) (a cos ωt + b sin ωt) + c + d t``.

    Parameters
    ----------
    time : (n,) [s], increasing, steps may differ
    signal : (n,), any unit (angle, displacement, voltage)

    Only δ and ω are searched (the rest is linear, variable projection), from the peak of the spectrum. Standard deviations
    come from the residual; where neighbouring residuals are correlated, they are widened for it.

    Raises
    ------
    BadInput : not finite, time not increasing, fewer than `LEAST_CYCLES`, fewer than `LEAST_SAMPLES` a cycle, or no decaying
        sinusoid in it.
    """
    t, y = _checked(time, signal, source)
    t = t - t[0]
    omega0 = _spectral_peak(t, y)
    _require_resolved(omega0 * t[-1] / (2 * np.pi), len(t), source)
    delta, omega, covariance, fit = _fitted(t, y, omega0)
    _require_resolved(omega * t[-1] / (2 * np.pi), len(t), source)
    residual, swing = y - fit.full, fit.full - fit.baseline
    noise = float(np.std(residual) / np.std(swing))
    _require_decay(delta, omega, t[-1], noise, source)
    correlation = _correlation(residual) if noise > ROUNDING else 0.0
    widening = np.sqrt((1 + correlation) / (1 - min(correlation, 0.99)))
    s_delta, s_omega = widening * np.sqrt(np.diag(covariance))
    return Decay(
        period=tagged(2 * np.pi / omega, 2 * np.pi / omega**2 * s_omega, "fit of the signal"),
        damping_ratio=tagged(delta / np.hypot(delta, omega), s_delta / omega, "damping from the signal"),
        amplitude=float(np.sqrt(np.mean(fit.envelope**2))),
        cycles=float(omega * t[-1] / (2 * np.pi)),
        fitted=fit.full,
        notes=_notes(noise, correlation, fit, swing),
    )


def require_positive(value: UFloat, field: str, source: str) -> UFloat:
    """`value` unchanged; BadInput when it is not positive."""
    if value.nominal_value > 0:
        return value
    problem = f"it must be positive, found {value.nominal_value:.6g}"
    raise BadInput(source=source, field=field, problem=problem, remedy="Check the sign and the unit")


@dataclass(frozen=True, eq=False, kw_only=True)
class _Fit:
    full: Array
    baseline: Array
    envelope: Array


def _checked(time: npt.ArrayLike, signal: npt.ArrayLike, source: str) -> tuple[Array, Array]:
    t, y = np.asarray(time, dtype=np.float64), np.asarray(signal, dtype=np.float64)
    if t.ndim != 1 or t.shape != y.shape or len(t) < LEAST_CYCLES * LEAST_SAMPLES:
        least = LEAST_CYCLES * LEAST_SAMPLES
        problem = f"time and signal must be equally long and hold {least} samples or more, found {t.shape}, {y.shape}"
    elif not (np.all(np.isfinite(t)) and np.all(np.isfinite(y))):
        problem = f"{np.sum(~np.isfinite(t) | ~np.isfinite(y))} samples are not finite"
    elif np.any(np.diff(t) <= 0):
        problem = f"time must increase, found {np.sum(np.diff(t) <= 0)} steps that do not"
    elif np.ptp(y) == 0:
        problem = f"the signal is constant, {y[0]:.6g}"
    else:
        return t, y
    raise BadInput(
        source=source, field="signal", problem=problem, remedy="Export two columns, time in s and the signal, of one free decay"
    )


def _spectral_peak(t: Array, y: Array) -> float:
    even = np.linspace(t[0], t[-1], len(t))
    flat = np.interp(even, t, y)
    flat = (flat - np.polyval(np.polyfit(even, flat, 1), even)) * np.hanning(len(t))
    spectrum = np.abs(np.fft.rfft(flat, 8 * len(t)))
    return float(2 * np.pi * np.argmax(spectrum) / (8 * len(t) * (even[1] - even[0])))


def _require_resolved(cycles: float, samples: int, source: str) -> None:
    if cycles < LEAST_CYCLES:
        problem = f"at least {LEAST_CYCLES} cycles are needed, found {cycles:.1f}"
        raise BadInput(source=source, field="signal", problem=problem, remedy="Record longer")
    if samples / cycles < LEAST_SAMPLES:
        problem = f"at least {LEAST_SAMPLES} samples a cycle are needed, found {samples / cycles:.1f}"
        raise BadInput(source=source, field="signal", problem=problem, remedy="Sample faster; a slower record may be aliased")


def _require_decay(delta: float, omega: float, duration: float, noise: float, source: str) -> None:
    if noise > NOISE_REFUSED or delta >= omega:
        problem = f"no decaying sinusoid: what the best one leaves over is {100 * noise:.0f} % of it"
    elif delta * duration < -GROWTH_REFUSED:
        problem = f"the oscillation grows, by a factor {np.exp(-delta * duration):.3g} over the record"
    else:
        return
    raise BadInput(source=source, field="signal", problem=problem, remedy="Record a free decay, or filter what disturbs it")


def _correlation(residual: Array) -> float:
    """Correlation of neighbouring residuals; a negative one is taken as none."""
    return max(0.0, float(np.corrcoef(residual[:-1], residual[1:])[0, 1]))


def _columns(t: Array, delta: float, omega: float) -> Array:
    envelope = np.exp(-delta * (t - t[-1] / 2))
    ramp = t / t[-1] - 0.5
    return np.column_stack([envelope * np.cos(omega * t), envelope * np.sin(omega * t), np.ones_like(t), ramp])


def _fitted(t: Array, y: Array, omega0: float) -> tuple[float, float, Array, _Fit]:
    """δ, ω, their (2, 2) covariance, and the fitted record."""
    from scipy.optimize import least_squares

    def linear(p: Array) -> tuple[Array, Array]:
        columns = _columns(t, p[0] * omega0, p[1] * omega0)
        coefficients: Array = np.linalg.lstsq(columns, y, rcond=None)[0].astype(np.float64)
        return columns, coefficients

    def misfit(p: Array) -> Array:
        columns, coefficients = linear(p)
        return (columns @ coefficients - y) / np.std(y)

    best = least_squares(misfit, [0.001, 1.0], x_scale=[0.01, 0.01], xtol=1e-15, ftol=1e-15, gtol=1e-15, jac="3-point")
    columns, coefficients = linear(best.x)
    variance = np.sum(best.fun**2) / max(len(t) - 6, 1)
    covariance = omega0**2 * variance * np.linalg.inv(best.jac.T @ best.jac)
    envelope = np.exp(-best.x[0] * omega0 * (t - t[-1] / 2)) * np.hypot(*coefficients[:2])
    fit = _Fit(full=columns @ coefficients, baseline=columns[:, 2:] @ coefficients[2:], envelope=envelope)
    return float(best.x[0] * omega0), float(best.x[1] * omega0), covariance, fit


def _notes(noise: float, correlation: float, fit: _Fit, swing: Array) -> tuple[str, ...]:
    drift = abs(fit.baseline[-1] - fit.baseline[0]) / (np.sqrt(2) * np.std(swing))
    said = {
        f"The residual is {100 * noise:.0f} % of the signal.": noise > NOISE_WARNED,
        f"The baseline drifts by {drift:.1f} amplitudes; a straight drift is fitted, a bent one is not.": drift > 1,
        f"What one decaying sinusoid leaves over is {100 * noise:.1f} % of the swing and no noise (neighbours are correlated, "
        f"{correlation:.2f}): the period changes with the amplitude as it dies away, or something else moves too. "
        "The tolerance is widened for it.": correlation > 0.5 and noise > LEFT_OVER,
    }
    return tuple(sentence for sentence, true in said.items() if true)
