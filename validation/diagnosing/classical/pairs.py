"""Two effects at once: the integral of `validation.diagnosing.classical.weighed` over both sizes.

What they make of a measurement adds, but for two that lengthen one period: factors multiply, and of a moment M that was measured
``M (1 - s₁/M) (1 - s₂/M)`` is left, so that s = s₁ + s₂ - s₁ s₂ / M.
"""

from __future__ import annotations

import numpy as np

from geometry.arrays import Array
from validation.diagnosing.classical.curve import Curve
from validation.diagnosing.classical.weighed import FAR, Weighed, is_end, prior, quantiles, steps

POINTS = 121
"""Of each look, along either size."""

LOOKS = 5


def both(
    curves: tuple[Curve, Curve], plausible: tuple[float, float], left: Array, precision: Array, shared: Array | None = None
) -> tuple[Weighed, Weighed]:
    """Both effects beside `left` (n,) of which the inverse covariance is `precision` (n, n).

    `shared` (n,) is 1 / M of periods that both lengthen, and 0 of what they only add to.
    The evidence of either is that of both together, and so is what they leave; value and interval are its own.
    """
    ends = [(one.low, one.high) for one in curves]
    for _ in range(LOOKS):
        sizes = [np.linspace(low, high, POINTS) for low, high in ends]
        gained = _gain(curves, sizes, left, precision, np.zeros(len(left)) if shared is None else shared)
        density = gained + sum(np.expand_dims(prior(sizes[k], curves[k], plausible[k]), 1 - k) for k in (0, 1))
        there = density > density.max() - FAR
        ends = [_around(sizes[k], there.any(axis=1 - k)) for k in (0, 1)]
    share = np.exp(density - density.max()) * np.outer(steps(sizes[0]), steps(sizes[1]))
    evidence = float(density.max() + np.log(share.sum()))
    best = np.unravel_index(int(np.argmax(gained)), gained.shape)
    chi2 = max(float(left @ precision @ left) - 2 * float(gained[best]), 0.0)
    one, other = (_weighed(curves[k], sizes[k], share.sum(axis=1 - k), float(sizes[k][best[k]]), evidence, chi2) for k in (0, 1))
    return one, other


def _gain(curves: tuple[Curve, Curve], sizes: list[Array], left: Array, precision: Array, shared: Array) -> Array:
    """(k, l) logarithm of the likelihood against that of neither."""
    one, other = curves[0].at(sizes[0])[:, None], curves[1].at(sizes[1])[None]
    s = one + other - shared * one * other
    return np.asarray(-(s @ precision @ left) - 0.5 * np.einsum("kln,nm,klm->kl", s, precision, s))


def _around(sizes: Array, there: Array) -> tuple[float, float]:
    at = np.flatnonzero(there)
    return float(sizes[max(at[0] - 1, 0)]), float(sizes[min(at[-1] + 1, len(sizes) - 1)])


def _weighed(curve: Curve, sizes: Array, share: Array, best: float, evidence: float, chi2: float) -> Weighed:
    low, value, high = quantiles(sizes, share)
    return Weighed(evidence=evidence, value=value, low=low, high=high, best=best, at_end=is_end(curve, best), chi2=chi2)
