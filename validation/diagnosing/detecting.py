"""The smallest size at which these data would name each effect: what "nothing is missing" is worth."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite

from validation.diagnosing.diagnosis import Detectable
from validation.diagnosing.dictionary import smallest_mass
from validation.diagnosing.screened import Screened
from validation.effects.worth import worth


def detectable(screened: Sequence[Screened]) -> tuple[Detectable, ...]:
    """Of every candidate that the data tell at all; switches have no size."""
    found = (_of(one) for one in screened if not all(size.whole for size in one.added.named.sizes))
    return tuple(one for one in found if isfinite(one.size))


def _of(one: Screened) -> Detectable:
    size, wanted = one.added.named.sizes[0], worth(one.added.named.family)
    if one.clearest is not None:
        mass = smallest_mass(one.clearest, wanted)
        return Detectable(id=one.id, size=mass, unit=size.unit, at=f"{one.clearest_at:.3g} Hz")
    return Detectable(id=one.id, size=one.told.detectable(one.plausible, wanted), unit=size.unit)
