"""Three pendulums, small amplitude, no damping, massless ropes: the period and a few lengths give a moment of inertia.

Every function takes and returns quantities with tolerance (`geometry.toml_file`; plain numbers do as well), SI inside.
What the ideal leaves out (amplitude, damping, rope mass) is in `validation.classical.pendulum`, term by term.

Rope pendulum, paper Eq. 5, with ropes of equal length l hung vertically. Turned by a small angle φ about the vertical through the
CoG, the foot of rope i moves r_i φ sideways and its tension F_i pulls it back with F_i r_i φ / l, so the restoring moment is
``φ Σ F_i r_i² / l``. Statics of the hanging body gives Σ F_i = m g and Σ F_i r_i = 0 (vectors from the CoG), which also keeps
rotation and sway apart.

* two ropes, s1 and s2 to either side of the CoG: F_1 = m g s2/(s1 + s2), and Σ F_i r_i² = m g s1 s2, which is Eq. 5;
* any number of ropes at one radius s about the CoG, however they share the weight: Σ F_i r_i² = m g s², Eq. 5 with s1 = s2 = s.

Both hold for rope feet in one horizontal plane; its height does not matter. They fail when ropes are slanted or unequal.
"""

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt
from numpy import pi
from uncertainties import UFloat, umath, wrap

from geometry.errors import BadInput
from geometry.frames import Array
from geometry.toml_file import is_number, quantity, tagged
from validation.classical.files import HEAD, Fields, Reduction

Value = TypeVar("Value", float, UFloat)
"""A plain number or one with a tolerance, all of one kind."""


def rope_pendulum(*, mass: Value, gravity: Value, s1: Value, s2: Value, length: Value, period: Value) -> Value:
    """Moment of inertia [kg m²] about the vertical through the CoG: ``m g s1 s2 T² / (4 π² l)``, paper Eq. 5."""
    return mass * gravity * s1 * s2 * period**2 / (4 * pi**2 * length)


def compound_pendulum(*, mass: Value, gravity: Value, arm: Value, period: Value) -> Value:
    """Moment of inertia [kg m²] about the axis through the CoG parallel to the pivot, which is `arm` [m] away.

    ``I + m l² = m g l T² / (4 π²)``, moment of momentum about the pivot. A result that is not positive contradicts itself: the
    period is shorter than that of a point mass on the same arm. The caller judges.
    """
    return mass * gravity * arm * period**2 / (4 * pi**2) - mass * arm**2


def torsion_stiffness(*, known_inertia: Value, period: Value) -> Value:
    """Stiffness [N m/rad] of a torsion rod on which a body of `known_inertia` [kg m²] swings: ``k = I (2 π / T)²``."""
    return known_inertia * (2 * pi / period) ** 2


def torsion_pendulum(*, stiffness: Value, period: Value) -> Value:
    """Moment of inertia [kg m²] about the axis of a torsion rod of `stiffness` [N m/rad]: ``I = k T² / (4 π²)``.

    The rod carries the body through its CoG; else the result is about the rod's axis, not the CoG.
    """
    return stiffness * (period / (2 * pi)) ** 2


def rod_inertia(*, mass: Value, length: Value, diameter: Value) -> Value:
    """Moment of inertia [kg m²] of a solid cylinder about its CoG, across its axis: ``m (l²/12 + d²/16)``."""
    return mass * (length**2 / 12 + diameter**2 / 16)


# Inertia tensor and CoG from several orientations of one body.
#
# A pendulum about the axis n sees one number, ``J = n^T Θ n``: linear in the six entries of the tensor, so several axes give
# them by least squares. A body with a plane of symmetry needs three axes in that plane. When the axes leave a combination of
# entries unseen, no arithmetic brings it back: it is refused, and the entries that suffer are named.


SIX = ("xx", "yy", "zz", "xy", "xz", "yz")
"""Entries of the tensor in the order of Eq. 4."""

UNSEEN = 1e-6
"""Singular value, relative to the largest, below which a combination of entries counts as not observable."""


def tensor_from_axes(
    axes: npt.ArrayLike, moments: Sequence[UFloat], components: Sequence[str] = SIX, source: str = "orientations"
) -> dict[str, UFloat]:
    """Entries `components` of the tensor [kg m²] from the `moments` (n,) [kg m²] about `axes` (n, 3), least squares.

    Axes are directions in the body's frame, of any length, numbers or quantities with tolerance; the tensor is about the point
    that all axes pass through. Entries not in `components` are taken as zero (symmetry). Products are matrix entries.
    Equation: ``J = sum_i n_i² I_ii + 2 sum_{i<j} n_i n_j I_ij``.

    Raises
    ------
    BadInput : the axes cannot see all `components`; the message names those that are not observable.
    """
    # What a moment about each of `axes` has of each of the `components`, (n, k)
    rows = []
    for axis in np.asarray(axes):
        length = sum(component**2 for component in axis) ** 0.5
        n = dict(zip("xyz", (component / length for component in axis), strict=True))
        rows.append([n[two[0]] * n[two[1]] * (1 if two[0] == two[1] else 2) for two in components])
    A = np.array(rows)
    A0, b, b0 = _nominal(A), np.array(moments, dtype=object), _nominal(moments)
    _, singular, V = np.linalg.svd(A0, full_matrices=True)
    null = V[int(np.sum(singular > UNSEEN * singular[0])) :]
    unseen = tuple(name for name, column in zip(components, null.T, strict=True) if np.any(np.abs(column) > UNSEEN))
    if unseen:
        problem = f"{len(A)} axes do not determine {', '.join('I' + name for name in unseen)} of the {len(components)} entries"
        remedy = "Swing about further axes, not in one plane with these, or state the symmetry with `components`"
        raise BadInput(source, "axes", problem, remedy)
    # Least squares, linearised exactly in the tolerances of both `A` and `b`
    inverse = np.linalg.pinv(A0)
    x0 = inverse @ b0
    r0 = b0 - A0 @ x0
    x = x0 + inverse @ (b - A @ x0 - r0) + np.linalg.inv(A0.T @ A0) @ ((A - A0).T @ r0)
    return dict(zip(components, x, strict=True))


def _nominal(values: Any) -> Array:
    array = np.asarray(values, dtype=object)
    return np.array([float(getattr(value, "nominal_value", value)) for value in array.ravel()]).reshape(array.shape)


# What Eq. 5 and its sisters leave out, as named terms that can be switched one by one.
#
# amplitude  The rope pendulum at any twist φ, ropes of length l on the radius s (exact, no small angles): the feet stand
#            ``h(φ) = sqrt(l² - 4 s² sin²(φ/2))`` below the ceiling, so the body rises and moves vertically as it turns,
#
#                potential  V = m g (l - h),      kinetic  ½ (I + m h'²) φ'²,   h' = -s² sin φ / h.
#
#            Energy gives the period as an integral over a quarter swing. With sin(φ/2) = sin(A/2) sin ψ both ends are regular,
#            and with ε = s²/l², κ = m s²/I, η = h/l, k = sin(A/2)
#
#                T/T0 = (4/π) ∫_0^{π/2} sqrt((1 + κ ε sin²φ/η²) (η + η_A)/8) / sqrt(1 - k² sin²ψ) dψ
#                     = 1 + A² (1/16 - 3 ε/16 + κ ε/4) + O(A⁴).
#
#            For long ropes (ε -> 0) it is the plane pendulum's 2 K(k)/π, which the compound pendulum obeys exactly. Two ropes at
#            s1 != s2 also tilt the body at second order; the term then uses s² = s1 s2 and is an approximation. A torsion rod is
#            linear in the twist and has no such term. A is the peak amplitude; while it decays, the root mean square of the
#              peaks.
# damping    A viscous damping ratio ζ lengthens the period by 1/sqrt(1 - ζ²).
# rope-mass  Uniform ropes, M in all, moving as straight lines: they add ``M q / 3`` to the inertia and, since the tension grows
#            upwards by their weight, ``M q / 2`` to m s1 s2 (q is the mean square of the radii: s², or (s1² + s2²)/2). The
#            two nearly cancel. Terms of order (M/m)² are neglected.
#
# One period is one number: it cannot tell these terms apart, nor show that one is missing. Their sizes are inputs.


TERMS = ("amplitude", "damping", "rope-mass")
"""Names of the corrections."""

QUADRATURE_POINTS = 64
"""Midpoints of the quarter swing; the integrand is smooth and periodic, so the error falls exponentially (1e-15 below 2 rad)."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Terms:
    """Sizes of the corrections; None leaves a term out.

    Attributes
    ----------
    amplitude : peak twist or swing [rad]
    damping : viscous damping ratio [1]
    rope_mass : mass of all ropes together [kg]
    """

    amplitude: UFloat | None = None
    damping: UFloat | None = None
    rope_mass: UFloat | None = None

    def without(self, name: str) -> "Terms":
        """The same with the term `name` of `TERMS` left out."""
        return replace(self, **{name.replace("-", "_"): None})

    @property
    def names(self) -> tuple[str, ...]:
        """The terms that are in."""
        return tuple(name for name in TERMS if getattr(self, name.replace("-", "_")) is not None)


@dataclass(frozen=True, eq=False, kw_only=True)
class RopeSwing:
    """A rope pendulum: mass [kg], gravity [m/s²], radii s1, s2 and rope length [m], measured period [s]."""

    mass: UFloat
    gravity: UFloat
    s1: UFloat
    s2: UFloat
    length: UFloat
    period: UFloat

    def inertia(self, terms: Terms) -> UFloat:
        """Moment of inertia [kg m²] about the vertical through the CoG, with `terms` taken off the period."""
        radius_square = (self.s1**2 + self.s2**2) / 2
        ropes = terms.rope_mass if terms.rope_mass is not None else 0.0
        hanging = self.mass + ropes * radius_square / (2 * self.s1 * self.s2)
        period = _undamped(self.period, terms)
        lengths = {"gravity": self.gravity, "s1": self.s1, "s2": self.s2, "length": self.length}
        total = rope_pendulum(mass=hanging, period=period, **lengths)
        if terms.amplitude is not None:
            # The factor needs the inertia that it corrects: a fixed point, each step a thousand times closer than the last.
            epsilon, swung = self.s1 * self.s2 / self.length**2, total
            for _ in range(5):
                kappa = self.mass * self.s1 * self.s2 / total
                total = swung / wrap(rope_amplitude_factor)(terms.amplitude, epsilon, kappa) ** 2
        return total - ropes * radius_square / 3


@dataclass(frozen=True, eq=False, kw_only=True)
class CompoundSwing:
    """A compound pendulum: mass [kg], gravity [m/s²], arm from pivot to CoG [m], measured period [s]."""

    mass: UFloat
    gravity: UFloat
    arm: UFloat
    period: UFloat

    def inertia(self, terms: Terms) -> UFloat:
        """Moment of inertia [kg m²] about the CoG, axis parallel to the pivot, with `terms` taken off the period."""
        period = _undamped(self.period, terms)
        if terms.amplitude is not None:
            period = period / wrap(plane_amplitude_factor)(terms.amplitude)
        return compound_pendulum(mass=self.mass, gravity=self.gravity, arm=self.arm, period=period)


@dataclass(frozen=True, eq=False, kw_only=True)
class TorsionSwing:
    """A torsion-rod pendulum: stiffness of the rod [N m/rad], measured period [s]."""

    stiffness: UFloat
    period: UFloat

    def inertia(self, terms: Terms) -> UFloat:
        """Moment of inertia [kg m²] about the rod's axis, with the damping term taken off the period."""
        return torsion_pendulum(stiffness=self.stiffness, period=_undamped(self.period, terms))


def rope_amplitude_factor(amplitude: float, epsilon: float, kappa: float) -> float:
    """T/T0 of the rope pendulum at peak `amplitude` A [rad]; `epsilon` = s²/l², `kappa` = m s²/I. Equation in the module's head.

    Raises
    ------
    BadInput : an amplitude not below π, or one at which the ropes would cross or lie flat.
    """
    k = np.sin(amplitude / 2)
    if not abs(amplitude) < np.pi or 4 * epsilon * k**2 >= 1:
        problem = f"ropes cannot swing to {amplitude:.4g} rad: they would cross or lie flat"
        raise BadInput("rope pendulum", "amplitude", problem, "Give the peak twist in rad or deg")
    psi = (np.arange(QUADRATURE_POINTS) + 0.5) * np.pi / 2 / QUADRATURE_POINTS
    half_sine = k * np.sin(psi)
    sine = 2 * half_sine * np.sqrt(1 - half_sine**2)
    eta, eta_end = np.sqrt(1 - 4 * epsilon * half_sine**2), np.sqrt(1 - 4 * epsilon * k**2)
    inertia = 1 + kappa * epsilon * sine**2 / eta**2
    return float(2 * np.mean(np.sqrt(inertia * (eta + eta_end) / 8) / np.sqrt(1 - half_sine**2)))


def plane_amplitude_factor(amplitude: float) -> float:
    """T/T0 = 2 K(sin(A/2))/π of a plane (compound) pendulum at peak `amplitude` A [rad], complete elliptic integral."""
    return rope_amplitude_factor(amplitude, 0.0, 0.0)


def _undamped(period: UFloat, terms: Terms) -> UFloat:
    return period if terms.damping is None else period * umath.sqrt(1 - terms.damping**2)


# The period of a pendulum: from counted cycles, from a list of passage times, or from a recorded signal.


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
        raise BadInput(source, "cycles", f"at least one cycle is needed, found {count}", "Count them")
    value = time / count
    if value.nominal_value <= 0:
        raise BadInput(source, "time", f"it must be positive, found {value.nominal_value:.6g}", "Check the sign and the unit")
    return value


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
        raise BadInput(source, "times", problem, "List every passage in one direction")
    index = np.arange(len(t)) - (len(t) - 1) / 2
    weight = index / np.sum(index**2)
    period = sum(w * time for w, time in zip(weight, times, strict=True))
    residual = t - t.mean() - period.nominal_value * index
    if np.ptp(np.diff(t)) > 0.5 * np.median(np.diff(t)):
        problem = f"a passage seems to be missing or doubled: intervals from {np.diff(t).min():.4g} to {np.diff(t).max():.4g} s"
        raise BadInput(source, "times", problem, "List every passage in one direction")
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
    t, y = np.asarray(time, dtype=np.float64), np.asarray(signal, dtype=np.float64)
    least, problem = LEAST_CYCLES * LEAST_SAMPLES, ""
    if t.ndim != 1 or t.shape != y.shape or len(t) < least:
        problem = f"time and signal must be equally long and hold {least} samples or more, found {t.shape}, {y.shape}"
    elif not (np.all(np.isfinite(t)) and np.all(np.isfinite(y))):
        problem = f"{np.sum(~np.isfinite(t) | ~np.isfinite(y))} samples are not finite"
    elif np.any(np.diff(t) <= 0):
        problem = f"time must increase, found {np.sum(np.diff(t) <= 0)} steps that do not"
    elif np.ptp(y) == 0:
        problem = f"the signal is constant, {y[0]:.6g}"
    if problem:
        raise BadInput(source, "signal", problem, "Export two columns, time in s and the signal, of one free decay")
    t = t - t[0]
    even = np.linspace(t[0], t[-1], len(t))
    flat = np.interp(even, t, y)
    flat = (flat - np.polyval(np.polyfit(even, flat, 1), even)) * np.hanning(len(t))
    spectrum = np.abs(np.fft.rfft(flat, 8 * len(t)))
    omega0 = float(2 * np.pi * np.argmax(spectrum) / (8 * len(t) * (even[1] - even[0])))
    _require_resolved(omega0 * t[-1] / (2 * np.pi), len(t), source)
    fit = _fitted(t, y, omega0)
    delta, omega = fit.delta, fit.omega
    _require_resolved(omega * t[-1] / (2 * np.pi), len(t), source)
    residual, swing = y - fit.full, fit.full - fit.baseline
    noise = float(np.std(residual) / np.std(swing))
    problem = ""
    if noise > NOISE_REFUSED or delta >= omega:
        problem = f"no decaying sinusoid: what the best one leaves over is {100 * noise:.0f} % of it"
    elif delta * t[-1] < -GROWTH_REFUSED:
        problem = f"the oscillation grows, by a factor {np.exp(-delta * t[-1]):.3g} over the record"
    if problem:
        raise BadInput(source, "signal", problem, "Record a free decay, or filter what disturbs it")
    # Correlation of neighbouring residuals; a negative one is taken as none
    correlation = max(0.0, float(np.corrcoef(residual[:-1], residual[1:])[0, 1])) if noise > ROUNDING else 0.0
    widening = np.sqrt((1 + correlation) / (1 - min(correlation, 0.99)))
    s_delta, s_omega = widening * np.sqrt(np.diag(fit.covariance))
    drift = abs(fit.baseline[-1] - fit.baseline[0]) / (np.sqrt(2) * np.std(swing))
    said = {
        f"The residual is {100 * noise:.0f} % of the signal.": noise > NOISE_WARNED,
        f"The baseline drifts by {drift:.1f} amplitudes; a straight drift is fitted, a bent one is not.": drift > 1,
        f"What one decaying sinusoid leaves over is {100 * noise:.1f} % of the swing and no noise (neighbours are correlated, "
        f"{correlation:.2f}): the period changes with the amplitude as it dies away, or something else moves too. "
        "The tolerance is widened for it.": correlation > 0.5 and noise > LEFT_OVER,
    }
    return Decay(
        period=tagged(2 * np.pi / omega, 2 * np.pi / omega**2 * s_omega, "fit of the signal"),
        damping_ratio=tagged(delta / np.hypot(delta, omega), s_delta / omega, "damping from the signal"),
        amplitude=float(np.sqrt(np.mean(fit.envelope**2))),
        cycles=float(omega * t[-1] / (2 * np.pi)),
        fitted=fit.full,
        notes=tuple(sentence for sentence, true in said.items() if true),
    )


def _require_resolved(cycles: float, samples: int, source: str) -> None:
    if cycles < LEAST_CYCLES:
        raise BadInput(source, "signal", f"at least {LEAST_CYCLES} cycles are needed, found {cycles:.1f}", "Record longer")
    if samples / cycles < LEAST_SAMPLES:
        problem = f"at least {LEAST_SAMPLES} samples a cycle are needed, found {samples / cycles:.1f}"
        raise BadInput(source, "signal", problem, "Sample faster; a slower record may be aliased")


@dataclass(frozen=True, eq=False, kw_only=True)
class _Fit:
    """δ and ω [1/s] with their (2, 2) covariance, and the record (n,) as they make it: whole, without swing, its envelope."""

    delta: float
    omega: float
    covariance: Array
    full: Array
    baseline: Array
    envelope: Array


def _fitted(t: Array, y: Array, omega0: float) -> _Fit:
    from scipy.optimize import least_squares

    def linear(p: Array) -> tuple[Array, Array]:
        omega, envelope = p[1] * omega0, np.exp(-(p[0] * omega0) * (t - t[-1] / 2))
        columns = np.column_stack([envelope * np.cos(omega * t), envelope * np.sin(omega * t), np.ones_like(t), t / t[-1] - 0.5])
        return columns, np.linalg.lstsq(columns, y, rcond=None)[0].astype(np.float64)

    def misfit(p: Array) -> Array:
        columns, coefficients = linear(p)
        return (columns @ coefficients - y) / np.std(y)

    best = least_squares(misfit, [0.001, 1.0], x_scale=[0.01, 0.01], xtol=1e-15, ftol=1e-15, gtol=1e-15, jac="3-point")
    columns, coefficients = linear(best.x)
    variance = np.sum(best.fun**2) / max(len(t) - 6, 1)
    return _Fit(
        delta=float(best.x[0] * omega0),
        omega=float(best.x[1] * omega0),
        covariance=omega0**2 * variance * np.linalg.inv(best.jac.T @ best.jac),
        full=columns @ coefficients,
        baseline=columns[:, 2:] @ coefficients[2:],
        envelope=np.exp(-best.x[0] * omega0 * (t - t[-1] / 2)) * np.hypot(*coefficients[:2]),
    )


# Pendulum files: one swing or several of one article, down to moments of inertia or to the whole tensor.
#
#     kind = "pendulum"
#     gravity = "9.811 +/- 0.001 m/s^2"
#     [article]
#     name = "clumod-4"
#     mass = "47.40 +/- 0.05 kg"
#     cog_z = "603.0 +/- 0.5 mm"              # also cog_x, cog_y; only for attachments given as positions
#     [corrections]                           # optional switches; a term whose size is stated is on unless switched off
#     amplitude = true
#     damping = true
#     rope-mass = false
#     [torsion_rod]                           # for torsion rods: calibrated with a known rod
#     rod_mass = "5.56 +/- 0.02 kg"
#     rod_length = "1.05 +/- 0.001 m"
#     rod_diameter = "30 +/- 0.1 mm"
#     period = "1.894 s"
#     [[swing]]
#     about = "x"                             # or a direction in the article's frame, about = [1, 0, 1]
#     suspension = "ropes"                    # "ropes", "compound" or "torsion-rod"
#     rope_length = "2.000 +/- 0.002 m"
#     s1 = "550 +/- 1 mm"                     # CoG to attachment; or positions = ["53 +/- 1 mm", "1503 +/- 1 mm"] along
#     s2 = "900 +/- 1 mm"                     # positions_along = "z", from which s1, s2 follow with cog_z; or, for
#     cycles = 20                             # three ropes or more, radius = "300 +/- 1 mm"
#     time = "61.2 +/- 0.1 s"                 # or period = "...", times = ["..."], or signal = "record.csv" (time [s], signal)
#     amplitude = "0.05 +/- 0.01 rad"         # sizes of the corrections, each optional
#     damping = "0.2 +/- 0.1 %"
#     rope_mass = "0.3 kg"                    # all ropes together
#
# A compound swing needs `arm` (pivot to CoG) instead of ropes. Several swings about one coordinate axis are averaged.


_PERIOD_KEYS = ("period", "cycles", "time", "times", "signal")
_SIZES = {"amplitude": "angle", "damping": "ratio", "rope_mass": "mass"}
_OWN_KEYS = {
    "ropes": ("rope_length", "s1", "s2", "positions", "positions_along", "radius", "amplitude", "damping", "rope_mass"),
    "compound": ("arm", "amplitude", "damping"),
    "torsion-rod": ("damping",),
}
_AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
HONEST = (
    "One period is one number: it cannot separate amplitude, damping and rope mass, nor show that one of them is missing. "
    "Two amplitudes, two rope lengths and the decay can."
)
"""What a pendulum record does not say, said with every one."""


@dataclass(frozen=True, eq=False, kw_only=True)
class RecordedSwing:
    """A swing that has been read.

    Attributes
    ----------
    axis : (3,) direction of its axis in the article's frame
    pendulum : lengths, mass and period
    terms : its corrections
    stated : what the file or the record says of the sizes of corrections, switched off ones too
    ropes : how many there are, as far as the file says: three where it states their radius; 0 for a pivot or a torsion rod
    notes : what was noted on the way
    """

    axis: tuple[float, ...]
    pendulum: RopeSwing | CompoundSwing | TorsionSwing
    terms: Terms
    stated: Terms
    ropes: int
    notes: tuple[str, ...]

    @property
    def moment(self) -> UFloat:
        """Moment of inertia [kg m²] about the axis through the CoG."""
        return self.pendulum.inertia(self.terms)

    def moment_at(self, period: float) -> float:
        """The same, had it swung with another `period` [s]."""
        bare: Any = _bare(self.pendulum)
        return float(replace(bare, period=period).inertia(_bare(self.terms)))

    def effects(self) -> dict[str, float]:
        """Relative change of the result by each term, the others as they are."""
        whole = self.moment.nominal_value
        return {name: whole / self.pendulum.inertia(self.terms.without(name)).nominal_value - 1 for name in self.terms.names}


def _bare(noun: RopeSwing | CompoundSwing | TorsionSwing | Terms) -> Any:
    """The same in plain numbers, which are many times quicker than those that carry tolerances."""
    given = {each.name: getattr(noun, each.name) for each in fields(noun)}
    bare: dict[str, Any] = {name: None if value is None else float(value.nominal_value) for name, value in given.items()}
    return replace(noun, **bare)


def reduce(file: Fields, off: tuple[str, ...] = ()) -> Reduction:
    """The moments of inertia about the CoG [kg m²] that the pendulum `file` comes down to, corrections in `off` left out.

    Raises
    ------
    BadInput : something in the file cannot be used, contradicts itself, or does not determine the tensor.
    """
    found = swings(file, off)
    coordinate = all(swing.axis in _AXES.values() for swing in found)
    results: dict[str, UFloat] = {}
    terms: dict[str, Mapping[str, float]] = {}
    if not coordinate or "components" in file.table:
        components = file.table.get("components", list(SIX))
        if not isinstance(components, list) or not components or not set(map(str, components)) <= set(SIX):
            raise file.refused("components", f"found {components!r}", f"A list of some of {', '.join(SIX)}")
        moments = [swing.moment for swing in found]
        tensor = tensor_from_axes([swing.axis for swing in found], moments, components, file.source)
        results = {f"I{name}": value for name, value in tensor.items()}
    else:
        for letter, axis in _AXES.items():
            same = [swing for swing in found if swing.axis == axis]
            if same:
                results[f"I{letter}{letter}"] = sum(swing.moment for swing in same) / len(same)
                each = [swing.effects() for swing in same]
                terms[f"I{letter}{letter}"] = {
                    name: sum(effects.get(name, 0.0) for effects in each) / len(each)
                    for name in TERMS
                    if any(name in effects for effects in each)
                }
    return Reduction(
        title=file.text("title", "Pendulum"),
        origin=file.text("origin", "origin not stated"),
        article=file.inner("article").text("name"),
        results=results,
        terms=terms,
        notes=(*(note for swing in found for note in swing.notes), HONEST),
    )


def swings(file: Fields, off: tuple[str, ...] = ()) -> list[RecordedSwing]:
    """Every swing of the pendulum `file`, corrections in `off` left out.

    Raises
    ------
    BadInput : something in the file cannot be used, or contradicts itself.
    """
    file.only((*HEAD, "gravity", "corrections", "torsion_rod", "components", "swing"))
    article = file.inner("article").only(("name", "mass", "cog_x", "cog_y", "cog_z"))
    found = []
    for entry in file.each("swing"):
        suspension = entry.choice("suspension", tuple(_OWN_KEYS))
        entry.only(("about", "suspension", *_PERIOD_KEYS, *_OWN_KEYS[suspension]))
        period, recorded, notes = _period(entry)
        pendulum: RopeSwing | CompoundSwing | TorsionSwing
        if suspension == "torsion-rod":
            rod = file.inner("torsion_rod").only(("known_inertia", "rod_mass", "rod_length", "rod_diameter", "period"))
            if "known_inertia" in rod.table:
                inertia = rod.positive("known_inertia", "moment of inertia")
            else:
                length, diameter = (rod.positive(key, "length") for key in ("rod_length", "rod_diameter"))
                inertia = rod_inertia(mass=rod.positive("rod_mass", "mass"), length=length, diameter=diameter)
            known = rod.positive("period", "time", "period with the known rod")
            pendulum = TorsionSwing(stiffness=torsion_stiffness(known_inertia=inertia, period=known), period=period)
        elif suspension == "compound":
            mass, arm = article.positive("mass", "mass"), entry.positive("arm", "length")
            pendulum = CompoundSwing(mass=mass, gravity=file.positive("gravity", "acceleration"), arm=arm, period=period)
        else:
            s1, s2 = _radii(entry, article)
            mass, length = article.positive("mass", "mass"), entry.positive("rope_length", "length")
            gravity = file.positive("gravity", "acceleration")
            pendulum = RopeSwing(mass=mass, gravity=gravity, s1=s1, s2=s2, length=length, period=period)
        terms, stated = _terms(entry, file, off, recorded)
        ropes = (3 if "radius" in entry.table else 2) if suspension == "ropes" else 0
        swing = RecordedSwing(axis=_axis(entry), pendulum=pendulum, terms=terms, stated=stated, ropes=ropes, notes=notes)
        try:
            moment = swing.moment.nominal_value
        except BadInput as error:  # the equations know the quantity that is at fault, but not the file
            raise entry.refused(error.field, error.problem, error.remedy) from None
        if moment <= 0:
            problem = f"the swing contradicts itself: its moment of inertia comes out as {moment:.4g} kg m²"
            why = "No body swings faster than a point mass there; check period, lengths and mass"
            raise BadInput(entry.source, entry.place, problem, why)
        found.append(swing)
    return found


def _period(entry: Fields) -> tuple[UFloat, Decay | None, tuple[str, ...]]:
    """The period [s], the fitted decay where a signal was recorded, and notes."""
    ways = [key for key in ("period", "cycles", "times", "signal") if key in entry.table]
    if len(ways) != 1 or ("time" in entry.table) != (ways == ["cycles"]):
        remedy = "Give period, or cycles and time, or times, or signal"
        raise entry.refused("period", f"the period must be given in one way, found {', '.join(ways) or 'none'}", remedy)
    source = f"{entry.source}: {entry.place}"
    if ways == ["signal"]:
        path = Path(entry.source).parent / entry.text("signal")
        if not path.is_file():
            raise entry.refused("signal", f"no file {path}", "The path is relative to the measurement file")
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # an empty file is refused below, in words
                columns = np.genfromtxt(path, delimiter=",", comments="#", dtype=np.float64)
        except (ValueError, UnicodeDecodeError) as error:
            why = str(error).splitlines()[0]
            raise entry.refused("signal", f"{path} is no table of numbers ({why})", "Two columns, comma between") from None
        if columns.ndim == 2 and np.all(np.isnan(columns[0])):
            columns = columns[1:]  # a line of headings
        if columns.ndim != 2 or columns.shape[1] != 2:
            remedy = "Two columns, time in s and the signal, comma between"
            raise entry.refused("signal", f"{path} has shape {columns.shape}", remedy)
        decay = from_signal(columns[:, 0], columns[:, 1], source)
        return decay.period, decay, decay.notes
    if ways == ["period"]:
        return entry.positive("period", "time"), None, ()
    if ways == ["cycles"]:
        count = entry.integer("cycles", 1, 1)
        return from_cycles(count, entry.positive("time", "time", "time of the cycles"), source), None, ()
    texts = entry.table["times"]
    if not isinstance(texts, list):
        raise entry.refused("times", f"a list is expected, found {texts!r}", 'Write ["0.0 +/- 0.1 s", "3.1 +/- 0.1 s", ...]')
    times = [quantity(text, "time", source=entry.source, field=entry.path("times"), name="passage times") for text in texts]
    return from_times(times, source), None, ()


def _axis(entry: Fields) -> tuple[float, ...]:
    about = entry.table.get("about")
    if isinstance(about, str) and about in _AXES:
        return _AXES[about]
    if isinstance(about, list) and len(about) == 3 and all(is_number(c) for c in about):
        length = float(np.linalg.norm(about))
        if np.isfinite(length) and length > 0:
            return tuple(float(c) / length for c in about)
    raise entry.refused("about", f"an axis is expected, found {about!r}", 'Write "x", "y", "z" or a direction like [1, 0, 1]')


def _radii(entry: Fields, article: Fields) -> tuple[UFloat, UFloat]:
    """s1 and s2 [m], in whichever of three ways the file gives them."""
    ways = [key for key in ("s1", "positions", "radius") if key in entry.table]
    if len(ways) != 1:
        remedy = "Give s1 and s2, or positions and positions_along, or radius (three ropes or more)"
        raise entry.refused("s1", f"the attachments must be given in one way, found {len(ways)}", remedy)
    if ways == ["radius"]:
        radius = entry.positive("radius", "length")
        return radius, radius
    if ways == ["s1"]:
        return entry.positive("s1", "length"), entry.positive("s2", "length")
    letter, texts = entry.choice("positions_along", tuple(_AXES)), entry.table["positions"]
    if not isinstance(texts, list) or len(texts) != 2:
        raise entry.refused("positions", f"two are expected, found {texts!r}", "Give both ropes' places along the article")
    one, two = (
        quantity(text, "length", source=entry.source, field=entry.path("positions"), name=f"position of rope {i}")
        for i, text in enumerate(texts, start=1)
    )
    cog = article.quantity(f"cog_{letter}", "length", f"position of the CoG ({letter})")
    s1, s2 = cog - one, two - cog
    if s1.nominal_value * s2.nominal_value <= 0:
        places = f"{one.nominal_value:.6g} and {two.nominal_value:.6g} m"
        problem = f"the CoG at {cog.nominal_value:.6g} m is not between the ropes at {places}"
        raise entry.refused("positions", problem, "One rope would have to push; check the places and the CoG")
    return s1, s2  # both negative where the places are listed downwards: only their product and squares are used


def _terms(entry: Fields, file: Fields, off: tuple[str, ...], recorded: Decay | None) -> tuple[Terms, Terms]:
    """The corrections that are on, and the sizes of all that are stated."""
    switches = file.inner("corrections").only(TERMS)
    sizes: dict[str, UFloat | None] = {}
    known: dict[str, UFloat | None] = {}
    for key, dimension in _SIZES.items():
        name = key.replace("_", "-")
        stated = entry.optional(key, dimension)
        if stated is not None and (stated.nominal_value < 0 or (key == "damping" and stated.nominal_value >= 1)):
            remedy = "Damping is a ratio from 0 to 1, the others are not negative"
            raise entry.refused(key, f"out of range: {entry.table[key]!r}", remedy)
        if key == "damping" and stated is None and recorded is not None:
            stated = recorded.damping_ratio
        if stated is None and switches.switch(name, False) and key in _OWN_KEYS[entry.text("suspension")]:
            problem = f"the correction {name} is switched on, but its size is missing"
            raise entry.refused(key, problem, "State it, or switch it off")
        known[key] = stated
        sizes[key] = stated if switches.switch(name, True) and name not in off else None
    return Terms(**sizes), Terms(**known)
