"""The smallest size at which classical measurements would name an effect: where its own answer, without noise, is worth it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from geometry.arrays import Array
from validation.diagnosing.classical.judged import Tried
from validation.diagnosing.classical.observed import inverse
from validation.diagnosing.classical.weighed import evidence
from validation.diagnosing.diagnosis import Detectable
from validation.effects.worth import WORTH

HALVINGS = 12
"""Of the interval that holds it."""


def detectable(tried: Sequence[Tried], covariance: Array) -> tuple[Detectable, ...]:
    """Of every effect that measurements with this `covariance` (n, n) would name within its reach."""
    return tuple(_found(tried, inverse(covariance)))


def _found(tried: Sequence[Tried], precision: Array) -> Iterator[Detectable]:
    for one in tried:
        size = smallest(one, precision)
        if size < one.curve.high:
            yield Detectable(id=one.id, size=size, unit=one.candidate.size.unit)


def smallest(one: Tried, precision: Array) -> float:
    """Positive size at which the evidence is `WORTH`; the end of what is looked at where it is not."""
    low, high = 0.0, one.curve.high
    if not _named(one, high, precision):
        return high
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if _named(one, middle, precision) else (middle, high)
    return high


def _named(one: Tried, size: float, precision: Array) -> bool:
    left = -one.curve.at(np.array([size]))[0]
    return evidence(one.curve, one.answering.plausible, left, precision) > WORTH
