"""What CAD, exudyn, a pendulum and an identification say about one article, in one row each, beside what is in print.

massline simulate fmd+disc+cuboid fmd+clumod-1 --out out/series
massline identify out/series/fmd+clumod-1 --tare out/series/fmd+disc+cuboid --out out/identified
python examples/closure_table.py out/identified/identify.json
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
from rich.console import Console

from geometry.frames import Pose
from geometry.inertia import Inertia
from validation.flexible.model import FlexibleOptions, flexible
from validation.output import NONE, fixed, rounded, shown
from validation.reference.published import published
from validation.reference.reference import ArticleOptions, read_result, reference, route_statement
from validation.reference.statement import QUANTITIES, Stated, Statement
from validation.report.document import Grid, aligned, page

# What CAD, exudyn, a pendulum, identification and print say about one article, in one row each.
#
# CAD is what every other row is held against. The pendulum is swung by exudyn about three axes and reduced like a measured one;
# a row that does not state a quantity leaves its place empty.


CAD = "CAD"

SHOWN = range(7)
"""Mass, CoG and moments: nobody prints products."""

DECIMALS = (3, 2, 2, 2, 4, 4, 4)
"""Of a value that has no interval and was not printed."""

INTERVALS = "95 % intervals"
"""The note of a statement whose tolerances are shown."""

CYCLES, RATE = 3.0, 50.0
"""Of a simulated swing."""


def rows(
    article: str, identified: Mapping[str, Statement], told: Callable[[str], object] = lambda words: None
) -> dict[str, Statement]:
    """Everything that is known about `article`, by the name of its row; `told` hears what is computed now.

    Parameters
    ----------
    identified : by name, in the article's frame

    Raises
    ------
    BadInput : no such built-in article.
    CheckFailed : exudyn failed.
    """
    told("CAD")
    found = {CAD: reference(article, "occ", ArticleOptions(), Pose())[1]}
    told("exudyn's flexible body")
    found["exudyn, flexible body"] = exudyn(article)
    told("pendulum about three axes")
    found["pendulum, swung by exudyn"] = swung(article)
    found |= identified
    for column, said in published(article).statements.items():
        found[f"in print: {column}"] = said
    return found


def exudyn(article: str) -> Statement:
    """The rigid mass of exudyn's own beams."""
    modes = flexible(article, "exudyn", FlexibleOptions(count=1)).modes
    body = Inertia.from_mass_matrix(np.asarray((modes.rigid_mass + modes.rigid_mass.T) / 2), modes.reference_point)
    return route_statement("exudyn", body.about(np.zeros(3)))


def swung(article: str) -> Statement:
    """Moments of inertia from three swings on three ropes, simulated, recorded and reduced; nothing else is known from them."""
    from validation.classical.swing import OPTIONS, Words, recorded, setup

    moments: list[Stated | None] = []
    for axis in "xyz":
        texts = {**dict.fromkeys(OPTIONS), "length": "2 m", "amplitude": "0.1 rad"}
        words = Words(
            texts=texts,
            ropes=None,
            axis=axis,
            along=None,
            off_centre=None,
            links=None,
            start="twist",
            cycles=CYCLES,
            rate=RATE,
            seed=0,
        )
        moments.append(Stated(value=recorded(setup(article, words, ArticleOptions())).corrected))
    return Statement(name="pendulum", values=(None, None, None, None, *moments, None, None, None), source="massline swing")


def grids(found: Mapping[str, Statement]) -> tuple[Grid, Grid]:
    """The values, and how far each row lies from CAD: in per cent, of the CoG in millimetres."""
    return _grid("", found, _value), _grid(
        "from CAD", {name: said for name, said in found.items() if name != CAD}, _from(found[CAD])
    )


def _grid(head: str, found: Mapping[str, Statement], cell: Callable[[Statement, int], str]) -> Grid:
    columns = [aligned(tuple(cell(said, k) for said in found.values())) for k in SHOWN]
    header = (head, *(f"{QUANTITIES[k].label.split()[-1]} [{QUANTITIES[k].unit}]" for k in SHOWN))
    if head:
        header = (head, *(f"{QUANTITIES[k].label.split()[-1]} [{'mm' if 1 <= k <= 3 else '%'}]" for k in SHOWN))
    return Grid(header=header, lines=tuple(zip(found, *columns, strict=True)))


def _value(said: Statement, k: int) -> str:
    stated = said.values[k]
    if stated is None:
        return NONE
    scale = QUANTITIES[k].per_si
    tolerance = (stated.tolerance or 0.0) * scale
    if tolerance and said.tolerance_note == INTERVALS:
        return f"{rounded(stated.value * scale, tolerance)} ± {rounded(tolerance, tolerance)}"
    return fixed(stated.value * scale, DECIMALS[k] if stated.decimals is None else stated.decimals)


def _from(cad: Statement) -> Callable[[Statement, int], str]:
    def cell(said: Statement, k: int) -> str:
        stated, known = said.values[k], cad.values[k]
        if stated is None or known is None:
            return NONE
        apart = stated.value - known.value
        shown = 1e3 * apart if 1 <= k <= 3 else 100 * apart / known.value
        return f"{round(shown, 2) + 0.0:+.2f}"

    return cell


def notes() -> tuple[str, ...]:
    """What must be known to read the table."""
    return (
        "CoG from the article's origin; moments about the CoG. Identified values with their 95 % intervals.",
        f"Pendulum: three ropes of 2 m, 0.1 rad, {CYCLES:g} cycles, corrected; it weighs nothing and finds no CoG.",
    )


def main(console: Console, path: str) -> None:
    """The table of the article that the identification in the file `path` is about."""
    article = json.loads(Path(path).read_text(encoding="utf-8"))["article"]
    identified = {
        f"identified, {way}": read_result(path, article=article, way=way).statement for way in ("plain", "self-calibrated")
    }
    with shown(f"CAD, exudyn and pendulum of {article}"):
        found = rows(article, identified)
    text = page(f"{article}: closure", grids(found), notes(), console.width)
    console.print(text, markup=False, highlight=False)


if __name__ == "__main__":
    main(Console(), sys.argv[1] if len(sys.argv) > 1 else "out/identified/identify.json")
