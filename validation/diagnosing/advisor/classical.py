"""Tests of the menu that need no shaker: a balance, a crane, a pendulum, each about an article that was tested."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from geometry.errors import BadInput
from identification import classical as classical_numbers
from identification.quality import NORMAL_95
from validation.diagnosing.advisor.articles import named
from validation.diagnosing.advisor.offer import Offer
from validation.diagnosing.advisor.planned import Template
from validation.engine.prediction import Fact
from validation.identifying.known import above_fmd
from validation.models.model import Added, Model
from validation.prediction.facts import KEYS, ArticleFact, article_of, weights_of


@dataclass(frozen=True, eq=False, kw_only=True)
class Method:
    """A classical measurement.

    Attributes
    ----------
    words : what to do; ``{}`` stands for the article
    hours : of work
    tolerances : half-widths of 95 % intervals by key of `KEYS`, SI; of a mass and of moments of inertia as a share
    """

    words: str
    hours: float
    tolerances: Mapping[str, float]


SHARES = ("mass", "Ixx", "Iyy", "Izz")

METHODS = (
    Method(words="Weigh {}", hours=0.5, tolerances={"mass": 1e-3}),
    Method(words="Find the centre of gravity of {} on the crane", hours=2.0, tolerances=dict.fromkeys(KEYS[1:4], 1e-3)),
    Method(words="Swing {} on a pendulum about its three axes", hours=8.0, tolerances=dict.fromkeys(KEYS[4:7], 0.01)),
)
"""With the tolerances of the examples that are shipped."""


def classical(templates: Sequence[Template], there: Sequence[Fact]) -> Iterator[Offer]:
    """Of every article that stood on the FMD, unless its numbers are among the facts that are `there`."""
    model = templates[0].tested.model
    known = [one for one in there if isinstance(one, ArticleFact)]
    for what in dict.fromkeys(above_fmd(one.tested.campaign.article) for one in templates):
        for method in METHODS if what else ():
            facts = _facts(model, what, method)
            if any(not _is_known(one, known) for one in facts):
                yield Offer(
                    kind=method.words, words=method.words.format(named(what)), hours=method.hours, facts=partial(_with, facts)
                )


def _facts(model: Model, what: str, method: Method) -> tuple[ArticleFact, ...]:
    """The numbers of the method, each counted from 0; none of an article of which the model knows no inertia."""
    try:
        of = article_of(model, method.words, what)
    except BadInput:
        return ()
    ten = classical_numbers.quantities(of.at({})[0])
    found = []
    for key, tolerance in method.tolerances.items():
        weights = weights_of(key)
        size = abs(float(weights @ ten)) if key in SHARES else 1.0
        found.append(ArticleFact(name=key, of=of, weights=weights, value=0.0, deviation=size * tolerance / NORMAL_95))
    return tuple(found)


def _is_known(one: ArticleFact, known: Sequence[ArticleFact]) -> bool:
    return any(other.of.article == one.of.article and np.array_equal(other.weights, one.weights) for other in known)


def _with(facts: Sequence[ArticleFact], effects: Sequence[Added]) -> tuple[Fact, ...]:
    return tuple(one.with_effects(effects) for one in facts)
