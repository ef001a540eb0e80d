"""What a search fits of all that a straight line promises, what it takes away again, and when a fit is good enough."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import log
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.errors import CheckFailed
from validation.cli import main
from validation.diagnose import candidate_fits, diagnose, search
from validation.diagnose.candidate_fits import ABSURD, CandidateFit, ranked
from validation.diagnose.candidates import candidates, sizes
from validation.diagnose.diagnosis import Candidate, FoundNode, Screened
from validation.effects.catalogue import FAMILIES, parse
from validation.effects.effect import EVIDENCE_THRESHOLD, STRUCTURE, evidence_threshold
from validation.estimation.fit import FLOOR, unfitted
from validation.estimation.likelihood import ObservedLines
from validation.estimation.problem import EFFECT, FITTED, Fit, Parameter, Predicted
from validation.estimation.screening import ScoreTest
from validation.estimation.verdicts import expected_z2
from validation.model import model_file
from validation.model.model import Added
from validation.study import Study, read_data

LOUD = tuple(
    f"{family}:{target}=0.1" for family in ("force-gain", "force-delay", "force-highpass") for target in ("fmd-z1", "fmd-z2")
)
"""Of no structure."""


def in_place(monkeypatch: pytest.MonkeyPatch, name: str, other: object) -> None:
    """`other` in place of what is called `name`, in the search and in the fits that it asks for."""
    modules = [module for module in (search, candidate_fits) if hasattr(module, name)]
    assert modules
    for module in modules:
        monkeypatch.setattr(module, name, other)


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


def test_what_promises_little_and_of_one_family_more_than_some_are_not_fitted():
    found = screened(*LOUD[:3], evidence=search.WORTH_A_FIT + 1.5)
    assert search._most_promising(found) == found[:2]
    assert search._most_promising([]) == []
    gains = [f"force-gain:fmd-{one}=0.1" for one in ("z1", "z2", "z3", "z4", "x12")]
    chosen = search._most_promising(screened(*gains, "force-delay:fmd-z1=0.001"))
    assert Counter(one.added.named.family for one in chosen) == {"force-gain": search.FEW, "force-delay": 1}
    assert ids(chosen)[: search.FEW] == ids(screened(*gains))[: search.FEW]


def test_the_structure_is_asked_though_many_channels_promise_more():
    structure = ("modulus:mast=0.1", "point-mass:mast-top=0.1", "rigid-inertia:m=0.1")
    assert all(FAMILIES[parse(one).family].side == STRUCTURE for one in structure)
    assert not any(FAMILIES[parse(one).family].side == STRUCTURE for one in LOUD)
    chosen = search._most_promising(screened(*LOUD, *structure))
    assert len(LOUD) == search.FITS_OF_A_STEP
    assert ids(chosen) == ids(screened(*LOUD, *structure))[: search.FITS_OF_A_STEP + search.OTHERS]
    leading = screened(*structure[:2], *LOUD, structure[2])
    assert len(search._most_promising(leading)) == search.FITS_OF_A_STEP  # no more where it leads anyway


def tried(text: str) -> CandidateFit:
    """A fit that ended there."""
    nobody: Any = None
    hypothesis = Candidate(effects=(Added(named=parse(text)),), fit=nobody, problem=nobody)
    return CandidateFit(id=hypothesis.effects[0].named.id, candidate=hypothesis, evidence=100.0, goodness=nobody)


def test_one_oscillator_under_two_names_is_fitted_under_both_at_the_sizes_of_the_first():
    menu = [
        Added(named=parse(f"{where}=m:0.001,f:1000,zeta:0.02"))
        for where in ("slosh:mast-top", "absorber:mast-top", "absorber:hub-4", "appendage:x")
    ]
    best = tried("slosh:mast-top=m:0.1,f:5,zeta:0.01")
    (twin,) = search._rivals([best], [*menu, Added(named=parse("point-mass:mast-top=0"))], [])
    assert twin.named.id == "absorber:mast-top"
    assert twin.named.values == best.added.named.values
    assert search._rivals([best, tried("absorber:mast-top=m:0.1,f:5,zeta:0.01")], menu[:2], []) == []  # fitted already


def test_the_rivals_of_a_resonator_stand_at_other_places_too_and_are_asked_once_more_at_the_sizes_of_a_better_one():
    best = tried("absorber:hub-3=m:0.1,f:5,zeta:0.01")
    places = ("hub-4", "hub-2", "hub-1", "flange", "top")
    found = screened("slosh:mast-top=m:1,f:5,zeta:0.01", *(f"absorber:{one}=m:1,f:5,zeta:0.01" for one in places))
    rivals = search._rivals([best], [], found)
    assert [one.named.id for one in rivals] == [f"absorber:{one}" for one in places[:3]]
    assert all(one.named.values == best.added.named.values for one in rivals)
    best, worse, other = (tried(f"absorber:{one}=m:0.{k},f:5,zeta:0.01") for k, one in enumerate(("hub-2", "hub-1", "top"), 1))
    slosh = tried("slosh:hub-2=m:0.1,f:5,zeta:0.01")
    again = search._rivals([best, worse, slosh, other], [], [], again=True)
    assert [one.named.id for one in again] == [worse.id, other.id]
    assert all(one.named.values == best.added.named.values for one in again)


def test_beside_another_effect_all_that_may_be_wrong_in_one_place_is_fitted(monkeypatch):
    """Beside 0.98 kg on a plate 68 % more of its density promised 82 nats of the 181 that it brought, and its modulus 121."""
    monkeypatch.setattr(search, "aliases", lambda *of, limit: [])
    best, found = tried("modulus:mast=-0.4"), screened("modulus:mast=-0.4", "mass:mast=0.4", "mass:upper-long=0.2")
    assert search._rivals([best], [], found) == []
    mass = Added(named=parse("point-mass:mast-top=0.1"))
    beside = replace(best, candidate=replace(best.candidate, effects=(mass, best.added)))
    assert [one.named.id for one in search._rivals([beside], [], found)] == ["mass:mast"]


def test_of_two_fits_of_one_candidate_the_better_counts():
    first, second, other = ended(MASSES[0], 10.0), ended(MASSES[0], 30.0), ended(MASSES[1], 20.0)
    assert ranked([first, second, other]) == [second, other]


def test_of_one_place_by_its_name_and_by_its_coordinates_the_name_counts():
    """6 kg on a floor of three were told as at 0,0,0.45, which is that floor."""
    named, written = ended(MASSES[0], 30.0), replace(ended(MASSES[1], 30.02), id="point-mass:@0,0,0.45")
    assert ranked([written, named]) == ranked([named, written]) == [named, written]


def test_a_place_without_a_name_must_be_better_by_what_it_cost_to_have_looked_for_it():
    """69 % more of a rib was told as 0.14 kg at one of hundreds of nodes, 2.5 nats better, which chance is worth as well."""
    named, node = ended(MASSES[0], 37.3), replace(ended(MASSES[1], 39.8), looked=4.4)
    tried = ranked([node, named])
    assert tried == [named, node]
    assert replace(a_round([]), tried=tuple(tried)).indistinguishable == (named, node)
    assert ranked([named, replace(node, looked=1.0)])[0].id == node.id
    tie = replace(node, evidence=37.301)  # one name, whatever it cost
    assert [one.evidence for one in ranked([named, tie])] == [one.evidence for one in ranked([tie, named])]


def test_a_fit_is_worth_its_end_where_it_may_be_the_best_or_a_rival_of_it():
    """Beside a best that is all that is needed a few nats decide, beside another one a part of what it brings."""
    other = ended(MASSES[1], 40.0)
    assert search.worth(HERE, []) == np.inf
    assert search.worth(HERE, [other, ended(MASSES[0], 900.0, null=True)]) == 100.0 + search.SCREENING_MARGIN
    assert search.worth(HERE, [other, ended(MASSES[0], 900.0)]) == 1000.0 - search.GOOD_PART * 900.0


def test_names_that_tie_to_the_last_digit_are_one_name_whichever_way_rounding_fell():
    """A mass rides as well on either of two bolts of a rigid flange; 0.3 nats, of which nobody makes anything, are no tie."""
    one, other, near = (
        ended("point-mass:hub-2=0.3", 100.0),
        ended("point-mass:hub-1=0.3", 99.999),
        ended("point-mass:top=0.3", 99.7),
    )
    for first, second in ((one, other), (replace(one, evidence=99.999), replace(other, evidence=100.0))):
        tried = ranked([near, first, second])
        assert [each.id for each in tried] == [other.id, one.id, near.id]
        step = replace(a_round([]), tried=tuple(tried), added=other.id)
        assert step.same_as(other.id) == (one.id,)
        assert step.same_as(near.id) == ()
        assert step.same_as("modulus:mast") == ()


BAND: Any = SimpleNamespace(made=[SimpleNamespace(measured=SimpleNamespace(frequency=np.array([4.0, 32.0])))], tests=())


def test_a_resonator_that_left_the_band_gives_way_to_springs_and_masses():
    gone, there = tried("slosh:mast-top=m:0.9,f:1.1,zeta:0.01"), tried("slosh:hub-4=m:0.9,f:9,zeta:0.01")
    springs = [f"cable:{one}:lateral=50" for one in ("mast-top", "hub-4", "hub-3")]
    found = screened("slosh:mast-top=m:1,f:4,zeta:0.01", "slosh:hub-3=m:1,f:4,zeta:0.01", *springs)
    asked: list[list[str]] = []

    def fits(some):
        asked.append(ids(list(some)))
        return [gone, there] if some == found else [tried(f"{one.id}=1") for one in some]

    kept, told = search._fits_in_band(BAND, found, fits, stands(null=True))
    instead = [one.partition("=")[0] for one in springs[:2]]
    assert [one.id for one in kept] == [there.id, *instead]
    assert told == (gone.id,)
    assert asked == [ids(found), instead]
    assert candidate_fits.in_band(BAND, tried("cable:mast-top:lateral=5000"))  # no resonator: it stays wherever it ends
    assert search._fits_in_band(BAND, found, lambda some: [there], stands(null=True)) == ([there], ())


def test_a_resonator_that_leaves_the_band_gives_up_no_way_to_a_node(monkeypatch):
    """It is no explanation, however little it leaves: nodes were held against it."""
    in_place(monkeypatch, "goodness_of_fit", lambda fit, problem: SimpleNamespace(null=False, misfit=1.0))
    monkeypatch.setattr(search, "screen", lambda data, at, menu: menu)
    for one, kept in ((ended("slosh:mast-top=m:0.9,f:1.1,zeta:0.01", 90.0), 0), (ended("cable:hub-4:lateral=50", 90.0), 1)):
        monkeypatch.setattr(search, "_fits_of", lambda here, one=one: lambda data, at, found, progress: [one])
        assert len(search.first_fit(BAND, HERE, screened("cable:hub-4:lateral=50"), lambda what, share: None)) == kept


def test_nothing_takes_the_place_of_a_resonator_where_another_leaves_nothing_of_what_is_missing():
    gone = ended("slosh:mast-top=m:0.9,f:1.1,zeta:0.01", 10.0)
    for null, count in ((True, 0), (False, 1)):
        there, asked = ended("cable:hub-4:lateral=50", 90.0, null=null), list[Any]()

        def fits(some, there=there, asked=asked):
            asked.append(some)
            return [gone, there] if len(asked) == 1 else []

        found = screened("slosh:mast-top=m:1,f:4,zeta:0.01", "cable:hub-4:lateral=50", "cable:hub-3:lateral=50")
        assert search._fits_in_band(BAND, found, fits, stands(null=False)) == ([there], (gone.id,))
        assert len(asked) == 1 + count


def test_along_few_lines_no_way_goes_on_that_ends_above_one_that_leaves_nothing():
    """A delay of one pick-up left nothing of 309,000 nats, and eight others went ways of up to 245 evaluations to 100,000."""
    ends = {MASSES[0]: (500.0, False), MASSES[1]: (40.0, True), MASSES[2]: (900.0, False), MASSES[3]: (45.0, True)}
    worth = list[float]()

    def rough(problem, kinds, parent, begin, *, worth: float, told=worth):
        told.append(worth)
        cost, sound = ends[problem]
        return SimpleNamespace(cost=cost, log_evidence=-cost, sound=sound)

    asked: Any = [SimpleNamespace(named=SimpleNamespace(id=one)) for one in MASSES]
    data: Any = SimpleNamespace(problem=lambda effects: SimpleNamespace(sparser=lambda stride: effects[-1].named.id))
    best, *_ = search._along_few_lines(data, HERE, asked, lambda added, problem: [{}], rough, lambda what, share: None)
    assert best[0] is asked[1]
    assert worth == [np.inf, np.inf, 40.0 + search.SCREENING_MARGIN, 40.0 + search.SCREENING_MARGIN]


def stands(null: bool) -> Any:
    return SimpleNamespace(null=null, largest=0.0)


def ended(text: str, evidence: float, null: bool = False) -> CandidateFit:
    return replace(tried(text), evidence=evidence, goodness=stands(null))


def unstuck(
    monkeypatch: pytest.MonkeyPatch,
    of: Sequence[CandidateFit],
    promises: Sequence[float],
    gain: float,
    null: bool = False,
) -> Any:
    """What comes of fits of such promises where a fit afresh ends `gain` [nats] off each; and which were."""
    found = [replace(screened(f"{one.id}=1")[0], evidence=promise) for one, promise in zip(of, promises, strict=True)]
    by_id, asked = {one.id: one for one in of}, []

    def again(bench: object, at: object, added: Added, **_: float) -> str:
        asked.append(added.named.id)
        return added.named.id

    in_place(monkeypatch, "restarted_from_priors", again)
    in_place(monkeypatch, "candidate_fit", lambda at, id: replace(by_id[id], evidence=by_id[id].evidence + gain))
    best_first = search._restarted_where_stuck(BAND, HERE, stands(null), of, found, lambda what, share: None)
    return best_first, asked


HERE: Any = SimpleNamespace(fit=SimpleNamespace(cost=1000.0), problem=None, effects=())
"""Where a step begins."""

MASSES = tuple(f"point-mass:{one}=0.1" for one in ("mast-top", "hub-3", "hub-4", "hub-1"))


def test_what_kept_less_than_half_of_the_best_promise_is_tried_afresh_and_taken_where_better(monkeypatch):
    fits = [ended(MASSES[0], 40.0), ended(MASSES[1], 30.0)]
    best_first, asked = unstuck(monkeypatch, fits, (70.0, 90.0), 200.0)
    assert asked == [fits[1].id]  # 40 are more than half of 70, and 30 less than half of 90
    assert [(one.id, one.evidence) for one in best_first] == [(fits[1].id, 230.0), (fits[0].id, 40.0)]
    worse, asked = unstuck(monkeypatch, fits[:1], (100.0,), -10.0)
    assert (asked, [one.evidence for one in worse]) == ([fits[0].id], [40.0])


@pytest.mark.parametrize(("promise", "better"), [(365.0, True), (321.0, False)])
def test_what_promised_clearly_more_than_a_fit_that_leaves_nothing_and_kept_nothing_is_tried_afresh(monkeypatch, promise, better):
    """A portal with 120 g between two halves of its beam: 34 % on the one left nothing, and the mass had stuck at none."""
    fits = [ended(MASSES[0], 317.0, null=True), ended(MASSES[1], -4.0)]
    best_first, asked = unstuck(monkeypatch, fits, (316.0, promise), 369.0)
    assert asked == [fits[1].id] * better
    assert best_first[0].id == fits[int(better)].id


@pytest.mark.parametrize(("largest", "afresh"), [(ABSURD + 0.1, True), (ABSURD - 0.1, False)])
def test_resonators_are_tried_afresh_where_tolerances_stand_absurdly_far_off(monkeypatch, largest, afresh):
    of, right = ended(MASSES[0], 39.0), Added(named=parse("absorber:mast-top=m:0.005,f:11.6,zeta:0.02"))
    found = [replace(screened(MASSES[0])[0], evidence=0.0)]
    named = replace(of, id=right.named.id, evidence=494.0, candidate=SimpleNamespace(effects=(right,)))
    monkeypatch.setattr(search, "_resonators_at_home", lambda bench, at, told: [right])
    in_place(monkeypatch, "restarted_from_priors", lambda bench, at, added, **_: added)
    in_place(monkeypatch, "candidate_fit", lambda at, there: named)
    here: Any = SimpleNamespace(null=False, largest=largest)
    some: Any = search._restarted_where_stuck(BAND, HERE, here, [of], found, lambda what, share: None)
    assert [one.id for one in some] == [right.named.id, of.id][not afresh :]


@pytest.mark.parametrize("beside", [True, False])
def test_beside_another_effect_what_no_straight_line_promises_is_sought_on_few_lines(monkeypatch, beside):
    """A joint of boxes that gives, beside 272 g: a straight line promised 3 nats where it is rigid, and its fit brings 2,700."""
    of, asked = ended(MASSES[0], 39.0), list[str]()
    rigid, others = (
        screened("joint-compliance:lateral=1e-9"),
        screened(MASSES[0], *LOUD[:1], "absorber:mast-top=m:1,f:9,zeta:0.1"),
    )
    right = replace(of, id=rigid[0].id, evidence=2700.0, candidate=SimpleNamespace(effects=(rigid[0].added,)))

    def nearest(data: object, at: object, menu: Sequence[Added], tell: object) -> list[tuple[Added, Fit]]:
        asked.extend(one.named.id for one in menu)
        return [(one, HERE.fit) for one in menu]

    monkeypatch.setattr(search, "_nearest_by_lines", nearest)
    in_place(monkeypatch, "restarted_from_priors", lambda bench, at, added, **_: added)
    in_place(monkeypatch, "candidate_fit", lambda at, there: right)
    at: Any = SimpleNamespace(fit=HERE.fit, effects=(others[0].added,) if beside else ())
    found = [replace(one, evidence=0.0) for one in (*others, *rigid)]
    some: Any = search._restarted_where_stuck(BAND, at, stands(False), [of], found, lambda what, share: None)
    assert asked == [rigid[0].id] * beside  # of channels, of what was fitted and of resonators nothing
    assert [one.id for one in some] == [right.id, of.id][not beside :]


def test_only_the_most_promising_are_tried_afresh(monkeypatch):
    fits = [ended(one, 1.0) for one in MASSES]
    _, asked = unstuck(monkeypatch, fits, (100.0, 400.0, 300.0, 200.0), 0.0)
    assert asked == [fits[1].id, fits[2].id, fits[3].id]
    assert len(asked) == search.FEW


def test_beside_a_table_of_modes_no_resonator_is_tried_afresh_however_far_tolerances_stand(monkeypatch):
    of, nobody = ended(MASSES[0], 39.0), SimpleNamespace(problem=SimpleNamespace(parameters=()))
    at: Any = Candidate(effects=(), fit=replace(fitted(), parameters=()), problem=nobody.problem)
    found = [replace(screened(MASSES[0])[0], evidence=0.0)]
    in_place(monkeypatch, "restarted_from_priors", lambda bench, at, added, **_: added)
    tables: Any = SimpleNamespace(made=(), tests=())  # a fit of resonators would ask for a problem
    here: Any = SimpleNamespace(null=False, largest=ABSURD + 0.1)
    some = search._restarted_where_stuck(tables, at, here, [of], found, lambda what, share: None)
    assert [one.id for one in some] == [of.id]


@pytest.mark.parametrize(("here", "best", "promise"), [(True, False, 100.0), (False, True, 7.0)])
def test_nothing_is_tried_afresh_where_nothing_need_be_missing(monkeypatch, here, best, promise):
    fits = [ended(MASSES[0], 1.0, best), ended(MASSES[1], 2.0, best)]
    best_first, asked = unstuck(monkeypatch, fits, (promise, promise), 5.0, here)
    assert not asked
    assert [one.evidence for one in best_first] == [2.0, 1.0]


def test_where_nothing_need_be_missing_what_asks_for_more_does_not_hide_what_asks_for_less(monkeypatch):
    in_place(monkeypatch, "fit_with", lambda bench, at, added, **_: added.named.id)
    in_place(monkeypatch, "candidate_fit", lambda at, id: ended(f"{id}=0.1", 1.0))
    found = screened("structural-damping:mast=0.02", "force-gain:fmd-z2=0.02", evidence=15.0)
    assert (
        evidence_threshold("structural-damping") - search.NULL_MARGIN
        > 15.0
        > 14.0
        > evidence_threshold("force-gain") - search.NULL_MARGIN
    )
    nobody: Any = None
    tried_ones = search._local_fits(nobody, HERE, found, lambda what, share: None, here=stands(null=True))
    assert [one.id for one in tried_ones] == ["force-gain:fmd-z2"]
    asked = evidence_threshold("force-gain")
    for short, count in ((0.9, 1), (1.1, 0)):  # a nat is what a straight line may err
        near = screened("force-gain:fmd-z2=0.02", evidence=asked - short)
        assert len(search._local_fits(nobody, HERE, near, lambda what, share: None, here=stands(null=True))) == count
    both = search._local_fits(nobody, HERE, found, lambda what, share: None, here=stands(null=False))
    assert [one.id for one in both] == ["structural-damping:mast", "force-gain:fmd-z2"]


def test_what_was_fitted_beside_other_places_of_a_mesh_is_fitted_from_where_that_ended(monkeypatch):
    """80 g at the mast of a satellite had been found, were fitted again from nothing, and were given up half-way."""
    begun = {}

    def fitted_from(bench, at, added, *, begin=None, worth=0.0):
        begun[added.named.id] = (begin, added.named.value)
        return added.named.id

    in_place(monkeypatch, "fit_with", fitted_from)
    in_place(monkeypatch, "candidate_fit", lambda at, id: ended(f"{id}=0.1", 1.0))
    in_place(monkeypatch, "goodness_of_fit", lambda fit, problem: SimpleNamespace(null=False, misfit=1.0))
    monkeypatch.setattr(search, "screen", lambda bench, at, menu: screened(*MASSES[:2], evidence=30.0))
    in_place(monkeypatch, "in_band", lambda bench, one: True)
    monkeypatch.setattr(search, "_restarted_where_stuck", lambda bench, at, here, tried, found, progress: tried)
    monkeypatch.setattr(search, "_rivals", lambda tried, menu, found, again: [])
    nobody: Any = None
    one, there = parse(MASSES[0]), fitted()
    node = FoundNode(
        evidence=10.0, named=replace(one, values={"": 0.3}), article="mast", position=(0.0, 0.0, 0.9), looked=4.0, fit=there
    )
    search._step(nobody, HERE, [], lambda what, share: None, [node])
    assert begun == {one.id: (there, 0.3), parse(MASSES[1]).id: (None, parse(MASSES[1]).value)}


@pytest.mark.parametrize(("straight", "again", "kept"), [(60.0, 90.0, 60.0), (10.0, 90.0, 90.0), (10.0, 5.0, 10.0)])
def test_a_rival_that_keeps_less_than_half_of_the_best_is_fitted_from_where_that_ended(monkeypatch, straight, again, kept):
    best, rival = ended(MASSES[0], 100.0), Added(named=parse(MASSES[1]))
    promised = screened(MASSES[0])
    in_place(monkeypatch, "goodness_of_fit", lambda fit, problem: SimpleNamespace(null=True, misfit=1.0))
    monkeypatch.setattr(search, "screen", lambda bench, at, menu: promised)
    monkeypatch.setattr(search, "_fits_in_band", lambda bench, found, fits, here: ([best], ()))
    in_place(monkeypatch, "is_significant", lambda of: True)
    monkeypatch.setattr(search, "_rivals", lambda tried, menu, found, *, again: [rival])
    in_place(monkeypatch, "fit_with", lambda bench, at, added, **_: straight)
    in_place(monkeypatch, "fit_in_place", lambda bench, best, at, added, **_: again)
    in_place(monkeypatch, "candidate_fit", lambda at, evidence: ended(MASSES[1], evidence))
    step = search._step(HERE, HERE, [rival], lambda what, share: None)
    assert [(one.id, one.evidence) for one in step.tried] == [(best.id, 100.0), (rival.named.id, kept)]


def a_round(found: Sequence[Screened], left_band: tuple[str, ...] = (), *, converged: bool = True) -> search.SearchStep:
    """In which no fit is left."""
    nobody: Any = None
    at: Any = SimpleNamespace(fit=SimpleNamespace(converged=converged))
    return search.SearchStep(at=at, goodness=nobody, screened=tuple(found), tried=(), added="", left_band=left_band)


def test_a_round_without_a_fit_says_why():
    assert a_round(screened("cable:mast-top:lateral=50", evidence=2.25)).text == (
        "no candidate is worth a fit: cable:mast-top:lateral promises most, +2.2 nats, where 8 are asked for"
    )
    assert a_round([]).text == "there is no candidate"
    assert a_round([], converged=False).text == "no candidate makes the fit converge"
    assert a_round(screened("slosh:mast-top=m:1,f:4,zeta:0.01"), left_band=("slosh:mast-top",)).text == (
        "a fit drives slosh:mast-top out of the band of the data, and no other kind of effect is worth a fit"
    )


TOP, HUB, BLADE, LOSS = "point-mass:mast-top", "point-mass:hub-4", "modulus:lower-1", "structural-damping:lower-1"
GONE = "cable:mast-top:lateral"
"""Stands for a resonator that a fit drives out of the band."""

NOBODY: Any = None
BENCH: Any = SimpleNamespace(problem=lambda effects: None)
STANDS: Any = SimpleNamespace(null=True, largest=0.0)


def hypothesis(*effect_ids: str, evidence: float) -> Candidate:
    """A fit of such effects."""
    fit: Any = SimpleNamespace(log_evidence=evidence, cost=-evidence, by_name={})
    return Candidate(effects=tuple(Added(named=parse(f"{id}=0.3")) for id in effect_ids), fit=fit, problem=NOBODY)


def found(*brought: tuple[str, float], at: Candidate) -> search.SearchStep:
    """A round from `at` that tried these, the best first, and took that."""
    tried = tuple(
        CandidateFit(id=id, candidate=hypothesis(id, evidence=nats), evidence=nats, goodness=STANDS) for id, nats in brought
    )
    return search.SearchStep(at=at, goodness=NOBODY, screened=(), tried=tried, added=tried[0].id)


def asked(
    monkeypatch: pytest.MonkeyPatch,
    at: Candidate,
    before: Sequence[search.SearchStep],
    worth: Mapping[tuple[str, ...], float],
    elsewhere: Any = None,
) -> tuple[Candidate, tuple[search.SearchStep, ...], list[str]]:
    """What comes of it where fits of effects end at the evidence `worth`; and what was fitted instead."""
    fitted: list[str] = []

    def instead(bench: object, of: Candidate, rest: Candidate, added: Added, **_: float) -> Candidate:
        effect_ids = [*(one.named.id for one in rest.effects), added.named.id]
        fitted.append(added.named.id)
        return hypothesis(*effect_ids, evidence=worth[tuple(sorted(effect_ids))])

    def without(bench: object, of: Candidate) -> Candidate:
        rest = [one.named.id for one in of.effects]
        return hypothesis(*rest, evidence=worth[tuple(sorted(rest))])

    in_place(monkeypatch, "nearby", lambda problem, free, offsets, **_: None)
    in_place(monkeypatch, "recentred", without)
    in_place(monkeypatch, "fit_in_place", instead)
    in_place(monkeypatch, "is_significant", lambda of: True)
    in_place(monkeypatch, "in_band", lambda bench, one: one.id != GONE)
    in_place(monkeypatch, "goodness_of_fit", lambda fit, problem: STANDS)
    _, ended, more = search.backward_elimination(BENCH, at, before, lambda what, share: None, elsewhere)
    return ended, more, fitted


def effect_ids(of: Candidate) -> set[str]:
    return {one.named.id for one in of.effects}


ALONE = hypothesis(evidence=0.0)
TWO = (found((HUB, 5200.0), (TOP, 4900.0), at=ALONE), found((BLADE, 130.0), at=hypothesis(HUB, evidence=5200.0)))
"""The first took the wrong place, before the blade was known to be soft."""


def test_a_place_that_is_better_beside_what_was_found_later_is_taken_and_a_single_effect_not_asked_again(monkeypatch):
    at = hypothesis(HUB, evidence=5200.0)
    assert asked(monkeypatch, at, TWO[:1], {}) == (at, (), [])
    at = hypothesis(HUB, BLADE, evidence=5330.0)
    known = {(BLADE,): 30.0, tuple(sorted((TOP, BLADE))): 5360.0, (TOP,): 4900.0}
    ended, (first, second), fitted = asked(monkeypatch, at, TWO, known)
    assert effect_ids(ended) == {TOP, BLADE}
    assert fitted == [TOP]
    assert (first.reconsidered, first.added) == (HUB, TOP)
    assert [(one.id, one.evidence) for one in first.tried] == [(TOP, 5330.0), (HUB, 5300.0)]
    assert (second.reconsidered, second.added, second.tried[0].evidence) == (BLADE, BLADE, 460.0)
    assert first.text == f"{TOP} brings +5330 nats beside {BLADE}, and {HUB} only +5300"
    assert replace(first, at=ALONE).text == f"{TOP} brings +5330 nats alone, and {HUB} only +5300"


@pytest.mark.parametrize(("looked", "stays"), [(0.0, {TOP}), (40.0, {HUB, BLADE})])
def test_what_moves_on_a_mesh_needs_no_second_effect_that_mended_its_place(monkeypatch, looked, stays):
    before = (found((HUB, 5200.0), at=ALONE), found((BLADE, 130.0), at=hypothesis(HUB, evidence=5200.0)))
    known = {(BLADE,): 30.0, tuple(sorted((TOP, BLADE))): 5360.0, (TOP,): 5358.0, (HUB,): 5200.0, (): 0.0}

    def elsewhere(data: object, rest: Candidate, there: Candidate) -> tuple[tuple[object, Added, float], ...]:
        return ((data, Added(named=parse(f"{TOP}=0.3")), looked),) if there.effects[-1].named.id == HUB else ()

    at = hypothesis(HUB, BLADE, evidence=5330.0)
    ended, again, _ = asked(monkeypatch, at, before, known, elsewhere)
    assert effect_ids(ended) == stays
    assert (again[0].reconsidered, again[0].added) == (HUB, HUB if looked else TOP)
    alone, _, _ = asked(monkeypatch, hypothesis(HUB, evidence=5200.0), before[:1], known, elsewhere)
    assert effect_ids(alone) == {TOP}  # 158 nats are more than it costs to have looked


@pytest.mark.parametrize(("largest", "moves"), [(ABSURD, True), (ABSURD - 0.1, False)])
def test_a_node_is_fitted_from_the_priors_where_tolerances_pay_for_another(monkeypatch, largest, moves):
    """Boxes: from where 410 g at a wrong node had ended 272 g at their own came to nothing, and from the priors to 960 nats."""
    alone, there = hypothesis(evidence=0.0), hypothesis(HUB, evidence=5200.0)
    goodness: Any = SimpleNamespace(null=False, largest=largest)
    in_place(monkeypatch, "fit_in_place", lambda *of, worth: hypothesis(TOP, evidence=-9.0))
    in_place(monkeypatch, "restarted_from_priors", lambda *of, worth: hypothesis(TOP, evidence=6160.0))
    in_place(monkeypatch, "is_significant", lambda of: True)
    in_place(monkeypatch, "goodness_of_fit", lambda fit, problem: goodness)
    begin = candidate_fits.candidate_fit(alone, there)
    near = ((BENCH, Added(named=parse(f"{TOP}=0.3")), 0.0),)
    _, end = search._moved(BENCH, alone, begin, lambda data, rest, at: near if at is there else ())
    assert (end.id, end.evidence) == ((TOP, 6160.0) if moves else (HUB, 5200.0))


def test_what_moves_alone_keeps_those_that_explain_as_much(monkeypatch):
    """A class had held nothing but places once its effect had moved."""
    before = (found((HUB, 5200.0), (BLADE, 5199.0), (LOSS, 5000.0), at=ALONE),)

    def elsewhere(data: object, rest: Candidate, there: Candidate) -> tuple[tuple[object, Added, float], ...]:
        return ((data, Added(named=parse(f"{TOP}=0.3")), 0.0),) if there.effects[-1].named.id == HUB else ()

    known = {(TOP,): 5201.0, (): 0.0}
    ended, (moved,), fitted = asked(monkeypatch, hypothesis(HUB, evidence=5200.0), before, known, elsewhere)
    assert (effect_ids(ended), fitted) == ({TOP}, [TOP])
    assert [one.id for one in moved.indistinguishable] == [TOP, HUB, BLADE]


def test_what_stays_the_best_stays_as_it_was_fitted_and_what_is_not_needed_any_more_goes(monkeypatch):
    at = hypothesis(HUB, BLADE, evidence=5330.0)
    known = {(BLADE,): 30.0, tuple(sorted((TOP, BLADE))): 5320.0, (HUB,): 5200.0}
    ended, again, _ = asked(monkeypatch, at, TWO, known)
    assert ended is at
    assert [one.reconsidered for one in again] == [one.added for one in again] == [HUB, BLADE]
    assert diagnose.indistinguishable_ids(at.effects, [*TWO, *again]) == ()
    known = {(BLADE,): 5330.0 - EVIDENCE_THRESHOLD + 1, (): 0.0}
    ended, again, fitted = asked(monkeypatch, at, TWO, known)
    assert (effect_ids(ended), fitted) == ({BLADE}, [])
    assert [(one.reconsidered, one.added, effect_ids(one.at)) for one in again] == [
        (BLADE, BLADE, set())
    ]  # asked alone, where it is


def test_what_took_a_place_beside_something_that_goes_is_asked_alone(monkeypatch):
    """Beside the blade both places were as good; without it the class is another, and the verdict that of what is left."""
    at = hypothesis(HUB, BLADE, evidence=5330.0)
    known = {(BLADE,): 30.0, tuple(sorted((TOP, BLADE))): 5333.0, (TOP,): 5332.0, (HUB,): 4000.0, (): 0.0}
    ended, again, _ = asked(monkeypatch, at, TWO, known)
    assert effect_ids(ended) == {TOP}
    assert [(one.reconsidered, one.added, effect_ids(one.at)) for one in again] == [
        (HUB, TOP, {BLADE}),
        (TOP, TOP, set()),
    ]
    best = diagnose.best_step(ended, [*TWO, *again])
    assert [one.id for one in best.tried] == [TOP, HUB]
    assert diagnose.indistinguishable_ids(ended.effects, [*TWO, *again]) == (TOP,)


@pytest.mark.parametrize(("other", "worth"), [(LOSS, 19.0), (GONE, 500.0)])
def test_no_name_is_taken_that_is_not_worth_it_or_does_not_stay_what_it_is(monkeypatch, other, worth):
    first = found((BLADE, 7.0), (other, 6.5), at=ALONE)
    at = hypothesis(BLADE, HUB, evidence=5207.0)
    known = {(HUB,): 5200.0, tuple(sorted((other, HUB))): 5200.0 + worth, (BLADE,): 7.0}
    ended, again, fitted = asked(monkeypatch, at, (first, found((HUB, 5200.0), at=hypothesis(BLADE, evidence=7.0))), known)
    assert fitted == [other]
    assert ended is at
    assert [one.added for one in again] == [BLADE, HUB]


def test_what_has_nothing_to_be_held_against_stays(monkeypatch):
    def breaks(problem, free, offsets, **_):
        raise CheckFailed("the model breaks down")

    in_place(monkeypatch, "nearby", breaks)
    at = hypothesis(HUB, BLADE, evidence=5330.0)
    assert search.backward_elimination(BENCH, at, TWO, lambda what, share: None) == (BENCH, at, ())


def test_only_what_brought_a_good_part_and_is_not_there_is_a_rival(monkeypatch):
    others = [(f"point-mass:{one}", 100.0) for one in ("flange", "hub-1", "hub-2", "hub-3", "disc", "top", "top-1")]
    one = found((TOP, 110.0), (BLADE, 105.0), *others, ("rigid-inertia:m", 110 * search.GOOD_PART - 1), at=ALONE)
    worth = {tuple(sorted((BLADE, id))): 90.0 for id, _ in others} | {(BLADE,): 50.0, (TOP,): 50.0, (BLADE, TOP): 150.0}
    known = found((BLADE, 100.0), at=hypothesis(TOP, evidence=50.0))
    _, _, fitted = asked(monkeypatch, hypothesis(TOP, BLADE, evidence=150.0), (one, known), worth)
    assert fitted == [id for id, _ in others[: search.FITS_OF_A_STEP]]
    few = replace(one, tried=(one.tried[0], one.tried[-1]))
    assert asked(monkeypatch, hypothesis(TOP, BLADE, evidence=150.0), (few, known), worth)[2] == []


@pytest.mark.parametrize(("other", "same"), [("absorber:hub-4=m:1,f:9,zeta:0.1", True), ("cable:hub-4:lateral=50", False)])
def test_a_resonator_begins_at_the_sizes_of_the_one_that_was_found(other, same):
    best = Added(named=parse("slosh:mast-top=m:0.002,f:19,zeta:0.02"))
    begins = search._at_sizes(Added(named=parse(other)), best)
    assert (begins.named.values == best.named.values) is same
    assert begins.named.id == other.partition("=")[0]


def test_logarithms_count_from_the_sizes_of_the_models_that_they_go_to():
    def parameter(name, nominal, logarithmic):
        return Parameter(name=name, kind=EFFECT, nominal=nominal, unit="kg", tolerance=1.0, logarithmic=logarithmic)

    old = (parameter("a", 2.0, True), parameter("b", 2.0, False), parameter("gone", 1.0, True))
    fit: Any = SimpleNamespace(parameters=old, offsets=np.array([0.1, 0.2, 0.3]))
    problem: Any = SimpleNamespace(by_name={"a": parameter("a", 4.0, True), "b": parameter("b", 2.0, False)})
    assert candidate_fits._offsets_in(problem, fit) == pytest.approx({"a": 0.1 - log(2), "b": 0.2})


TORSION, SIZE = "joint-compliance:torsion", 1.8e-5
"""[rad/(N m)] Of the flange; it moves the torsion of mast and blade by fifty times what is declared of a frequency."""

DRIVEN = ("--octaves-per-minute", "60", "--band", "4", "32", "--seed", "5")


@pytest.fixture(scope="module")
def soft(tmp_path_factory) -> Study:
    """Clumod with one blade on a flange that gives, and a model that does not know."""
    folder = tmp_path_factory.mktemp("afresh")
    model, campaign = folder / "model.toml", folder / "blade"
    assert main.run(["model", "fmd+clumod-1", "--out", str(model)]) == main.DONE
    assert main.run(["simulate", "fmd+clumod-1", "--out", str(campaign), *DRIVEN, "--effect", f"{TORSION}={SIZE}"]) == main.DONE
    known = model_file.read(str(model))
    return Study.of(known, read_data([str(campaign)], known))


@pytest.fixture(scope="module")
def paid(soft) -> Candidate:
    """The model as it is, fitted to that: tolerances pay."""
    return Candidate(effects=(), fit=soft.all_free(), problem=soft.problem())


@pytest.fixture(scope="module")
def torsion(soft) -> Added:
    return next(one for one in candidates(soft, only=["joint-compliance"]) if one.named.id == TORSION)


@pytest.fixture(scope="module")
def stuck(soft, paid, torsion) -> Candidate:
    """The effect added where the tolerances stand."""
    return candidate_fits.fit_with(soft, paid, torsion)


@pytest.fixture(scope="module")
def restarted(soft, paid, torsion) -> Candidate:
    """The effect added from where they are declared."""
    return candidate_fits.restarted_from_priors(soft, paid, torsion)


@pytest.mark.proof  # two long diagnoses; test_laboratories.py names a layer's loss in short
def test_a_layer_is_named_where_it_loses_more_than_its_own_tolerance_hides(tmp_path):
    """Its loss factor of 0.2 is known to 35 %, and a fault may plausibly be larger; `damping = 0.1` halves its interval."""
    layer, campaign, loss = "layer-damping:upper-short", str(tmp_path / "blades"), 0.6
    assert main.run(["simulate", "fmd+clumod-4", "--out", campaign, *DRIVEN, "--effect", f"{layer}={loss}"]) == main.DONE
    wide = []
    for tolerances in ("", "tolerances = { damping = 0.1 }"):
        file = tmp_path / "model.toml"
        file.write_text(f'format = 1\nmodel = {{ title = "four", article = "fmd+clumod-4" }}\n[structure]\n{tolerances}\n')
        found = diagnose.diagnosed(Study.open(file, [campaign]), only=["layer-damping", "structural-damping"])
        assert [one.id for one in found.accepted] == [layer], found.text
        ((size,),) = [one.sizes for one in found.accepted]
        assert abs(size.value / loss - 1) < 0.3
        wide.append(size.high - size.low)
    assert wide[1] < 0.6 * wide[0] < 0.3 * loss


@pytest.mark.parametrize(("share", "steps"), [(0.21, 2), (0.19, 1)])
def test_beside_what_explains_a_fifth_of_what_is_wrong_others_are_sought_and_beside_less_nothing(monkeypatch, share, steps):
    """A bearing of a truss that loses half explained 0.21 beside 1.63 kg at a node, and the mass was not looked for."""
    asked: list[Any] = []
    bad: Any = SimpleNamespace(null=False, largest=0.0, excess=lambda fit: 1000.0)
    start: Any = SimpleNamespace(effects=(), problem=None, fit=SimpleNamespace(cost=5000.0, converged=True))
    better = SimpleNamespace(effects=(tried(MASSES[0]).added,), problem=None, fit=SimpleNamespace(cost=5000.0 - 1000 * share))
    one = replace(ended(MASSES[0], 1000 * share), candidate=better)

    def step(data: object, at: Any, *rest: object) -> Any:
        asked.append(at)
        found = () if at.effects else (one,)
        return SimpleNamespace(at=at, tried=found, added=one.id if found else "", reconsidered="", goodness=bad)

    monkeypatch.setattr(search, "_step", step)
    monkeypatch.setattr(search, "reduced_anew", lambda data, at: (data, at))
    monkeypatch.setattr(search, "_finished", lambda data, at: (data, at))
    monkeypatch.setattr(search, "goodness_of_fit", lambda fit, problem: bad)
    monkeypatch.setattr(search, "backward_elimination", lambda data, at, *rest: (data, at, ()))
    search.stepwise_search(BAND, start, [], lambda what, share: None)
    assert asked == [start, better][:steps]


@pytest.mark.parametrize("far", [True, False])
def test_from_afar_faults_of_sensors_are_asked_too_of_which_no_tolerance_is_in_the_fit(monkeypatch, far):
    """Of a bracket under a hammer whose force came late, and of pick-ups of 5 g that rove, no fit of the model as it is ended,
    and none but effects on the structure were asked."""
    view, asked = SimpleNamespace(marks=(1,), far=far, nearest=lambda menu, most: []), list[str]()
    monkeypatch.setattr(search, "DistantView", lambda marks: view)
    monkeypatch.setattr(search, "Landmark", SimpleNamespace(of_tests=lambda predictions: ()))
    monkeypatch.setattr(search, "_nearest_by_lines", lambda data, at, menu, tell: asked.extend(x.named.id for x in menu) or [])
    monkeypatch.setattr(search, "goodness_of_fit", lambda fit, problem: stands(False))
    texts = ("point-mass:mast-top=0.1", "transducer-mass=0.005", "accelerometer-gain:table-x1=0.05", "exponential-window=3")
    menu = [one.added for one in screened(*texts)]
    at: Any = SimpleNamespace(fit=SimpleNamespace(by_name={menu[2].named.id: 0.0}), effects=(), problem=None)
    data: Any = SimpleNamespace(made=(), predictions=())
    search.step_from_afar(data, at, menu, lambda what, share: None)
    assert asked == [one.named.id for one in (*menu[: not far], menu[1], menu[3])]


@pytest.mark.proof  # ten times as long as the refusal that test_diagnosed.py holds
def test_a_model_that_does_not_converge_is_rescued_by_what_is_found_from_afar(soft, monkeypatch):
    """As if its fit had stopped where it begins."""
    stopped = unfitted(soft.problem(), FITTED, {})

    monkeypatch.setattr(Study, "all_free", lambda study, progress=None: stopped)
    found = diagnose.diagnosed(soft, only=[TORSION])
    assert [one.id for one in found.accepted] == [TORSION], found.text
    ((size,),) = [one.sizes for one in found.accepted]
    assert_allclose(size.value, SIZE, rtol=0.2)


@pytest.mark.proof
def test_from_where_tolerances_have_paid_no_step_leads_there_and_from_home_one_does(paid, stuck, restarted):
    assert stuck.effects[-1].named.values[""] < 0.5 * SIZE
    assert restarted.effects[-1].named.values[""] == pytest.approx(SIZE, rel=0.03)
    assert restarted.fit.cost < min(stuck.fit.cost, paid.fit.cost) - 1000


@pytest.mark.proof
def test_the_search_goes_that_way_where_no_fit_keeps_the_promise(soft, paid):
    said: list[str] = []
    _, explained, rounds = search.stepwise_search(
        soft, paid, candidates(soft, only=[TORSION]), lambda what, share: said.append(what)
    )
    assert f"trying {TORSION} afresh" in said
    assert [one.named.id for one in explained.effects] == [TORSION]
    assert explained.effects[0].named.values[""] == pytest.approx(SIZE, rel=0.03)
    assert rounds[0].goodness.prior_penalty > 50 > 2 > rounds[0].tried[0].goodness.prior_penalty


@pytest.mark.proof
def test_beside_an_accepted_effect_that_keeps_its_size_and_of_a_modulus(soft, restarted):
    mast = next(one for one in candidates(soft, only=["modulus"]) if one.named.id == "modulus:mast")
    both = candidate_fits.restarted_from_priors(soft, restarted, mast)
    assert [one.named.id for one in both.effects] == [TORSION, "modulus:mast"]
    assert both.effects[0].named.values[""] == pytest.approx(SIZE, rel=0.03)
    assert abs(both.effects[1].named.values[""]) < 0.05
    assert both.fit.cost <= restarted.fit.cost


@pytest.mark.proof
def test_tolerances_that_come_home_never_cost_more_and_keep_what_was_found(soft, paid, restarted):
    again = candidate_fits.restarted_from_priors(soft, restarted)
    assert again.fit.cost <= restarted.fit.cost + 1e-6
    assert again.effects[-1].named.values[""] == pytest.approx(SIZE, rel=0.03)
    assert candidate_fits.restarted_from_priors(soft, paid).fit.cost <= paid.fit.cost + 1e-6


@pytest.mark.proof
def test_from_home_a_size_that_had_not_come_through_does(soft, stuck):
    assert candidate_fits.restarted_from_priors(soft, stuck).fit.cost < stuck.fit.cost - 1000


def test_sizes_grow_by_half_octaves_about_what_is_plausible_within_bounds():
    one = Parameter(name="x", unit="kg", tolerance=2.0, kind=EFFECT, low=-0.5, high=100.0)
    found = sizes(one)
    assert np.all((found > -0.5) & (found < 100.0))
    assert np.all(found != 0)
    positive = found[found > 0]
    assert_allclose(positive[1:] / positive[:-1], np.sqrt(2))
    assert positive[0] == 2.0 / 64
    assert found[found < 0].min() > -0.5
    sided = sizes(replace(one, low=0.0, high=4e-6, tolerance=1e-6))
    assert 0 < sided.min() < sided.max() < 4e-6
    # What little may be taken off is nearer than all of them, and was nothing to look at: an empty list ended a diagnosis
    assert sizes(replace(one, low=-1e-3, high=2e-3)).tolist() == [-5e-4, 1e-3]


def test_of_a_logarithm_sizes_lie_a_factor_of_two_apart_at_most_as_far_as_bounds_allow():
    one = Parameter(name="x", unit="1", tolerance=1.0, kind=EFFECT, low=-6.9, high=6.9, logarithmic=True)
    for octaves in (np.arange(-6.0, 4.0, 0.5), np.arange(-3.0, 5.0)):
        found = sizes(one, octaves)
        assert np.diff(found[found > 0]).max() <= log(2) + 1e-12
        assert 6.9 - log(2) < found.max() < 6.9
        assert_allclose(found, -found[::-1])
        plain = sizes(replace(one, logarithmic=False), octaves)
        assert set(plain[(plain > 0) & (plain <= 1.0)]) <= set(found)


@pytest.mark.parametrize(
    ("text", "fixed", "there"),
    [
        ("point-mass:mast-top=0.1", False, True),
        ("gravity=0", True, False),
        ("slosh:mast-top=m:0.1,f:5,zeta:0.01", False, False),
        ("pendulum-damping=0.1", False, False),
    ],
)
def test_effects_of_one_size_that_is_fitted_have_such_a_way(text, fixed, there):
    assert candidate_fits.can_restart(Added(named=parse(text), fixed=fixed)) is there


FREEDOM, COUNT = 5000, 100


def fitted(*, misfit: float = 0.9, z: np.ndarray | None = None) -> Fit:
    """All tolerances are told by the data, ten times better than beforehand, and moved by `z`."""
    moved = np.ones(COUNT) if z is None else z
    return Fit(
        parameters=tuple(Parameter(name=f"gain:{k}", unit="1", tolerance=0.01) for k in range(COUNT)),
        offsets=0.01 * moved,
        covariance=0.001**2 * np.eye(COUNT),
        cost=0.5 * (misfit * FREEDOM + float(moved @ moved)),
        chi2=misfit * FREEDOM,
        degrees_of_freedom=FREEDOM,
        tolerance_z2=float(moved @ moved),
        tolerances=COUNT,
        log_evidence=0.0,
        converged=True,
    )


@pytest.fixture
def noisy(monkeypatch) -> Any:
    """A problem whose likelihood allows for noise and as much again of a floor."""
    noise = np.ones((1, 4, 2))
    seen = SimpleNamespace(noise=noise, floor=noise / FLOOR, values=noise, inputs=noise, parts=2)
    monkeypatch.setattr("validation.diagnose.candidate_fits.observed", lambda measured, lines: seen)
    return SimpleNamespace(predictions=(of_spread(0.0),), lines_of=lambda one: None)


def of_spread(spread: float, scatter: float = 0.0, discrepancy: float = 0.0) -> SimpleNamespace:
    """A data set whose noise is known so well."""
    told = {"noise_spread": spread, "discrepancy": discrepancy, "noise_scatter": scatter}
    return SimpleNamespace(measured=SimpleNamespace(**told, is_real=False, read=None), at=lambda *_, **__: None)


def one_far(z: float) -> np.ndarray:
    return np.concatenate([[z], np.full(COUNT - 1, 0.9)])


def test_the_misfit_of_a_null_is_the_share_of_noise_and_an_estimate_of_the_noise_widens_its_limit(noisy):
    assert_allclose(candidate_fits.goodness_of_fit(fitted(), noisy).limit, 0.53, rtol=1e-12)  # 3 sd of 2 % each
    # Half of the variance is noise, estimated to 20 % at every line.
    noisy.predictions = (of_spread(0.0, 0.2),)
    estimates = 1 + 0.2 * np.random.default_rng(1).standard_normal(1_000_000)
    drawn = np.mean(1 / (estimates + 1)) / np.mean(estimates / (estimates + 1))
    noise_alone = candidate_fits.goodness_of_fit(fitted(), noisy).limit / (1 + candidate_fits.SCATTER * np.sqrt(2 / FREEDOM))
    assert_allclose(noise_alone / 0.5, drawn, rtol=1e-3)
    # Two data sets of one size: 3 % and 4 % of each are 2.5 % of both.
    noisy.predictions = (of_spread(0.03), of_spread(0.04))
    assert_allclose(
        candidate_fits.goodness_of_fit(fitted(), noisy).limit,
        0.5 * (1 + candidate_fits.SCATTER * np.hypot(np.sqrt(2 / FREEDOM), 0.025)),
        rtol=1e-12,
    )


def test_where_what_nobody_measured_takes_every_reading_the_limit_is_that_of_noise_still(noisy, monkeypatch):
    """A mean over readings that count for nothing had ended in a division by zero."""
    limit = candidate_fits.goodness_of_fit(fitted(), noisy).limit
    monkeypatch.setattr(candidate_fits, "freedom", lambda seen, predicted, floor: np.zeros(seen.noise.shape))
    assert_allclose(candidate_fits.goodness_of_fit(fitted(), noisy).limit, limit, rtol=1e-12)


def test_what_is_due_of_a_channel_that_the_inputs_take_counts_for_nothing(noisy, monkeypatch):
    """A table's one pick-up, whose variance is a model's error but for a tenth, tells its motion; half of another's is noise."""
    noise = np.ones((1, 4, 2))
    seen = ObservedLines(runs=("x",), values=0j * noise, noise=noise, floor=noise * [3.0, 1.0] / FLOOR, inputs=None)
    monkeypatch.setattr(candidate_fits, "observed", lambda measured, lines: seen)
    noisy.predictions[0].at = lambda *_, **__: Predicted(rows=np.tile([[1.0 + 0j], [0.0]], (4, 1, 1)))
    assert_allclose(candidate_fits.goodness_of_fit(fitted(), noisy).limit, 0.53, rtol=1e-12)  # 0.318 where both count alike


def test_a_class_that_admits_a_discrepancy_is_judged_by_replicated_data(noisy):
    """Residuals of the whole variance, half of it noise, come to chi² = 1 on average, and stay below the limit."""
    noisy.predictions = (of_spread(0.0, discrepancy=1.0),)
    limit = candidate_fits.goodness_of_fit(fitted(), noisy).limit
    replicated = np.random.default_rng(3).chisquare(FREEDOM, 2000) / FREEDOM
    assert np.mean(replicated) == pytest.approx(1.0, rel=1e-2)
    assert 0.995 < np.mean(replicated <= limit) < 1.0
    noisy.predictions = (of_spread(0.0),)
    assert candidate_fits.goodness_of_fit(fitted(), noisy).limit < 0.6


def test_a_fit_within_noise_that_pays_what_is_due_is_that_of_a_null(noisy):
    of = fitted(misfit=0.49)
    found = candidate_fits.goodness_of_fit(of, noisy)
    assert found.null
    assert found.text == ""
    assert_allclose(found.prior_penalty, COUNT / expected_z2(of), rtol=1e-12)
    assert_allclose(expected_z2(of), 0.99 * COUNT, rtol=1e-12)  # each was told ten times better
    assert found.excess(of) == pytest.approx(0.5 * 0.01 * COUNT)  # no misfit, and a hundredth more than is due


def test_misfit_alone_refuses(noisy):
    limit = candidate_fits.goodness_of_fit(fitted(), noisy).limit
    below, above = (candidate_fits.goodness_of_fit(fitted(misfit=factor * limit), noisy) for factor in (0.999, 1.001))
    assert (below.null, above.null) == (True, False)
    assert above.text.startswith("chi² per degree of freedom")
    assert ";" not in above.text


def test_price_alone_refuses(noisy):
    """Every tolerance a little too far, none of them by much."""
    from scipy.stats import chi2

    z = np.sqrt(chi2.isf(candidate_fits.UNLIKELY, 0.99 * COUNT) / COUNT)
    below, above = (
        candidate_fits.goodness_of_fit(fitted(misfit=0.4, z=np.full(COUNT, factor * z)), noisy) for factor in (0.999, 1.001)
    )
    assert (below.null, above.null) == (True, False)
    assert above.largest < 2
    assert above.text.startswith("the prior penalty of the tolerances is")
    due, of = candidate_fits.goodness_of_fit(fitted(misfit=0.4), noisy), np.sqrt(np.array([155.0, 165.0]) / COUNT)
    assert due.null
    assert [candidate_fits.goodness_of_fit(fitted(misfit=0.4, z=np.full(COUNT, one)), noisy).null for one in of] == [
        True,
        False,
    ]  # 1 in 10,000
    assert ";" not in above.text


def test_one_tolerance_alone_refuses_and_everything_that_refuses_is_said(noisy):
    below, above = (
        candidate_fits.goodness_of_fit(fitted(misfit=0.4, z=one_far(-factor * ABSURD)), noisy) for factor in (0.999, 1.001)
    )
    assert (below.null, above.null) == (True, False)
    assert above.likely > candidate_fits.UNLIKELY
    assert above.text.startswith("a tolerance is moved by 4.8 of its")
    found = candidate_fits.goodness_of_fit(fitted(misfit=2.0, z=np.full(COUNT, 6.0)), noisy)
    assert found.text.count(";") == 2
    assert not found.null


def test_what_breaks_down_over_more_coordinates_wherever_it_begins_stays_where_it_is(monkeypatch):
    """It had ended the diagnosis: on the mesh, and at the end of a search."""

    def breaks(problem, free, offsets, **_):
        raise CheckFailed("the model breaks down")

    ready = SimpleNamespace(problem=lambda effects: None)
    model = SimpleNamespace(looked_at=())
    bench: Any = SimpleNamespace(model=model, made=(), tests=(), ready_at=lambda places: ready, problem=lambda effects: None)
    bench.over = lambda reduced_anew: bench
    at = hypothesis("point-mass:mast-top", evidence=10.0)
    at = replace(at, effects=tuple(replace(one, named=replace(one.named, targets=("@0,0,1",))) for one in at.effects))
    in_place(monkeypatch, "nearby", breaks)
    monkeypatch.setattr(candidate_fits, "declared", lambda problem, fit: {})
    assert search._finished(bench, at) == (bench, at)
    there = CandidateFit(id=at.effects[0].named.id, candidate=at, evidence=10.0, goodness=STANDS)
    assert search._moved(bench, ALONE, there, lambda *_: ((ready, at.effects[0], 0.0),)) == (bench, there)


def test_what_breaks_down_over_more_coordinates_begins_there_where_tolerances_are_declared(monkeypatch):
    """A plate with a spring ended in a traceback: its tolerances stood where coordinates that are new keep no stiffness."""
    begun: list[object] = []

    def fitted_from(problem, kinds, begin):
        begun.append(begin)
        if len(begun) == 1:
            raise CheckFailed("it breaks down")
        return "a fit"

    in_place(monkeypatch, "nearby", fitted_from)
    monkeypatch.setattr(candidate_fits, "declared", lambda problem, fit: {"home": 0.0})
    in_place(monkeypatch, "recentred", lambda data, of: of)
    far = Candidate(effects=(), fit=SimpleNamespace(by_name={"far": 9.0}), problem=None)
    wider = SimpleNamespace(problem=lambda effects: "over more")
    assert candidate_fits.over(wider, SimpleNamespace(), far).fit == "a fit"
    assert begun == [{"far": 9.0}, {"home": 0.0}]
    assert candidate_fits.over(wider, wider, far) is far
