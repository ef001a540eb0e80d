"""A reference table for a terminal, by rich."""

from __future__ import annotations

from typing import TYPE_CHECKING

from validation.reference_table import ReferenceTable
from validation.tables.grid import Grid, grids, notes

if TYPE_CHECKING:
    from rich.table import Table


WIDTH = 132
"""Columns; a table is never cut, since that would lose digits, only its words wrap."""


def render(table: ReferenceTable, width: int = WIDTH) -> str:
    """`table` as plain text of `width` columns."""
    from rich.console import Console
    from rich.padding import Padding
    from rich.text import Text

    console = Console(width=width, color_system=None, force_terminal=False)
    with console.capture() as capture:
        console.print(Text(table.article))
        for grid in grids(table):
            console.print(_table(grid))
        for note in notes(table):
            console.print(Padding(Text(note), (0, 0, 0, 2)))
    return "\n".join(line.rstrip() for line in capture.get().splitlines()) + "\n"


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
