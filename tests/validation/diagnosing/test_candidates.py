"""Candidates in closed form: aliases, resonators of every frequency, the smallest size that would be named."""

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import expm1, inf, isfinite
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from benchmarks.bench_scale import MODEL, campaign
from validation.diagnose import candidate_fits, candidates
from validation.diagnose.candidate_fits import CandidateFit, is_accepted
from validation.diagnose.candidates import OCCAM, TINY, TINY_AT, band, baseline, detectable, screen, shape, share
from validation.diagnose.diagnose import as_cause
from validation.diagnose.diagnosis import Candidate, Screened, sized
from validation.effects.catalogue import parse
from validation.effects.effect import Vocabulary, evidence_threshold
from validation.estimation.problem import EFFECT, Parameter, Predicted
from validation.estimation.screening import POWER, ScoreTest
from validation.model.model import Added
from validation.prediction.modal_table import real_modes, seen
from validation.prediction.series import predictions
from validation.study import Study


def fisher(*columns: np.ndarray) -> np.ndarray:
    J = np.stack(columns, axis=1)
    return np.asarray(J.T @ J)


def test_a_share_is_the_squared_sine_of_the_angle_between_two_columns():
    for angle in (0.0, 0.02, 0.7, np.pi / 2):
        b, c = np.array([1.0, 0.0, 0.0]), 3e4 * np.array([np.cos(angle), np.sin(angle), 0.0])
        assert_allclose(share(fisher(b, c), np.zeros(2), 0, [1], []), np.sin(angle) ** 2, atol=1e-12)


def test_two_effects_that_differ_only_by_a_tolerance_are_one_and_several_sizes_do_together_what_none_does():
    rng = np.random.default_rng(2)
    b, loose = rng.standard_normal((2, 50))
    N = fisher(b, b + loose, loose)
    assert share(N, np.array([0.0, 0.0, 1e-9]), 0, [1], [2]) < 1e-6  # nothing is known of the tolerance
    assert share(N, np.array([0.0, 0.0, 1e9]), 0, [1], [2]) > 0.2  # it is known exactly
    c1, c2 = rng.standard_normal((2, 50))
    N = fisher(c1 - 2 * c2, c1, c2)
    assert share(N, np.zeros(3), 0, [1, 2], []) < 1e-9
    assert share(N, np.zeros(3), 0, [1], []) > 0.1


FREQUENCY = np.linspace(4.0, 32.0, 57)


def driven(f: float, zeta: float, mass: float = 1.0) -> np.ndarray:
    """[kg] Dynamic mass of a mass on a spring and a damper whose foot is driven: the force there over the acceleration."""
    own, omega = 2 * np.pi * f, 2 * np.pi * FREQUENCY
    k, c = mass * own**2, 2 * zeta * mass * own
    foot = k + 1j * omega * c
    moved = foot / (k + 1j * omega * c - mass * omega**2)  # of the mass, for a foot that moves by 1
    return np.asarray(foot * (1 - moved) / (-(omega**2)))


@pytest.mark.parametrize(("f", "zeta"), [(3.5, 0.005), (12.0, 0.02), (31.0, 0.08)])
def test_a_shape_turns_the_resonator_of_the_menu_into_any_other(f, zeta):
    menu = driven(TINY_AT["f"], TINY_AT["zeta"])
    assert_allclose(menu * shape(FREQUENCY, f, zeta), driven(f, zeta), rtol=1e-9)  # rounding of 1 - moved at 1000 Hz


def test_the_shape_of_the_menu_s_own_resonator_is_one():
    assert_allclose(shape(FREQUENCY, TINY_AT["f"], TINY_AT["zeta"]), 1.0, rtol=1e-14)


def smallest_mass(deviation: float, evidence: float) -> float:
    """[kg] Of a resonator that a straight line tells so, where so much evidence is asked for."""
    told = ScoreTest(name="", estimate=0.0, information=deviation**-2)
    added = Added(named=parse("slosh:mast-top=m:0.1,f:9,zeta:0.01"))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("validation.effects.effect.evidence_threshold", lambda family: evidence)
        found = detectable([Screened(added=added, evidence=0.0, told=told, plausible=np.inf, usual=told)])
    return found[0].size if found else np.inf


def test_the_smallest_mass_brings_the_evidence_that_is_asked_for_and_grows_with_its_root_and_the_deviation():
    once = smallest_mass(3.0, 8.0)
    by_noise = 3 * TINY * POWER  # in one test of five
    assert_allclose(smallest_mass(3.0, 4 * (8.0 + OCCAM) - OCCAM) - by_noise, 2 * (once - by_noise), rtol=1e-12)
    assert_allclose(smallest_mass(15.0, 8.0), 5 * once, rtol=1e-12)
    assert smallest_mass(np.inf, 8.0) == np.inf  # the data tell nothing of it
    offset = smallest_mass(3.0, 8.0) / TINY - 3 * POWER  # a straight line from the mass TINY, whose offset is that of ln m
    assert_allclose(0.5 * offset**2 / 3.0**2 - OCCAM, 8.0, rtol=1e-12)
    assert_allclose(smallest_mass(3.0, 8.0), 3 * TINY * (np.sqrt(2 * (8 + 4)) + POWER), rtol=1e-12)  # [kg]


@pytest.mark.parametrize(("f", "there"), [(3.4, False), (3.6, True), (12.0, True), (36.0, True), (38.0, False)])
def test_a_resonator_reaches_the_data_a_seventh_beyond_the_band(f, there):
    low, high = band([FREQUENCY])
    assert (low <= f <= high) is there


SURE = ScoreTest(name="x", estimate=0.0, information=1e4)


def screened(text: str, told: ScoreTest = SURE, **more: Any) -> Screened:
    """A candidate whose size a straight line tells to 0.01 of its offset."""
    one = Parameter(name="x", unit="1", tolerance=0.1, kind=EFFECT, **more)
    return Screened(added=Added(named=parse(text)), evidence=0.0, told=told, plausible=1.0, parameter=one)


def test_a_size_that_adds_is_its_offset():
    (found,) = detectable([screened("force-gain:fmd-z2=0.1")])
    assert found.size == pytest.approx(SURE.detectable(1.0, evidence_threshold("force-gain")))


@pytest.mark.parametrize(
    ("text", "more"),
    [
        ("fmd-compliance:lateral=2", {"nominal": 1.0, "logarithmic": True}),
        ("modulus:mast=0.1", {"nominal": 1.0, "logarithmic": True, "above": -1.0}),
    ],
)
def test_a_factor_counts_from_one(text, more):
    (found,) = detectable([screened(text, **more)])
    assert found.size == pytest.approx(expm1(SURE.detectable(1.0, evidence_threshold(text.partition(":")[0]))))


def test_what_is_hardly_told_is_left_out():
    vague = ScoreTest(name="x", estimate=0.0, information=1e-8)
    assert vague.detectable(inf, 8.0) > 1000
    found = screened("fmd-compliance:lateral=2", vague, nominal=1.0, logarithmic=True)
    assert detectable([Screened(added=found.added, evidence=0.0, told=vague, plausible=1e6, parameter=found.parameter)]) == ()


def test_many_candidates_are_screened_some_at_a_time_and_what_is_promised_is_the_same(monkeypatch: pytest.MonkeyPatch):
    of = Study(model=MODEL, campaigns=(campaign(),), made=predictions(MODEL, (campaign(),), lines=np.linspace(8.0, 16.0, 40)))
    base, menu = candidates.baseline(of), candidates.candidates(of)
    together, sizes, problem = candidates.screen(of, base, menu), [], Study.problem

    def noted(data: Study, effects: Any) -> Any:
        sizes.append(len(effects))
        return problem(data, effects)

    monkeypatch.setattr(Study, "problem", noted)
    monkeypatch.setattr(candidates, "TOGETHER", 50)
    some = {one.added.named.id: one for one in candidates.screen(of, base, menu)}
    assert len(menu) > 100
    assert max(sizes) <= 50
    assert len(some) == len(together)
    for one in together:
        assert_allclose(some[one.added.named.id].evidence, one.evidence, rtol=1e-6, atol=1e-6)


def test_no_resonator_is_looked_up_where_data_have_no_lines():
    @dataclass(frozen=True)
    class Table:
        predictions: tuple[Any, ...] = ()

    table: Any = SimpleNamespace(problem=lambda effects: Table())
    stands: Any = SimpleNamespace(effects=(), fit=None)
    assert candidates.screened_resonators(table, stands, [Added(named=parse("slosh:mast-top=m:0.1,f:9,zeta:0.01"))]) == []


@pytest.fixture(scope="module")
def table(portal: Callable[..., Path], tmp_path_factory: pytest.TempPathFactory) -> Study:
    """A table of four modes of a portal as its model has them."""
    folder = tmp_path_factory.mktemp("table")
    model = portal(folder, 6)
    model.write_text(model.read_text().replace("places.a", 'places.d = ["0 mm", "0 mm", "40 mm"]\nplaces.a'))

    def read(frequency: Sequence[float], shapes: Sequence[Sequence[float]]) -> Study:
        written = {
            "format": 1,
            "kind": "modal-table",
            "article": "portal",
            "sensors": ["a:x", "a:z", "b:x", "b:z", "c:y", "c:z"],
            "frequencies": [f"{one:.9g} +/- {0.01 * one:.3g} Hz" for one in frequency],
            "shapes": [[float(f"{x:.9g}") for x in row] for row in shapes],
            "shapes_deviation": 0.05,
        }
        lines = [f"{key} = {json.dumps(value)}" for key, value in written.items()]
        (folder / "table.toml").write_text("\n".join(lines) + "\n")
        return Study.open(model, [folder / "table.toml"])

    known = [40.0, 80.0, 160.0, 320.0]
    first = read(known, np.eye(4, 6).tolist())
    modes = real_modes(first.tests[0].structure.nominal)
    rows = seen(modes.matrices, first.tests[0].table)
    return read(modes.frequency[:4], (rows @ modes.shapes[:, :4]).T.tolist())


def with_effect(study: Study, text: str) -> Study:
    """`study`, whose data are those of its model with an effect."""
    there = Added(named=parse(text, Vocabulary(places=None)), fixed=True)
    tests = [
        replace(one, measured=replace(one.measured, values=one.with_effects((there,)).at({}, derivatives=False).rows[..., 0]))
        for one in study.tests
    ]
    return replace(study, tests=tuple(tests))


def test_a_spring_is_asked_of_those_data_alone_that_it_reaches():
    def refused(*_: object, **__: object) -> None:
        raise AssertionError("what it does not reach reads as before")

    def test_of(name: str) -> Any:
        told = candidates.Answers(score=np.array([3.0]), own=np.array([4.0]), swallowed=np.array([[0.6]]))
        of, beyond = SimpleNamespace(name=name, lines=None), lambda rows: rows
        return SimpleNamespace(of=of, names=(), slope=np.zeros(1), beyond=beyond, answers=lambda each: told)

    def prediction(name: str, parameters: Sequence[str], at: Callable[..., Any]) -> Any:
        return SimpleNamespace(
            measured=SimpleNamespace(name=name), parameters=[SimpleNamespace(name=one) for one in parameters], at=at
        )

    reached = prediction("reached", ("gain", "cable:k"), lambda *_, **__: Predicted(rows=np.zeros((1, 1, 1))))
    problem: Any = SimpleNamespace(predictions=(reached, prediction("beside", ("gain",), refused)))
    told: Any = SimpleNamespace(name="cable:k")
    one = candidates.AnySize(
        told=told, parameter=told, problem=problem, offsets={}, tests=[test_of("reached"), test_of("beside")]
    )
    _, answers = one._read(1.0)
    assert (float(answers.score), float(answers.own), answers.swallowed.tolist()) == (3.0, 4.0, [0.6])


@pytest.mark.parametrize("side", [1, -1])
def test_a_support_that_data_tell_next_to_nothing_of_is_promised_at_no_size(side: int) -> None:
    told = ScoreTest(name="support-stiffness:drive", estimate=0.0, information=1e-300, tolerance=0.1)
    answers = candidates.Answers(score=np.array([0.0]), own=np.array([1e-300]), swallowed=np.zeros((1, 1)))
    reached = SimpleNamespace(name="reached", lines=None)
    test: Any = SimpleNamespace(of=reached, names=(), slope=np.zeros(1), beyond=lambda rows: rows, answers=lambda _: answers)
    moved = SimpleNamespace(
        measured=reached,
        parameters=[SimpleNamespace(name=told.name)],
        at=lambda *_, **__: Predicted(rows=np.zeros((1, 1, 1))),
    )
    problem: Any = SimpleNamespace(predictions=(moved,))
    parameter: Any = SimpleNamespace(low=-np.inf, high=np.inf)
    one = candidates.AnySize(told=told, parameter=parameter, problem=problem, offsets={}, tests=[test])
    assert one.detectable(1.0, 8.0, side) == np.inf


SATURATED = ("cable:d:x", "cable:d:y")


def beside(study: Study, id: str, size: float) -> tuple[Candidate, CandidateFit]:
    """The fit of what has the effect without it, and with it."""
    there = with_effect(study, f"{id}={size}")
    start = baseline(there)
    added = Added(named=parse(f"{id}={size}", Vocabulary(places=None)))
    return start, candidate_fits.candidate_fit(start, candidate_fits.fit_with(there, start, added))


def test_a_spring_is_named_at_the_size_that_is_promised_and_at_none_where_none_is(table: Study) -> None:
    """What a post holds beside its foot moves no more however stiff a spring: a straight line promises it all the same."""
    of = {one.id: one for one in screen(table, baseline(table), candidates.candidates(table, only=["cable"]))}
    promised, asked = {one.id: one.size for one in detectable(list(of.values()))}, evidence_threshold("cable")
    for id in ("cable:c:z", *SATURATED):
        assert asked < beside(table, id, promised[id])[1].evidence < asked + 6  # what noise may take away of it is there yet
    for id in SATURATED:
        assert beside(table, id, of[id].told.detectable(of[id].plausible, asked))[1].evidence < asked
    assert "cable:d:z" not in promised
    assert isfinite(of["cable:d:z"].told.detectable(of["cable:d:z"].plausible, asked))
    assert beside(table, "cable:d:z", 1e9)[1].evidence < asked


@pytest.mark.parametrize(
    ("id", "size", "told"),
    [
        ("cable:c:z", 3e5, "N/m (2753"),
        ("cable:d:x", 3e7, "at least 1.1e+07 N/m"),
        ("cable:d:x", 1e9, "at least"),
    ],
)
def test_a_spring_of_which_more_comes_to_the_same_is_told_to_be_at_least_as_stiff(
    table: Study, id: str, size: float, told: str
) -> None:
    _, fitted = beside(table, id, size)
    assert is_accepted(fitted)
    cause = as_cause(fitted.added, fitted.candidate, fitted.evidence, fitted.goodness)
    (one,) = cause.sizes
    assert one.low < size <= one.high
    assert told in sized(cause, one)


def test_a_node_under_two_names_is_one_candidate_by_the_name_that_the_test_gave_it(tmp_path, portal):
    """A group of one node, "RBE2 902" of a deck, and "node 5" of a test had been two that tied."""
    path = portal(tmp_path, 4)
    table = '[[test]]\nkind = "modal-table"\nfrequencies = ["60 Hz", "200 Hz"]\nsensors = ["node 5:x", "b:x"]\n'
    path.write_text(path.read_text() + table + "shapes = [[1.0, 1.0], [1.0, -1.0]]\n")
    data = Study.open(str(path), [])
    masses = [one.named.target for one in candidates.candidates(data) if one.named.family == "point-mass"]
    assert sorted(masses) == ["b", "c", "node 5"]  # a is node 5
    assert [one.named.target for one in candidates.candidates(data, only=["point-mass:a"])] == ["a"]
