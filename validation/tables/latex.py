"""A reference table in LaTeX: plain `tabular` with `\\hline`, no package needed.

A column of figures is two of LaTeX's that meet at the decimal point, so that the points stand below each other in any font.
"""

from __future__ import annotations

import re
import unicodedata

from validation.reference_table import ReferenceTable
from validation.tables.grid import Grid, at_point, grids, notes

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
    **{c: f"${c}$" for c in "<>|"},  # the first fonts of TeX have other signs in their places
    "−": "$-$",
    "…": r"\dots{}",
    "≤": r"$\le$",
    "≥": r"$\ge$",
    "→": r"$\to$",
    **dict.fromkeys("’‘", "'"),
}

_WESTERN = frozenset(map(chr, range(0xC0, 0x100))) - frozenset("ÐðÞþ÷")
"""Letters with accents that TeX's first fonts can set."""


def render(table: ReferenceTable) -> str:
    """`table` as a LaTeX `table` environment, to be put into any document class."""
    shown = "\n\\par\\medskip\n".join(_grid(grid) for grid in grids(table))
    listed = "\n".join(rf"\item {escaped(note)}" for note in notes(table))
    return (
        "\\begin{table}[htb]\n\\centering\\footnotesize\\renewcommand{\\arraystretch}{1.15}\n"
        f"\\caption{{Inertia parameters of {escaped(table.article)}}}\n\\smallskip\n"
        f"{shown}\n\\begin{{itemize}}\n{listed}\n\\end{{itemize}}\n\\end{{table}}\n"
    )


def document(tables: list[str]) -> str:
    """A document that holds the rendered `tables` and compiles as it is."""
    head = "\\documentclass{article}\n\\usepackage[utf8]{inputenc}\n\\usepackage[landscape,margin=15mm]{geometry}\n"
    return head + "\\begin{document}\n" + "\n".join(tables) + "\\end{document}\n"


def escaped(text: str) -> str:
    """`text` with every character that LaTeX reads as a command, or may not know, spelled out; signs as mathematics."""
    spelled = "".join(_SPECIAL.get(character) or _known(character) for character in text)
    indexed = re.sub(r"\$\\Theta\$([xyz]{2})\b", r"$\\Theta_{\1}$", spelled)
    return re.sub(r"(?<![\w.])-(?=\.?\d|\$>)", "$-$", indexed)


def _known(character: str) -> str:
    """`character` where every LaTeX has it, else its nearest letter or, of other scripts, its number."""
    if character.isascii() or character in _WESTERN:
        return character
    plain = unicodedata.normalize("NFKD", character).encode("ascii", "ignore").decode()
    return plain or f"U+{ord(character):04X}"


def _grid(grid: Grid) -> str:
    left = {0, len(grid.header) - 1} if grid.words else {0}
    form = "".join("l" if k in left else "r@{}l" for k in range(len(grid.header)))
    header = " & ".join(escaped(cell) if k in left else _over_two(cell) for k, cell in enumerate(grid.header))
    lines = [" & ".join(_cell(cell, k in left) for k, cell in enumerate(line)) for line in grid.lines]
    body = "".join(rf"{line} \\" + "\n" for line in lines)
    return f"\\begin{{tabular}}{{{form}}}\n\\hline\n{header} \\\\\n\\hline\n{body}\\hline\n\\end{{tabular}}"


def _over_two(heading: str) -> str:
    return rf"\multicolumn{{2}}{{c}}{{{escaped(heading)}}}"


def _cell(cell: str, words: bool) -> str:
    """Words as they are; a figure as two cells, before and from its decimal point."""
    return escaped(cell.strip()) if words else " & ".join(escaped(part) for part in at_point(cell.strip()))
