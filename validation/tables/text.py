"""A reference table for a terminal, by rich."""

from __future__ import annotations

from typing import TYPE_CHECKING

from validation.reference_table import ReferenceTable
from validation.tables.grid import Grid, grids, notes

if TYPE_CHECKING:
    from rich.table import Table


def render(table: ReferenceTable, width: int = 160) -> str:
    """`table` as plain text of at most `width` columns."""
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
    for k, heading in enumerate(grid.header):
        in_words = grid.words and k == len(grid.header) - 1
        table.add_column(Text(heading), justify="left" if k == 0 or in_words else "right", no_wrap=not in_words)
    for line in grid.lines:
        table.add_row(*(Text(cell) for cell in line))
    return table
