"""Pictures of every built-in article and set-up, and of what they do: modes, dynamic mass, a sweep, a pendulum.

    python examples/pictures.py [FOLDER] [SHEET]

Writes one picture an article into FOLDER (``out/pictures``) and the contact sheet to SHEET (``docs/pictures/articles.png``);
beside the sheet go the modes of Clumod, its dynamic mass, a sweep that it was driven with, and Clumod on three ropes. These carry
what they show in figures too, so that a test sees when the articles have moved on. All pictures of the docs, these among them:
``examples/gallery.py``.
"""

import json
import sys
from collections.abc import Sequence
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from geometry import routes
from geometry.article import Article
from geometry.articles import NAMES, SETUPS, built_in
from geometry.dynamic_mass import SIGNS
from geometry.errors import BadInput
from validation.classical.swing import Setup, Words, setup, simulated
from validation.excite.question import Attached, ExciteOptions, drive
from validation.excite.runs import ready
from validation.flexible.dynamic_mass import BAND, STEP, dynamic_mass, lines, reference_point
from validation.flexible.model import FlexibleOptions, flexible
from validation.output import inertia_json
from validation.reference.reference import ArticleOptions as Unchanged
from validation.report.charts import static, style
from validation.report.charts.excitation import draw_sheet as draw_driven
from validation.report.charts.spec import INK
from validation.report.charts.static import ABOUT, save
from validation.report.charts.style import DynamicMassCurve
from validation.report.excite import RunPicture
from validation.report.flexible import draw_sheet, note_on
from validation.report.scenes.scene import drawn_bodies, picture
from validation.report.scenes.setups import drawn_swing, pendulum_picture

SIDE_BY_SIDE = {"disc+cuboid": "Cuboid on its disc", "clumod-1": "Clumod, one blade", "clumod-4": "Clumod, four blades"}

ON_THE_SHEET = ("cuboid", "disc", "fmd", "clumod-1", "clumod-4", "fmd+disc+cuboid")


COLUMNS = 2
TILE = (800, 600)
COLOURS = 255
"""A PNG sheet keeps so many colours, spread over all that occur: a third of the size, and no difference to the eye."""

DEFAULTS = (Path("out/pictures"), Path("docs/pictures/articles.png"))


def main(folder: Path, sheet: Path, names: Sequence[str] = (*NAMES, *SETUPS)) -> None:
    """Draw the articles called `names` into `folder`, and those of them that the README shows on one `sheet`."""
    for name in names:
        article = built_in(name)
        picture(name, drawn_bodies(article), routes.inertia(article), folder / f"{name}.png", note=article.note)
    shown = [name for name in ON_THE_SHEET if name in names]
    about = json.dumps({name: figures(built_in(name)) for name in shown})
    contact_sheet([folder / f"{name}.png" for name in shown], sheet, about)


def contact_sheet(paths: Sequence[Path], path: Path, about: str = "") -> None:
    """Put the pictures at `paths` on one sheet, two abreast, in their order; the ending of `path` chooses PNG or JPEG.

    A PNG carries the words `about` as its comment.

    Raises
    ------
    BadInput : no picture, a file that is none, or an unknown ending of `path`.
    """
    from PIL import Image
    from PIL.PngImagePlugin import PngInfo

    if not paths:
        raise BadInput(str(path), "paths", "no picture was given", "Give at least one")
    rows = -(-len(paths) // COLUMNS)
    sheet = Image.new("RGB", (COLUMNS * TILE[0], rows * TILE[1]), "white")
    for index, tile in enumerate(paths):
        row, column = divmod(index, COLUMNS)
        try:
            with Image.open(tile) as image:
                sheet.paste(image.convert("RGB").resize(TILE, Image.Resampling.LANCZOS), (column * TILE[0], row * TILE[1]))
        except OSError as error:
            problem = f"this is no picture that can be read ({error})"
            raise BadInput(str(tile), "", problem, "Draw it again") from None
    octree, plain = Image.Quantize.FASTOCTREE, Image.Dither.NONE
    finished = sheet.quantize(COLOURS, method=octree, dither=plain) if path.suffix == ".png" else sheet
    more: dict[str, Any] = {}
    if path.suffix == ".png" and about:
        more["pnginfo"] = PngInfo()
        more["pnginfo"].add_text(ABOUT, about)
    save(path, lambda temporary: finished.save(temporary, optimize=True, **more))


def flexible_bodies(folder: Path) -> None:
    """Draw the first 11 modes of Clumod with four blades, and dynamic masses as in the paper's Figs. 7 to 9, into `folder`."""
    four = flexible("clumod-4", "beam", FlexibleOptions(count=30))
    draw_sheet(four, folder, "modes-clumod-4.png", about=json.dumps(frequencies("clumod-4")))
    drawn = [curve(name) for name in SIDE_BY_SIDE]
    title = "Dynamic mass about F: flat for what is rigid, resonances for what is not"
    note = note_on(drawn[0].mass, "F", "in each article's frame")
    about = json.dumps({name: frequencies(name) for name in SIDE_BY_SIDE})
    side_by_side(title, drawn, folder / "dynamic-mass.png", note, about)


def side_by_side(title: str, articles: Sequence[DynamicMassCurve], path: Path, note: str = "", about: str = "") -> None:
    """Write a picture with one column an article: diagonal of the translations [kg] and of the rotations [kg m²] over frequency.

    A PNG carries the words `about` as its comment.

    Raises
    ------
    BadInput : the ending of `path` is unknown.
    """
    static.require_format(path)
    figure = static.new_figure(4.6 * len(articles) + 1.0, 9.6)
    room = {"hspace": 0.09, "wspace": 0.07, "left": 0.06, "right": 0.985, "top": 0.895, "bottom": 0.085}
    grid = figure.add_gridspec(5, len(articles), height_ratios=(3, 1.15, 0.3, 3, 1.15), **room)
    rows: dict[int, list[static.Axes]] = {0: [], 3: []}
    for column, curve in enumerate(articles):
        for top, entries in ((0, (0, 1, 2)), (3, (3, 4, 5))):
            upper = figure.add_subplot(grid[top, column], sharey=rows[top][0] if rows[top] else None)
            lower = figure.add_subplot(grid[top + 1, column], sharex=upper)
            rows[top].append(upper)
            for colour, width, i in zip(style.AXES, style.WIDTHS, entries, strict=True):
                static.draw_curve(upper, lower, replace(curve.entry(i, i), name=SIGNS[i]), colour, width=width)
                upper.axhline(curve.rigid[i, i], color=colour, linewidth=0.9, linestyle=(0, (5, 3)), alpha=0.6)
            static.dress_entry(upper, lower, curve.mass.frequency)
            upper.tick_params(labelleft=column == 0)
            lower.tick_params(labelleft=column == 0)
            style.mark(upper, curve, entries)
            if top == 0:
                upper.set_title(curve.name, fontsize=13, weight="bold", color=INK, pad=14)
            if column == 0:
                upper.set_ylabel(f"|H| [{style.unit(entries[0], entries[0])}]", fontsize=10)
                lower.set_ylabel("phase [°]", fontsize=10)
                upper.legend(fontsize=9, loc="upper right", ncols=3, framealpha=0.85, handlelength=1.4)
            if top == 3:
                lower.set_xlabel("frequency [Hz]", fontsize=10)
    for row in rows.values():
        static.at_least_a_decade(row[0])
    static.finish(figure, title, note, path, about)


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
    question = ExciteOptions(
        article="clumod-1", model=None, asked=FlexibleOptions(count=30), attached=Attached(), drive=sweep, route=None, rate=1024.0
    )
    made = ready(question)
    (one,) = made.done()
    draw_driven(RunPicture(made=made, one=one).sheet(), folder / "excite-clumod-1.png", json.dumps(frequencies("clumod-1")))


def pendulum(folder: Path) -> None:
    """Draw Clumod with four blades on three ropes, its recorded twist below, into `folder`."""
    found = simulated(swing_setup(), lambda words: nullcontext())
    pendulum_picture(drawn_swing(found, Unchanged()), folder / "swing.png", about=json.dumps(swung(found.record.setup)))


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


def curve(name: str) -> DynamicMassCurve:
    """The dynamic mass of the article `name` about F, 4 to 32 Hz, by its beam model."""
    model = flexible(name, "beam", FlexibleOptions(count=30))
    point = reference_point("F", name)[1]
    H, at_rest = (dynamic_mass(model, f, point) for f in (lines(BAND, STEP), np.zeros(1)))
    marks = {"marked": model.modes.frequency, "effective_mass": model.modes.effective_mass}
    return DynamicMassCurve(name=SIDE_BY_SIDE[name], mass=H, rigid=at_rest.matrix[0].real, **marks)


def frequencies(name: str) -> list[float]:
    """The first 11 eigenfrequencies [Hz] of the article `name` by its beam model."""
    return [float(f) for f in flexible(name, "beam", FlexibleOptions(count=11)).modes.frequency]


def figures(article: Article) -> dict[str, Any]:
    """What a picture of `article` shows: its parts with their materials, and its inertia."""
    parts = [[part.name, part.material.name, part.counted] for part in article.parts]
    return {"parts": parts, "note": article.note, **inertia_json(routes.inertia(article))}


if __name__ == "__main__":
    given = [Path(argument) for argument in sys.argv[1:]]
    folder, sheet = (*given, *DEFAULTS[len(given) :])
    main(folder, sheet)
    flexible_bodies(sheet.parent)
    base_excitation(sheet.parent)
    pendulum(sheet.parent)
