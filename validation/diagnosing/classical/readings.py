"""Is an input wrong? By how much each length, mass or time would have to be, to explain the deviation by itself."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from identification.quality import NORMAL_95
from validation.diagnosing.classical.judged import UNLIKELY, chance
from validation.diagnosing.classical.nouns import Reading
from validation.diagnosing.classical.observed import Observed, inverse
from validation.prediction.inputs import Input

ROUNDING = 1e-12
"""Share of a variance that is left of one that a single input makes alone."""


def readings(of: Observed) -> tuple[Reading, ...]:
    """Every input that has a name and explains the measurements, the one that would be least wrong first.

    What fits best, the others as they are: ``z = aᵀ N⁻¹ d / (aᵀ N⁻¹ a)`` standard deviations, a what one of them makes of the
    measurements, N the covariance without it; what is left is ``dᵀ N⁻¹ d - z² aᵀ N⁻¹ a``.
    """
    return tuple(sorted(_wrong(of), key=lambda one: abs(one.tolerances)))


def _wrong(of: Observed) -> Iterator[Reading]:
    spreads = [fact.spread for fact in of.facts]
    for one in dict.fromkeys(each for spread in spreads for each in spread):
        a = np.array([spread.get(one, 0.0) for spread in spreads])
        P = inverse(of.covariance - np.outer(a, a) + ROUNDING * np.diag(np.diag(of.covariance)))
        z = float(a @ P @ of.left / (a @ P @ a))
        left = of.left - z * a
        if one.name and chance(float(left @ P @ left), len(left) - 1) > UNLIKELY:
            yield _reading(one, z, tuple(fact.name for fact, part in zip(of.facts, a, strict=True) if part))


def _reading(one: Input, z: float, of: tuple[str, ...]) -> Reading:
    """An input that reads `z` standard deviations too low, since the model says more than was measured."""
    return Reading(name=one.name, value=one.value, change=z * one.deviation, tolerances=z / NORMAL_95, of=of)
