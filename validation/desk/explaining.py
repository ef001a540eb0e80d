"""One effect explained to a person: what it means, how large it is, what it is mistaken for, and what would tell."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import inf
from typing import Any

from validation.desk.desk import Desk
from validation.desk.diagnosing import diagnosis
from validation.diagnosing import figures
from validation.diagnosing.diagnosis import Advice
from validation.effects.catalogue import FAMILIES
from validation.effects.identifiers import Named, parse
from validation.effects.targets import Vocabulary
from validation.ladders.candidate import completed


@dataclass(frozen=True, kw_only=True)
class Shown:
    """One size of an effect.

    Attributes
    ----------
    key : empty for the one that stands alone
    value, low, high : SI; the last two a 90 % interval, equal to the value where it was not fitted
    unit : SI; "1" for a ratio
    text : value and interval as a laboratory says them: "+7.93 % (+7.69 to +8.17)"
    """

    key: str
    value: float
    low: float
    high: float
    unit: str
    text: str


@dataclass(frozen=True, eq=False, kw_only=True)
class Explained:
    """One effect, for somebody who never heard of it.

    Attributes
    ----------
    id : ``family:target``
    written : with its size, as `massline add` takes it
    what : in a few words
    text : what it means here
    equation, reference : of the catalogue
    sizes : as the diagnosis found them; none of one that it did not try
    evidence : [nats]; None where it was not tried, or beyond all numbers
    aliases : ids that these data cannot tell from it
    mistaken_for : ids or families that look like it
    confirmed_by : what would confirm it in the laboratory
    separating : measurements that would tell it from its aliases, the best first, in words
    note : what the data say of it beyond its size
    """

    id: str
    written: str
    what: str
    text: str
    equation: str
    reference: str
    sizes: tuple[Shown, ...]
    evidence: float | None
    aliases: tuple[str, ...]
    mistaken_for: tuple[str, ...]
    confirmed_by: str
    separating: tuple[str, ...]
    note: str


def explained(of: Desk, effect: str) -> Explained:
    """`effect` (an id, or with its size) as the diagnosis and the catalogue speak of it. Its curves: `whatif.what_if`.

    Raises
    ------
    BadInput : no such effect, with the nearest.
    """
    named = parse(completed(effect)[0], Vocabulary(accelerometers=None, forces=None, places=None, parts=None), source="effect")
    family, found = FAMILIES[named.family], diagnosis(of) or {}
    tried = _tried(found, named.id)
    return Explained(
        id=named.id,
        written=str(tried.get("written", effect)),
        what=family.what,
        text=family.sentence.format(target=named.target, targets=" and ".join(named.targets)),
        equation=family.equation,
        reference=family.reference,
        sizes=tuple(_shown(named.family, one) for one in tried.get("values", ())),
        evidence=tried.get("evidence_nats"),
        aliases=_aliases(found, named),
        mistaken_for=family.mistaken_for,
        confirmed_by=family.confirmed_by,
        separating=tuple(_advice(one) for one in found.get("advice", ()) if _is_about(one, named.id)),
        note=str(tried.get("note") or ""),
    )


def _tried(found: Mapping[str, Any], id: str) -> Mapping[str, Any]:
    """What a diagnosis says of an effect: as it was accepted, else as it was ranked."""
    every = (*found.get("accepted", ()), *found.get("ranking", ()))
    nothing: Mapping[str, Any] = {}
    return next((one for one in every if one["id"] == id), nothing)


def _shown(family: str, one: Mapping[str, Any]) -> Shown:
    key, value, unit, (low, high) = one["key"], one["value"], one["unit"], one["interval90"]
    (middle, least, most), shown = figures.written(family, key, unit, (value, low, high))
    text = figures.with_unit(middle, shown) + (f" ({least} to {most})" if low < high else "")
    return Shown(key=key, value=value, low=low, high=high, unit=unit, text=text)


def _aliases(found: Mapping[str, Any], named: Named) -> tuple[str, ...]:
    alike = found.get("equivalence_class", ())
    return tuple(id for id in alike if id != named.id) if named.id in alike else ()


def _is_about(one: Mapping[str, Any], id: str) -> bool:
    """Whether a piece of advice tells `id` from others; one that names nobody is about all."""
    return not one["separates"] or id in one["separates"]


def _advice(one: Mapping[str, Any]) -> str:
    gain, hours = one["expected_evidence_nats"], one["hours"]
    return Advice(
        test=one["test"], gain=inf if gain is None else gain, separates=tuple(one["separates"]), hours=hours or 0.0
    ).text
