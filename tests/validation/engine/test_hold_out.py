"""What is held out is not fitted, and is predicted."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.errors import BadInput
from validation.estimation.evaluate import NEAR, evaluate, every_block, folds, held, named, refitted, solved, without
from validation.estimation.fit import PLAIN_FLOOR, fit
from validation.estimation.problem import MODE, PLAIN, Problem

TRUTH = {"mass": 0.03, "inertia": -0.02, "damping": 0.2, "frequency:one": 0.01, "frequency:first": 0.015, "frequency:two": -0.01}


class Weight:
    name = "scales: mass"

    def __init__(self, lab):
        self.parameters = (lab.LABORATORY[0],)

    def residual(self, offsets):
        return (offsets.get("mass", 0.0) - 0.03) / 0.001, {"mass": 1 / 0.001}


@pytest.fixture
def series(lab):
    truth = {**lab.drawn(5), **TRUTH}
    return Problem(
        (lab.toy(truth, name="one", configuration="first"), lab.toy(truth, name="two", seed=8, stiffer=1.2)), (Weight(lab),)
    )


def spoilt(toy, run=None, lines=None):
    """The same data, with noise in place of one run or of some lines."""
    values = toy.measured.values.copy()
    values[slice(None) if run is None else run, slice(None) if lines is None else lines] = 5.0 - 3.0j
    return replace(toy, measured=replace(toy.measured, values=values))


def test_by_default_each_run_and_each_configuration_is_held_out_in_turn_and_so_every_line_twice(series, lab):
    names = [fold.name for fold in folds(series)]
    assert names == [
        *(f"run r{k} of one" for k in (1, 2, 3)),
        *(f"run r{k} of two" for k in (1, 2, 3)),
        "configuration first",
        "configuration two",
    ]
    assert len(folds(Problem((lab.toy({}),)))) == 3
    assert folds(Problem((lab.toy({}, runs=1),))) == ()
    modes = lab.toy({}, name="table")
    named = replace(modes, measured=replace(modes.measured, runs=("mode 1", "bending", "torsion"), axes=(MODE,) * 3))
    assert [fold.name for fold in folds(Problem((named,)))] == ["mode 1 of table", "bending of table", "torsion of table"]
    driven = replace(modes, measured=replace(modes.measured, runs=("mode a", "mode b", "mode c")))  # modes of a shaker, say
    assert [fold.name for fold in folds(Problem((driven,)))] == [f"run mode {one} of table" for one in "abc"]
    count = sum(len(part.measured.runs) for fold in folds(series) for part, _ in held(series, fold))
    assert count == 2 * 6


def test_a_fold_never_sees_what_it_holds_out(lab):
    """However wrong the run is, the fit without it is the same."""
    toy = lab.toy({**lab.drawn(1), **TRUTH})
    answers = []
    for one in (toy, spoilt(toy, run=0)):
        problem = Problem((one,))
        fold = folds(problem)[0]
        alone = fit(without(problem, fold), PLAIN)
        whole = fit(problem, PLAIN)
        at = refitted(solved(problem, whole, PLAIN_FLOOR), fold)
        sd = dict(zip([p.name for p in alone.parameters], np.sqrt(np.diag(alone.covariance)), strict=True))
        answers.append(np.array([(at[name] - x) / sd[name] for name, x in alone.by_name.items()]))
    # in standard deviations, of which the last step of a fit leaves a tenth, and more where it is bad
    assert_allclose(answers[0], 0.0, atol=0.3)
    assert_allclose(answers[1], 0.0, atol=0.3)


def test_a_quick_fold_is_where_the_whole_way_leads_and_not_where_it_began(lab):
    """Nothing is wrong with the runs: a single step goes nearly all of the way that leaving one out takes."""
    problem = Problem((lab.toy({**lab.drawn(1), **TRUTH}),))
    whole = fit(problem, PLAIN)
    at = solved(problem, whole, PLAIN_FLOOR)
    for fold in folds(problem):
        far, quick = (refitted(at, fold, near) for near in (0.0, NEAR))
        alone = fit(without(problem, fold), PLAIN)
        sd = dict(zip([p.name for p in alone.parameters], np.sqrt(np.diag(alone.covariance)), strict=True))
        apart = np.array([(quick[name] - far[name]) / sd[name] for name in sd])
        way = np.array([(far[name] - whole.by_name[name]) / sd[name] for name in sd])
        assert np.linalg.norm(apart) < 0.3  # in standard deviations, of which the last step of a fit leaves a tenth
        assert np.linalg.norm(way) > np.linalg.norm(apart)


def test_of_a_configuration_that_is_held_out_only_knowledge_beforehand_is_left(series):
    plain = fit(series, PLAIN)
    fold = folds(series)[-1]
    assert fold.name == "configuration two"
    at = refitted(solved(series, plain, PLAIN_FLOOR), fold)
    assert abs(plain.by_name["frequency:two"]) > 0.005
    assert_allclose(at["frequency:two"], 0.0, atol=1e-9)
    assert_allclose(at["frequency:first"], 0.015, atol=1e-3)


def test_a_block_of_frequencies_is_not_seen_either(lab):
    toy = lab.toy({**lab.drawn(1), **TRUTH})
    fold = every_block(Problem((toy,)), 4)[-1]
    problem = Problem((spoilt(toy, lines=fold.blocks["one"]),))
    at = refitted(solved(problem, fit(problem, PLAIN), PLAIN_FLOOR), fold)
    right = refitted(solved(Problem((toy,)), fit(Problem((toy,)), PLAIN), PLAIN_FLOOR), fold)
    assert_allclose(at["mass"], right["mass"], atol=1e-3)


@pytest.mark.parametrize("count", [0, 1, 40])
def test_blocks_too_few_or_too_narrow_are_refused(series, count):
    with pytest.raises(BadInput, match="blocks"):
        every_block(series, count)


@pytest.mark.parametrize(
    ("names", "runs", "facts"),
    [
        (["one/r2"], {"one": ("r2",)}, ()),
        (["two"], {"two": ("r1", "r2", "r3")}, ()),
        (["first"], {"one": ("r1", "r2", "r3")}, ()),
        (["one/r1", "one/r3", "scales: mass"], {"one": ("r1", "r3")}, ("scales: mass",)),
    ],
)
def test_names_of_runs_data_sets_configurations_and_facts(series, names, runs, facts):
    fold = named(series, names)
    assert dict(fold.runs) == runs
    assert fold.facts == facts
    left = without(series, fold)
    assert [fact.name for fact in left.facts] == [name for name in ("scales: mass",) if name not in facts]
    for one in left.predictions:
        assert not set(one.measured.runs) & set(runs.get(one.measured.name, ()))


def test_a_run_of_the_only_data_set_needs_no_more_than_its_name(lab):
    assert dict(named(Problem((lab.toy({}),)), ["r2"]).runs) == {"one": ("r2",)}


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("on/r2", "Did you mean one/r2"),
        ("tow", "Did you mean two"),
        ("r2", "Write one of one/r2, two/r2"),
        ("scales", "Known are"),
    ],
)
def test_unknown_names_are_refused_with_the_nearest(series, name, said):
    with pytest.raises(BadInput, match="--hold-out") as refused:
        named(series, [name])
    assert said in str(refused.value)
    assert refused.value.field == name


def test_blocks_are_all_lines_once_and_nothing_left_to_fit_is_refused(series):
    with pytest.raises(BadInput, match="nothing is left to fit"):
        named(series, ["one", "two"])
    blocks = every_block(series, 3)
    lines = np.concatenate([fold.blocks["one"] for fold in blocks])
    assert sorted(lines) == list(range(60))
    for fold in blocks:
        left = without(series, fold).lines["one"]
        assert not set(left) & set(fold.blocks["one"])


def test_what_is_named_is_in_no_fit_and_is_predicted(lab, series):
    found = evaluate(series, hold_out=["two"])
    assert {p.name for p in found.fitted.parameters} & {"frequency:two"} == set()
    assert set(found.plain.by_data_set) == {"one"}
    assert set(found.held_out.by_data_set) == {"two"}
    assert found.held_out_names == ("two",)
    one, two = series.predictions
    again = evaluate(Problem((one, spoilt(two)), series.facts), hold_out=["two"])
    assert_allclose(again.plain_fit.offsets, found.plain_fit.offsets, rtol=1e-12)
    assert again.held_out.percent > 10 * found.held_out.percent


def test_a_series_is_evaluated_with_every_fold_or_frequency_blocks_where_they_are_asked_for(series):
    told: list[float] = []
    found = evaluate(series, progress=told.append)
    assert found.held_out_names == tuple(fold.name for fold in folds(series))
    assert {*found.held_out.by_fold, *found.held_out_configurations.by_fold} == set(found.held_out_names)
    assert set(found.held_out_configurations.by_fold) == {fold.name for fold in folds(series) if fold.configuration}
    assert found.plain.percent < found.held_out.percent < found.held_out_nominal.percent
    assert found.held_out_configurations.percent < found.held_out_configurations_nominal.percent
    assert told == sorted(told)
    assert told[-1] == 1.0
    found = evaluate(series, blocks=3)
    assert len(found.held_out_names) == 3
    assert all(name.endswith("Hz") for name in found.held_out_names)


def test_one_run_alone_has_nothing_to_hold_out(lab):
    found = evaluate(Problem((lab.toy({}, runs=1),)))
    assert found.held_out is None
    assert found.held_out_names == ()


def test_configurations_may_be_held_out_later_and_no_fit_of_all_data_is_made_again(series):
    whole, runs = evaluate(series), evaluate(series, configurations=False)
    assert (runs.held_out_configurations, runs.held_out_configurations_nominal) == (None, None)
    later = evaluate(series, baseline=runs)
    assert (later.fitted, later.plain_fit) == (runs.fitted, runs.plain_fit)
    for name in (
        "nominal",
        "plain",
        "held_out",
        "held_out_nominal",
        "held_out_configurations",
        "held_out_configurations_nominal",
    ):
        assert vars(getattr(later, name)) == vars(getattr(whole, name)), name
    assert later.held_out_names == whole.held_out_names
    assert (later.of_runs.held_out_names, later.of_runs.held_out_configurations) == (runs.held_out_names, None)
