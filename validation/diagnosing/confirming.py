"""What the catalogue knows to confirm a cause, as advice for which there is no figure."""

from __future__ import annotations

from collections.abc import Iterable

from validation.diagnosing.diagnosis import Advice
from validation.effects.catalogue import FAMILIES
from validation.effects.identifiers import Named


def confirming(effects: Iterable[Named]) -> tuple[Advice, ...]:
    """One for each of `effects`, in their order; none of those that nothing confirms."""
    known = [(one.id, FAMILIES[one.family].confirmed_by) for one in effects]
    return tuple(Advice(test=f"to confirm {id}: {how}", gain=0.0) for id, how in known if how)
