"""A row's arithmetic, its verdict, its renderings, and pages as wide as the reader can see."""

import io
import sys

import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from rich.console import Console
from rich.table import Table
from rich.text import Text

from validation.classical.files import Item
from validation.output import PIPED_WIDTH, odds, page_width, print_pages, rounded, to_json
from validation.reference.statement import Row, add_figures, rows_table
from validation.report.reference import budget_table


def row(value: float = 47.4, tolerance: float | None = 0.05, reference: float | None = 47.23, **more: float) -> Row:
    return Row(quantity="mass", value=value, tolerance=tolerance, unit="kg", reference=reference, dominated_by="balance", **more)


def test_the_deviation_is_relative_to_the_reference_as_in_table_1():
    # Table 1 prints two decimals: half a unit of the last is the tolerance
    assert_allclose(row().deviation_percent, 0.36, atol=0.005)


@pytest.mark.parametrize(
    ("own", "others", "within"), [(0.16, None, False), (0.18, None, True), (0.12, 0.13, True), (None, None, False)]
)
def test_the_verdict_takes_both_tolerances_in_quadrature(own, others, within):
    judged = Row(quantity="mass", value=47.4, tolerance=own, unit="kg", reference=47.23, reference_tolerance=others)
    assert judged.within is within


@given(st.floats(-1e6, 1e6), st.floats(1e-3, 1e3))
def test_value_and_reference_may_change_places_without_changing_the_verdict(value, tolerance):
    there, back = row(value, tolerance, 1.0), row(1.0, tolerance, value)
    assert there.within == back.within


def test_without_a_reference_nothing_is_invented_and_a_zero_one_still_has_a_verdict():
    alone = row(reference=None)
    assert alone.within
    assert alone.deviation_percent is None
    assert alone.deviation_in_tolerances is None
    offset = row(value=-5.45, tolerance=1.0, reference=0.0)
    assert offset.deviation_percent is None
    assert not offset.within


def test_json_tells_a_row_that_agrees_from_one_that_was_compared_with_nothing():
    entries = to_json([row(tolerance=1.0), row(reference=None), row(reference=0.0)])
    assert [(entry["within"], entry["compared"]) for entry in entries] == [(True, True), (True, False), (False, True)]


@pytest.mark.parametrize(
    ("value", "tolerance", "text"),
    [
        (47.4, 0.05, "47.400"),
        (20.353, 0.0417, "20.353"),
        (1234.5, 30.0, "1234"),
        (2.0, None, "2"),
        (None, 0.1, "–"),
        (-1e-9, 1.0, "0.0"),
        (9.87e6, 1e4, "9870000"),
        (1.23456789e20, 3e17, "1.2346e+20"),
        (-4.5678e-8, 2e-10, "-4.568e-08"),
        (0.0, 2e-10, "0"),
        (0.0, 0.01, "0.000"),
    ],
)
def test_a_value_is_printed_with_the_digits_its_tolerance_leaves_it(value, tolerance, text):
    assert rounded(value, tolerance) == text


def printed(table: Table, width: int) -> str:
    console = Console(width=width, color_system=None)
    with console.capture() as capture:
        console.print(table)
    return capture.get()


def moment() -> Row:
    return Row(
        quantity="MoI xx about the CoG",
        value=20.353,
        tolerance=0.217,
        unit="kg m²",
        reference=20.144,
        reference_tolerance=0.0005,
        dominated_by="[b] balance resolution",
    )


@pytest.mark.parametrize("width", [80, 100, 160])
def test_no_figure_unit_or_heading_is_cut_on_any_usual_terminal(width):
    page = printed(rows_table([moment()], "A [title]\nconstructed, not measured"), width)
    for text in (
        "A [title]",
        "20.35 ± 0.22",
        "20.144",
        "+1.04 %",
        "+0.96",
        "[kg m²]",
        "reference",
        "deviation",
        "[b]",
        "resolution",
    ):
        assert text in page, page
    assert "…" not in page
    assert max(map(len, page.splitlines())) <= width


def test_what_makes_a_result_no_measurement_stands_in_another_colour_below_the_title():
    title = rows_table([row()], "Clumod, weighed\nconstructed, not measured").title
    assert isinstance(title, Text)
    assert [(title.plain[span.start : span.end], str(span.style)) for span in title.spans] == [
        ("Clumod, weighed", "bold not italic"),
        ("constructed, not measured", "yellow not italic"),
    ]


def test_a_row_that_is_not_within_stands_out_and_a_budget_prints_its_unit_and_any_name_of_an_input():
    lines = rows_table([row(), row(tolerance=0.2)]).rows
    assert [line.style for line in lines] == ["bold red", None]
    item = Item(name="rope [left] :smile:", value=2.0, tolerance=0.005, contribution=0.051, share=0.054)
    page = printed(budget_table([item], "Tolerance of MoI xx", "kg m²", 1.0), 120)
    assert "[kg m²]" in page
    assert "rope [left] :smile:" in page


def test_a_unit_is_spelt_for_programs_as_a_model_file_spells_it():
    """Effects, rows of measurements and facts of a comparison go into the same programs."""
    from validation.compare.compare import FactComparison
    from validation.effects.catalogue import FAMILIES

    (of_effect,) = {size.unit for size in FAMILIES["air-inertia"].sizes}
    fact = FactComparison(name="a period", unit="kg m²", predicted=1.0, measured=1.0, tolerance=0.1, sigma=0.0, nominal_sigma=0.0)
    assert to_json(moment())["unit"] == to_json(fact)["unit"] == of_effect == "kg m^2"


MASS = Row(quantity="mass", value=47.4, tolerance=0.14, unit="kg", dominated_by="relative error of the balance that weighed it")


@pytest.mark.parametrize(("columns", "width"), [("72", 72), ("", PIPED_WIDTH), ("0", PIPED_WIDTH), ("wide", PIPED_WIDTH)])
@pytest.mark.usefixtures("capsys")
def test_a_pipe_is_as_wide_as_columns_says(columns, width, monkeypatch):
    monkeypatch.setenv("COLUMNS", columns)
    assert page_width() == width


@pytest.mark.parametrize("columns", ["20", "80", "200"])
def test_words_wrap_figures_stay_whole_and_no_line_ends_in_spaces(columns, monkeypatch, capsys):
    monkeypatch.setenv("COLUMNS", columns)
    print_pages([rows_table([MASS], "A [title]\nconstructed, not measured")])
    page = capsys.readouterr().out
    assert "47.40 ± 0.14" in page
    assert "reference" not in page  # of which no row says anything
    assert "…" not in page
    assert max(map(len, page.splitlines())) <= max(80, int(columns))
    assert all(line == line.rstrip() for line in page.splitlines())


def test_a_column_of_figures_is_never_narrower_than_its_figures(monkeypatch, capsys):
    monkeypatch.setenv("COLUMNS", "20")
    table = Table()
    for _ in range(6):
        add_figures(table, "deviation\n/ tolerance", ["-0.00440876", "0.1"])
    table.add_row(*["-0.00440876"] * 6)
    print_pages([table])
    assert capsys.readouterr().out.count("-0.00440876") == 6


@pytest.mark.parametrize("encoding", ["ascii", "utf-8"])
def test_the_line_under_the_title_stands_alone_in_any_encoding(encoding, monkeypatch):
    written = io.BytesIO()
    out = io.TextIOWrapper(written, encoding=encoding, errors="replace")
    monkeypatch.setattr(sys, "stdout", out)
    print_pages([rows_table([MASS], "Weighed\nconstructed, not measured")])
    out.flush()
    assert "constructed, not measured" in written.getvalue().decode("utf-8").splitlines()  # click takes an ASCII stream for UTF-8


@pytest.mark.parametrize(
    ("evidence", "said"),
    [
        *((0.0, "1 to 1"), (1.0, "2.7 to 1"), (3.0, "20 to 1"), (8.0, "3000 to 1"), (12.0, "160,000 to 1")),
        *((-3.0, "1 to 20"), (1084.0, "over a million to 1"), (float("inf"), "over a million to 1")),
    ],
)
def test_evidence_is_said_as_odds(evidence, said):
    assert odds(evidence) == said
