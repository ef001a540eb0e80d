"""`Offer`: a test that a laboratory can do: in words, how long it takes, and what it would read."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import MappingProxyType

from validation.diagnosing.advisor.knowledge import Knowledge, Moved, Origin
from validation.diagnosing.advisor.planned import Planned
from validation.engine.prediction import Fact
from validation.models.model import Added

NOTHING: Mapping[str, Origin] = MappingProxyType({})


def no_facts(effects: Sequence[Added]) -> tuple[Fact, ...]:
    """Of a test that is a campaign."""
    return ()


@dataclass(frozen=True, eq=False, kw_only=True)
class Offer:
    """A test of the menu: a campaign, or numbers of another measurement.

    Attributes
    ----------
    kind : of several of one kind only the best is named
    words : what to do
    hours : of work, roughly; assumed, to compare tests by
    test : the campaign; None for other measurements
    facts : by effects, the numbers of another measurement
    moved : parameters that the test moves or draws anew
    gone : families or ids of effects that the test takes away
    """

    kind: str
    words: str
    hours: float
    test: Planned | None = None
    facts: Callable[[Sequence[Added]], tuple[Fact, ...]] = no_facts
    moved: Moved = field(default_factory=lambda: NOTHING)
    gone: tuple[str, ...] = ()

    def by(self, known: Knowledge) -> Knowledge:
        """What is `known`, as it is in the test."""
        left = tuple(one for one in known.effects if not {one.named.family, one.named.id} & set(self.gone))
        return replace(known, effects=left, offsets=known.at(self.moved))
