"""How many sound laboratories are said to be sound: ``python -m benchmarks.laboratories --count 8 --sheet calibrated``."""

from __future__ import annotations

import json
import time
from pathlib import Path

import click
import numpy as np

from benchmarks.laboratories.shaking import SOUND, STIFFNESS, Faults, series
from validation.diagnose.diagnose import diagnosed
from validation.diagnose.diagnosis import NOTHING
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


def of_text(text: str) -> Faults:
    """``gain:CHANNEL=0.05``, ``late:CHANNEL=1e-4``, ``place:CHANNEL:x=0.003``, ``mass:PLACE=0.2``; nothing for a null."""
    if not text:
        return SOUND
    what, _, size = text.partition("=")
    kind, target, *axis = what.split(":")
    value = np.eye(3)["xyz".index(axis[0])] * float(size) if axis else float(size)
    return Faults(**{key: {target: value} if key == kind else {} for key in ("gain", "late", "place", "mass")})  # type: ignore[arg-type]


@click.command()
@click.option("--count", default=8, show_default=True, help="Laboratories.")
@click.option("--first", default=1, show_default=True, help="Number of the first.")
@click.option("--sheet", default="calibrated", show_default=True, help="Class that they are drawn from.")
@click.option("--class", "stated", default="", help="Class that the analyst states; none by default.")
@click.option("--fault", default="", help="What is planted, such as gain:fmd-z2=0.05; nothing by default.")
@click.option("--article", "articles", multiple=True, default=ARTICLES, show_default=True, help="Of the series.")
@click.option("--out", type=click.Path(path_type=Path), default=None, help="A line of JSON for every laboratory is added here.")
def main(count: int, first: int, sheet: str, stated: str, fault: str, articles: tuple[str, ...], out: Path | None) -> None:
    """Draw laboratories, diagnose them, and count verdicts."""
    quiet = 0
    for number in range(first, first + count):
        model = model_file.of_text(analyst(stated), "drawn.toml")
        campaigns = series(number, articles, sheet, of_text(fault))
        begun = time.process_time()
        try:
            found = diagnosed(Study.of(model, Data(campaigns=campaigns)))
            verdict, named, text = found.verdict, [one.id for one in found.accepted], found.text
            limit = (found.steps[-1].misfit, found.settings["misfit_limit"])
            said = [f"{one.id} {one.sizes[0].value if one.sizes else 0:.4g}" for one in found.accepted]
        except Exception as error:  # a refusal is an answer that counts
            verdict, named, text, said, limit = "refused", [], str(error), [], (0.0, 0.0)
        took = time.process_time() - begun
        quiet += verdict == NOTHING
        click.echo(f"{sheet} {number:3d}  stated {stated or '-'}  {verdict}: {', '.join(said)} {text[:160]}  ({took:.0f} s)")
        if out is not None:
            line = {"sheet": sheet, "laboratory": number, "stated": stated, "fault": fault, "verdict": verdict, "named": said}
            with out.open("a", encoding="utf-8") as file:
                file.write(json.dumps({**line, "text": text, "ids": named, "misfit_and_limit": limit}) + "\n")
    click.echo(f"{quiet} of {count} quiet")


if __name__ == "__main__":
    main()
