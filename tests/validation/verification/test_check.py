"""What makes a row pass or fail, and how the table prints it."""

import json
import math

import pytest
from rich.console import Console

from validation.output import to_json
from validation.report.flexible import markdown, pages, summary
from validation.verification import check
from validation.verification.check import CheckResult, Error, Found, Mesh, Rows, order, run


def row(reference: float, value: float, bar: float, error: Error = Error.RELATIVE, unit: str = "Hz") -> CheckResult:
    rows = Rows("Bars")
    if error is Error.RELATIVE:
        rows.relative("Cantilever, mode 1", "closed form", unit, bar)(lambda mesh: Found(reference, value))
    else:
        rows.absolute("Cantilever, mode 1", "closed form", bar, unit=unit)(lambda mesh: Found(reference, value))
    return run(rows.checks)[0]


@pytest.mark.parametrize(
    ("result", "passed"),
    [
        (row(100.0, 100.9, 0.01), True),
        (row(100.0, 101.1, 0.01), False),
        (row(-100.0, -101.1, 0.01), False),
        (row(4.0, 3.7, 0.25, Error.ABSOLUTE), False),
        (row(4.0, 3.8, 0.25, Error.ABSOLUTE), True),
        (row(0.0, 2e-12, 1e-12, Error.ABSOLUTE), False),
        (row(6.0, 6.0, 0.0), True),
        (row(6.0, 5.0, 0.0), False),
        (row(1.0, math.nan, 1.0), False),
        (row(math.nan, 1.0, 1.0), False),
        (row(1.0, math.inf, 1.0), False),
    ],
)
def test_a_row_passes_up_to_its_bar_and_never_without_a_number(result, passed):
    assert result.passed is passed
    json.dumps(to_json(result), allow_nan=False)


def test_what_rows_share_is_computed_once_a_run_and_anew_in_the_next():
    calls: list[int] = []

    @check.once
    def shared(number):
        calls.append(number)
        return float(number)

    rows = Rows("")
    for _ in range(3):
        rows.relative("", "", "", 0.0)(lambda mesh: Found(1.0, shared(1)))
    run(rows.checks)
    assert calls == [1]
    run(rows.checks, Mesh.FINE)
    assert calls == [1, 1]


def test_the_observed_order_is_the_slope_of_the_error():
    assert order([1.0, 0.5, 0.25], [-3.0, -3.0 / 16, -3.0 / 256]) == pytest.approx(4, abs=1e-12)


GOLDEN = """\
Bars

 check                    reference        value  error    bar  pass  reference from
 ───────────────────────────────────────────────────────────────────────────────────────────
 Cantilever, mode 1 [Hz]    100.000      101.100  1.1 %    2 %   yes  closed form
 Cantilever, mode 1               4      3.70000    0.3   0.25    NO  closed form
 Cantilever, mode 1               0  2.00000e-16  2e-16  1e-12   yes  closed form
 Cantilever, mode 1 [Hz]    100.000            –      –    1 %    NO  closed form

"""


def results() -> list[CheckResult]:
    return [
        row(100.0 + 1e-9, 101.1, 0.02),
        row(4.0, 3.7, 0.25, Error.ABSOLUTE, unit=""),
        row(0.0, 2e-16, 1e-12, Error.ABSOLUTE, unit=""),
        row(100.0 + 1e-9, math.nan, 0.01),
    ]


def test_the_table_reads_like_this():
    console = Console(width=100, color_system=None, force_terminal=False)
    with console.capture() as capture:
        for page in pages(results()):
            console.print(page)
    assert [line.rstrip() for line in capture.get().splitlines()] == GOLDEN.splitlines()


def test_markdown_holds_the_same_cells_and_the_summary_names_what_fails():
    lines = markdown(results()).splitlines()
    assert lines[0] == "### Bars"
    cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines[4:]]
    assert cells[1] == ["Cantilever, mode 1", "4", "3.70000", "0.3", "0.25", "NO", "closed form"]
    assert summary(results()[::2]) == "All 2 checks pass."
    assert summary(results()).startswith("2 of 4 checks fail: Cantilever, mode 1; ")
