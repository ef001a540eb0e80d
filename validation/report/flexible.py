"""The table of `massline modes`: frequencies, damping, what moves, effective masses and their sum; and its JSON."""

import csv
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from io import StringIO
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from fem.user_model import examine, reading
from geometry import toml_file
from geometry.atomic import write_text, write_with
from geometry.dynamic_mass import MOTIONS, SIGNS, DynamicMass
from geometry.errors import BadInput, CheckFailed
from geometry.frames import Array
from identification import test_file
from identification.files import files
from validation import output
from validation.compare.correlation import RIGID, NamedMode
from validation.diagnose.reduction_errors import MULTIPLE, ReductionErrors, reduction_errors
from validation.flexible.dynamic_mass import UNITS, Curves
from validation.flexible.model import OWN, Flexible, another_body
from validation.flexible.modes import APART, SAME_MODE, Described, ModeComparison, compared, described, displacement, movable
from validation.model import model_file
from validation.reference.published import claims
from validation.reference.reference import file_name
from validation.report.charts.style import DynamicMassCurve, diagonal, full
from validation.report.document import NOTHING as TABLES_NOTHING
from validation.report.document import Column, Document, Figures, Grid, Number, Safe, Table, aligned, pipes, tag
from validation.report.parts import Report, picture, section
from validation.report.parts import notes as parts_notes
from validation.report.scenes.motion import DrawnMode, MovingBody, animation, bendable, mode_sheet, sharp_edges, write_glb
from validation.report.scenes.scene import DrawnBody, drawn_bodies
from validation.study import Study
from validation.verification.check import CheckResult, Error

if TYPE_CHECKING:
    from rich.table import Table as RichTable


NOTHING = 1e-6
"""Share of the rigid mass below which an effective mass is printed as 0."""

DECIMALS = 3

SHOWN = 12
"""Modes of a printed MAC matrix; all of it is in the JSON."""

HOW_HELD = {"base": "Base held.", "ground": "On the ground.", "free": "Free: the modes at 0 Hz are its rigid motions."}

UNNAMED = {"structure", "damped", "rest"}
"""Shares that a reader makes of a stiffness that has no parts."""

WHAT_STRAINS = "What moves: the parts that are strained, with their share of the strain energy; how they move is not known."

WHAT_MOVES = "What moves: parts with their share of the kinetic energy and the axis along which most of it goes."


def words(model: Flexible) -> tuple[Described, ...]:
    """Every mode of `model` in words; empty ones for modal data without a structure."""
    if model.structure is None:
        return tuple(Described(moving={}, text="") for _ in model.modes.frequency)
    structure, unnamed = model.structure, model.model == OWN and set(model.structure.part_stiffness) <= UNNAMED
    # Where a user's own model has no parts, its reader may have made shares of the stiffness for the damping
    structure = replace(structure, part_stiffness={}, loss_factors={}) if unnamed else structure
    return described(structure, model.modes, model.article_of_primitives)


def support_of(model: Flexible) -> str:
    """How `model` is held: "base", "ground" or "free"."""
    if model.structure is None or len(model.structure.held):
        return "base"
    return "ground" if model.structure.grounded else "free"


def of_columns(header: Sequence[str], lines: Sequence[tuple[str, ...]], *, words: bool = False) -> Grid:
    """A grid whose figures have their decimal points below each other; the last column is words where `words`."""
    first, *columns = zip(*lines, strict=True)
    figures = columns[:-1] if words else columns
    return Grid(
        header=tuple(header), lines=tuple(zip(first, *map(aligned, figures), *columns[len(figures) :], strict=True)), words=words
    )


def _heads() -> tuple[str, ...]:
    return tuple(f"{axis} [{unit}]" for axis, unit in zip(SIGNS, UNITS, strict=True))


def _masses(masses: Array, rigid: Array) -> tuple[str, ...]:
    return tuple(output.fixed(m, DECIMALS) if abs(m) > NOTHING * whole else "0" for m, whole in zip(masses, rigid, strict=True))


def print_modes(model: Flexible, against: Flexible | None, *, as_json: bool) -> None:
    """What `massline modes` prints of `model`, and of another beside it."""
    beside = None if against is None else ModesBeside(found=compared(model, against))
    output.print_answer(
        lambda: modes_json(model) | ({} if beside is None else {"against": beside.json()}),
        lambda: modes_document(model).text() + ("" if beside is None else "\n" + beside.document().text()),
        as_json=as_json,
    )


def modes_document(model: Flexible) -> Document:
    """One line a mode, and below them the sum, what the base carries, and the rigid mass; the paper's sentences beside it."""
    modes, said, support = model.modes, words(model), support_of(model)
    rigid, total = np.diag(modes.rigid_mass), modes.effective_mass.sum(axis=0)
    weighed = bool(np.any(rigid))  # without coordinates nobody knows which way a mass moves

    def masses(values: Array) -> tuple[str, ...]:
        return _masses(values, rigid) if weighed else ()

    figures = zip(modes.frequency, modes.damping_ratio, modes.effective_mass, said, strict=True)
    lines = [
        (str(r), f"{f:.3f}", f"{100 * zeta:.2f}", *masses(mass), what.text)
        for r, (f, zeta, mass, what) in enumerate(figures, start=1)
    ]
    if weighed:
        lines.append(("Σ", "", "", *masses(total), f"sum of {len(modes.frequency)} modes"))
    if weighed and model.structure is not None:
        can = movable(model.structure)
        share = tuple(f"{100 * part / whole:.1f} %" if whole > 0 else output.NONE for part, whole in zip(total, can, strict=True))
        lines.append(("", "", "", *share, "of what all modes together carry"))
        if support == "base":
            lines.append(("base", "", "", *masses(rigid - can), "carried by the base itself, in no mode"))
    if weighed:
        lines.append(("rigid", "", "", *masses(rigid), "all that moves" if support == "ground" else "the whole article"))
    head = ("mode", "f [Hz]", "ζ [%]", *(_heads() if weighed else ()), "what moves")
    found = of_columns(head, lines, words=True)
    holds = {True: "yes", False: "NO", None: "too few modes to tell"}
    published = Table(
        rows=claims(model.article, modes.frequency),
        columns=(
            Column("in print", lambda one: one.says),
            Column(f"{model.model} model", lambda one: one.found, aligned=False),
            Column("holds", lambda one: holds[one.holds], words=True),
        ),
    )
    about = ", ".join(f"{1e3 * x:g}" for x in modes.reference_point)
    where = "the article's origin" if not modes.reference_point.any() else f"({about}) mm"
    notes = (
        HOW_HELD[support]
        + (f" Effective masses about {where}: [kg] along x, y, z, [kg m²] about them (α, β, γ)." if weighed else ""),
        *((WHAT_MOVES if any(what.moving for what in said) else WHAT_STRAINS,) if any(what.text for what in said) else ()),
        *model.notes,
    )
    return Document(title=f"{model.article}: {model.model} model", blocks=(found, published), notes=notes)


def modes_json(model: Flexible) -> dict[str, Any]:
    """The object of the output contract, effective masses [kg, kg m²] about the reference point."""
    modes = model.modes
    base = {} if model.structure is None else {"effective_mass_of_all_modes": movable(model.structure)}
    support = support_of(model)
    found = {
        "article": model.article,
        "model": model.model,
        **({} if support == "base" else {"support": support}),
        "frequency_hz": modes.frequency,
        "damping_ratio": modes.damping_ratio,
        "effective_mass": modes.effective_mass,
        "effective_mass_unit": UNITS,
        "reference_point_mm": 1e3 * modes.reference_point,
        "rigid_mass": np.diag(modes.rigid_mass),
        **base,
        "what_moves": words(model),
        "published": claims(model.article, modes.frequency),
        "notes": model.notes,
    }
    return {key: output.to_json(value) for key, value in found.items()}


@dataclass(frozen=True, eq=False, kw_only=True)
class ModesBeside:
    """Two models side by side, as they were `found`: frequencies, MAC, effective masses, and in words where they part."""

    found: ModeComparison

    def document(self) -> Document:
        """Frequencies with MAC, the MAC matrix, and the effective masses."""
        found = self.found
        first, second, f, g = found.first.model, found.second.model, found.first.modes.frequency, found.second.modes.frequency
        lines = []
        for k, other in enumerate(found.partner):
            alone = np.sum(found.cluster == found.cluster[k]) == 1
            mac = f"{found.mac[k, other]:.3f}" if found.mac.size else output.NONE
            theirs = (str(other + 1), f"{g[other]:.3f}", _percent(found.difference[k]), mac) if other >= 0 else 4 * (output.NONE,)
            space = output.NONE if alone or other < 0 or not found.mac.size else f"{found.space[k]:.3f}"
            lines.append((str(k + 1), f"{f[k]:.3f}", *theirs, space))
        header = (f"{first} mode", "f [Hz]", f"{second} mode", "f [Hz]", "difference", "MAC", "space")
        matched = "Matched in ascending order: a model without shapes on this article's points has no MAC."
        mac_is = (
            "MAC: share of a mode's kinetic energy that moves as the other model says. In a cluster of close frequencies shapes "
            "mix at will; there `space` is the same for the direction that the two clusters have least in common."
        )
        return Document(
            title=f"{found.first.article}: {second} beside {first}",
            blocks=(of_columns(header, lines), self.matrix() if found.mac.size else None, self.masses()),
            notes=(*self.said, mac_is if found.mac.size else matched),
        )

    def matrix(self) -> Grid:
        """The MAC of every mode with every other."""
        found = self.found
        rows, columns = (min(SHOWN, size) for size in found.mac.shape)
        cells = [[f"{value:.2f}" if value >= 0.005 else "·" for value in row[:columns]] for row in found.mac[:rows]]
        lines = tuple((f"{found.first.model} {i + 1}", *row) for i, row in enumerate(cells))
        return Grid(header=(f"MAC with {found.second.model}", *(str(j + 1) for j in range(columns))), lines=lines)

    def masses(self) -> Grid:
        """Effective masses of both, one below the other."""
        first, second, rigid = self.found.first, self.found.second, np.diag(self.found.first.modes.rigid_mass)
        lines = [
            (f"{one.model} {index + 1}", *_masses(one.modes.effective_mass[index], rigid))
            for k, other in enumerate(self.found.partner)
            for one, index in ((first, k), (second, other))
            if index >= 0
        ]
        return of_columns(("effective mass", *_heads()), lines)

    @property
    def said(self) -> tuple[str, ...]:
        """Whether the bodies are the same, and where the models part."""
        return tuple(filter(None, (another_body(self.found.first, self.found.second), self.where_they_part())))

    def where_they_part(self) -> str:
        """One sentence."""
        found = self.found
        names, parted = f"{found.second.model} and {found.first.model}", found.parted
        if not len(parted):
            worst = int(np.nanargmax(np.abs(found.difference)))
            return (
                f"{names} agree in all {len(found.partner)} modes: frequencies within {100 * APART:g} % "
                f"(mode {worst + 1} differs most, by {_percent(found.difference[worst])})"
                + (f", shapes alike (MAC at least {SAME_MODE:g})." if found.mac.size else ".")
            )
        said, listed = words(found.first), []
        for k in parted[:5]:
            how = [f" by {_percent(found.difference[k])}"] if abs(found.difference[k]) > APART else []
            how += [f" in shape, MAC {found.space[k]:.2f}"] if found.space[k] < SAME_MODE else []
            apart = " has no partner" if found.partner[k] < 0 else " and".join(how)
            listed.append(f"mode {k + 1}{apart}" + (f" ({said[k].text})" if said[k].text else ""))
        more = f"; and {len(parted) - 5} more" if len(parted) > 5 else ""
        return f"{names} part in {len(parted)} of {len(found.partner)} modes: {'; '.join(listed)}{more}."

    def json(self) -> dict[str, Any]:
        """What `massline modes --against --json` says beyond the first model."""
        found = self.found
        figures = {
            "model": found.second.model,
            "frequency_hz": found.second.modes.frequency,
            "effective_mass": found.second.modes.effective_mass,
            "partner": [None if k < 0 else k for k in found.partner],
            "difference_percent": 100 * found.difference,
            "mac": found.mac,
            "cluster": found.cluster,
            "mac_of_space": found.space if found.mac.size else None,
            "text": " ".join(self.said),
        }
        return {key: output.to_json(value) for key, value in figures.items()}


def _percent(share: float) -> str:
    return f"{100 * share:+.3g} %".replace("-", "−")


# What `massline dynamic-mass` says: diagonal magnitudes at a few lines, the peaks, two models side by side.


SHOWN_LINES = 8


def dynamic_mass_document(found: Curves) -> Document:
    """All of it, in the order in which it is read."""
    first, H, rigid = found.models[0], found.masses[0], np.diag(found.rigid)
    shown = np.unique(np.round(np.linspace(0, len(H.frequency) - 1, SHOWN_LINES)).astype(int)).tolist()
    lines = [("rigid", *(output.fixed(m, DECIMALS) for m in rigid))]
    lines += [(f"{H.frequency[k]:.2f} Hz", *(output.fixed(abs(H.matrix[k, i, i]), DECIMALS) for i in range(6))) for k in shown]
    peaks = Table(
        rows=found.peaks,
        columns=(
            Column("peak of", lambda p: SIGNS[p.axis]),
            Column("at [Hz]", lambda p: p.frequency, ".2f"),
            Column("|H|", lambda p: f"{output.fixed(p.magnitude, DECIMALS)} {p.unit}"),
            Column("times rigid", lambda p: f"{p.amplification:.2f}"),
        ),
    )

    def largest(share: float | None, frequency: float | None) -> str:
        return output.NONE if share is None else f"{100 * share:.3g} % at {frequency:.2f} Hz"

    point = ", ".join(f"{1e3 * x + 0.0:g}" for x in H.reference_point)
    name = {"article": "the article's origin", "F": "F, the centre of the force-measuring plane"}.get(found.about, "the point")
    kept = f"{len(first.modes.frequency)} modes and the residual mass of the others"
    beside, notes = [], [text for other in found.models[1:] if (text := another_body(first, other))]
    notes += [
        f"Blocked: all six base motions are prescribed. About {name}, ({point}) mm in the article's frame; {kept}.",
        f"{len(H.frequency)} lines, {H.frequency[0]:g} to {H.frequency[-1]:g} Hz; a peak between two lines is higher than shown.",
    ]
    for blocks, other in zip(found.apart, found.models[1:], strict=True):
        table = Table(
            rows=blocks,
            columns=(
                Column(f"{other.model} from {first.model}, largest", lambda one: one.block),
                Column("off resonance", lambda one: largest(one.off_resonance, one.off_frequency), aligned=False),
                Column("at resonance", lambda one: largest(one.at_resonance, one.at_frequency), aligned=False),
            ),
        )
        beside.append(table)
        known = [(one.off_resonance, one) for one in blocks if one.off_resonance is not None]
        if not known:
            notes.append(f"{other.model} and {first.model}: every line lies at a resonance.")
            continue
        most, off = max(known, key=lambda pair: pair[0])
        notes.append(
            f"Off resonance {other.model} and {first.model} differ by at most {largest(most, off.off_frequency)} of the largest "
            f"entry of a block there or in the rigid body, in {off.block}."
        )
    return Document(
        title=f"{found.article}: dynamic mass, {first.model} model",
        blocks=(of_columns(("|H|", *_heads()), lines), peaks, *beside),
        notes=(*notes, *first.notes),
    )


def report(found: Curves, *, as_json: bool) -> None:
    """Print `found` as tables, or as the JSON object of the output contract."""
    output.print_answer(lambda: output.to_json(found), lambda: dynamic_mass_document(found).text(), as_json=as_json)


# A dynamic mass as a file: comma-separated for a spreadsheet, ``.npz`` for numpy; no pickle, whole or not at all.


ENDINGS = (".csv", ".npz", *(ending for ending in files.FORMATS if ending != ".csv"))


def require_ending(path: Path) -> None:
    """Refuse a `path` that names no format, as `validation.output.require_ending`."""
    output.require_ending(path, ENDINGS, "a dynamic mass", "out/H.csv")


def write(path: Path, H: DynamicMass, article: str) -> None:
    """Write `H`: frequency [Hz], then real and imaginary part of all 36 entries, row by row."""
    require_ending(path)
    if path.suffix.lower() == ".csv":
        # `H` as lines of text; those that begin with # say of what and about which point
        about = ", ".join(f"{1e3 * x:g}" for x in H.reference_point)
        text = StringIO()
        text.write(f"# dynamic mass of {article} about ({about}) mm, blocked, loads of the table on the article\n")
        text.write("# units: kg between translations, kg m mixed, kg m2 between rotations\n")
        table = csv.writer(text, lineterminator="\n")
        table.writerow(
            ["frequency_hz", *(f"{part}_{row}_{column}" for row in MOTIONS for column in MOTIONS for part in ("re", "im"))]
        )
        for f, matrix in zip(H.frequency, H.matrix, strict=True):
            flat = matrix.ravel()
            table.writerow([repr(float(f)), *(repr(float(v)) for v in np.column_stack([flat.real, flat.imag]).ravel())])
        write_text(path, text.getvalue())
    elif path.suffix.lower() in files.FORMATS:
        test_file.write(path, test_file.of_dynamic_mass(H, article))
    else:
        point, order = H.reference_point, np.array(MOTIONS)
        arrays: dict[str, Any] = {"frequency_hz": H.frequency, "matrix": H.matrix, "reference_point_m": point, "order": order}
        write_with(path, lambda temporary: np.savez_compressed(temporary, **arrays, article=np.array(article)))


# The modes of a flexible model as bodies that move: the CAD's own surface, carried by the model.


Moved = tuple[DrawnBody, npt.NDArray[np.int64], Array]
"""A body, its sharp edges, and the displacement (n, 3, m) of its vertices."""

CHORD = 5e-4
"""Chord error [m] of the drawn surface: these pictures are small."""

PIECES = 30
"""Sides of triangles are at most the article's diagonal over this."""


def drawn_modes(model: Flexible, numbers: Sequence[int]) -> tuple[DrawnMode, ...]:
    """The modes `numbers` (from 1) of `model`, ready to be drawn.

    Raises
    ------
    BadInput : a mode that was not computed, or a model of which no surface is known.
    """
    if model.drawn is None or model.structure is None:
        problem = f"the {model.model} model gives frequencies and participations, but no shape that could be drawn"
        raise BadInput(model.article, "--shapes", problem, "Draw the beam or the solid model")
    count = len(model.modes.frequency)
    for number in numbers:
        if not 1 <= number <= count:
            problem = f"modes 1 to {count} were computed, found {number}"
            raise BadInput("--mode", "", problem, "Choose one of them, or compute more with --count")
    chosen = np.array(numbers, dtype=np.intp) - 1
    shapes = model.modes.shapes[:, chosen]
    said = words(model)
    bodies = moved_bodies(model, shapes)
    return tuple(
        DrawnMode(
            number=number,
            frequency=float(model.modes.frequency[number - 1]),
            text=said[number - 1].text,
            bodies=tuple(
                MovingBody(name=body.name, vertices=body.vertices, faces=body.faces, edges=edges, displacement=u[:, :, k])
                for body, edges, u in bodies
            ),
        )
        for k, number in enumerate(numbers)
    )


def moved_bodies(model: Flexible, shapes: Array) -> tuple[Moved, ...]:
    """The surface of every part of `model`, and how it moves in `shapes` (N, m); none of a model whose surface is not known."""
    if model.drawn is None or model.structure is None:
        return ()
    # The surface of every counted part, fine enough to bend
    article = model.article_of_primitives
    if article is not None:
        drawn = drawn_bodies(article, CHORD)
    else:
        parts: Sequence[Any] = model.drawn.parts
        drawn = tuple(
            DrawnBody(name=part.name, material=part.material.name, vertices=part.mesh.vertices, faces=part.mesh.faces)
            for part in parts
        )
    counted = [body for body in drawn if body.counted]
    longest = float(np.linalg.norm(np.ptp(np.concatenate([body.vertices for body in counted]), axis=0))) / PIECES
    moved = []
    for number, body in enumerate(bendable(body, longest) for body in counted):
        owner = np.full(len(body.vertices), number, dtype=np.intp)
        moved.append((body, sharp_edges(body), displacement(model.structure, shapes, article, body.vertices, owner)))
    return tuple(moved)


# The pictures of `massline dynamic-mass --plot`.


def draw(found: Curves, folder: Path) -> tuple[Path, ...]:
    """Write the diagonal and the full 6x6 grid of `found` into `folder`, and say where they are."""
    drawn = [
        DynamicMassCurve(
            name=f"{model.model} model",
            mass=mass,
            rigid=found.rigid,
            marked=model.modes.frequency,
            effective_mass=model.modes.effective_mass,
        )
        for model, mass in zip(found.models, found.masses, strict=True)
    ]
    stem = file_name(f"dynamic-mass-{found.article}-{'-'.join(model.model for model in found.models)}")
    paths = folder / f"{stem}.png", folder / f"{stem}-6x6.png"
    note = note_on(found.masses[0], found.about)
    diagonal(f"{found.article}: dynamic mass, diagonal", drawn, paths[0], note)
    full(f"{found.article}: dynamic mass, rows loads, columns base motions", drawn, paths[1], note.removesuffix(TICKS))
    return paths


TICKS = " Ticks on the upper edge: eigenfrequencies [Hz]."
"""Said where there are such ticks: the full grid has none."""


def note_on(H: DynamicMass, about: str, frame: str = "in the article's frame") -> str:
    """What must be known to read a picture of `H`."""
    point = ", ".join(f"{1e3 * x + 0.0:g}" for x in H.reference_point)
    name = {"article": "the article's origin", "F": "F"}.get(about, "the point")
    return (
        f"Blocked: all six base motions prescribed; loads of the table on the article, about {name}, ({point}) mm {frame}. "
        f"Dashed: the rigid body.{TICKS}"
    )


# The pictures of `massline modes --shapes` and `--mode`.


ON_THE_SHEET = 11
"""Modes of Clumod with four blades up to 15.5 Hz."""

NOTE = "Base held. Grey outline: at rest. All are drawn with the same largest displacement."


def require_drawable(article: str, model: str, moving: int | None, count: int) -> None:
    """Refuse pictures of a model that gives no shapes, or of a mode beyond `count`, before it is computed.

    Raises
    ------
    BadInput : it is exudyn's; the mode that is `moving` is not among them.
    """
    if moving is not None and not 1 <= moving <= count:
        problem, remedy = f"modes 1 to {count} are computed, found {moving}", "Choose one of them, or compute more with --count"
        raise BadInput("--mode", "", problem, remedy)
    if model == "exudyn":
        problem = "exudyn's own elements give frequencies and participations here, no shape that could be drawn"
        raise BadInput(article, "--shapes", problem, "Draw the beam or the solid model")


def draw_sheet(model: Flexible, folder: Path, name: str | None = None, about: str = "") -> Path:
    """Write the contact sheet of the first modes into `folder`, and say where it is; it carries the words `about`.

    Raises
    ------
    BadInput : the article has no mode, or no surface that is known.
    CheckFailed : nothing can be rendered on this machine.
    """
    numbers = range(1, 1 + min(ON_THE_SHEET, len(model.modes.frequency)))
    path = folder / (name or f"{_stem(model)}.png")
    title = f"{model.article}: the first {len(numbers)} modes, {model.model} model"
    mode_sheet(title, drawn_modes(model, numbers), path, NOTE, about)
    return path


def draw_moving(model: Flexible, number: int, folder: Path) -> list[Path]:
    """Write mode `number` as a GIF and as an animated glTF into `folder`, and say where they are.

    Raises
    ------
    BadInput : no such mode, or no surface that is known.
    CheckFailed : nothing can be rendered on this machine.
    """
    (mode,) = drawn_modes(model, [number])
    moving = folder / f"{_stem(model)}-{number}.gif", folder / f"{_stem(model)}-{number}.glb"
    write_glb(moving[1], model.article, mode)
    animation(model.article, mode, moving[0])
    return list(moving)


def _stem(model: Flexible) -> str:
    return file_name(f"modes-{model.article}-{model.model}")


# Modes of every set-up, and their shapes.


SMALL = 1e-6
"""Share of the largest along an axis below which an effective mass is 0."""

FEWEST, MOST = 6, 20
"""Modes of a table: those within twice the band, but so many at least and at most."""

HEAVY = 1e3
"""Times the end of the band: beyond it swings what has next to no mass, such as turns of a frame whose floors alone are heavy."""

MODES_NOTE = (
    "Base held, about F, with the effects of the model. Effective mass along and about every axis. "
    "The last modes of a model stand for the static answer of all others and are left out here."
)


def html(report: Report, figures: Figures) -> Safe:
    """The section; empty where nothing has modes."""
    found = report.comparison

    def mass(k: int, least: float, one: NamedMode) -> Number:
        """Along axis `k`; what is below the `least` is rounding."""
        if not one.effective_mass:
            return TABLES_NOTHING
        own = one.effective_mass[k]
        return Number(value=own, text=f"{own:.3g}" if own > least else "0")

    tables, alike = [], dict[tuple[object, ...], list[int]]()
    for k, (of, modes) in enumerate(zip(found.maps, found.modes, strict=True)):
        if modes:
            alike.setdefault((of.configuration, *((one.name, one.frequency) for one in modes)), []).append(k)
    for same in alike.values():
        of, modes, names = found.maps[same[0]], found.modes[same[0]], ", ".join(found.maps[k].data_set for k in same)
        modes = tuple(one for one in modes if one.name != RIGID)
        near = sum(one.frequency <= 2 * float(of.frequency[-1]) for one in modes)
        least = SMALL * np.max([one.effective_mass or (0.0,) * 6 for one in modes], axis=0)
        driven = range(6) if any(one.effective_mass for one in modes) else range(0)
        along = [Column(f"m eff {SIGNS[k]}", partial(mass, k, least[k]), unit=UNITS[k]) for k in driven]
        table = Table(
            caption=f"Modes of {of.configuration} at the plain fit ({names})",
            rows=[one for one in modes[: min(max(near, FEWEST), MOST)] if one.frequency < HEAVY * of.frequency[-1]],
            columns=(
                Column("mode", lambda one: one.name, words=True),
                Column("frequency", lambda one: one.frequency, ".3f", unit="Hz"),
                Column("damping ratio", lambda one: 100 * one.damping_ratio, ".3g", unit="%"),
                *along,
            ),
        )
        tables.append(table.html())
    shapes = [tag("div", tag("h3", f"Shapes of {one.name}"), picture(one.shapes)) for one in report.articles if one.shapes]
    if not tables:
        return Safe("")
    held = any(one.effective_mass for modes in found.modes for one in modes)
    return section("modes", "Modes", *tables, parts_notes([MODES_NOTE] if held else []), *shapes)


# The verification table to print: one page a family, errors beside their bars.


DIGITS = 6

WORDS = 22
"""Columns below which words are not squeezed."""

CHECK, SOURCE = "check", "reference from"
FIGURES = ("reference", "value", "error", "bar", "pass")


def pages(results: Sequence[CheckResult]) -> "Iterator[RichTable]":
    """A table for every family, in order."""
    for family, rows in _by_family(results):
        from rich import box
        from rich.table import Table as RichTable
        from rich.text import Text

        from validation.reference.statement import add_figures, headline

        table = RichTable(title=headline(family), title_justify="left", box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0), pad_edge=False)
        lines = [cells(result) for result in rows]
        table.add_column(CHECK, min_width=WORDS)
        for heading, column in zip(FIGURES, list(zip(*lines, strict=True))[1:-1], strict=True):
            add_figures(table, heading, column)
        table.add_column(SOURCE, min_width=WORDS)
        for result, line in zip(rows, lines, strict=True):
            table.add_row(*(Text(cell) for cell in line), style=None if result.passed else "bold red")
        yield table


def markdown(results: Sequence[CheckResult]) -> str:
    """The same in Markdown, every family a section."""
    header = (CHECK, *FIGURES, SOURCE)
    grids = [(family, Grid(header=header, lines=tuple(map(cells, rows)), words=True)) for family, rows in _by_family(results)]
    return "\n\n".join(f"### {family}\n\n{pipes(grid)}" for family, grid in grids)


def _by_family(results: Sequence[CheckResult]) -> Iterator[tuple[str, list[CheckResult]]]:
    for family, rows in groupby(results, key=lambda result: result.family):
        yield family, list(rows)


def cells(result: CheckResult) -> tuple[str, ...]:
    """A row as text: check, reference, value, error, bar, pass, source."""
    relative = result.error_is is Error.RELATIVE and result.reference != 0
    return (
        f"{result.what} [{result.unit}]" if result.unit else result.what,
        six_digits(result.reference),
        six_digits(result.value),
        small(result.error, relative),
        small(result.bar, relative),
        "yes" if result.passed else "NO",
        result.source,
    )


def six_digits(value: float) -> str:
    """Six significant digits, whole numbers as they are."""
    if not math.isfinite(value):
        return output.NONE
    return f"{value:g}" if value == round(value) and abs(value) < output.LARGE else f"{value:#.{DIGITS}g}"


def small(error: float, relative: bool) -> str:
    """An error with two digits, a relative one in per cent."""
    if not math.isfinite(error):
        return output.NONE
    return f"{100 * error:.2g} %" if relative and error else f"{error:.2g}"


def summary(results: Sequence[CheckResult]) -> str:
    """How many checks passed, and the names of those that did not."""
    failed = [result.what for result in results if not result.passed]
    if not failed:
        return f"All {len(results)} checks pass."
    return f"{len(failed)} of {len(results)} checks fail: {'; '.join(failed)}."


# `massline model --examine`: what is wrong with a model of the user's own, where, how much, and what to do.


def examine_answer(path: str, *, as_json: bool) -> None:
    """Print what is wrong with the model in `path`.

    Raises
    ------
    BadInput : it is no model, or cannot be read at all.
    CheckFailed : something is wrong with it.
    """
    study = path
    if Path(path).suffix.lower() == ".toml" and Path(path).is_file() and not reading.is_model(path):
        # Of a study, beside its structure, that; what is no TOML is said, such as a support that is named twice
        own = model_file.read(path).own if "model" in toml_file.read(path) else {}
        path = next(iter(own.values())) if len(own) == 1 else path
    if not Path(path).exists() or not reading.is_model(path):
        toml_file.require_no_other(Path(path))
        remedy = f"Name one of {', '.join(reading.DATA_ENDINGS)}, or a description (.toml with [fe_model])"
        raise BadInput(path, "", "there is no such file" if not Path(path).exists() else "it is no finite-element model", remedy)
    with output.shown(f"examining {path}", quiet=as_json):
        found = examine.examine(path)
        reduced, why = ((), "") if found.findings else _reduced(study)
    if why:
        found = replace(found, unexamined=(*found.unexamined, why))
    whole = {**output.to_json(found), "sound": not found.findings, "reduction": [output.to_json(one) for one in reduced]}
    output.print_answer(lambda: whole, lambda: examined(found, reduced).text(), as_json=as_json)
    if found.findings:
        raise CheckFailed(_in_a_sentence(found), findings=found.findings)


def _reduced(path: str) -> tuple[tuple[ReductionErrors, ...], str]:
    """How exact the reduction is for the tests that a model file names, and why it was not measured."""
    if Path(path).suffix.lower() != ".toml" or "test" not in toml_file.read(path):
        return (), ""
    try:
        return reduction_errors(Study.open(path, ())), ""
    except (BadInput, CheckFailed) as error:
        return (), f"How exact its reduction is was not measured: {error}"


def examined(found: examine.Examination, reduced: Sequence[ReductionErrors] = ()) -> Document:
    """What was found, each with where, how much and what to do; causes first. Then how exact its reduction is."""
    columns = (
        Column("", lambda row: row[0], words=True),
        Column("finding", lambda row: row[1], words=True),
        Column("", lambda row: row[2], words=True),
    )
    rows = []
    for k, one in enumerate(found.findings, start=1):
        rows.append((str(k), one.check, f"{one.what}."))
        told = (("where", one.where), ("how much", one.amount), ("to do", one.remedy))
        rows += [("", head, f"{words}.") for head, words in told if words]
    of_effects = (
        Column("effect", lambda one: one.id, words=True),
        Column("size", lambda one: f"{one.size:.3g}"),
        Column("moves omega² by", lambda one: f"{100 * one.change:.2g} %"),
        Column("off by", lambda one: f"{100 * one.error:.2g} % of that"),
    )
    caption = f"How exact the reduction is, effects at {MULTIPLE:g} times what the tests would name; the worst"
    tables = [Table(caption=caption, columns=of_effects, rows=one.effects[:5]) for one in reduced if one.effects]
    return Document(
        title=f"{found.name}: {found.kind} in {found.source}",
        opening=[*([f"{'; '.join(found.facts)}."] if found.facts else []), *(f"{one.article}: {one.text}." for one in reduced)],
        blocks=(Table(caption="What is wrong", columns=columns, rows=rows), *tables),
        notes=[*(f"{words}." for words in found.unexamined), *([] if found.findings else [_in_a_sentence(found)])],
    )


def _in_a_sentence(found: examine.Examination) -> str:
    """One sentence."""
    many = len(found.findings)
    if not many:
        return f"{found.source}: nothing is wrong with it."
    return f"{found.source}: {many} finding{'s' if many > 1 else ''}, the first is {found.findings[0].check}."
