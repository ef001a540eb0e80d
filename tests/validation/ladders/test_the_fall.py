"""The picture of the command line and the figure of report and workbench show the same fall."""

from dataclasses import replace

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from validation.history.history import HistoryPosition, Ladder
from validation.report.charts import history
from validation.report.charts.history import falling_errors, spread


def test_what_tolerances_pay_is_told_over_what_is_due_wherever_it_is_drawn(rung, tmp_path, monkeypatch):
    """Of 270 tolerances that the data hardly tell, 40 is due in all. The sum is 30.25: beside one each that seems nothing."""
    rungs = tuple(rung(k, k - 1 if k else None) for k in range(2))
    rungs = tuple(replace(one, errors=replace(one.errors, expected_z2=40.0)) for one in rungs if one.errors is not None)
    at = HistoryPosition(path=tmp_path / "model.toml", text="", ladder=Ladder(rungs=rungs, current=1), rung=rungs[1])
    seen: list[history.DrawnRung] = []
    monkeypatch.setattr(history, "draw_fall", lambda title, rungs, *rest: seen.extend(rungs))
    monkeypatch.setattr(history.static, "draw_intervals", lambda *rest: None)
    history.draw(at, tmp_path)
    (price,) = (name for name in history.FITTED if "z²" in name)
    on_paper = [one.errors[price] for one in seen]
    (line,) = (one for one in falling_errors(at).checked().data if "z²" in one.name and one.mode != "markers")
    assert_allclose(on_paper, 30.25 / 40.0, rtol=1e-12)
    assert_allclose(np.asarray(line.y, dtype=float), on_paper, rtol=1e-12)
    assert "due" in price
    absurd = tuple(replace(one, errors=replace(one.errors, tolerance_z2=142_320.0)) for one in rungs)
    at = replace(at, ladder=Ladder(rungs=absurd, current=1), rung=absurd[1])
    assert "3560" in {text for one in falling_errors(at).data for text in one.get("text", ())}  # and not 3.56e+03


def test_an_error_of_nothing_but_noise_stands_below_all_others_and_is_called_0(rung, tmp_path, monkeypatch):
    """It has no place on a logarithmic axis: the fall of what had been added ended at the rung before it, without a word."""
    first, then = rung(0), rung(1, 0)
    then = replace(then, errors=replace(then.errors, plain=0.0))
    at = HistoryPosition(path=tmp_path / "model.toml", text="", ladder=Ladder(rungs=(first, then), current=1), rung=then)
    seen: list[object] = []
    monkeypatch.setattr(history, "draw_fall", lambda title, rungs, path, note: seen.extend((*rungs, note)))
    monkeypatch.setattr(history.static, "draw_intervals", lambda *rest: None)
    history.draw(at, tmp_path)
    assert 0 < seen[1].errors["plain"] < min(one.errors[name] for one in seen[:2] for name in ("nominal", "held out"))
    assert "0: what noise makes" in seen[2]
    (line,) = (one for one in falling_errors(at).checked().data if one.name == "plain, fitted data" and one.mode != "markers")
    assert list(line.text) == ["4.10", "0"]


HEIGHTS = st.lists(st.floats(-200.0, 200.0), min_size=1, max_size=8)


@given(heights=HEIGHTS, gap=st.floats(0.0, 20.0))
def test_labels_end_at_least_a_gap_apart_about_the_same_middle(heights, gap):
    placed = spread(heights, gap)
    assert np.all(np.diff(placed) >= gap - 1e-9)
    assert_allclose(np.mean(placed), np.mean(heights), atol=1e-9)


@given(heights=HEIGHTS)
def test_labels_that_are_apart_stay_where_they_are(heights):
    apart = np.sort(heights) + 10.0 * np.arange(len(heights))
    assert_allclose(spread(list(apart), 10.0), apart, atol=1e-9)


def test_two_labels_that_meet_move_by_half_of_what_is_missing():
    assert_allclose(spread([0.0, 4.0, 50.0], 10.0), [-3.0, 7.0, 50.0])
