"""What a search fits, of all that a straight line promises."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from validation.diagnose import search
from validation.diagnose.diagnosis import Candidate, Screened
from validation.diagnose.search import (
    ALIAS_FITS,
    FITS_OF_A_FAMILY,
    FITS_OF_A_STEP,
    FITS_OF_THE_STRUCTURE,
    NULL_MARGIN,
    REPLACEMENTS,
    RESTARTS,
    WORTH_A_FIT,
    CandidateFit,
    SearchStep,
    _fits_in_band,
    _local_fits,
    _most_promising,
    _rivals,
    in_band,
    ranked,
)
from validation.effects.catalogue import FAMILIES, parse
from validation.effects.effect import STRUCTURE, evidence_threshold
from validation.estimation.screening import ScoreTest
from validation.model.model import Added

LOUD = tuple(
    f"{family}:{target}=0.1" for family in ("force-gain", "force-delay", "force-highpass") for target in ("fmd-z1", "fmd-z2")
)
"""Of no structure."""


def screened(*texts: str, evidence: float = 100.0) -> list[Screened]:
    """All of them, the first one promising the most."""
    return [
        Screened(
            added=Added(named=parse(text)),
            evidence=evidence - k,
            told=ScoreTest(name="", estimate=0.0, information=0.0),
            plausible=1,
        )
        for k, text in enumerate(texts)
    ]


def ids(found: list[Screened]) -> list[str]:
    return [one.id for one in found]


def test_what_promises_little_is_not_fitted() -> None:
    found = screened(*LOUD[:3], evidence=WORTH_A_FIT + 1.5)
    assert _most_promising(found) == found[:2]


def test_of_one_family_no_more_than_some_are_fitted() -> None:
    gains = [f"force-gain:fmd-{one}=0.1" for one in ("z1", "z2", "z3", "z4", "x12")]
    chosen = _most_promising(screened(*gains, "force-delay:fmd-z1=0.001"))
    assert Counter(one.added.named.family for one in chosen) == {"force-gain": FITS_OF_A_FAMILY, "force-delay": 1}
    assert ids(chosen)[:FITS_OF_A_FAMILY] == ids(screened(*gains))[:FITS_OF_A_FAMILY]


def test_the_structure_is_asked_though_many_channels_promise_more() -> None:
    structure = ("modulus:mast=0.1", "point-mass:mast-top=0.1", "rigid-inertia:m=0.1")
    assert all(FAMILIES[parse(one).family].side == STRUCTURE for one in structure)
    assert not any(FAMILIES[parse(one).family].side == STRUCTURE for one in LOUD)
    chosen = _most_promising(screened(*LOUD, *structure))
    assert len(LOUD) == FITS_OF_A_STEP
    assert ids(chosen) == ids(screened(*LOUD, *structure))[: FITS_OF_A_STEP + FITS_OF_THE_STRUCTURE]


def test_no_more_of_the_structure_is_added_where_it_leads_anyway() -> None:
    chosen = _most_promising(screened("modulus:mast=0.1", "rigid-inertia:m=0.1", *LOUD, "point-mass:mast-top=0.1"))
    assert len(chosen) == FITS_OF_A_STEP


@pytest.mark.parametrize("count", [0, 1])
def test_few_promises_are_all_fitted(count: int) -> None:
    assert len(_most_promising(screened(*LOUD[:count]))) == count


def tried(text: str) -> CandidateFit:
    """A fit that ended there."""
    nobody: Any = None
    hypothesis = Candidate(effects=(Added(named=parse(text)),), fit=nobody, problem=nobody)
    return CandidateFit(id=hypothesis.effects[0].named.id, candidate=hypothesis, evidence=100.0, goodness=nobody)


def test_one_oscillator_under_two_names_is_fitted_under_both_at_the_sizes_of_the_first() -> None:
    menu = [
        Added(named=parse(f"{where}=m:0.001,f:1000,zeta:0.02"))
        for where in ("slosh:mast-top", "absorber:mast-top", "absorber:hub-4", "appendage:x")
    ]
    best = tried("slosh:mast-top=m:0.1,f:5,zeta:0.01")
    (twin,) = _rivals([best], [*menu, Added(named=parse("point-mass:mast-top=0"))], [])
    assert twin.named.id == "absorber:mast-top"
    assert twin.named.values == best.added.named.values


def test_the_rivals_of_a_resonator_stand_at_other_places_too_the_most_promising_first() -> None:
    best = tried("absorber:hub-3=m:0.1,f:5,zeta:0.01")
    places = ("hub-4", "hub-2", "hub-1", "flange", "top")
    found = screened("slosh:mast-top=m:1,f:5,zeta:0.01", *(f"absorber:{one}=m:1,f:5,zeta:0.01" for one in places))
    rivals = _rivals([best], [], found)
    assert [one.named.id for one in rivals] == [f"absorber:{one}" for one in places[:ALIAS_FITS]]
    assert all(one.named.values == best.added.named.values for one in rivals)


def test_where_another_place_is_better_the_others_are_asked_once_more_at_its_sizes() -> None:
    best, worse, other = (tried(f"absorber:{one}=m:0.{k},f:5,zeta:0.01") for k, one in enumerate(("hub-2", "hub-1", "top"), 1))
    slosh = tried("slosh:hub-2=m:0.1,f:5,zeta:0.01")
    again = _rivals([best, worse, slosh, other], [], [], again=True)
    assert [one.named.id for one in again] == [worse.id, other.id]
    assert all(one.named.values == best.added.named.values for one in again)


def test_of_two_fits_of_one_candidate_the_better_counts() -> None:
    first, second, other = ended(MASSES[0], 10.0), ended(MASSES[0], 30.0), ended(MASSES[1], 20.0)
    assert ranked([first, second, other]) == [second, other]


def test_a_twin_that_was_fitted_is_not_fitted_again() -> None:
    best, other = tried("slosh:mast-top=m:0.1,f:5,zeta:0.01"), tried("absorber:mast-top=m:0.1,f:5,zeta:0.01")
    assert _rivals([best, other], [best.added, other.added], []) == []


BAND: Any = SimpleNamespace(made=[SimpleNamespace(measured=SimpleNamespace(frequency=np.array([4.0, 32.0])))])


def test_a_resonator_that_left_the_band_gives_way_to_springs_and_masses() -> None:
    gone, there = tried("slosh:mast-top=m:0.9,f:1.1,zeta:0.01"), tried("slosh:hub-4=m:0.9,f:9,zeta:0.01")
    springs = [f"cable:{one}:lateral=50" for one in ("mast-top", "hub-4", "hub-3")]
    found = screened("slosh:mast-top=m:1,f:4,zeta:0.01", "slosh:hub-3=m:1,f:4,zeta:0.01", *springs)
    asked: list[list[str]] = []

    def fits(some: Sequence[Screened]) -> list[CandidateFit]:
        asked.append(ids(list(some)))
        return [gone, there] if some == found else [tried(f"{one.id}=1") for one in some]

    kept, told = _fits_in_band(BAND, found, fits)
    instead = [one.partition("=")[0] for one in springs[:REPLACEMENTS]]
    assert [one.id for one in kept] == [there.id, *instead]
    assert told == (gone.id,)
    assert asked == [ids(found), instead]
    assert _fits_in_band(BAND, found, lambda some: [there]) == ([there], ())


def test_an_effect_that_is_no_resonator_stays_wherever_it_ends() -> None:
    assert in_band(BAND, tried("cable:mast-top:lateral=5000"))
    assert not in_band(BAND, tried("absorber:mast-top=m:0.9,f:90,zeta:0.01"))


def stands(null: bool) -> Any:
    return SimpleNamespace(null=null)


def ended(text: str, evidence: float, null: bool = False) -> CandidateFit:
    return replace(tried(text), evidence=evidence, goodness=stands(null))


def unstuck(
    monkeypatch: pytest.MonkeyPatch, of: Sequence[CandidateFit], promises: Sequence[float], gain: float, null: bool = False
) -> Any:
    """What comes of fits of such promises where a fit afresh ends `gain` [nats] off each; and which were."""
    found = [replace(screened(f"{one.id}=1")[0], evidence=promise) for one, promise in zip(of, promises, strict=True)]
    by_id, asked = {one.id: one for one in of}, []

    def again(bench: object, at: object, added: Added) -> str:
        asked.append(added.named.id)
        return added.named.id

    monkeypatch.setattr(search, "restarted_from_priors", again)
    monkeypatch.setattr(search, "candidate_fit", lambda at, id: replace(by_id[id], evidence=by_id[id].evidence + gain))
    nobody: Any = None
    best_first = search._restarted_where_stuck(BAND, nobody, stands(null), of, found, lambda what, share: None)
    return best_first, asked


MASSES = tuple(f"point-mass:{one}=0.1" for one in ("mast-top", "hub-3", "hub-4", "hub-1"))


def test_what_kept_less_than_half_of_the_best_promise_is_tried_afresh_and_taken_where_better(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    fits = [ended(MASSES[0], 40.0), ended(MASSES[1], 30.0)]
    best_first, asked = unstuck(monkeypatch, fits, (70.0, 90.0), 200.0)
    assert asked == [fits[1].id]  # 40 are more than half of 70, and 30 less than half of 90
    assert [(one.id, one.evidence) for one in best_first] == [(fits[1].id, 230.0), (fits[0].id, 40.0)]


def test_a_fit_afresh_that_is_worse_is_not_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    best_first, asked = unstuck(monkeypatch, [ended(MASSES[0], 40.0)], (100.0,), -10.0)
    assert asked
    assert [one.evidence for one in best_first] == [40.0]


def test_only_the_most_promising_are_tried_afresh(monkeypatch: pytest.MonkeyPatch) -> None:
    fits = [ended(one, 1.0) for one in MASSES]
    _, asked = unstuck(monkeypatch, fits, (100.0, 400.0, 300.0, 200.0), 0.0)
    assert asked == [fits[1].id, fits[2].id, fits[3].id]
    assert len(asked) == RESTARTS


@pytest.mark.parametrize(("here", "best"), [(True, False), (False, True)])
def test_nothing_is_tried_afresh_where_nothing_need_be_missing(monkeypatch: pytest.MonkeyPatch, here: bool, best: bool) -> None:
    best_first, asked = unstuck(
        monkeypatch, [ended(MASSES[0], 1.0, best), ended(MASSES[1], 2.0, best)], (100.0, 100.0), 5.0, here
    )
    assert not asked
    assert [one.evidence for one in best_first] == [2.0, 1.0]


def test_where_nothing_need_be_missing_what_asks_for_more_does_not_hide_what_asks_for_less(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(search, "fit_with", lambda bench, at, added: added.named.id)
    monkeypatch.setattr(search, "candidate_fit", lambda at, id: ended(f"{id}=0.1", 1.0))
    found = screened("structural-damping:mast=0.02", "force-gain:fmd-z2=0.02", evidence=15.0)
    assert evidence_threshold("structural-damping") - NULL_MARGIN > 15.0 > 14.0 > evidence_threshold("force-gain") - NULL_MARGIN
    nobody: Any = None
    tried_ones = _local_fits(nobody, nobody, stands(null=True), found, lambda what, share: None)
    assert [one.id for one in tried_ones] == ["force-gain:fmd-z2"]
    both = _local_fits(nobody, nobody, stands(null=False), found, lambda what, share: None)
    assert [one.id for one in both] == ["structural-damping:mast", "force-gain:fmd-z2"]


@pytest.mark.parametrize(("straight", "again", "kept"), [(60.0, 90.0, 60.0), (10.0, 90.0, 90.0), (10.0, 5.0, 10.0)])
def test_a_rival_that_keeps_less_than_half_of_what_the_best_does_is_fitted_afresh(
    monkeypatch: pytest.MonkeyPatch, straight: float, again: float, kept: float
) -> None:
    best, rival = ended(MASSES[0], 100.0), Added(named=parse(MASSES[1]))
    promised = screened(MASSES[0])
    monkeypatch.setattr(search, "goodness_of_fit", lambda fit, problem: SimpleNamespace(null=True, misfit=1.0))
    monkeypatch.setattr(search, "screen", lambda bench, at, menu: promised)
    monkeypatch.setattr(search, "_fits_in_band", lambda bench, found, fits: ([best], ()))
    monkeypatch.setattr(search, "is_significant", lambda of: True)
    monkeypatch.setattr(search, "_rivals", lambda tried, menu, found, *, again: [rival])
    monkeypatch.setattr(search, "fit_with", lambda bench, at, added: straight)
    monkeypatch.setattr(search, "restarted_from_priors", lambda bench, at, added: again)
    monkeypatch.setattr(search, "candidate_fit", lambda at, evidence: ended(MASSES[1], evidence))
    nobody: Any = SimpleNamespace(fit=None, problem=None)
    step = search._step(nobody, nobody, [rival], lambda what, share: None)
    assert [(one.id, one.evidence) for one in step.tried] == [(best.id, 100.0), (rival.named.id, kept)]


def a_round(found: Sequence[Screened], left_band: tuple[str, ...] = ()) -> SearchStep:
    """In which no fit is left."""
    nobody: Any = None
    return SearchStep(at=nobody, goodness=nobody, screened=tuple(found), tried=(), added="", left_band=left_band)


def test_a_round_without_a_fit_says_why() -> None:
    assert a_round(screened("cable:mast-top:lateral=50", evidence=2.25)).text == (
        "no candidate is worth a fit: cable:mast-top:lateral promises most, 2.2 nats, where 8 are asked for"
    )
    assert a_round([]).text == "there is no candidate"
    assert a_round(screened("slosh:mast-top=m:1,f:4,zeta:0.01"), left_band=("slosh:mast-top",)).text == (
        "a fit drives slosh:mast-top out of the band of the data, and no other kind of effect is worth a fit"
    )
