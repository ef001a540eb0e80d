"""The verification table to print: one page a family, errors beside their bars."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import TYPE_CHECKING

from validation.rows import LARGE, NONE
from validation.verification.check import Error, Result

if TYPE_CHECKING:
    from rich.table import Table

DIGITS = 6

WORDS = 22
"""Columns below which words are not squeezed."""

CHECK, SOURCE = "check", "reference from"
FIGURES = ("reference", "value", "error", "bar", "pass")


def pages(results: Sequence[Result]) -> Iterator[Table]:
    """A table for every family, in order."""
    for family, rows in _by_family(results):
        yield _table(family, rows)


def markdown(results: Sequence[Result]) -> str:
    """The same in Markdown, every family a section."""
    from validation.tables.grid import Grid
    from validation.tables.markdown import pipes

    header = (CHECK, *FIGURES, SOURCE)
    grids = [(family, Grid(header=header, lines=tuple(map(cells, rows)), words=True)) for family, rows in _by_family(results)]
    return "\n\n".join(f"### {family}\n\n{pipes(grid)}" for family, grid in grids)


def _by_family(results: Sequence[Result]) -> Iterator[tuple[str, list[Result]]]:
    for family, rows in groupby(results, key=lambda result: result.check.family):
        yield family, list(rows)


def _table(family: str, results: list[Result]) -> Table:
    from rich import box
    from rich.table import Table
    from rich.text import Text

    from validation.rows import add_figures, headline

    table = Table(title=headline(family), title_justify="left", box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0), pad_edge=False)
    lines = [cells(result) for result in results]
    table.add_column(CHECK, min_width=WORDS)
    for heading, column in zip(FIGURES, list(zip(*lines, strict=True))[1:-1], strict=True):
        add_figures(table, heading, column)
    table.add_column(SOURCE, min_width=WORDS)
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
    """Six significant digits, whole numbers as they are."""
    if not math.isfinite(value):
        return NONE
    return f"{value:g}" if value == round(value) and abs(value) < LARGE else f"{value:#.{DIGITS}g}"


def small(error: float, relative: bool) -> str:
    """An error with two digits, a relative one in per cent."""
    if not math.isfinite(error):
        return NONE
    return f"{100 * error:.2g} %" if relative and error else f"{error:.2g}"


def summary(results: Sequence[Result]) -> str:
    """How many checks passed, and the names of those that did not."""
    failed = [result.check.what for result in results if not result.passed]
    if not failed:
        return f"All {len(results)} checks pass."
    return f"{len(failed)} of {len(results)} checks fail: {'; '.join(failed)}."
