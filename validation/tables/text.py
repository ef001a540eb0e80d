"""A reference table for a terminal, by rich."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from validation.output import PIPED_WIDTH, page_width
from validation.reference_table import ReferenceTable
from validation.tables.grid import Grid, grids, notes

if TYPE_CHECKING:
    from rich.table import Table


WIDTH = PIPED_WIDTH
"""Columns of a table in a file."""

VERDICT = 24
"""Columns below which words are not squeezed."""

GAP = 3
"""Columns between two columns of a table."""


def render(table: ReferenceTable, width: int | None = None) -> str:
    """`table` as plain text of `width` columns; None is `page_width`.

    No figure is cut or broken: words wrap, and a table that is still too wide is continued below itself.
    """
    return page(table.article, grids(table), notes(table), width)


def page(
    title: str, grids: Iterable[Grid], notes: Iterable[str] = (), width: int | None = None, opening: Iterable[str] = ()
) -> str:
    """A title, the paragraphs of its `opening`, tables and the notes below them as plain text of `width` columns.

    None is `page_width`.
    """
    from rich.console import Console
    from rich.padding import Padding
    from rich.text import Text

    console = Console(width=width or page_width(), color_system=None, force_terminal=False)
    with console.capture() as capture:
        console.print(Text(title), Text("═" * min(len(title), console.width)), sep="\n")
        for paragraph in opening:
            console.print(Text(), Text(paragraph), sep="\n")
        for grid in grids:
            for part in parts(grid, console.width):
                console.print(_table(part))
        for note in notes:
            console.print(Padding(Text(note), (0, 0, 0, 2)))
    return "\n".join(line.rstrip() for line in capture.get().splitlines()) + "\n"


def parts(grid: Grid, width: int) -> list[Grid]:
    """`grid` side by side in pieces of at most `width` columns, each with the first column of `grid`.

    A piece holds at least one column more, however narrow the terminal. Columns of a pair stay together: a deviation and the same
    in tolerances.
    """
    columns = list(zip(grid.header, *grid.lines, strict=True))
    label, rest = columns[0], columns[1:]
    step = 2 if grid.words else 1
    groups = [rest[i : i + step] for i in range(0, len(rest), step)]
    pieces = [[groups[0]]]
    for group in groups[1:]:
        tried = [label, *(column for one in (*pieces[-1], group) for column in one)]
        if _width(tried, grid.words and group is groups[-1]) <= width:
            pieces[-1].append(group)
        else:
            pieces.append([group])
    return [_piece([label, *(c for group in piece for c in group)], grid.words and piece is pieces[-1]) for piece in pieces]


def _width(columns: list[tuple[str, ...]], words: bool) -> int:
    """Columns that a table of `columns` needs, with the verdict at its narrowest."""
    widths = [max(map(len, column)) for column in columns]
    if words:
        widths[-1] = min(widths[-1], VERDICT)
    return sum(widths) + GAP * (len(widths) - 1) + 2


def _piece(columns: list[tuple[str, ...]], words: bool) -> Grid:
    header, *lines = zip(*columns, strict=True)
    return Grid(header=header, lines=tuple(lines), words=words)


def _table(grid: Grid) -> Table:
    from rich import box
    from rich.table import Table
    from rich.text import Text

    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    left = {0, len(grid.header) - 1} if grid.words else {0}
    columns = []
    for k, column in enumerate(zip(grid.header, *grid.lines, strict=True)):
        # Padded here: rich strips what it justifies to the right, and with it the spaces that line the decimal points up.
        width = 0 if k in left else max(len(cell) for cell in column)
        columns.append([f"{cell:>{width}}" for cell in column])
        table.add_column(Text(columns[k][0]), no_wrap=k == 0 or k not in left)
    for line in list(zip(*columns, strict=True))[1:]:
        table.add_row(*(Text(cell) for cell in line))
    return table
