"""All parameters together by Levenberg and Marquardt: normal equations of weighted lines, analytic derivatives.

Priors keep what the data do not say: a structure is lightly damped (a factor of 4.5 either way about 0.4 %), a pole belongs to
the band unless the data say otherwise, and coupling of damping does not exceed what its two modes have. Against data they weigh
nothing: a resonance tells ln f a thousand times better.

Source: Marquardt, J. SIAM 11 (1963) 431; scaling of the damping by the diagonal.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from identification.elastic import model
from identification.elastic.lines import Lines
from identification.elastic.model import UPPER, Layout

DAMPING = (np.log(0.004), 1.5)
"""Mean and standard deviation of ln zeta."""

COUPLING = 0.4
"""Standard deviation of rho."""

STEP = 0.3
"""Largest step of a logarithm or a coupling."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Refined:
    """Where an iteration ended.

    Attributes
    ----------
    vector : (k,) of `layout`
    chi2 : of the data alone
    information : (k, k) J^T J with the priors
    converged : whether it ended by itself
    """

    layout: Layout
    vector: Array
    chi2: float
    cost: float
    information: Array
    converged: bool


def refine(start: Array, layout: Layout, lines: Lines, *, iterations: int = 30, accuracy: float = 1e-6) -> Refined:
    """From the vector `start` (k,) downhill until a step gains less than `accuracy` of what is left or one unit of chi² times it."""
    x, damping = start, 1e-3
    J, r, chi2 = _linearised(x, layout, lines)
    cost = float(r @ r)
    A, g = J @ J.T, J @ r
    for _ in range(iterations):
        trial, predicted = _step(x, A, g, damping, layout)
        moved = _residual(trial, layout, lines)
        gained = cost - float(moved @ moved)
        if gained > 0:
            x, damping = trial, damping * (0.1 if gained > 0.5 * predicted else 1.0)
            J, r, chi2 = _linearised(x, layout, lines)
            cost = float(r @ r)
            A, g = J @ J.T, J @ r
            if gained < accuracy * (cost + 1):
                return Refined(layout=layout, vector=x, chi2=chi2, cost=cost, information=A, converged=True)
        else:
            damping = max(10 * damping, 1e-8)
            if damping > 1e8 or predicted < accuracy * (cost + 1):
                return Refined(layout=layout, vector=x, chi2=chi2, cost=cost, information=A, converged=True)
    return Refined(layout=layout, vector=x, chi2=chi2, cost=cost, information=A, converged=False)


def _step(x: Array, A: Array, g: Array, damping: float, layout: Layout) -> tuple[Array, float]:
    d = np.sqrt(np.diag(A))
    scaled = A / np.outer(d, d)
    dx = -np.linalg.solve(scaled + damping * np.eye(len(d)), g / d) / d
    blocks = layout.blocks
    limited = slice(blocks["frequency"].start, blocks["pairs"].stop)
    largest = np.abs(dx[limited]).max(initial=0.0)
    dx = dx * min(1.0, STEP / max(largest, 1e-300))
    return x + dx, float(-2 * g @ dx - dx @ A @ dx)


def _weights(lines: Lines) -> Array:
    """Per real number: the variance of a complex error is shared by its two parts."""
    return np.asarray(np.sqrt(2) / lines.deviation)


def _residual(x: Array, layout: Layout, lines: Lines) -> Array:
    parameters, terms = model.unpack(x, layout)
    mass = np.tensordot(x[:10], model.inertia_basis(), axes=1)
    left = model.dynamic_mass(mass, terms, lines.frequency)[:, UPPER[0], UPPER[1]] - lines.values
    weighted = np.ascontiguousarray(left * _weights(lines)).view(np.float64).ravel()
    return np.concatenate([weighted, _prior(x, layout, lines)[0]])


def _linearised(x: Array, layout: Layout, lines: Lines) -> tuple[Array, Array, float]:
    """J^T (k, N), r (N,) and chi² of the data."""
    _, terms = model.unpack(x, layout)
    dH = model.derivatives(terms, lines.frequency, layout)[:, :, UPPER[0], UPPER[1]]
    dH *= _weights(lines)
    J = dH.reshape(len(x), -1).view(np.float64)
    r = _residual(x, layout, lines)
    data = r[: J.shape[1]]
    return np.hstack([J, _prior(x, layout, lines)[1]]), r, float(data @ data)


def _prior(x: Array, layout: Layout, lines: Lines) -> tuple[Array, Array]:
    """Residuals (p,) and their derivatives (k, p)."""
    blocks, low, high = layout.blocks, np.log(lines.frequency[0]), np.log(lines.frequency[-1])
    mean, sd = np.zeros(len(x)), np.ones(len(x))
    mean[blocks["frequency"]], sd[blocks["frequency"]] = (low + high) / 2, max(high - low, 1.0) / 2
    mean[blocks["damping"]], sd[blocks["damping"]] = DAMPING
    sd[blocks["pairs"]] = COUPLING
    place = np.arange(blocks["frequency"].start, blocks["pairs"].stop)
    rows = np.zeros((len(x), len(place)))
    rows[place, np.arange(len(place))] = 1 / sd[place]
    return ((x - mean) / sd)[place], rows
