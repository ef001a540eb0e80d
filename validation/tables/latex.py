"""A reference table in LaTeX: plain `tabular` with `\\hline`, no package needed; decimal points line up by phantoms."""

from __future__ import annotations

import re

from validation.reference_table import ReferenceTable
from validation.tables.grid import Grid, grids, notes

_SPECIAL = {
    "\\": r"\textbackslash{}",
    **{c: rf"\{c}" for c in "&%$#_{}"},
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
    "Θ": r"$\Theta$",
    "²": r"$^2$",
    "³": r"$^3$",
    "±": r"$\pm$",
    "–": "--",
    "×": r"$\times$",
    "∫": r"$\int$",
    "·": r"$\cdot$",
    "°": r"$^\circ$",
    "µ": r"$\mu$",
}


def render(table: ReferenceTable) -> str:
    """`table` as a LaTeX `table` environment, to be put into any document class."""
    shown = "\n\\par\\medskip\n".join(_grid(grid) for grid in grids(table))
    listed = "\n".join(rf"\item {escaped(note)}" for note in notes(table))
    return (
        "\\begin{table}[htb]\n\\centering\\footnotesize\n"
        f"\\caption{{Inertia parameters of {escaped(table.article)}}}\n"
        f"{shown}\n\\begin{{itemize}}\n{listed}\n\\end{{itemize}}\n\\end{{table}}\n"
    )


def document(tables: list[str]) -> str:
    """A document that holds the rendered `tables` and compiles as it is."""
    head = "\\documentclass{article}\n\\usepackage[utf8]{inputenc}\n\\usepackage[landscape,margin=15mm]{geometry}\n"
    return head + "\\begin{document}\n" + "\n".join(tables) + "\\end{document}\n"


def escaped(text: str) -> str:
    """`text` with every character that LaTeX reads as a command, or may not know, spelled out."""
    return "".join(_SPECIAL.get(character, character) for character in text)


def _grid(grid: Grid) -> str:
    left = {0, len(grid.header) - 1} if grid.words else {0}
    form = "".join("l" if k in left else "r" for k in range(len(grid.header)))
    lines = [" & ".join(_cell(cell) for cell in line) + r" \\" for line in (grid.header, *grid.lines)]
    body = "\n".join([lines[0], r"\hline", *lines[1:]])
    return f"\\begin{{tabular}}{{{form}}}\n\\hline\n{body}\n\\hline\n\\end{{tabular}}"


def _cell(cell: str) -> str:
    """A cell with the spaces that align it turned into phantoms of a digit's width."""
    text = cell.rstrip()
    padding = len(cell) - len(text)
    phantom = rf"\phantom{{{'0' * padding}}}" if padding else ""
    return escaped(re.sub(r"^\s+", "", text)) + phantom
