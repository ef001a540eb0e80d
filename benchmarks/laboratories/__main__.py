"""How many sound laboratories are said to be sound: ``python -m benchmarks.laboratories --count 8 --sheet calibrated``."""

from __future__ import annotations

import json
import time
from collections import Counter
from pathlib import Path
from typing import Any

import click
import numpy as np

from benchmarks.laboratories.shaking import SOUND, STIFFNESS, Faults, series
from geometry.errors import BadInput, CheckFailed
from validation.diagnose.diagnose import diagnosed
from validation.model import model_file
from validation.study import Data, Study

ARTICLES = ("fmd+disc+cuboid", "fmd+clumod-1")

MODEL = """
format = 1
model = {{ title = "drawn", article = "fmd+clumod-1" }}
laboratory = {{ cell_stiffness_N_m = {stiffness}, fmd = {{ inertia = "drawing", tolerance = 0.04 }} }}
{tolerances}
structure = {{ kind = "beam" }}
"""


def analyst(name: str) -> str:
    """The model file of an analyst who states the class `name`; none states nothing."""
    said = f'tolerances = {{ class = "{name}" }}' if name else ""
    return MODEL.format(stiffness=list(STIFFNESS), tolerances=said)


KINDS = {"gain": "gain", "delay": "late", "position": "place", "mass": "mass"}
"""Which of `Faults` a family of the catalogue is, by the last word of its name."""


def of_text(text: str) -> Faults:
    """``force-gain:fmd-z2=0.05``, ``accelerometer-position:cover-x1:y=0.003``, ``point-mass:top=0.2``; nothing for a null."""
    if not text:
        return SOUND
    what, _, size = text.partition("=")
    family, target, *axis = what.split(":")
    value = np.eye(3)["xyz".index(axis[0])] * float(size) if axis else float(size)
    kind = KINDS[family.rpartition("-")[2]]
    return Faults(**{key: {target: value} if key == kind else {} for key in KINDS.values()})  # type: ignore[arg-type]


@click.command()
@click.option("--count", default=8, show_default=True, help="Laboratories.")
@click.option("--first", default=1, show_default=True, help="Number of the first.")
@click.option("--sheet", default="calibrated", show_default=True, help="Class that they are drawn from.")
@click.option("--class", "stated", default="", help="Class that the analyst states; none by default.")
@click.option("--fault", default="", help="What is planted, such as force-gain:fmd-z2=0.05; nothing by default.")
@click.option("--times", default=0.0, help="Plant so many times the smallest size that its null would have named.")
@click.option("--article", "articles", multiple=True, default=ARTICLES, show_default=True, help="Of the series.")
@click.option("--out", type=click.Path(path_type=Path), default=None, help="A line of JSON for every laboratory is added here.")
def main(
    count: int, first: int, sheet: str, stated: str, fault: str, times: float, articles: tuple[str, ...], out: Path | None
) -> None:
    """Draw laboratories, diagnose them, and count verdicts."""
    model, told = model_file.of_text(analyst(stated), "drawn.toml"), []
    for number in range(first, first + count):
        planted = fault
        if times:
            null = diagnosed(Study.of(model, Data(campaigns=series(number, articles, sheet))))
            planted = f"{fault}={times * next(one.size for one in null.detectable if one.id == fault):.5g}"
        line: dict[str, Any] = {"sheet": sheet, "laboratory": number, "stated": stated, "fault": planted, "times": times}
        begun = time.process_time()
        try:
            found = diagnosed(Study.of(model, Data(campaigns=series(number, articles, sheet, of_text(planted)))))
            line |= {"verdict": found.verdict, "text": found.text, "class": found.equivalence_class}
            line["named"] = [f"{one.id} {one.sizes[0].value if one.sizes else 0:.4g}" for one in found.accepted]
            line["misfit_and_limit"] = (found.steps[-1].misfit, found.settings["misfit_limit"]) if found.steps else None
        except (BadInput, CheckFailed) as error:  # a refusal is an answer that counts
            line |= {"verdict": "refused", "text": str(error), "named": []}
        told.append(line["verdict"])
        took = time.process_time() - begun
        click.echo(
            f"{sheet} {number:3d} {planted} {line['verdict']}: {', '.join(line['named'])} {line['text'][:160]} ({took:.0f} s)"
        )
        if out is not None:
            with out.open("a", encoding="utf-8") as file:
                file.write(json.dumps(line) + "\n")
    click.echo(", ".join(f"{n} {verdict}" for verdict, n in Counter(told).items()))


if __name__ == "__main__":
    main()
