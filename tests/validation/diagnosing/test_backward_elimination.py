"""Effects that were found first are asked once more beside those that were found later."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import log
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from geometry.errors import CheckFailed
from validation.diagnose import diagnose, search
from validation.diagnose.diagnosis import Candidate
from validation.diagnose.search import RIVAL_SHARE, RIVALS, CandidateFit, SearchStep, _offsets_in
from validation.effects.catalogue import parse
from validation.effects.effect import EVIDENCE_THRESHOLD
from validation.estimation.problem import EFFECT, Parameter
from validation.model.model import Added

TOP, HUB, BLADE, LOSS = "point-mass:mast-top", "point-mass:hub-4", "modulus:lower-1", "structural-damping:lower-1"
GONE = "cable:mast-top:lateral"
"""Stands for a resonator that a fit drives out of the band."""

NOBODY: Any = None
BENCH: Any = SimpleNamespace(problem=lambda effects: None)
STANDS: Any = SimpleNamespace(null=True)


def hypothesis(*ids: str, evidence: float) -> Candidate:
    """A fit of such effects."""
    fit: Any = SimpleNamespace(log_evidence=evidence, by_name={})
    return Candidate(effects=tuple(Added(named=parse(f"{id}=0.3")) for id in ids), fit=fit, problem=NOBODY)


def found(*brought: tuple[str, float], at: Candidate) -> SearchStep:
    """A round from `at` that tried these, the best first, and took that."""
    tried = tuple(
        CandidateFit(id=id, candidate=hypothesis(id, evidence=nats), evidence=nats, goodness=STANDS) for id, nats in brought
    )
    return SearchStep(at=at, goodness=NOBODY, screened=(), tried=tried, added=tried[0].id)


def asked(
    monkeypatch: pytest.MonkeyPatch, at: Candidate, before: Sequence[SearchStep], worth: Mapping[tuple[str, ...], float]
) -> tuple[Candidate, tuple[SearchStep, ...], list[str]]:
    """What comes of it where fits of effects end at the evidence `worth`; and what was fitted instead."""
    fitted: list[str] = []

    def instead(bench: object, of: Candidate, rest: Candidate, added: Added) -> Candidate:
        ids = [*(one.named.id for one in rest.effects), added.named.id]
        fitted.append(added.named.id)
        return hypothesis(*ids, evidence=worth[tuple(sorted(ids))])

    def without(bench: object, of: Candidate) -> Candidate:
        rest = [one.named.id for one in of.effects]
        return hypothesis(*rest, evidence=worth[tuple(sorted(rest))])

    monkeypatch.setattr(search, "nearby", lambda problem, free, offsets: None)
    monkeypatch.setattr(search, "recentred", without)
    monkeypatch.setattr(search, "_fit_in_place", instead)
    monkeypatch.setattr(search, "is_significant", lambda of: True)
    monkeypatch.setattr(search, "in_band", lambda bench, one: one.id != GONE)
    monkeypatch.setattr(search, "goodness_of_fit", lambda fit, problem: STANDS)
    ended, more = search.backward_elimination(BENCH, at, before, lambda what, share: None)
    return ended, more, fitted


def ids(of: Candidate) -> set[str]:
    return {one.named.id for one in of.effects}


ALONE = hypothesis(evidence=0.0)
TWO = (found((HUB, 5200.0), (TOP, 4900.0), at=ALONE), found((BLADE, 130.0), at=hypothesis(HUB, evidence=5200.0)))
"""The first took the wrong place, before the blade was known to be soft."""


def test_a_single_effect_is_not_asked_again(monkeypatch: pytest.MonkeyPatch) -> None:
    at = hypothesis(HUB, evidence=5200.0)
    assert asked(monkeypatch, at, TWO[:1], {}) == (at, (), [])


def test_a_place_that_is_better_beside_what_was_found_later_is_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    at = hypothesis(HUB, BLADE, evidence=5330.0)
    known = {(BLADE,): 30.0, tuple(sorted((TOP, BLADE))): 5360.0, (TOP,): 4900.0}
    ended, (first, second), fitted = asked(monkeypatch, at, TWO, known)
    assert ids(ended) == {TOP, BLADE}
    assert fitted == [TOP]
    assert (first.reconsidered, first.added) == (HUB, TOP)
    assert [(one.id, one.evidence) for one in first.tried] == [(TOP, 5330.0), (HUB, 5300.0)]
    assert (second.reconsidered, second.added, second.tried[0].evidence) == (BLADE, BLADE, 460.0)
    assert first.text == f"{TOP} brings 5330.0 nats beside {BLADE}, and {HUB} only 5300.0"
    assert replace(first, at=ALONE).text == f"{TOP} brings 5330.0 nats alone, and {HUB} only 5300.0"


def test_what_stays_the_best_stays_as_it_was_fitted(monkeypatch: pytest.MonkeyPatch) -> None:
    at = hypothesis(HUB, BLADE, evidence=5330.0)
    known = {(BLADE,): 30.0, tuple(sorted((TOP, BLADE))): 5320.0, (HUB,): 5200.0}
    ended, again, _ = asked(monkeypatch, at, TWO, known)
    assert ended is at
    assert [one.reconsidered for one in again] == [one.added for one in again] == [HUB, BLADE]
    assert diagnose.indistinguishable_ids(at.effects, [*TWO, *again]) == ()


def test_what_is_not_needed_any_more_goes(monkeypatch: pytest.MonkeyPatch) -> None:
    at = hypothesis(HUB, BLADE, evidence=5330.0)
    known = {(BLADE,): 5330.0 - EVIDENCE_THRESHOLD + 1, (): 0.0}
    ended, again, fitted = asked(monkeypatch, at, TWO, known)
    assert (ids(ended), fitted) == ({BLADE}, [])
    assert [(one.reconsidered, one.added, ids(one.at)) for one in again] == [(BLADE, BLADE, set())]  # asked alone, where it is


def test_what_took_a_place_beside_something_that_goes_is_asked_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """Beside the blade both places were as good; without it the class is another, and the verdict that of what is left."""
    at = hypothesis(HUB, BLADE, evidence=5330.0)
    known = {(BLADE,): 30.0, tuple(sorted((TOP, BLADE))): 5333.0, (TOP,): 5332.0, (HUB,): 4000.0, (): 0.0}
    ended, again, _ = asked(monkeypatch, at, TWO, known)
    assert ids(ended) == {TOP}
    assert [(one.reconsidered, one.added, ids(one.at)) for one in again] == [(HUB, TOP, {BLADE}), (TOP, TOP, set())]
    best = diagnose.best_step(ended, [*TWO, *again])
    assert [one.id for one in best.tried] == [TOP, HUB]
    assert diagnose.indistinguishable_ids(ended.effects, [*TWO, *again]) == (TOP,)


@pytest.mark.parametrize(("other", "worth"), [(LOSS, 19.0), (GONE, 500.0)])
def test_no_name_is_taken_that_is_not_worth_it_or_does_not_stay_what_it_is(
    monkeypatch: pytest.MonkeyPatch, other: str, worth: float
) -> None:
    first = found((BLADE, 7.0), (other, 6.5), at=ALONE)
    at = hypothesis(BLADE, HUB, evidence=5207.0)
    known = {(HUB,): 5200.0, tuple(sorted((other, HUB))): 5200.0 + worth, (BLADE,): 7.0}
    ended, again, fitted = asked(monkeypatch, at, (first, found((HUB, 5200.0), at=hypothesis(BLADE, evidence=7.0))), known)
    assert fitted == [other]
    assert ended is at
    assert [one.added for one in again] == [BLADE, HUB]


def test_what_has_nothing_to_be_held_against_stays(monkeypatch: pytest.MonkeyPatch) -> None:
    def breaks(problem: object, free: object, offsets: object) -> None:
        raise CheckFailed("the model breaks down")

    monkeypatch.setattr(search, "nearby", breaks)
    at = hypothesis(HUB, BLADE, evidence=5330.0)
    assert search.backward_elimination(BENCH, at, TWO, lambda what, share: None) == (at, ())


def test_only_what_brought_a_good_part_and_is_not_there_is_a_rival(monkeypatch: pytest.MonkeyPatch) -> None:
    others = [(f"point-mass:{one}", 100.0) for one in ("flange", "hub-1", "hub-2", "hub-3", "hub-4", "mast-top")]
    one = found((TOP, 110.0), (BLADE, 105.0), *others[:5], ("rigid-inertia:m", 110 * RIVAL_SHARE - 1), at=ALONE)
    worth = {tuple(sorted((BLADE, id))): 90.0 for id, _ in others} | {(BLADE,): 50.0, (TOP,): 50.0, (BLADE, TOP): 150.0}
    known = found((BLADE, 100.0), at=hypothesis(TOP, evidence=50.0))
    _, _, fitted = asked(monkeypatch, hypothesis(TOP, BLADE, evidence=150.0), (one, known), worth)
    assert fitted == [id for id, _ in others[:RIVALS]]
    few = replace(one, tried=(one.tried[0], one.tried[-1]))
    assert asked(monkeypatch, hypothesis(TOP, BLADE, evidence=150.0), (few, known), worth)[2] == []


@pytest.mark.parametrize(("other", "same"), [("absorber:hub-4=m:1,f:9,zeta:0.1", True), ("cable:hub-4:lateral=50", False)])
def test_a_resonator_begins_at_the_sizes_of_the_one_that_was_found(other: str, same: bool) -> None:
    best = Added(named=parse("slosh:mast-top=m:0.002,f:19,zeta:0.02"))
    begins = search._at_sizes(Added(named=parse(other)), best)
    assert (begins.named.values == best.named.values) is same
    assert begins.named.id == other.partition("=")[0]


def test_logarithms_count_from_the_sizes_of_the_models_that_they_go_to() -> None:
    def parameter(name: str, nominal: float, logarithmic: bool) -> Parameter:
        return Parameter(name=name, kind=EFFECT, nominal=nominal, unit="kg", tolerance=1.0, logarithmic=logarithmic)

    old = (parameter("a", 2.0, True), parameter("b", 2.0, False), parameter("gone", 1.0, True))
    fit: Any = SimpleNamespace(parameters=old, offsets=np.array([0.1, 0.2, 0.3]))
    problem: Any = SimpleNamespace(by_name={"a": parameter("a", 4.0, True), "b": parameter("b", 2.0, False)})
    assert _offsets_in(problem, fit) == pytest.approx({"a": 0.1 - log(2), "b": 0.2})
