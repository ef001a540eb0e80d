"""The score in ``docs/diagnosis-proven-blind.md``, between two markers; what only this machine knows stays out of it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from benchmarks.blind.score.families import OfFamily
from benchmarks.blind.score.printed import HEADS, cells, verdict
from benchmarks.blind.score.rows import Row
from geometry.atomic import write_text

PAGE = Path("docs/diagnosis-proven-blind.md")

BEGIN, END = "<!-- score: begin -->", "<!-- score: end -->"


def text(found: Sequence[Row], families: Sequence[OfFamily], heading: str) -> str:
    """Both tables as Markdown."""
    bars = [(row.what, row.figure, row.bar, verdict(row)) for row in found if not row.private]
    return "\n\n".join((heading, _table(("measure", "figure", "bar", ""), bars), _table(HEADS, [cells(one) for one in families])))


def _table(heads: Sequence[str], lines: Sequence[Sequence[str]]) -> str:
    written = [f"| {' | '.join(cells)} |" for cells in (heads, ["---"] * len(heads), *lines)]
    return "\n".join(written)


def write(score: str, file: Path = PAGE) -> None:
    """`score` in the place of the one that is in `file`.

    Raises
    ------
    ValueError : the markers are not there.
    """
    page = file.read_text(encoding="utf-8")
    before, begin, rest = page.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not (begin and end):
        raise ValueError(f"`{file}` must hold {BEGIN} and {END}: put them where the score belongs")
    write_text(file, f"{before}{BEGIN}\n{score}\n{END}{after}")
