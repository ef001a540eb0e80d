"""Pictures of every built-in article and set-up, and those that README and docs show.

    python examples/pictures.py [FOLDER] [SHEET]

Writes one picture an article into FOLDER (``out/pictures``) and the contact sheet to SHEET (``docs/pictures/articles.png``);
beside the sheet go the modes of Clumod, its dynamic mass, a sweep that it was driven with, Clumod on three ropes, and, where the
measured data are, the three-storey frame. These carry what they show in figures too, so that a test sees when the articles have
moved on.
"""

import json
import os
import sys
from collections.abc import Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import numpy as np

from geometry import multibody
from geometry.article import Article
from geometry.articles import NAMES, SETUPS, built_in
from validation.article_reference import Asked as Unchanged
from validation.excitation.asked import Question, drive
from validation.excitation.attached import Attached
from validation.excitation.plots import sheet as driven_sheet
from validation.excitation.runs import done, ready
from validation.flexible.dynamic_mass import BAND, STEP, dynamic_mass, lines, reference_point
from validation.flexible.model import Asked, flexible
from validation.flexible.plots import note_on
from validation.flexible.shapes import draw_sheet
from validation.output import inertia_json
from validation.pictures import contact_sheet, drawn_bodies, picture
from validation.pictures.curves import Curve, side_by_side
from validation.pictures.excitation import draw_sheet as draw_driven
from validation.pictures.pendulum_sheet import pendulum_picture
from validation.swing.asked import Words, setup
from validation.swing.drawing import drawn
from validation.swing.setup import Setup
from validation.swing.shifts import simulated

SIDE_BY_SIDE = {"disc+cuboid": "Cuboid on its disc", "clumod-1": "Clumod, one blade", "clumod-4": "Clumod, four blades"}

ON_THE_SHEET = ("cuboid", "disc", "fmd", "clumod-1", "clumod-4", "fmd+disc+cuboid")


DEFAULTS = (Path("out/pictures"), Path("docs/pictures/articles.png"))


def main(folder: Path, sheet: Path, names: Sequence[str] = (*NAMES, *SETUPS)) -> None:
    """Draw the articles called `names` into `folder`, and those of them that the README shows on one `sheet`."""
    for name in names:
        article = built_in(name)
        picture(name, drawn_bodies(article), multibody.inertia(article), folder / f"{name}.png", note=article.note)
    shown = [name for name in ON_THE_SHEET if name in names]
    about = json.dumps({name: figures(built_in(name)) for name in shown})
    contact_sheet([folder / f"{name}.png" for name in shown], sheet, about)


def flexible_bodies(folder: Path) -> None:
    """Draw the first 11 modes of Clumod with four blades, and dynamic masses as in the paper's Figs. 7 to 9, into `folder`."""
    four = flexible("clumod-4", "beam", Asked(count=30))
    draw_sheet(four, folder, "modes-clumod-4.png", about=json.dumps(frequencies("clumod-4")))
    drawn = [curve(name) for name in SIDE_BY_SIDE]
    title = "Dynamic mass about F: flat for what is rigid, resonances for what is not"
    note = note_on(drawn[0].mass, "F", "in each article's frame")
    about = json.dumps({name: frequencies(name) for name in SIDE_BY_SIDE})
    side_by_side(title, drawn, folder / "dynamic-mass.png", note, about)


def base_excitation(folder: Path) -> None:
    """Draw Clumod with one blade on a table that sweeps about beta as in the paper, into `folder`."""
    sweep = drive(
        axes=["beta"],
        every=False,
        pattern="sweep",
        band=BAND,
        octaves_per_minute=2.0,
        level=1.0,
        cross=0.03,
        seed=0,
        duration=None,
        ring_down="auto",
    )
    question = Question(
        article="clumod-1", model=None, asked=Asked(count=30), attached=Attached(), drive=sweep, route=None, rate=1024.0
    )
    made = ready(question)
    (one,) = done(made)
    draw_driven(driven_sheet(made, one), folder / "excite-clumod-1.png", json.dumps(frequencies("clumod-1")))


def pendulum(folder: Path) -> None:
    """Draw Clumod with four blades on three ropes, its recorded twist below, into `folder`."""
    found = simulated(swing_setup(), lambda words: nullcontext())
    pendulum_picture(drawn(found, Unchanged()), folder / "swing.png", about=json.dumps(swung(found.record.setup)))


def three_storey_frame(folder: Path, data: Path) -> None:
    """Draw the three-storey frame of `data` with the models of its ladder into `folder`; nothing where the data are absent."""
    if not data.is_dir():
        return
    from frame_story.pictures import draw, draw_ladder
    from three_storey_frame import GROWN, LADDER, MODELS, climbed, nominal, tested

    found = climbed(tested(data, nominal()), MODELS, GROWN)
    draw(found, LADDER, folder)
    draw_ladder(found, LADDER, folder)


PLANTED = ("modulus:mast=0.06", "point-mass:mast-top=0.2")
UNSEEN = ("fmd+clumod-1/x", "fmd+clumod-1/beta")


def cross_check(folder: Path) -> None:
    """Draw the ladder of docs/ladder.md, the map of docs/compare.md and what they quote in words into `folder`."""
    from tempfile import TemporaryDirectory

    from validation.cli import run

    with TemporaryDirectory() as place:
        model, tests = f"{place}/model.toml", [f"{place}/test/fmd+cuboid", f"{place}/test/fmd+clumod-1"]
        planted = [word for effect in PLANTED for word in ("--effect", effect)]
        held = [word for name in UNSEEN for word in ("--hold-out", name)]
        for command in (
            [
                "simulate",
                "fmd+cuboid",
                "fmd+clumod-1",
                "--seed",
                "4",
                "--octaves-per-minute",
                "6",
                *planted,
                "--out",
                f"{place}/test",
            ],
            ["model", "fmd+clumod-1", "--out", model],
            ["compare", model, *tests, *held, "--out", place],
            ["add", model, "force-gain:fmd-z2", *tests, *held],
            ["undo", model],
            ["add", model, "point-mass:mast-top", *tests, *held],
            ["ladder", model, "--out", place],
        ):
            if run(command):
                raise SystemExit(f"`massline {' '.join(command)}` failed")
        drawn = {
            "model-ladder": "ladder-fall",
            "model-ladder-clumod-1": "ladder-inertia",
            "compare-fmd+clumod-1-channels": "compare-channels",
        }
        for name, shown in drawn.items():
            (folder / f"{shown}.png").write_bytes(Path(place, f"{name}.png").read_bytes())


HIDDEN = "force-gain:fmd-z2=0.15"


def diagnosis(folder: Path) -> None:
    """Draw the errors before and after the diagnosis of the demo's series into `folder`."""
    from tempfile import TemporaryDirectory

    from validation.cli import run

    with TemporaryDirectory() as place:
        series = ["fmd+disc+cuboid", "fmd+clumod-1"]
        model, tests = f"{place}/model.toml", [f"{place}/test/{name}" for name in series]
        hidden = ["--seed", "3", "--octaves-per-minute", "16", "--effect", HIDDEN]
        for command in (
            ["simulate", *series, *hidden, "--out", f"{place}/test"],
            ["model", "fmd+clumod-1", "--out", model],
            ["diagnose", model, *tests, "--out", place],
        ):
            if run(command):
                raise SystemExit(f"`massline {' '.join(command)}` failed")
        (folder / "diagnose-errors.png").write_bytes(Path(place, "diagnose-errors.png").read_bytes())


def swing_setup() -> Setup:
    """The pendulum of the picture."""
    texts = {
        "length": "2 m",
        "amplitude": "20 deg",
        "damping": "0.5 %",
        "height": "990 mm",
        "noise": "3 mrad",
        "rope_mass": "0.3 kg",
    }
    recorder = {"off_centre": None, "links": None, "start": "twist", "cycles": 10.0, "rate": 50.0, "seed": 0}
    return setup("clumod-4", Words(texts=texts, ropes=3, axis="z", along=None, **recorder), Unchanged())


def swung(test: Setup) -> dict[str, float]:
    """What the picture of a pendulum shows: its body and the period that Eq. 5 gives it."""
    return {"mass_kg": test.inertia.mass, "moi_kgm2": test.reference, "period_eq5_s": test.ideal_period}


def curve(name: str) -> Curve:
    """The dynamic mass of the article `name` about F, 4 to 32 Hz, by its beam model."""
    model = flexible(name, "beam", Asked(count=30))
    point = reference_point("F", name)[1]
    H, at_rest = (dynamic_mass(model, f, point) for f in (lines(BAND, STEP), np.zeros(1)))
    return Curve(name=SIDE_BY_SIDE[name], mass=H, rigid=at_rest.matrix[0].real, modes=model.modes)


def frequencies(name: str) -> list[float]:
    """The first 11 eigenfrequencies [Hz] of the article `name` by its beam model."""
    return [float(f) for f in flexible(name, "beam", Asked(count=11)).modes.frequency]


def figures(article: Article) -> dict[str, Any]:
    """What a picture of `article` shows: its parts with their materials, and its inertia."""
    parts = [[part.name, part.material.name, part.counted] for part in article.parts]
    return {"parts": parts, "note": article.note, **inertia_json(multibody.inertia(article))}


if __name__ == "__main__":
    given = [Path(argument) for argument in sys.argv[1:]]
    folder, sheet = (*given, *DEFAULTS[len(given) :])
    main(folder, sheet)
    flexible_bodies(sheet.parent)
    base_excitation(sheet.parent)
    pendulum(sheet.parent)
    cross_check(sheet.parent)
    diagnosis(sheet.parent)
    three_storey_frame(sheet.parent, Path(os.environ.get("MASSLINE_DATA", "../shared/data")) / "three_storey_frame")
