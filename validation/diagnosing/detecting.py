"""The smallest size at which these data would name each effect: what "nothing is missing" is worth."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, isfinite

from validation.diagnosing.diagnosis import Detectable
from validation.diagnosing.dictionary import smallest_mass
from validation.diagnosing.screened import Screened
from validation.effects.worth import worth

USUAL = "half of all frequencies"
"""At which a resonator of that mass would be named; tuned to a resonance of the article, one of a hundredth of it would be."""


def detectable(screened: Sequence[Screened]) -> tuple[Detectable, ...]:
    """Of every candidate that the data tell at all; switches have no size."""
    found = (_of(one) for one in screened if not all(size.whole for size in one.added.named.sizes))
    return tuple(one for one in found if isfinite(one.size))


def _of(one: Screened) -> Detectable:
    size, wanted = one.added.named.sizes[0], worth(one.added.named.family)
    if one.usual is not None:
        return Detectable(id=one.id, size=smallest_mass(one.usual, wanted), unit=size.unit, at=USUAL)
    return Detectable(id=one.id, size=_meant(one, one.told.detectable(one.plausible, wanted)), unit=size.unit)


def _meant(one: Screened, offset: float) -> float:
    """How far from no effect the size is at `offset`; infinite where that is more than a number holds."""
    if one.parameter is None or not isfinite(offset):
        return offset
    try:
        return one.parameter.value(offset) - one.parameter.value(0.0)
    except OverflowError:
        return inf
