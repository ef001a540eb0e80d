"""All parameters together by Levenberg and Marquardt: normal equations of weighted lines, analytic derivatives.

Priors keep what the data do not say: a structure is lightly damped (a factor of 4.5 either way about 0.4 %), a pole belongs to
the band unless the data say otherwise, and coupling of damping does not exceed what its two modes have. Against data they weigh
nothing: a resonance tells ln f a thousand times better.

Source: Marquardt, J. SIAM 11 (1963) 431; its damping as in Nielsen, IMM-REP-1999-05, Technical University of Denmark.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray
from identification.elastic import model
from identification.elastic.lines import Lines
from identification.elastic.model import UPPER, Layout

DAMPING = (np.log(0.004), 1.5)
"""Mean and standard deviation of ln zeta."""

REACH = (0.5, 2.5)
"""How far out of the band a pole may go, of its lower and of its upper end: beyond, it is an error and no mode."""

RATIOS = (2e-4, 0.1)
"""Damping ratios of a resonance: above them it is a slope that other poles lack, below them an error of one line."""

COUPLING = 0.3
"""Standard deviation of rho."""

TIGHTEST = 0.95
"""Largest rho: at 1 a pair would have a motion without damping."""

ENOUGH = 0.03
"""Gain of chi² that is no gain: a sixth of a standard deviation."""

HOPELESS = 1e8
"""Damping at which a step is too short to gain by anything but rounding."""

STEP = 0.3
"""Largest step of a logarithm or a coupling."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Refined:
    """Where an iteration ended.

    Attributes
    ----------
    vector : (k,) of `layout`
    chi2 : of the data alone
    cost : of data and priors
    jacobian : (k, N) of the weighted data, N = 42 n: line by line, entry by entry, real and imaginary
    residual : (N,) fitted less measured, weighted
    prior : (k,) gradient of half the priors' cost
    certainty : (k,) inverse variance of the priors, 0 where there is none
    information : (k, k) J^T J with the priors
    converged : whether it ended by itself
    """

    layout: Layout
    vector: Array
    chi2: float
    cost: float
    jacobian: Array
    residual: Array
    prior: Array
    certainty: Array
    information: Array
    converged: bool


def refine(start: Array, layout: Layout, lines: Lines, *, iterations: int = 40, accuracy: float = 3e-5) -> Refined:
    """From the vector `start` (k,) downhill until a step gains less than `accuracy` of the cost and `ENOUGH`.

    Not converged when `iterations` steps did not do; none only linearises at `start`.
    """
    at, damping, rise = linearised(start, layout, lines), 1e-3, 2.0
    for _ in range(iterations):
        trial, predicted = _step(at, damping, lines)
        left = _residual(trial, layout, lines)
        gained = at.cost - float(left @ left)
        if gained > 0 and predicted > 0:
            at, rise = linearised(trial, layout, lines), 2.0
            damping *= max(0.1, 1 - (2 * gained / predicted - 1) ** 3)
        else:
            damping, rise = damping * rise, 2 * rise
        if damping > HOPELESS or 0 <= max(gained, predicted) < accuracy * at.cost + ENOUGH:
            return replace(at, converged=True)
    return at


def _step(at: Refined, damping: float, lines: Lines) -> tuple[Array, float]:
    """The vector of the next trial and what cost it should save; what stands at a limit and pushes against it stays."""
    x, A, blocks = at.vector, at.information, at.layout.blocks
    g = at.jacobian @ at.residual + at.prior
    limited = slice(blocks["frequency"].start, blocks["pairs"].stop)
    low, high = np.full(len(x), -np.inf), np.full(len(x), np.inf)
    low[limited], high[limited] = limits(at.layout, lines)
    free = ~(((x <= low) & (g > 0)) | ((x >= high) & (g < 0)))
    d = unit_of(A)[free]
    scaled = A[np.ix_(free, free)] / np.outer(d, d) + damping * np.eye(len(d))
    dx = np.zeros(len(x))
    dx[free] = -np.linalg.solve(scaled, g[free] / d) / d
    dx *= min(1.0, STEP / max(np.abs(dx[limited]).max(initial=0.0), STEP))
    trial = np.clip(x + dx, low, high)
    dx = trial - x
    return trial, float(-2 * g @ dx - dx @ A @ dx)


def leftover(x: Array, layout: Layout, lines: Lines) -> ComplexArray:
    """Fitted less measured (n, 21), in the units of H."""
    _, terms = model.unpack(x, layout)
    mass = np.tensordot(x[:10], model.inertia_basis(), axes=1)
    return np.asarray(model.dynamic_mass(mass, terms, lines.frequency)[:, UPPER[0], UPPER[1]] - lines.values)


def weighted(values: ComplexArray, lines: Lines) -> Array:
    """(..., n, 21) complex as (..., 42 n) real of unit variance: that of a complex error is shared by its two parts."""
    scaled = np.multiply(values, np.sqrt(2) / lines.deviation, order="C")
    return np.asarray(scaled.reshape(*values.shape[:-2], -1).view(np.float64))


def unit_of(information: Array) -> Array:
    """(k,) by which a normal matrix is divided to have ones on its diagonal; 1 where the data do not see a parameter at all."""
    diagonal = np.diag(information)
    return np.sqrt(np.where(diagonal > 0, diagonal, 1.0))


def limits(layout: Layout, lines: Lines) -> tuple[Array, Array]:
    """Lowest and highest ln f, ln zeta and rho, in the order of the vector."""
    f, m, p = lines.frequency[[0, -1]], layout.modes, len(layout.pairs)
    low, high = np.log(np.array(REACH) * f)
    return (
        np.concatenate([np.full(m, low), np.full(m, np.log(RATIOS[0])), np.full(p, -TIGHTEST)]),
        np.concatenate([np.full(m, high), np.full(m, np.log(RATIOS[1])), np.full(p, TIGHTEST)]),
    )


def effective_size(at: Refined) -> float:
    """Parameters that the data decide and not the priors: k less the share of the priors in what is known of each."""
    d = unit_of(at.information)
    variance = np.diag(np.linalg.pinv(at.information / np.outer(d, d), hermitian=True)) / d**2
    return len(at.vector) - float(at.certainty @ variance)


def correlation_time(at: Refined) -> float:
    """Lines that repeat the same error, 1 and more: the sum of the autocorrelation of what is left over up to its first zero."""
    r = at.residual.reshape(-1, 42)
    lags = [float(np.sum(r[k:] * r[: len(r) - k])) for k in range(len(r) // 2)]
    ends = next((k for k, lag in enumerate(lags) if lag <= 0), len(lags))
    return 1 + 2 * sum(lags[1:ends]) / lags[0] if lags and lags[0] > 0 else 1.0


def _residual(x: Array, layout: Layout, lines: Lines) -> Array:
    return np.concatenate([weighted(leftover(x, layout, lines), lines), _prior(x, layout, lines)[0]])


def linearised(x: Array, layout: Layout, lines: Lines) -> Refined:
    """Cost and derivatives at the vector `x` (k,), which nothing moves."""
    _, terms = model.unpack(x, layout)
    J = weighted(model.upper_derivatives(terms, lines.frequency, layout), lines)
    r = weighted(leftover(x, layout, lines), lines)
    p, slopes = _prior(x, layout, lines)
    chi2, information = float(r @ r), J @ J.T
    information[np.diag_indices(len(x))] += slopes**2
    return Refined(
        layout=layout,
        vector=x,
        chi2=chi2,
        cost=chi2 + float(p @ p),
        jacobian=J,
        residual=r,
        prior=slopes * p,
        certainty=slopes**2,
        information=information,
        converged=False,
    )


def _prior(x: Array, layout: Layout, lines: Lines) -> tuple[Array, Array]:
    """Residuals (k,) and their slopes (k,), zero for parameters without a prior."""
    blocks, low, high = layout.blocks, np.log(lines.frequency[0]), np.log(lines.frequency[-1])
    mean, slope = np.zeros(len(x)), np.zeros(len(x))
    mean[blocks["frequency"]], slope[blocks["frequency"]] = (low + high) / 2, 2 / max(high - low, 1.0)
    mean[blocks["damping"]], slope[blocks["damping"]] = DAMPING[0], 1 / DAMPING[1]
    slope[blocks["pairs"]] = 1 / COUPLING
    return slope * (x - mean), slope
