"""What CAD, exudyn, a pendulum and an identification say about one article, in one row each, beside what is in print.

massline simulate fmd+disc+cuboid fmd+clumod-1 --out out/series
massline identify out/series/fmd+clumod-1 --tare out/series/fmd+disc+cuboid --out out/identified
python examples/closure_table.py out/identified/identify.json
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

from rich.console import Console

from validation.output import shown
from validation.reference.reference import read_result
from validation.report import identify
from validation.report.document import page


def main(console: Console, path: str) -> None:
    """The table of the article that the identification in the file `path` is about."""
    article = json.loads(Path(path).read_text(encoding="utf-8"))["article"]
    identified = {
        f"identified, {way}": read_result(path, article=article, way=way).statement for way in ("plain", "self-calibrated")
    }
    with shown(f"CAD, exudyn and pendulum of {article}"):
        found = identify.rows(article, identified)
    text = page(f"{article}: closure", identify.grids(found), identify.notes(), console.width)
    console.print(text, markup=False, highlight=False)


if __name__ == "__main__":
    main(Console(), sys.argv[1] if len(sys.argv) > 1 else "out/identified/identify.json")
