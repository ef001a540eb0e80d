"""What stands on the pictures of comparisons and ladders can be read: no words upon words, no curve behind its dots."""

from itertools import combinations
from typing import Any

import numpy as np
import pytest

from geometry.dynamic_mass import DynamicMass
from validation.report.charts import crosscheck, history, style
from validation.report.charts.spec import MEASURED, BarChart, BarPanel, Bars
from validation.report.charts.style import DynamicMassCurve


def box(of: Any) -> Any:
    return of.get_window_extent()


def rung(number: int, parent: int | None, depth: int, percents: tuple[float, ...], *, here: bool = True) -> history.DrawnRung:
    errors = dict(zip((*history.PERCENT, *history.FITTED), percents, strict=True))
    return history.DrawnRung(
        number=number, parent=parent, title=f"effect {number}", depth=depth, here=here, errors=errors, gain=5.0
    )


CLOSE = (
    rung(0, None, 0, (3.02, 1.66, 3.12, 0.91, 1.05)),
    rung(1, 0, 1, (2.99, 2.93, 3.01, 0.9, 0.91)),
    rung(2, 0, 1, (3.0, 2.9, 3.05, 0.5, 1.4), here=False),
    rung(3, 0, 1, (3.0, 2.9, 3.0, 0.9, 1.35), here=False),
)


def test_figures_of_nearly_equal_errors_do_not_stand_on_each_other_and_no_line_strikes_them(drawn, tmp_path):
    history.draw_fall("m.toml: errors from rung to rung", CLOSE, tmp_path / "fall.png")
    for axes in drawn[0].axes:
        texts = [box(text).padded(-1.5) for text in axes.texts]  # the box of a text is taller than its letters
        assert len(texts) >= 4
        assert not [pair for pair in combinations(texts, 2) if pair[0].overlaps(pair[1])]
    history.draw_fall("m.toml", CLOSE[:2], tmp_path / "fall.png")
    upper = drawn[0].axes[0]
    (text,) = [one for one in upper.texts if one.get_text() == "3.02"]
    ends = upper.transData.transform([(0, 3.12), (1, 3.01)])
    over = box(text).padded(-1.5)
    height = np.interp([over.x0, over.x1], *ends.T)
    assert np.all(height > over.y1)


def test_a_branch_of_chi_squared_that_stands_apart_has_its_name(drawn, tmp_path):
    apart = (CLOSE[0], CLOSE[1], rung(2, 0, 1, (3.0, 2.9, 3.05, 0.2, 1.0), here=False))
    history.draw_fall("m.toml", apart, tmp_path / "fall.png")
    lower = drawn[0].axes[1]
    at = [one.xy for one in lower.texts if one.get_text() == "2  effect 2"]
    assert (1, 0.2) in at


def test_everything_stays_on_the_page(drawn, tmp_path):
    for count in (1, 3, 8):
        way = [rung(k, k - 1 if k else None, k, (3.0, 2.0, 2.5, 0.9, 1.0)) for k in range(count)]
        history.draw_fall("m.toml", way, tmp_path / "fall.png")
        page = drawn[-1].bbox
        for axes in drawn[-1].axes:
            for one in (axes.get_legend(), *axes.texts, *axes.get_xticklabels()):
                assert box(one).x0 >= page.x0
                assert box(one).x1 <= page.x1


@pytest.mark.parametrize("name", ["cuboid on the FMD", "the long name of an article with sixty letters in it, on the FMD"])
def test_the_legend_of_the_errors_stands_below_the_title(name, drawn, tmp_path):
    rows = ("nominal", "plain", "plain, held out")
    bars = Bars(name="errors", rows=rows, values=(1.0, 1.0, 1.0), words=("1 %",) * 3, roles="good")
    panel = BarPanel(label="%", rows=rows, bars=(bars,), limit=0.9)
    chart = BarChart(title=f"{name}: the four errors", panels=(panel, panel), legend={"good": "good"}, limit="expected")
    crosscheck.draw_errors(chart, tmp_path / "errors.png")
    figure = drawn[0]
    (legend,) = figure.legends
    title = next(text for text in figure.texts if text.get_text().startswith(name))
    assert not box(legend).overlaps(box(title))
    assert not any(box(legend).overlaps(box(axes)) for axes in figure.axes)


def test_what_is_predicted_is_drawn_above_the_dots_and_labels_leave_neighbours_alone(drawn, tmp_path):
    frequency = np.linspace(8.0, 16.0, 50)
    mass = DynamicMass(frequency=frequency, matrix=np.broadcast_to(2e-3 * np.eye(6) + 0j, (50, 6, 6)) * frequency[:, None, None])
    look: dict[str, Any] = {"mass": mass, "rigid": np.zeros((6, 6)), "marked": np.zeros(0), "effective_mass": np.zeros((0, 6))}
    pair = (DynamicMassCurve(name="predicted", **look), DynamicMassCurve(name="measured", dots=MEASURED, **look))
    style.chosen("predicted beside measured", [("qq", k, k, pair) for k in range(6)], tmp_path / "mass.png")
    figure = drawn[0]
    for axes in figure.axes:
        line, dots = sorted(axes.lines[:2], key=lambda one: one.get_marker() == "o")
        assert line.get_zorder() > dots.get_zorder()
        label = box(axes.yaxis.label)
        assert label.x0 >= 0
        assert not any(label.overlaps(box(other)) for other in figure.axes)
