"""Pages are as wide as the reader can see, cut no figure and end no line in spaces."""

import io
import sys

import pytest
from rich.table import Table

from validation.output import PIPED_WIDTH, page_width, print_pages
from validation.reference.statement import Row, add_figures, rows_table

MASS = Row(quantity="mass", value=47.4, tolerance=0.14, unit="kg", dominated_by="relative error of the balance that weighed it")


@pytest.mark.parametrize(("columns", "width"), [("72", 72), ("", PIPED_WIDTH), ("0", PIPED_WIDTH), ("wide", PIPED_WIDTH)])
@pytest.mark.usefixtures("capsys")
def test_a_pipe_is_as_wide_as_columns_says(columns: str, width: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", columns)
    assert page_width() == width


@pytest.mark.parametrize("columns", ["20", "80", "200"])
def test_words_wrap_figures_stay_whole_and_no_line_ends_in_spaces(
    columns: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", columns)
    print_pages([rows_table([MASS], "A [title]\nconstructed, not measured")])
    page = capsys.readouterr().out
    assert "47.40 ± 0.14" in page
    assert "…" not in page
    assert max(map(len, page.splitlines())) <= max(80, int(columns))
    assert all(line == line.rstrip() for line in page.splitlines())


def test_a_column_of_figures_is_never_narrower_than_its_figures(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", "20")
    table = Table()
    for _ in range(6):
        add_figures(table, "deviation\n/ tolerance", ["-0.00440876", "0.1"])
    table.add_row(*["-0.00440876"] * 6)
    print_pages([table])
    assert capsys.readouterr().out.count("-0.00440876") == 6


@pytest.mark.parametrize("encoding", ["ascii", "utf-8"])
def test_the_line_under_the_title_stands_alone_in_any_encoding(encoding: str, monkeypatch: pytest.MonkeyPatch) -> None:
    written = io.BytesIO()
    out = io.TextIOWrapper(written, encoding=encoding, errors="replace")
    monkeypatch.setattr(sys, "stdout", out)
    print_pages([rows_table([MASS], "Weighed\nconstructed, not measured")])
    out.flush()
    assert "constructed, not measured" in written.getvalue().decode("utf-8").splitlines()  # click takes an ASCII stream for UTF-8
