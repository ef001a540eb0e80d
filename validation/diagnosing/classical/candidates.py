"""What may be wrong where only weights, centres of gravity and periods are known: effects of the pendulum and of the body."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from geometry.errors import BadInput
from geometry.inertia import PARAMETERS
from geometry.keys import nearest
from validation.effects.catalogue import FAMILIES
from validation.effects.family import PENDULUM, PERIOD_STAGE, Size
from validation.effects.identifiers import Named
from validation.models.model import Added
from validation.prediction import swung
from validation.prediction.facts import ArticleFact
from validation.prediction.inertia import WEIGHED

REACH = 6.0
"""Plausible sizes up to which an effect is looked at; beyond it explains nothing."""

LIGHTEST = 0.5
"""Share of an article's mass that is left at the least: more is not missing in a drawing."""


@dataclass(frozen=True, kw_only=True)
class Candidate:
    """An effect with one size that might be there.

    Attributes
    ----------
    added : with its plausible size
    size : of the catalogue
    low, high : sizes that are looked at
    """

    added: Added
    size: Size
    low: float
    high: float

    @property
    def id(self) -> str:
        """``family:target``."""
        return self.added.named.id

    @property
    def of_pendulum(self) -> bool:
        """Whether it is the pendulum's, and not the article's."""
        return FAMILIES[self.added.named.family].side == PENDULUM


def pendulum_candidates(facts: Sequence[ArticleFact]) -> tuple[Added, ...]:
    """Effects, each at a plausible size, that change the period of a swing among `facts` and were not corrected for."""
    swings = [fact.swing for fact in facts if fact.swing is not None]
    named = (plausible(name) for name, family in FAMILIES.items() if family.stage == PERIOD_STAGE and not family.targets)
    return tuple(Added(named=one) for one in named if any(swung.acts(one, swing) for swing in swings))


def candidates(facts: Sequence[ArticleFact], own: Sequence[Added] = (), only: Sequence[str] = ()) -> tuple[Candidate, ...]:
    """All that might explain `facts`, but for what the model has among its `own`: the pendulum's first, then the article's.

    Raises
    ------
    BadInput : one of `only`, families or ids that are looked for, is none of them.
    """
    there = {one.named.id for one in own}
    least = min((float(fact.of.ten({})[0]) for fact in facts), default=0.0)
    every = (*pendulum_candidates(facts), *(Added(named=plausible(name)) for name in _of_body(facts)))
    found = tuple(_candidate(one, least) for one in every if one.named.id not in there)
    for wanted in only:
        if not any(_is(one, wanted) for one in found):
            known = dict.fromkeys(name for one in found for name in (one.added.named.family, one.id))
            problem = "is no effect that weights and periods could show"
            remedy = f"{nearest(wanted, known)}Known here are {', '.join(dict.fromkeys(one.added.named.family for one in found))}"
            raise BadInput(source="--candidate", field=wanted, problem=problem, remedy=remedy)
    return tuple(one for one in found if not only or any(_is(one, wanted) for wanted in only))


def _is(one: Candidate, name: str) -> bool:
    return name in (one.added.named.family, one.id)


def _of_body(facts: Sequence[ArticleFact]) -> Iterator[str]:
    yield from (f"rigid-inertia:{name}" for name in PARAMETERS)
    yield from dict.fromkeys(f"point-mass:{place}" for fact in facts for place in fact.of.drawn.places)


def plausible(name: str) -> Named:
    """The effect `name` at a plausible size."""
    family, *targets = name.split(":")
    sizes = FAMILIES[family].sizes_at(tuple(targets))
    return Named(family=family, targets=tuple(targets), values={size.key: size.null + size.plausible for size in sizes})


def _candidate(added: Added, mass: float) -> Candidate:
    size = added.named.sizes[0]
    low, high = max(size.low, -REACH * size.plausible), min(size.high, REACH * size.plausible)
    if added.named.family in WEIGHED and size.unit == "kg":
        low = max(low, -LIGHTEST * mass)
    return Candidate(added=added, size=size, low=low, high=high)
