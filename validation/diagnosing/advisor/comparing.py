"""Explanations set beside each other in one test: how many nats it gives for the right one, whichever that is.

The first explanation lends the test its derivatives. Every other one predicts what it would read; what the first cannot follow of
that, latent inputs taken out, is their difference.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from geometry.arrays import Array
from identification.self_calibration.elimination import Normal
from validation.diagnosing.advisor.expected import nats
from validation.diagnosing.advisor.knowledge import Knowledge
from validation.diagnosing.advisor.offer import Offer
from validation.diagnosing.advisor.planned import Planned, lines_of, reading
from validation.engine import likelihood
from validation.engine.fit import FLOOR
from validation.engine.parameter import EFFECT, Parameter
from validation.engine.prediction import Change, Conveyed, Fact, Lines


@dataclass(frozen=True, eq=False, kw_only=True)
class _Differences:
    """In the parameters (p,), how every other explanation differs from the first in a test."""

    parameters: tuple[Parameter, ...]
    others: tuple[Normal, ...]


def told(offer: Offer, first: Knowledge, others: Sequence[Knowledge]) -> tuple[float, ...]:
    """Nats that `offer` is expected to tell of `first` against each of `others`, as far as a straight line goes.

    Raises
    ------
    numpy.linalg.LinAlgError, ValueError, FloatingPointError : a model breaks down in this test.
    """
    here, there = offer.by(first), tuple(offer.by(one) for one in others)
    found = _of_facts(offer, here, there) if offer.test is None else _of_lines(offer.test, here, there)
    own = first.spread(found.parameters, offer.moved)
    return tuple(
        either(first.odds(one), nats(difference, one.spread(found.parameters, offer.moved)), nats(difference, own))
        for difference, one in zip(found.others, others, strict=True)
    )


def either(probability: float, first: float, other: float) -> float:
    """What is expected where the first is right with `probability`: the geometric mean, which follows the smaller of the two.

    What would be plain in the one case is no reason to expect it in the other.
    """
    least = np.finfo(np.float64).tiny
    return float(max(first, least) ** probability * max(other, least) ** (1 - probability))


def _of_lines(test: Planned, first: Knowledge, others: Sequence[Knowledge]) -> _Differences:
    lines, worth = lines_of(test, reading(test, first, first.offsets))
    mine = test.prediction.with_effects(first.effects)
    predicted = mine.at(first.offsets, lines)
    parameters = {one.name: one for one in mine.parameters if one.tolerance > 0}
    changes = {name: change for name, change in predicted.changes.items() if name in parameters}
    for other in others:
        own, extra = _of_effects(test, other, lines)
        changes = {**extra, **changes}
        parameters = {**own, **parameters}
    names = tuple(changes)
    whole = replace(predicted, changes=changes)
    found = []
    for other in others:
        seen = likelihood.observed(reading(test, other, other.offsets), lines)
        found.append(likelihood.total(likelihood.normals(seen, whole, names, FLOOR).values(), len(names)))
    return _Differences(
        parameters=tuple(parameters[name] for name in names),
        others=tuple(_scaled(one, worth) for one in found),
    )


def _of_effects(test: Planned, of: Knowledge, lines: Lines) -> tuple[dict[str, Parameter], Mapping[str, Change | Conveyed]]:
    """The sizes of the effects of `of`, and how the test answers to them."""
    own = test.prediction.with_effects(of.effects)
    parameters = {one.name: one for one in own.parameters if one.kind == EFFECT and one.tolerance > 0}
    changes = own.at(of.offsets, lines, derivatives=frozenset(parameters)).changes if parameters else {}
    return parameters, {name: change for name, change in changes.items() if name in parameters}


def _scaled(one: Normal, factor: float) -> Normal:
    return Normal(cost=factor * one.cost, gradient=factor * one.gradient, matrix=factor * one.matrix)


def _of_facts(offer: Offer, first: Knowledge, others: Sequence[Knowledge]) -> _Differences:
    """(predicted - measured) / deviation of every number, as each explanation has it."""
    every = [offer.facts(one.effects) for one in (first, *others)]
    known = {one.name: one for facts in every[::-1] for fact in facts for one in fact.parameters}
    left, J = _said(every[0], first, tuple(known))
    found = []
    for facts, other in zip(every[1:], others, strict=True):
        says, slopes = _said(facts, other, tuple(known))
        J = np.where(np.any(J != 0, axis=0), J, slopes)
        found.append(says - left)
    differences = (Normal(cost=0.5 * float(away @ away), gradient=J.T @ away, matrix=J.T @ J) for away in found)
    return _Differences(parameters=tuple(known.values()), others=tuple(differences))


def _said(facts: Sequence[Fact], by: Knowledge, names: Sequence[str]) -> tuple[Array, Array]:
    """(q,) residuals and (q, p) slopes."""
    said = [fact.residual(by.offsets) for fact in facts]
    rows = np.array([[slopes.get(name, 0.0) for name in names] for _, slopes in said])
    return np.array([left for left, _ in said]), rows.reshape(len(said), len(names))
