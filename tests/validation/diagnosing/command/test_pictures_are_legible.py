"""What stands on the pictures of a diagnosis can be read: everything on the page, no words upon words."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import combinations
from pathlib import Path
from typing import Any

import pytest

from validation.diagnose.diagnosis import Diagnosis
from validation.effects.catalogue import parse
from validation.report import diagnose
from validation.report.charts import static

Made = Callable[[str], Diagnosis]


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """The figures that were finished."""
    figures: list[Any] = []
    finish = static.finish

    def finished(figure: Any, *arguments: Any) -> None:
        finish(figure, *arguments)
        figure.canvas.draw()
        figures.append(figure)

    monkeypatch.setattr(static, "finish", finished)
    return figures


def box(of: Any) -> Any:
    return of.get_window_extent()


def texts(figure: Any) -> list[Any]:
    of_axes = [text for axes in figure.axes for text in (*axes.texts, *axes.get_yticklabels())]
    return [text for text in (*figure.texts, *of_axes) if text.get_text()]


@pytest.mark.parametrize("verdict", ["nothing", "ambiguous", "several"])
def test_everything_stays_on_the_page_and_off_each_other(verdict: str, drawn: list[Any], made: Made, tmp_path: Path) -> None:
    diagnose.draw(made(verdict), tmp_path)
    assert len(drawn) == (2 if made(verdict).ranking or made(verdict).accepted else 1)
    for figure in drawn:
        page = figure.bbox
        for one in texts(figure):
            assert box(one).x0 >= page.x0, one.get_text()
            assert box(one).x1 <= page.x1, one.get_text()
        (legend,) = figure.legends
        assert not any(box(legend).overlaps(box(axes)) for axes in figure.axes)
        title = max(figure.texts, key=lambda text: box(text).y0)
        assert not box(legend).overlaps(box(title))


def test_many_causes_have_a_bar_and_a_size_each(drawn: list[Any], made: Made, tmp_path: Path) -> None:
    first = made("missing").accepted[0]
    names = ["accelerometer-misalignment:cover-z1:x", "cable:upper-short-:lateral", "joint-compliance:rotation"]
    sizes = [0.1, 5000.0, 3e-6]
    more = [
        replace(first, named=parse(f"{name}={size}"), evidence=evidence, null=False)
        for name, size, evidence in zip(names, sizes, (28000.0, 0.4, -3.0), strict=True)
    ]
    diagnose.draw(replace(made("missing"), ranking=(first, *more)), tmp_path)
    axes = drawn[0].axes[0]
    assert len(axes.patches) == 4
    labels = [box(text) for text in axes.texts]
    assert len(labels) == 4
    assert not [pair for pair in combinations(labels, 2) if pair[0].overlaps(pair[1])]
    assert all(one.x1 <= drawn[0].bbox.x1 for one in labels)
    low, high = axes.get_xlim()
    assert low < -3.0
    assert high > 28000.0


def test_where_nothing_was_found_there_is_no_after(drawn: list[Any], made: Made, tmp_path: Path) -> None:
    found = made("nothing")
    diagnose.draw(replace(found, after=found.before), tmp_path)
    labels = [text.get_text() for text in drawn[-1].legends[0].get_texts()]
    assert labels == ["due, nothing wrong"]


def test_the_line_of_what_is_asked_for_is_drawn_where_a_diagnosis_says_it(made: Made) -> None:
    assert diagnose.asked(made("missing")) == 8.0
    assert diagnose.asked(replace(made("missing"), settings={})) is None
