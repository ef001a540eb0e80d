"""Makes ``drawing/limits.json``: ``python -m benchmarks.blind.limits [NULLS]``, by default of nine development nulls.

A diagnosis of a series in which nothing is missing says of every effect at which size it would have been named. The limit is the
median over the nulls in which the effect can act: for most those with one blade, for parts that only four blades have those with
four. An effect of which no null says anything keeps the limit that it had. A new limit is another draw.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterable, Sequence
from statistics import median

from rich.console import Console

from benchmarks.blind import ledger
from benchmarks.blind.drawing import limits
from benchmarks.blind.drawing.case import NULL, SERIES
from benchmarks.blind.drawing.choices import CHOICES
from benchmarks.blind.drawing.draw import draw
from benchmarks.blind.keeping import Kept, present_code
from benchmarks.blind.names import Json
from benchmarks.blind.running import finished
from geometry.atomic import write_text

COMMAND = "python -m benchmarks.blind.limits"

DIGITS = 3


def of_nulls(pairs: Sequence[tuple[Json, Json]]) -> dict[str, float]:
    """By id, of truths and answers of nulls."""
    found = {}
    for choice in CHOICES:
        for id in () if choice.words else choice.ids:
            sizes = [
                size for truth, answer in pairs if tuple(truth["articles"]) == choice.articles for size in _sizes(id, answer)
            ]
            if sizes:
                found[id] = float(f"{median(sizes):.{DIGITS}g}")
    return found


def _sizes(id: str, answer: Json) -> Iterable[float]:
    """Of `id` in one answer."""
    return [one["size"] for one in answer.get("detectable", ()) if one["id"] == id and one["size"] is not None]


def text(found: dict[str, float]) -> str:
    """The file."""
    return json.dumps({"made_by": COMMAND, "limits": dict(sorted(found.items()))}, indent=1) + "\n"


def main(count: int = 9) -> int:
    """Diagnose `count` nulls of each series where that has not been done, and write the limits."""
    console, seed = Console(stderr=True), ledger.read().development[0]
    nulls = draw(seed, (NULL,))
    plain = [one for one in nulls if one.articles == SERIES][:count]
    whole = [one for one in nulls if one.articles != SERIES][: (count + 2) // 3]
    kept = Kept(seed=seed, code=present_code())
    for number, _ in enumerate(finished((*plain, *whole), kept, 1), start=1):
        console.print(f"{number} of {len(plain) + len(whole)}", style="dim")
    found = of_nulls([kept.pair(one.name) for one in (*plain, *whole)])
    write_text(limits.FILE, text({**limits.found(), **found}))
    console.print(f"{len(found)} limits of {len(limits.found())} in {limits.FILE.name} are new")
    return 0


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:])))
