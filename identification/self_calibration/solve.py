"""Levenberg-Marquardt on normal equations, with priors as part of them, and the verdict whether it converged.

Data and priors add: cost, gradient and matrix of every campaign, and half the square of whitened knowledge. The damped equations
are scaled by the diagonal of the matrix (Marquardt 1963), so units do not matter. The iteration ends when the Newton decrement
sqrt(g^T N^-1 g) - how many standard deviations the step still is - falls below `CLOSE`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from identification.self_calibration.likelihood import Normal

CLOSE = 0.1
"""Standard deviations that the step may be which is taken last, unseen: it leaves less."""

MOST = 60
"""Evaluations before the iteration is given up."""


Knowledge = Callable[[Array], tuple[Array, Array]]
"""Whitened residuals (p,) at x (k,), and their derivatives (p, k)."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Solution:
    """Where the iteration ended.

    Attributes
    ----------
    x : (k,)
    normal : data and priors together, there
    data : of the data alone
    converged : whether it ended by itself
    decrement : length of the next step [standard deviations]
    evaluations : of the normal equations
    """

    x: Array
    normal: Normal
    data: Normal
    converged: bool
    decrement: float
    evaluations: int


def minimise(
    data: Callable[[Array], Normal],
    start: Array,
    knowledge: Knowledge,
    *,
    close: float = CLOSE,
    most: int = MOST,
    size: int = 0,
    progress: Callable[[float], None] | None = None,
) -> Solution:
    """The minimum of the cost of `data` and of half the square of the whitened `knowledge`, from `start` (k,).

    Where the data, of `size` real numbers, do not fit, standard deviations are larger than they are stated, and so is `close`.
    """
    x, damping, growth = start.copy(), 1e-6, 4.0
    own = data(x)
    total = _with_prior(own, x, knowledge)
    decrement = np.inf
    for evaluation in range(1, most + 1):
        step, free = _step(total, damping), _step(total, 0.0)
        decrement = float(np.sqrt(max(-(total.gradient @ free), 0.0)))
        if progress is not None:
            progress(min(evaluation / 15, 0.99))
        if decrement < close * np.sqrt(max(2 * own.cost / max(size, 1), 1.0) if size else 1.0):
            return Solution(x=x + free, normal=total, data=own, converged=True, decrement=decrement, evaluations=evaluation)
        expected = -(total.gradient @ step) - 0.5 * step @ total.matrix @ step
        trial_own = _tried(data, x + step)
        trial = None if trial_own is None else _with_prior(trial_own, x + step, knowledge)
        ratio = -1.0 if trial is None else (total.cost - trial.cost) / expected
        if trial is not None and trial_own is not None and ratio > 1e-4:
            x, own, total = x + step, trial_own, trial
            damping, growth = damping * max(0.02, 1 - (2 * ratio - 1) ** 3), 4.0
        else:
            damping, growth = max(damping, 1e-6) * growth, growth * 2
            if damping > 1e12:
                break
    return Solution(x=x, normal=total, data=own, converged=False, decrement=decrement, evaluations=most)


def inverse(matrix: Array) -> Array:
    """The inverse of a symmetric positive matrix whose units differ; directions that nothing determines get a huge variance."""
    scale = 1 / np.sqrt(np.maximum(np.diag(matrix), np.finfo(np.float64).tiny))
    values, vectors = np.linalg.eigh(scale[:, None] * matrix * scale)
    values = np.maximum(values, values[-1] * len(matrix) * np.finfo(np.float64).eps)
    return np.asarray(scale[:, None] * ((vectors / values) @ vectors.T) * scale)


def _with_prior(data: Normal, x: Array, knowledge: Knowledge) -> Normal:
    away, rows = knowledge(x)
    return Normal(
        cost=data.cost + 0.5 * float(away @ away),
        gradient=data.gradient + rows.T @ away,
        matrix=data.matrix + rows.T @ rows,
    )


def _step(normal: Normal, damping: float) -> Array:
    scale = 1 / np.sqrt(np.maximum(np.diag(normal.matrix), np.finfo(np.float64).tiny))
    scaled = scale[:, None] * normal.matrix * scale
    values, vectors = np.linalg.eigh(scaled)
    values = np.maximum(values, values[-1] * len(values) * np.finfo(np.float64).eps) + damping
    return np.asarray(-scale * (vectors @ ((vectors.T @ (scale * normal.gradient)) / values)))


def _tried(data: Callable[[Array], Normal], x: Array) -> Normal | None:
    """The data at `x`; None where the model breaks down there."""
    try:
        found = data(x)
    except (np.linalg.LinAlgError, ValueError, FloatingPointError):
        return None
    return found if np.isfinite(found.cost) else None
