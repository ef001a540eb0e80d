"""One row a family: how often it was planted alone, and what became of it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from statistics import median

from benchmarks.blind.score.outcome import Outcome
from benchmarks.blind.score.rates import Rate, rate
from benchmarks.blind.score.rows import SINGLE


@dataclass(frozen=True, kw_only=True)
class OfFamily:
    """One family of effects, of the singles in which it was planted.

    Attributes
    ----------
    family : name
    first, inside, extra : how often it was named first, lay in the class, and something else was claimed besides
    error : median of the relative errors of its sizes; None where none was found
    covered : how often intervals held them
    instead : what was claimed in its place, and how often; empty where nothing was
    """

    family: str
    first: Rate
    inside: Rate
    extra: Rate
    error: float | None
    covered: Rate
    instead: str


def by_family(outcomes: Sequence[Outcome]) -> list[OfFamily]:
    """In the order in which they come."""
    singles = [one for one in outcomes if one.kind == SINGLE]
    names = sorted({one.families[0] for one in singles})
    return [_family(name, [one for one in singles if one.families[0] == name]) for name in names]


def _family(name: str, found: Sequence[Outcome]) -> OfFamily:
    sizes = [size for one in found for size in one.sizes]
    return OfFamily(
        family=name,
        first=rate(one.first for one in found),
        inside=rate(one.inside for one in found),
        extra=rate(one.extra for one in found),
        error=median(size.error for size in sizes) if sizes else None,
        covered=rate(size.inside for size in sizes),
        instead=_counted(_instead(one) for one in found if not one.first),
    )


def _instead(one: Outcome) -> str:
    if one.refused or one.broken:
        return "refused" if one.refused else "broken"
    return one.claimed[0] if one.claimed else one.verdict


def _counted(words: Iterable[str]) -> str:
    found = Counter(words)
    return ", ".join(f"{word}{f' ({count})' if count > 1 else ''}" for word, count in found.most_common())
