"""The scores in ``docs/diagnosis-proven-blind.md``, each between two markers; what only this machine knows stays out of them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from benchmarks.blind.score.families import OfFamily
from benchmarks.blind.score.printed import GROUP_HEADS, HEADS, cells, verdict
from benchmarks.blind.score.rates import Rate
from benchmarks.blind.score.rows import Row
from geometry.atomic import write_text

PAGE = Path("docs/diagnosis-proven-blind.md")

SCORE, STRUCTURES = "score", "structures"
"""Names of the markers: of Clumod's series, and of random structures."""


def text(found: Sequence[Row], families: Sequence[OfFamily], heading: str) -> str:
    """Both tables as Markdown."""
    return "\n\n".join((heading, _bars(found), _table(HEADS, [cells(one) for one in families])))


def text_of_structures(found: Sequence[Row], groups: Sequence[tuple[str, Rate, Rate]], heading: str) -> str:
    """The same of random structures, with one row a kind of structure, a kind of effect and a size."""
    lines = [(name, str(right), str(wrong)) for name, right, wrong in groups]
    return "\n\n".join((heading, _bars(found), _table(GROUP_HEADS, lines)))


def _bars(found: Sequence[Row]) -> str:
    lines = [(row.what, row.figure, row.bar, verdict(row)) for row in found if not row.private]
    return _table(("measure", "figure", "bar", ""), lines)


def _table(heads: Sequence[str], lines: Sequence[Sequence[str]]) -> str:
    written = [f"| {' | '.join(cells)} |" for cells in (heads, ["---"] * len(heads), *lines)]
    return "\n".join(written)


def write(score: str, file: Path = PAGE, which: str = SCORE) -> None:
    """`score` in the place of the one that is in `file`, between the markers `which`.

    Raises
    ------
    ValueError : the markers are not there.
    """
    begin, end = (f"<!-- {which}: {side} -->" for side in ("begin", "end"))
    before, found, rest = file.read_text(encoding="utf-8").partition(begin)
    _, closed, after = rest.partition(end)
    if not (found and closed):
        raise ValueError(f"`{file}` must hold {begin} and {end}: put them where the score belongs")
    write_text(file, f"{before}{begin}\n{score}\n{end}{after}")
