"""The verification table to print: one page a family, errors beside their bars."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import TYPE_CHECKING

from validation.rows import NONE
from validation.verification.check import Error, Result

if TYPE_CHECKING:
    from rich.table import Table

DIGITS = 6
FIGURES = ("reference", "value", "error", "bar")


def pages(results: Sequence[Result]) -> Iterator[Table]:
    """A table for every family, in order."""
    for family, rows in groupby(results, key=lambda result: result.check.family):
        yield _table(family, list(rows))


def _table(family: str, results: list[Result]) -> Table:
    from rich import box
    from rich.table import Table
    from rich.text import Text

    from validation.rows import add_figures, headline

    table = Table(title=headline(family), title_justify="left", box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0), pad_edge=False)
    lines = [cells(result) for result in results]
    table.add_column("check", min_width=24)
    for heading, column in zip(FIGURES, list(zip(*lines, strict=True))[1:5], strict=True):
        add_figures(table, heading, column)
    table.add_column("pass", no_wrap=True)
    table.add_column("reference from", min_width=20)
    for result, line in zip(results, lines, strict=True):
        table.add_row(*(Text(cell) for cell in line), style=None if result.passed else "bold red")
    return table


def cells(result: Result) -> tuple[str, ...]:
    """A row as text: check, reference, value, error, bar, pass, source."""
    check = result.check
    what = f"{check.what} [{check.unit}]" if check.unit else check.what
    relative = check.error is Error.RELATIVE and result.found.reference != 0
    return (
        what,
        number(result.found.reference),
        number(result.found.value),
        small(result.error, relative),
        small(check.bar, relative),
        "yes" if result.passed else "NO",
        check.source,
    )


def number(value: float) -> str:
    """Six significant digits, with an exponent where zeros would have to be counted."""
    return NONE if value != value else f"{value:.{DIGITS}g}"


def small(error: float, relative: bool) -> str:
    """An error with two digits: relative ones in per cent unless they are tiny."""
    if error == 0:
        return "0"
    if relative and error >= 1e-6:
        return f"{100 * error:.2g} %"
    return f"{error:.2g}"


def summary(results: Sequence[Result]) -> str:
    """How many checks passed, and the names of those that did not."""
    failed = [result.check.what for result in results if not result.passed]
    if not failed:
        return f"All {len(results)} checks pass."
    return f"{len(failed)} of {len(results)} checks fail: {'; '.join(failed)}."
