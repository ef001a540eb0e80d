"""Tables as pages have them: one number a cell, its unit in the head, and every digit of it for a spreadsheet.

A cell shows the digits that mean something. Copied, a table gives all digits, tab-separated, which a spreadsheet takes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite

from validation.report.markup import Safe, joined, tag, worded
from validation.rows import NONE, rounded
from validation.tables.grid import Grid


@dataclass(frozen=True, kw_only=True)
class Column:
    """One column.

    Attributes
    ----------
    head : its name
    unit : of its numbers; empty where they have none
    words : whether it is read from the left, as words are
    """

    head: str
    unit: str = ""
    words: bool = False


@dataclass(frozen=True, kw_only=True)
class Number:
    """One number of a cell.

    Attributes
    ----------
    value : with all its digits; None where there is none
    text : as it is shown
    """

    value: float | None
    text: str


Cell = Number | str
"""What stands in a cell; a text may be `Safe`."""

WHOLE = 16
"""Rows up to which a table stays on one sheet of paper."""

SHORT, TINY = 24, 8
"""Letters of a text that is not broken on a screen, and of one that is not broken on paper either."""

NOTHING = Number(value=None, text=NONE)


def number(value: float | None, form: str = ".4g") -> Number:
    """`value` shown in the form `form`."""
    if value is None or not isfinite(value):
        return NOTHING
    return Number(value=value, text=format(value, form).replace("-", "−"))


def toleranced(value: float | None, tolerance: float | None) -> Number:
    """`value` shown with the digits that `tolerance` leaves it."""
    if value is None or not isfinite(value):
        return NOTHING
    return Number(value=value, text=rounded(value, tolerance).replace("-", "−"))


def table(caption: str, columns: Sequence[Column], rows: Sequence[Sequence[Cell]], *, note: str = "") -> Safe:
    """A table under its `caption`, with a button that copies it; nothing where it has no rows."""
    if not rows:
        return Safe("")
    head = tag("tr", *(_head(column) for column in columns))
    body = joined(
        *(tag("tr", *(_cell(column, cell, k == 0) for k, (column, cell) in enumerate(_paired(columns, row)))) for row in rows)
    )
    button = tag(
        "button",
        "copy",
        type="button",
        class_="copy",
        title="Copy the table for a spreadsheet",
        aria_label=f"Copy the table: {caption}",
    )
    named = tag("caption", tag("span", caption), button)
    inner = tag("table", named, tag("thead", head), tag("tbody", body))
    below = tag("p", worded(note), class_="note") if note else None
    kind = "table whole" if len(rows) <= WHOLE else "table"
    return tag("div", tag("div", inner, class_="scroll", tabindex="0", role="region", aria_label=caption), below, class_=kind)


def of_grid(caption: str, grid: Grid, *, note: str = "") -> Safe:
    """A table of words as the command line prints it."""
    last = len(grid.header) - 1
    columns = [Column(head=head, words=k == 0 or (grid.words and k == last)) for k, head in enumerate(grid.header)]
    return table(caption, columns, [[cell.strip() for cell in line] for line in grid.lines], note=note)


def _paired(columns: Sequence[Column], row: Sequence[Cell]) -> list[tuple[Column, Cell]]:
    return list(zip(columns, row, strict=True))


def _head(column: Column) -> Safe:
    unit = tag("span", f" [{column.unit}]", class_="unit") if column.unit else None
    return tag("th", column.head, unit, scope="col", class_="words" if column.words else None)


def _cell(column: Column, cell: Cell, first: bool) -> Safe:
    name, scope = ("th", "row") if first else ("td", None)
    if isinstance(cell, Number):
        value = "" if cell.value is None else repr(float(cell.value))
        return tag(name, cell.text, class_="words" if column.words else None, data_value=value, scope=scope)
    kind = "words" if isinstance(cell, Safe) else f"words{_length(cell)}"
    return tag(name, worded(cell), class_=kind if column.words else None, scope=scope)


def _length(cell: str) -> str:
    return " short tiny" if len(cell) <= TINY else " short" if len(cell) <= SHORT else ""
