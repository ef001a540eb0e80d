"""What-if curves are those of the prediction, quick while a slider is dragged."""

from collections.abc import Callable
from dataclasses import replace
from statistics import median
from time import process_time
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from geometry.errors import BadInput, CheckFailed
from geometry.frames import Array
from validation.app import whatif
from validation.app.session import Session, begun
from validation.app.whatif import ReadyPredictions, SampledPrediction, Trace, WhatIf, what_if
from validation.effects.catalogue import FAMILIES, parse
from validation.effects.effect import PENDULUM, SIDES
from validation.estimation import evaluate
from validation.estimation.problem import Change, Lines, Measured, Offsets, Predicted, Wanted
from validation.model.model import Added
from validation.prediction.series import SeriesPrediction, predictions
from validation.report.effects import examples
from validation.study import read_data

TRIED = (
    "force-gain:fmd-z2=0.2",
    "accelerometer-position:cover-z3:x=0.02",
    "cell-stiffness:1z=0.5",
    "rigid-inertia:m=1.5",
    "modulus:mast=0.3",
    "joint-compliance:rotation=4e-6",
    "appendage:z=m:0.3,f:12,zeta:0.02",
    "absorber:mast-top=m:0.2,f:11,zeta:0.02",
    "orientation:z=0.1",
    "gravity=0",
    "polarity:fmd-z1",
    "channel-swap:cover-x1:cover-x2",
    "saturation:fmd-z2=0.1",
    "gap:2=50",
    "sweep-bias",
    "friction:flange:x=3",
)
"""One for every stage and every way through it."""


@pytest.fixture(scope="module")
def mast_desk(mast, tmp_path_factory) -> Session:
    """Nothing was compared there."""
    return begun(tmp_path_factory.mktemp("desks") / "mast", mast.model, mast.data)


@pytest.fixture(scope="module")
def table(mast_desk) -> ReadyPredictions:
    """Of the series with a mast, at the model as drawn."""
    return whatif.table(mast_desk)


@pytest.fixture(scope="module")
def predicted(mast, table) -> Callable[[str], tuple[SeriesPrediction, ...]]:
    """By effect, what `validation.prediction` says of the series, read anew."""
    data = read_data(mast.data, table.model)
    drawn = predictions(table.model, data.campaigns)

    def of(effect: str) -> tuple[SeriesPrediction, ...]:
        return tuple(one.with_effects((Added(named=parse(effect, table.words), fixed=True),)) for one in drawn)

    return of


def by_least_squares(one: SeriesPrediction, tested: whatif.ReadyCampaign, offsets: Any) -> Array:
    """H of what the channels are predicted to read in the very runs: loads over motions, by an equation of one's own."""
    rows = one.at(offsets, derivatives=False).rows
    read = np.einsum("nck,rnk->rnc" if rows.ndim == 3 else "rnck,rnk->rnc", rows, tested.inputs)
    load, motion = (np.einsum("nic,rnc->nir", each, read) for each in (tested.operators.load, tested.operators.motion))
    return np.asarray(load @ np.linalg.inv(motion))


@pytest.mark.parametrize("effect", TRIED)
def test_released_it_is_the_prediction_and_dragged_the_same_where_every_line_can_be_afforded(table, predicted, effect):
    shown = what_if(table, effect)
    assert shown.exact
    for trace, one, tested in zip(shown.traces, predicted(effect), table.tested, strict=True):
        expected = by_least_squares(one, tested, table.offsets)
        assert_allclose(trace.matrix, expected, rtol=1e-7, atol=1e-8 * np.abs(expected).max())  # 6 x 6 inverted twice
        assert trace.reached or np.array_equal(trace.matrix, tested.entries)
    # Sizes pass through the parameters of a fit there, which costs no more than rounding.
    dragged, released = (what_if(replace(table, pace=1e-9), effect, exact=exact) for exact in (False, True))
    assert dragged.exact
    for one, other in zip(dragged.traces, released.traces, strict=True):
        assert_allclose(one.matrix, other.matrix, rtol=1e-9, atol=1e-12 * np.abs(other.matrix).max())
    assert dragged.plain_percent == pytest.approx(released.plain_percent, rel=0.25)  # at every twelfth line


@pytest.mark.parametrize("effect", ["saturation:fmd-z2=0.1", "gap:2=50", "sweep-bias", "friction:flange:x=3"])
def test_what_asks_for_every_run_is_the_same_for_the_eye_at_a_quarter_of_the_lines(table, effect):
    few = replace(table, pace=whatif.BUDGET / (40 * len(table.tested) * 6))
    dragged, released = (what_if(few, effect, exact=exact) for exact in (False, True))
    assert not dragged.exact
    assert max(off(one, other) for one, other in zip(dragged.traces, released.traces, strict=True)) < 1.0


def off(one: Trace, other: Trace) -> float:
    """How far two magnitudes are apart on a logarithmic axis of 400 pixels."""
    both = np.log10(np.abs([one.matrix[:, 4, 4], other.matrix[:, 4, 4]]))
    return float(400 * np.abs(both[0] - both[1]).max() / max(np.ptp(both[1]), 1.0))


def test_no_effect_changes_nothing_and_before_a_comparison_nothing_is_fitted(table):
    shown = what_if(table, "force-gain:fmd-z2=0")
    assert shown.plain_percent == pytest.approx(shown.before_percent, rel=1e-9)
    for one, tested in zip(shown.traces, table.tested, strict=True):
        assert_allclose(one.matrix, tested.entries, rtol=1e-9)
    assert table.at == whatif.DRAWN


@pytest.fixture(scope="module")
def fitted(worked) -> ReadyPredictions:
    """Of the block that was compared."""
    return whatif.table(worked.desk)


def test_the_right_size_brings_the_error_down_and_a_wrong_sign_up(fitted):
    """What the plain fit had taken up of the fault goes with it: else the right size would count twice, and seem wrong."""
    right, wrong = (what_if(fitted, f"force-gain:fmd-z2={size}") for size in (0.08, -0.08))
    assert right.followed
    assert right.plain_percent < 0.3 * right.before_percent
    assert wrong.plain_percent > 1.5 * wrong.before_percent
    alone = what_if(fitted, "force-gain:fmd-z2=0.08", follow=False)
    assert not alone.followed
    assert alone.plain_percent > alone.before_percent


def test_what_follows_a_slider_begins_where_the_comparison_ended_and_arrives_at_the_prediction(fitted, worked):
    sizes = (0.02, 0.04, 0.06, 0.08)
    dragged = [what_if(fitted, f"force-gain:fmd-z2={size}", exact=False).plain_percent for size in sizes]
    released = what_if(fitted, "force-gain:fmd-z2=0.08").plain_percent
    assert dragged == sorted(dragged, reverse=True)
    assert dragged[-1] == pytest.approx(released, rel=0.3)
    shown = what_if(fitted, "force-gain:fmd-z2=0.08")
    effects = (Added(named=parse("force-gain:fmd-z2=0.08", fitted.words), fixed=True),)
    (tested,) = fitted.tested
    expected = by_least_squares(tested.prediction.with_effects(effects), tested, shown.offsets)
    assert_allclose(shown.traces[0].matrix, expected, rtol=1e-7, atol=1e-8 * np.abs(expected).max())
    assert fitted.at == whatif.FITTED
    shown = what_if(fitted, "force-gain:fmd-z2=0")
    assert shown.before_percent == pytest.approx(worked.compared.summary["plain_error_percent"], rel=1e-9)
    assert shown.plain_percent == pytest.approx(shown.before_percent, rel=1e-3)  # the fit had ended there
    pairs = worked.compared.maps[0].pairs
    assert_allclose(fitted.tested[0].entries, pairs.predicted, rtol=1e-6, atol=1e-8 * np.abs(pairs.predicted).max())


def test_every_effect_that_reaches_the_data_has_sliders_that_can_be_dragged(table):
    for effect in {one.family: one for one in reversed(whatif.reaching(table))}.values():
        for end in ("low", "start", "high"):
            written = effect.written({one.key: getattr(one, end) for one in effect.sliders})
            assert str(parse(written, table.words)) == written
        assert np.isfinite(what_if(table, effect.written(), exact=False).plain_percent)
        for one in effect.sliders:
            assert one.low <= one.start <= one.high
            assert one.low < one.high
            assert not one.logarithmic or one.low > 0


def test_a_model_that_breaks_down_says_so(table, monkeypatch):
    def broken(*given, **more):
        raise FloatingPointError("divide by zero")

    monkeypatch.setattr(SeriesPrediction, "at", broken)
    with pytest.raises(CheckFailed, match="breaks down at that size: divide by zero"):
        what_if(table, "modulus:mast=0.1")


def test_all_sides_of_the_catalogue_are_there_but_ropes(table):
    found = whatif.reaching(table)
    assert {one.side for one in found} == set(SIDES) - {PENDULUM}
    ids = [one.id for one in found]
    assert len(set(ids)) == len(ids)
    assert "channel-swap:fmd-z1:fmd-z2" in ids
    assert "channel-swap:fmd-z2:fmd-z1" not in ids
    assert {"modulus:mast", "point-mass:mast-top", "force-gain:fmd-z2", "sweep-bias", "noise:fmd-z1"} <= set(ids)
    assert "modulus:upper-long" not in ids  # no such part on one blade
    reached = {one.id: one.campaigns for one in found}
    assert reached["modulus:mast"] == ("fmd+clumod-1",)
    assert reached["force-gain:fmd-z2"] == ("fmd+cuboid", "fmd+clumod-1")


def test_an_effect_of_the_model_is_moved_in_its_place(mast_desk, table):
    added = Added(named=parse("force-gain:fmd-z2=0.05", table.words))
    of = replace(
        table,
        model=replace(table.model, effects=(added,)),
        tested=tuple(replace(one, prediction=one.prediction.with_effects((added,))) for one in table.tested),
        offsets={**table.offsets, "force-gain:fmd-z2": 0.05},
        dragged={},
    )
    effect = next(one for one in whatif.reaching(of) if one.id == "force-gain:fmd-z2")
    assert effect.in_model
    assert effect.sliders[0].start == 0.05
    moved = what_if(of, "force-gain:fmd-z2=0.08")
    alone = what_if(table, "force-gain:fmd-z2=0.08")
    assert_allclose(moved.traces[0].matrix, alone.traces[0].matrix, rtol=1e-9)


def test_nonsense_and_a_size_that_leaves_no_body_are_refused_in_words(table):
    for effect in ("force-gain:fmd-z9=0.1", "nonsense", "force-gain:fmd-z2=1e9", "modulus:upper-long=0.1"):
        with pytest.raises(BadInput):
            what_if(table, effect)
    with pytest.raises(BadInput, match="no body is left"):
        what_if(table, "rigid-inertia:m=-50")


def test_what_if_says_which_campaigns_are_reached_and_a_slider_can_say_every_family(table):
    found: WhatIf = what_if(table, "modulus:mast=0.1")
    assert [one.reached for one in found.traces] == [False, True]
    assert np.array_equal(found.traces[0].matrix, table.tested[0].entries)
    # Also of families that do not reach this series.
    for family in FAMILIES.values():
        typical = parse(examples(family)[0]).values
        for size in (*family.sizes, *(one for sizes in family.varying.values() for one in sizes)):
            low, high, logarithmic = whatif.ends(size, typical.get(size.key))
            assert size.low <= low < high <= size.high
            assert not logarithmic or low > 0


MOVES = 5
GENEROUS = 12.0
"""Full predictions that a drag of a small series may cost. It is about three; what is computed at rest costs forty and more."""


@pytest.mark.parametrize("effect", ["force-gain:fmd-z2=0.0{}", "rigid-inertia:m=1.{}"])
def test_a_drag_costs_a_few_full_predictions(worked, effect):
    """By the clock of this process: other work on the machine slows both."""
    table = whatif.table(worked.desk)
    anew = worked.desk.predictions(worked.desk.read_model())
    whatif.what_if(table, effect.format(1), exact=False)  # which makes ready
    drag, full = [], []
    for k in range(2, 2 + MOVES):
        began = process_time()
        whatif.what_if(table, effect.format(k), exact=False)
        drag.append(process_time() - began)
        began = process_time()
        for one in anew:
            one.at(table.offsets, derivatives=False)
        full.append(process_time() - began)
    assert median(drag) < GENEROUS * median(full)


RUNS, LINES, CHANNELS, INPUTS = 3, 8, 6, 2


class Asked:
    """A prediction that says the same at whatever offsets."""

    parameters = ()

    def __init__(self, measured: Measured, rows: np.ndarray, noise: np.ndarray) -> None:
        self.measured, self._rows, self._noise = measured, rows, noise

    def at(self, offsets: Offsets, lines: Lines | None = None, *, derivatives: Wanted = True) -> Predicted:
        at = np.arange(LINES) if lines is None else lines
        rows = self._rows[at] if self._rows.ndim == 3 else self._rows[:, at]
        return Predicted(rows=rows, changes={"x": Change(channels=(0,), rows=rows)}, noise=self._noise[:, at])


@pytest.fixture(params=[False, True], ids=["shared rows", "rows by run"])
def asked(request) -> Asked:
    rng = np.random.default_rng(2)

    def drawn(*shape: int) -> np.ndarray:
        return np.asarray(rng.standard_normal(shape) + 1j * rng.standard_normal(shape))

    measured = Measured(
        name="a",
        configuration="a",
        runs=("x", "y", "z"),
        channels=tuple(f"c{k}" for k in range(CHANNELS)),
        judged=np.array([False, False, False, True, True, True]),
        frequency=np.linspace(4.0, 30.0, LINES),
        values=drawn(RUNS, LINES, CHANNELS),
        noise=np.full((RUNS, LINES, CHANNELS), 1e-3),
        inputs=None,
    )
    shape = (RUNS, LINES, CHANNELS, INPUTS) if request.param else (LINES, CHANNELS, INPUTS)
    return Asked(measured, drawn(*shape), np.abs(drawn(RUNS, LINES, CHANNELS)))


def answered(of: Asked, lines: Lines) -> SampledPrediction:
    return SampledPrediction(measured=of.measured, parameters=(), lines=lines, said=of.at({}, lines, derivatives=False))


def test_some_lines_and_errors_of_some_runs_are_those_of_the_prediction_and_nothing_else_is_said(asked):
    there = answered(asked, np.array([0, 2, 3, 7])).at({}, np.array([2, 7]), derivatives=False)
    wanted = asked.at({}, np.array([2, 7]))
    assert_array_equal(there.rows, wanted.rows)
    assert_array_equal(there.noise, wanted.noise)
    assert not there.changes
    every = np.arange(LINES)
    (of_y,) = evaluate.squares(answered(asked, every).on(("y",)), {}, np.array([1, 4]))
    whole = evaluate.squares(asked, {}, np.array([1, 4]))  # type: ignore[arg-type]
    assert of_y.run == "y"
    # how far silent channels are trusted is told by all runs together, so that a run alone errs a trifle otherwise
    np.testing.assert_allclose(of_y.values, whole[1].values, rtol=0.02)
    some = answered(asked, np.array([0, 2]))
    with pytest.raises(ValueError, match="asked"):
        some.at({}, np.array([1]), derivatives=False)
    with pytest.raises(ValueError, match="asked"):
        some.at({}, np.array([0]))
    with pytest.raises(ValueError, match="asked"):
        some.at({}, derivatives=False)
