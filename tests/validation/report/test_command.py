"""`massline report`: bad input is refused by name before anything is computed; an interruption leaves what was there."""

from pathlib import Path
from typing import Any

import pytest

from validation.report import page


@pytest.mark.parametrize(
    ("model", "out", "words"),
    [
        (None, "report.docx", ".html"),
        (None, "/no-such-place/deeper/report.html", "/no-such-place"),
        ("none.toml", "report.html", "none.toml"),
        ("../none.toml", "report.html", "none.toml"),
    ],
)
def test_a_model_that_is_not_there_and_a_place_or_an_ending_that_cannot_be_are_refused(model, out, words, refused, series):
    assert words in refused("report", model or str(series.model), str(series.campaign), "--out", out)
    assert not Path(out).exists()


def test_without_a_name_it_goes_under_out_after_the_model(run, series, report, monkeypatch):
    monkeypatch.setattr(page, "reported", lambda asked: report)
    monkeypatch.setattr(page, "html", lambda *_: "<!DOCTYPE html>")
    code, out, said = run("report", str(series.model), *series.data)
    assert (code, out) == (0, "")
    assert "wrote out/model-report.html" in said
    assert Path("out/model-report.html").read_text("utf-8").startswith("<!DOCTYPE html>")


def test_an_interruption_leaves_the_page_that_was_there(run, series, report, monkeypatch):
    Path("report.html").write_text("the page before")
    monkeypatch.setattr(page, "reported", lambda asked: report)

    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(page, "html", interrupted)
    code, _, _ = run("report", str(series.model), *series.data, "--out", "report.html")
    assert code == 130
    assert [path.name for path in Path().iterdir()] == ["report.html"]
    assert Path("report.html").read_text() == "the page before"


def test_the_diagnosis_can_be_left_out(series, monkeypatch):
    def never(*_):
        raise AssertionError

    monkeypatch.setattr(page, "compared", lambda *_, **__: "compared")
    monkeypatch.setattr(page.diagnose, "diagnosed", never)
    monkeypatch.setattr(page, "assembled", lambda *_, **given: given)
    given: Any = page.reported(page.ReportOptions(compared=series.asked, diagnosis=False), quiet=True)
    assert given["diagnosis"] is None
    assert given["not_diagnosed"] == page.WITHOUT
