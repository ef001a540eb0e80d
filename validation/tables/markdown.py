"""A reference table in Markdown (pipe tables), padded so that its source reads as a table too."""

from __future__ import annotations

import re

from validation.reference_table import ReferenceTable
from validation.tables.grid import Grid, grids, notes


def render(table: ReferenceTable) -> str:
    """`table` as a section of a Markdown page."""
    shown = "\n\n".join(pipes(grid) for grid in grids(table))
    listed = "\n".join(f"- {escaped(note)}" for note in notes(table))
    return f"### {escaped(table.article)}\n\n{shown}\n\n{listed}\n"


def escaped(text: str) -> str:
    """`text` with what Markdown would read as a link, emphasis, HTML or the border of a cell spelled out."""
    return re.sub(r"([\\`*<|\[\]]|(?<!\w)_|_(?!\w))", r"\\\1", text)


def pipes(grid: Grid) -> str:
    """`grid` as one pipe table."""
    header = tuple(map(escaped, grid.header))
    columns = list(zip(header, *grid.lines, strict=True))
    widths = [max(3, *(len(cell) for cell in column)) for column in columns]
    left = {0, len(grid.header) - 1} if grid.words else {0}
    rule = [":" + "-" * (w - 1) if k in left else "-" * (w - 1) + ":" for k, w in enumerate(widths)]
    lines = [header, tuple(rule), *grid.lines]
    return "\n".join(_line(line, widths, left) for line in lines)


def _line(cells: tuple[str, ...], widths: list[int], left: set[int]) -> str:
    padded = (f"{cell:<{w}}" if k in left else f"{cell:>{w}}" for k, (cell, w) in enumerate(zip(cells, widths, strict=True)))
    return "| " + " | ".join(padded) + " |"
