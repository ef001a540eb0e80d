"""How probable measurements are if an effect of plausible size is there, against that it is not: an integral over its size.

    Z = ∫ p(θ) exp(-½ [ (d + s(θ))ᵀ C⁻¹ (d + s(θ)) - dᵀ C⁻¹ d ]) dθ

d (n,) is predicted - measured without the effect, s(θ) what it adds, C the covariance of what was measured, p the normal density
of the plausible size, halved where a size has one sign. Effects of a pendulum go with the square of their size, so that no
Gaussian in θ describes them near 0; one integral over a line costs nothing. Where s is linear and p whole, Z is that of two
Gaussians: ``-½ ln(1 + σ_p² sᵀ C⁻¹ s) + ½ (sᵀ C⁻¹ d)² σ_p² / (1 + σ_p² sᵀ C⁻¹ s)`` (MacKay, Information Theory, Inference, and
Learning Algorithms, ch. 28).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from validation.diagnosing.classical.curve import Curve

POINTS = 401
"""Of each look at the line."""

LOOKS = 4
"""Each closer than the one before."""

FAR = 30.0
"""Nats below the summit at which nothing is left."""

NEAR = 1e-4
"""The same, where the summit itself is looked for."""

TAIL = 0.05
"""On either side of a 90 % interval."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Weighed:
    """One effect beside the measurements.

    Attributes
    ----------
    evidence : ln Z [nats], against the model without the effect
    value : median of its size
    low, high : 90 % interval
    best : size that fits best, whether plausible or not
    at_end : whether that is the end of what was looked at: a larger one would fit better yet
    chi2 : of what is left at `best`
    """

    evidence: float
    value: float
    low: float
    high: float
    best: float
    at_end: bool
    chi2: float


def weighed(curve: Curve, plausible: float, left: Array, precision: Array) -> Weighed:
    """An effect of which `curve` is the answer, beside `left` (n,) of which the inverse covariance is `precision` (n, n)."""
    sizes, density = _posterior(curve, plausible, left, precision)
    peak = density.max()
    share = steps(sizes) * np.exp(density - peak)
    low, value, high = quantiles(sizes, share)
    best = _best(curve, left, precision)
    gained = float(_gain(curve, np.array([best]), left, precision)[0])
    return Weighed(
        evidence=float(peak + np.log(share.sum())),
        value=value,
        low=low,
        high=high,
        best=best,
        at_end=is_end(curve, best),
        chi2=max(float(left @ precision @ left) - 2 * gained, 0.0),
    )


def evidence(curve: Curve, plausible: float, left: Array, precision: Array) -> float:
    """ln Z alone."""
    sizes, density = _posterior(curve, plausible, left, precision)
    return float(density.max() + np.log(np.sum(steps(sizes) * np.exp(density - density.max()))))


def _posterior(curve: Curve, plausible: float, left: Array, precision: Array) -> tuple[Array, Array]:
    return _around(curve, lambda x: _gain(curve, x, left, precision) + prior(x, curve, plausible), FAR)


def quantiles(sizes: Array, share: Array) -> tuple[float, float, float]:
    """Low end of a 90 % interval, median and high end of a distribution that has `share` (k,) around each of `sizes` (k,)."""
    below = np.cumsum(share) - share / 2
    low, value, high = np.interp([TAIL, 0.5, 1 - TAIL], below / share.sum(), sizes)
    return float(low), float(value), float(high)


def _gain(curve: Curve, sizes: Array, left: Array, precision: Array) -> Array:
    """(k,) logarithm of the likelihood against that without the effect."""
    s = curve.at(sizes)
    return np.asarray(-(s @ precision @ left) - 0.5 * np.einsum("kn,nm,km->k", s, precision, s))


def prior(sizes: Array, curve: Curve, plausible: float) -> Array:
    """(k,) logarithm of the density of a plausible size, on one side of 0 where the other is none."""
    sided = np.log(2.0) if curve.low >= 0 else 0.0
    return np.asarray(sided - 0.5 * (sizes / plausible) ** 2 - np.log(np.sqrt(2 * np.pi) * plausible))


def _around(curve: Curve, density: Callable[[Array], Array], far: float) -> tuple[Array, Array]:
    """Sizes (k,) and the logarithm of the density there, from end to end of where it is no more than `far` below the summit."""
    low, high = curve.low, curve.high
    for _ in range(LOOKS):
        sizes = np.linspace(low, high, POINTS)
        found = density(sizes)
        there = np.flatnonzero(found > found.max() - far)
        low, high = sizes[max(there[0] - 1, 0)], sizes[min(there[-1] + 1, POINTS - 1)]
    return sizes, found


def _best(curve: Curve, left: Array, precision: Array) -> float:
    sizes, found = _around(curve, lambda x: _gain(curve, x, left, precision), NEAR)
    return float(sizes[int(np.argmax(found))])


def is_end(curve: Curve, size: float) -> bool:
    width = (curve.high - curve.low) / POINTS
    return size > curve.high - width or (curve.low < 0 and size < curve.low + width)


def steps(sizes: Array) -> Array:
    """(k,) weights of the trapezoidal rule."""
    steps = np.full(len(sizes), sizes[1] - sizes[0])
    steps[[0, -1]] /= 2
    return steps
