"""The table of `massline modes`: frequencies, damping, what moves, effective masses and their sum; and its JSON."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from io import StringIO
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
import numpy as np
import numpy.typing as npt

from fem.structure import Structure
from geometry.article import Article
from geometry.atomic import write_text, write_with
from geometry.dynamic_mass import MOTIONS, DynamicMass
from geometry.errors import BadInput
from geometry.frames import Array
from validation import output
from validation.compare.maps import Map, NamedMode
from validation.flexible.dynamic_mass import Apart, Curves, apart, beyond_the_modes, dynamic_mass, lines, reference_point
from validation.flexible.model import OWN, Flexible, FlexibleOptions, another_body, flexible, require_model, require_used
from validation.flexible.modes import APART, SAME_MODE, Described, ModeComparison, described, displacement, movable
from validation.reference.published import Claim, claims
from validation.reference.reference import file_name
from validation.reference.statement import LARGE, NONE
from validation.report.charts.style import DynamicMassCurve, diagonal, full
from validation.report.document import NOTHING as TABLES_NOTHING
from validation.report.document import Cell, Column, Figures, Grid, Number, Safe, aligned, grid_number, joined, table, tag
from validation.report.document import number as tables_number
from validation.report.parts import Report, picture, section
from validation.report.parts import notes as parts_notes
from validation.report.scenes.motion import DrawnMode, MovingBody, animation, bendable, mode_sheet, sharp_edges, write_glb
from validation.report.scenes.scene import DrawnBody, drawn_bodies
from validation.verification.check import CheckResult, Error

if TYPE_CHECKING:
    from rich.table import Table


AXES = ("x", "y", "z", "α", "β", "γ")
UNITS = ("kg", "kg", "kg", "kg m²", "kg m²", "kg m²")

NOTHING = 1e-6
"""Share of the rigid mass below which an effective mass is printed as 0."""

DECIMALS = 3


def grid(model: Flexible) -> Grid:
    """One line a mode, and below them the sum, what the base carries, and the rigid mass."""
    modes = model.modes
    rigid = np.diag(modes.rigid_mass)
    lines = [
        (str(r), f"{f:.3f}", f"{100 * zeta:.2f}", *_masses(mass, rigid), what.text)
        for r, (f, zeta, mass, what) in enumerate(
            zip(modes.frequency, modes.damping_ratio, modes.effective_mass, words(model), strict=True), start=1
        )
    ]
    header = ("mode", "f [Hz]", "ζ [%]", *(f"{axis} [{unit}]" for axis, unit in zip(AXES, UNITS, strict=True)), "what moves")
    columns = list(zip(*lines, *_sums(model, rigid), strict=True))
    return Grid(header=header, lines=tuple(zip(columns[0], *map(aligned, columns[1:9]), columns[9], strict=True)), words=True)


def words(model: Flexible) -> tuple[Described, ...]:
    """Every mode of `model` in words; empty ones for modal data without a structure."""
    if model.structure is None:
        return tuple(Described(moving={}, strained={}, text="") for _ in model.modes.frequency)
    # The parts of a user's own model are shares of its stiffness, which only its reader has given names.
    structure = replace(model.structure, part_stiffness={}, loss_factors={}) if model.model == OWN else model.structure
    return described(structure, model.modes, model.article_of_primitives)


def _sums(model: Flexible, rigid: Array) -> list[tuple[str, ...]]:
    """The sum over the modes, its share of what all modes can carry, and the base's own part, which is in none."""
    total = model.modes.effective_mass.sum(axis=0)
    sums = [("Σ", "", "", *_masses(total, rigid), f"sum of {len(model.modes.frequency)} modes")]
    if model.structure is not None:
        can = movable(model.structure)
        share = tuple(f"{100 * part / whole:.1f} %" if whole > 0 else NONE for part, whole in zip(total, can, strict=True))
        sums.append(("", "", "", *share, "of what all modes together carry"))
        sums.append(("base", "", "", *_masses(rigid - can, rigid), "carried by the base itself, in no mode"))
    return [*sums, ("rigid", "", "", *_masses(rigid, rigid), "the whole article")]


def _masses(masses: Array, rigid: Array) -> tuple[str, ...]:
    return tuple(grid_number(m, DECIMALS) if abs(m) > NOTHING * whole else "0" for m, whole in zip(masses, rigid, strict=True))


def notes(model: Flexible) -> tuple[str, ...]:
    """What must be known to read the table."""
    about = ", ".join(f"{1e3 * x:g}" for x in model.modes.reference_point)
    where = "the article's origin" if not model.modes.reference_point.any() else f"({about}) mm"
    return (
        f"Base held. Effective masses about {where}: [kg] along x, y, z, [kg m²] about them (α, β, γ).",
        *((_WHAT_MOVES,) if any(what.text for what in words(model)) else ()),
        *model.notes,
    )


_WHAT_MOVES = "What moves: parts with their share of the kinetic energy and the axis along which most of it goes."


def published(model: Flexible) -> Grid | None:
    """The paper's sentences beside what `model` has; None where it prints none."""
    said = claims(model.article, model.modes.frequency)
    if not said:
        return None
    return Grid(
        header=("in print", f"{model.model} model", "holds"),
        lines=tuple((claim.says, claim.found, _verdict(claim)) for claim in said),
        words=True,
    )


def _verdict(claim: Claim) -> str:
    return {True: "yes", False: "NO", None: "too few modes to tell"}[claim.holds]


def modes_json(model: Flexible) -> dict[str, Any]:
    """The object of the output contract, effective masses [kg, kg m²] about the reference point."""
    modes = model.modes
    base = {} if model.structure is None else {"effective_mass_of_all_modes": movable(model.structure).tolist()}
    return {
        "article": model.article,
        "model": model.model,
        "frequency_hz": modes.frequency.tolist(),
        "damping_ratio": modes.damping_ratio.tolist(),
        "effective_mass": modes.effective_mass.tolist(),
        "effective_mass_unit": list(UNITS),
        "reference_point_mm": (1e3 * modes.reference_point).tolist(),
        "rigid_mass": np.diag(modes.rigid_mass).tolist(),
        **base,
        "what_moves": [{"text": what.text, "kinetic_energy_share": what.moving} for what in words(model)],
        "published": [{"says": c.says, "found": c.found, "holds": c.holds} for c in claims(model.article, modes.frequency)],
        "notes": list(model.notes),
    }


# Two models side by side: frequencies, MAC, effective masses, and in words where they part.


SHOWN = 12
"""Modes of a printed MAC matrix; all of it is in the JSON."""


def grids(found: ModeComparison) -> tuple[Grid, ...]:
    """Frequencies with MAC, the MAC matrix, and the effective masses."""
    return _frequencies(found), *([_matrix(found)] if found.mac.size else []), _comparison_table_masses(found)


def comparison_table_notes(found: ModeComparison) -> tuple[str, ...]:
    """Whether the bodies are the same, where the models part, and what must be known to read the tables."""
    if not found.mac.size:
        return *_said(found), "Matched in ascending order: a model without shapes on this article's points has no MAC."
    return (
        *_said(found),
        "MAC: share of a mode's kinetic energy that moves as the other model says. In a cluster of close frequencies shapes mix "
        "at will; there `space` is the same for the direction that the two clusters have least in common.",
    )


def _said(found: ModeComparison) -> tuple[str, ...]:
    return tuple(filter(None, (another_body(found.first, found.second), where_they_part(found))))


def where_they_part(found: ModeComparison) -> str:
    """One sentence."""
    names = f"{found.second.model} and {found.first.model}"
    parted = found.parted
    if not len(parted):
        worst = int(np.nanargmax(np.abs(found.difference)))
        return (
            f"{names} agree in all {len(found.partner)} modes: frequencies within {100 * APART:g} % "
            f"(mode {worst + 1} differs most, by {_percent(found.difference[worst])})"
            + (f", shapes alike (MAC at least {SAME_MODE:g})." if found.mac.size else ".")
        )
    said = words(found.first)
    listed = "; ".join(f"mode {k + 1}{_how(found, int(k))}" + (f" ({said[k].text})" if said[k].text else "") for k in parted[:5])
    more = f"; and {len(parted) - 5} more" if len(parted) > 5 else ""
    return f"{names} part in {len(parted)} of {len(found.partner)} modes: {listed}{more}."


def _how(found: ModeComparison, k: int) -> str:
    if found.partner[k] < 0:
        return " has no partner"
    how = [f" by {_percent(found.difference[k])}"] if abs(found.difference[k]) > APART else []
    how += [f" in shape, MAC {found.space[k]:.2f}"] if found.space[k] < SAME_MODE else []
    return " and".join(how)


def _percent(share: float) -> str:
    return f"{100 * share:+.3g} %".replace("-", "−")


def _frequencies(found: ModeComparison) -> Grid:
    f, g = found.first.modes.frequency, found.second.modes.frequency
    lines = []
    for k, other in enumerate(found.partner):
        alone = np.sum(found.cluster == found.cluster[k]) == 1
        mac = f"{found.mac[k, other]:.3f}" if found.mac.size else NONE
        theirs = (str(other + 1), f"{g[other]:.3f}", _percent(found.difference[k]), mac)
        told = theirs if other >= 0 else 4 * (NONE,)
        lines.append(
            (str(k + 1), f"{f[k]:.3f}", *told, NONE if alone or other < 0 or not found.mac.size else f"{found.space[k]:.3f}")
        )
    columns = list(zip(*lines, strict=True))
    first, second = found.first.model, found.second.model
    header = (f"{first} mode", "f [Hz]", f"{second} mode", "f [Hz]", "difference", "MAC", "space")
    return Grid(header=header, lines=tuple(zip(columns[0], *map(aligned, columns[1:]), strict=True)))


def _matrix(found: ModeComparison) -> Grid:
    rows, columns = (min(SHOWN, size) for size in found.mac.shape)
    cells = [[f"{value:.2f}" if value >= 0.005 else "·" for value in row[:columns]] for row in found.mac[:rows]]
    lines = tuple((f"{found.first.model} {i + 1}", *row) for i, row in enumerate(cells))
    return Grid(header=(f"MAC with {found.second.model}", *(str(j + 1) for j in range(columns))), lines=lines)


def _comparison_table_masses(found: ModeComparison) -> Grid:
    """Effective masses of both, one below the other."""
    rigid = np.diag(found.first.modes.rigid_mass)
    a, b = found.first.modes.effective_mass, found.second.modes.effective_mass
    lines = []
    for k, other in enumerate(found.partner):
        for name, index, mass in ((found.first.model, k, a[k]), (found.second.model, other, b[other])):
            if index >= 0:
                shown = (grid_number(m, DECIMALS) if m > NOTHING * whole else "0" for m, whole in zip(mass, rigid, strict=True))
                lines.append((f"{name} {index + 1}", *shown))
    columns = list(zip(*lines, strict=True))
    header = ("effective mass", *(f"{axis} [{unit}]" for axis, unit in zip(AXES, UNITS, strict=True)))
    return Grid(header=header, lines=tuple(zip(columns[0], *map(aligned, columns[1:]), strict=True)))


def as_json(found: ModeComparison) -> dict[str, Any]:
    """What `massline modes --against --json` says beyond the first model."""
    return {
        "model": found.second.model,
        "frequency_hz": found.second.modes.frequency.tolist(),
        "effective_mass": found.second.modes.effective_mass.tolist(),
        "partner": [None if k < 0 else int(k) for k in found.partner],
        "difference_percent": [None if np.isnan(d) else 100 * float(d) for d in found.difference],
        "mac": found.mac.tolist(),
        "cluster": found.cluster.tolist(),
        "mac_of_space": found.space.tolist() if found.mac.size else None,
        "text": " ".join(_said(found)),
    }


# The tables of `massline dynamic-mass`: diagonal magnitudes at a few lines, the peaks, two models side by side; and the JSON.


SHOWN_LINES = 8

PROMINENCE = 0.05
"""Decades by which a peak must stand out on both sides to be listed."""


@dataclass(frozen=True, kw_only=True)
class Peak:
    """A maximum of one diagonal entry.

    Attributes
    ----------
    axis : index of the entry
    frequency : of the line [Hz]
    magnitude : |H| there [kg, kg m²]
    amplification : over the rigid body's [1]
    """

    axis: int
    frequency: float
    magnitude: float
    amplification: float


def peaks_table(H: DynamicMass, rigid: Array) -> tuple[Peak, ...]:
    """The maxima of the diagonal of `H` by axis and frequency; `rigid` (6,) is the diagonal of the rigid body."""
    from scipy.signal import find_peaks

    found = []
    for axis in range(6):
        size = np.abs(H.matrix[:, axis, axis])
        for k in find_peaks(np.log10(np.maximum(size, 1e-300)), prominence=PROMINENCE)[0]:
            found.append(
                Peak(
                    axis=axis,
                    frequency=float(H.frequency[k]),
                    magnitude=float(size[k]),
                    amplification=float(size[k] / rigid[axis]) if rigid[axis] > 0 else float("nan"),
                )
            )
    return tuple(found)


def lines_grid(H: DynamicMass, rigid: Array) -> Grid:
    """Magnitude of the diagonal at a few lines, and of the rigid body."""
    shown = np.unique(np.round(np.linspace(0, len(H.frequency) - 1, SHOWN_LINES)).astype(int))
    lines = [("rigid", *(grid_number(m, DECIMALS) for m in rigid))]
    lines += [
        (f"{H.frequency[k]:.2f} Hz", *(grid_number(abs(H.matrix[k, i, i]), DECIMALS) for i in range(6))) for k in shown.tolist()
    ]
    columns = list(zip(*lines, strict=True))
    header = ("|H|", *(f"{axis} [{unit}]" for axis, unit in zip(AXES, UNITS, strict=True)))
    return Grid(header=header, lines=tuple(zip(columns[0], *map(aligned, columns[1:]), strict=True)))


def peaks_grid(found: Sequence[Peak]) -> Grid | None:
    """The peaks of the diagonal; None without any."""
    if not found:
        return None
    lines = [
        (AXES[p.axis], f"{p.frequency:.2f}", f"{grid_number(p.magnitude, DECIMALS)} {UNITS[p.axis]}", f"{p.amplification:.2f}")
        for p in found
    ]
    columns = list(zip(*lines, strict=True))
    header = ("peak of", "at [Hz]", "|H|", "times rigid")
    return Grid(header=header, lines=tuple(zip(columns[0], *map(aligned, columns[1:]), strict=True)))


def apart_grid(found: Sequence[Apart], first: str, second: str) -> Grid:
    """How far two models are apart, block by block."""
    lines = tuple(
        (
            one.block,
            _dynamic_mass_table_percent(one.off_resonance, one.off_frequency),
            _dynamic_mass_table_percent(one.at_resonance, one.at_frequency),
        )
        for one in found
    )
    return Grid(header=(f"{second} from {first}, largest", "off resonance", "at resonance"), lines=lines)


def apart_text(found: Sequence[Apart], first: str, second: str) -> str:
    """The same in one sentence."""
    off = max((one for one in found if one.off_resonance is not None), key=lambda one: one.off_resonance or 0.0, default=None)
    if off is None:
        return f"{second} and {first}: every line lies at a resonance."
    return (
        f"Off resonance {second} and {first} differ by at most "
        f"{_dynamic_mass_table_percent(off.off_resonance, off.off_frequency)} of the largest "
        f"entry of a block there or in the rigid body, in {off.block}."
    )


def _dynamic_mass_table_percent(share: float | None, frequency: float | None) -> str:
    return NONE if share is None else f"{100 * share:.3g} % at {frequency:.2f} Hz"


def dynamic_mass_table_json(
    model: Flexible, H: DynamicMass, rigid: Array, about: str, against: tuple[str, Sequence[Apart]] | None
) -> dict[str, Any]:
    """The object of the output contract; `rigid` (6,) is the diagonal of the rigid body about the same point."""
    compared: dict[str, Any] = {}
    if against is not None:
        compared = {"against": against[0], "apart": [_apart_json(one) for one in against[1]]}
    return {
        "article": model.article,
        "model": model.model,
        "frequency_hz": H.frequency.tolist(),
        "re": H.matrix.real.tolist(),
        "im": H.matrix.imag.tolist(),
        "about": about,
        "reference_point_mm": (1e3 * H.reference_point).tolist(),
        "order": ["x", "y", "z", "alpha", "beta", "gamma"],
        "peaks": [
            {
                "axis": ("x", "y", "z", "alpha", "beta", "gamma")[p.axis],
                "frequency_hz": p.frequency,
                "magnitude": p.magnitude,
                "magnitude_unit": UNITS[p.axis],
            }
            for p in peaks_table(H, rigid)
        ],
        **compared,
    }


def _apart_json(one: Apart) -> dict[str, Any]:
    return {
        "block": one.block,
        "off_resonance_percent": _times_100(one.off_resonance),
        "off_resonance_hz": one.off_frequency,
        "at_resonance_percent": _times_100(one.at_resonance),
        "at_resonance_hz": one.at_frequency,
    }


def _times_100(share: float | None) -> float | None:
    return None if share is None else 100 * share


# What `massline dynamic-mass` was asked, and what it answers: the dynamic mass of an article by one model or by several.


@dataclass(frozen=True, kw_only=True)
class DynamicMassOptions:
    """Article, models (the first is the one asked for, the others stand beside it), band and step [Hz], reference point."""

    article: str
    models: tuple[str, ...]
    band: tuple[float, float]
    step: float
    about: str
    asked: FlexibleOptions


def curves(question: DynamicMassOptions, *, quiet: bool = False) -> Curves:
    """Answer `question`.

    Raises
    ------
    BadInput : something in it cannot be; everything that can be checked is, before anything is computed.
    """
    from validation.output import shown

    names = [
        require_model(question.article, m, option) for m, option in zip(question.models, ("--model", "--against"), strict=False)
    ]
    require_used(question.article, names, question.asked)
    frequency = lines(question.band, question.step)
    about, point = reference_point(question.about, question.article)
    models, masses = [], []
    for name, model in zip(names, question.models, strict=True):
        with shown(f"dynamic mass of {question.article}, {name} model", quiet=quiet):
            models.append(flexible(question.article, model, question.asked))
            masses.append(dynamic_mass(models[-1], frequency, point))
    resonances = np.concatenate([m.modes.frequency for m in models])
    rigid = DynamicMass(
        frequency=np.zeros(1),
        matrix=models[0].modes.rigid_mass[None].astype(complex),
        reference_point=models[0].modes.reference_point,
    )
    rigid_mass = np.asarray(rigid.about(point).matrix[0].real)
    said = [beyond_the_modes(m, question.band[1], question.asked) for m in models]
    return Curves(
        article=question.article,
        about=about,
        models=tuple(models),
        masses=tuple(masses),
        rigid=rigid_mass,
        apart=tuple(apart(masses[0], other, resonances, rigid_mass) for other in masses[1:]),
        warnings=tuple(dict.fromkeys(filter(None, said))),
    )


def report(found: Curves, *, as_json: bool) -> None:
    """Print `found` as tables, or as the JSON object of the output contract."""
    from validation.output import print_json
    from validation.report.document import page

    first = found.models[0]
    if as_json:
        other = (found.models[1].model, found.apart[0]) if found.apart else None
        print_json(dynamic_mass_table_json(first, found.masses[0], np.diag(found.rigid), found.about, other))
        return
    H, rigid = found.masses[0], np.diag(found.rigid)
    peaks = peaks_grid(peaks_table(H, rigid))
    grids = [lines_grid(H, rigid), *([peaks] if peaks else [])]
    grids += [apart_grid(one, first.model, m.model) for one, m in zip(found.apart, found.models[1:], strict=True)]
    click.echo(page(f"{found.article}: dynamic mass, {first.model} model", grids, _notes(found)), nl=False)


def _notes(found: Curves) -> tuple[str, ...]:
    first, H = found.models[0], found.masses[0]
    point = ", ".join(f"{1e3 * x + 0.0:g}" for x in H.reference_point)
    name = {"article": "the article's origin", "F": "F, the centre of the force-measuring plane"}.get(found.about, "the point")
    compared = (apart_text(one, first.model, m.model) for one, m in zip(found.apart, found.models[1:], strict=True))
    kept = f"{len(first.modes.frequency)} modes and the residual mass of the others"
    return (
        *filter(None, (another_body(first, other) for other in found.models[1:])),
        f"Blocked: all six base motions are prescribed. About {name}, ({point}) mm in the article's frame; {kept}.",
        f"{len(H.frequency)} lines, {H.frequency[0]:g} to {H.frequency[-1]:g} Hz; a peak between two lines is higher than shown.",
        *compared,
        *first.notes,
    )


# A dynamic mass as a file: comma-separated for a spreadsheet, ``.npz`` for numpy; no pickle, whole or not at all.


ENDINGS = (".csv", ".npz")


def require_ending(path: Path) -> None:
    """Refuse a `path` that names no format, as `validation.output.require_ending`."""
    output.require_ending(path, ENDINGS, "a dynamic mass", "out/H.csv")


def write(path: Path, H: DynamicMass, article: str) -> None:
    """Write `H`: frequency [Hz], then real and imaginary part of all 36 entries, row by row."""
    require_ending(path)
    if path.suffix.lower() == ".csv":
        write_text(path, comma_separated(H, article))
    else:
        write_with(path, lambda temporary: _npz(temporary, H, article))


def comma_separated(H: DynamicMass, article: str) -> str:
    """`H` as lines of text; those that begin with # say of what and about which point."""
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
    return text.getvalue()


def _npz(path: Path, H: DynamicMass, article: str) -> None:
    np.savez_compressed(
        path,
        frequency_hz=H.frequency,
        matrix=H.matrix,
        reference_point_m=H.reference_point,
        order=np.array(MOTIONS),
        article=np.array(article),
    )


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
        raise BadInput(
            source=model.article,
            field="--shapes",
            problem=f"the {model.model} model gives frequencies and participations, but no shape that could be drawn",
            remedy="Draw the beam or the solid model",
        )
    count = len(model.modes.frequency)
    for number in numbers:
        if not 1 <= number <= count:
            raise BadInput(
                source="--mode",
                problem=f"modes 1 to {count} were computed, found {number}",
                remedy="Choose one of them, or compute more with --count",
            )
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
    structure, article = model.structure, model.article_of_primitives
    return tuple(_moved(structure, article, number, body, shapes) for number, body in enumerate(_surfaces(model)))


def _surfaces(model: Flexible) -> tuple[DrawnBody, ...]:
    """The surface of every counted part, fine enough to bend."""
    drawn = _users(model.drawn) if model.article_of_primitives is None else drawn_bodies(model.article_of_primitives, CHORD)
    counted = [body for body in drawn if body.counted]
    longest = float(np.linalg.norm(np.ptp(np.concatenate([body.vertices for body in counted]), axis=0))) / PIECES
    return tuple(bendable(body, longest) for body in counted)


def _users(article: Any) -> tuple[DrawnBody, ...]:
    return tuple(
        DrawnBody(name=part.name, material=part.material.name, vertices=part.mesh.vertices, faces=part.mesh.faces)
        for part in article.parts
    )


def _moved(structure: Structure, article: Article | None, part: int, body: DrawnBody, shapes: Array) -> Moved:
    owner = np.full(len(body.vertices), part, dtype=np.intp)
    return body, sharp_edges(body), displacement(structure, shapes, article, body.vertices, owner)


# The pictures of `massline dynamic-mass --plot`.


def draw(found: Curves, folder: Path) -> tuple[Path, ...]:
    """Write the diagonal and the full 6x6 grid of `found` into `folder`, and say where they are."""
    drawn = [
        DynamicMassCurve(name=f"{model.model} model", mass=mass, rigid=found.rigid, modes=model.modes)
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

NOTE = "Base held. Grey outline: at rest. A mode has no scale of its own: each is drawn with the same largest displacement."


def require_mode(number: int, count: int) -> None:
    """Refuse a mode that is not among the `count` that will be computed.

    Raises
    ------
    BadInput : it is not.
    """
    if not 1 <= number <= count:
        problem, remedy = f"modes 1 to {count} are computed, found {number}", "Choose one of them, or compute more with --count"
        raise BadInput(source="--mode", problem=problem, remedy=remedy)


def require_drawable(article: str, model: str) -> None:
    """Refuse pictures of a model that gives no shapes, before it is computed.

    Raises
    ------
    BadInput : it is exudyn's.
    """
    if model == "exudyn":
        problem = "exudyn's own elements give frequencies and participations here, no shape that could be drawn"
        raise BadInput(source=article, field="--shapes", problem=problem, remedy="Draw the beam or the solid model")


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

MODES_NOTE = (
    "Base held, about F, as the plain fit has them with the effects of the model. Effective mass along and about every axis. "
    "The last modes of a model stand for the static answer of all others and are left out here."
)


def html(report: Report, figures: Figures) -> Safe:
    """The section; empty where nothing has modes."""
    found = report.comparison
    tables = [_table(of, modes) for of, modes in zip(found.maps, found.modes, strict=True) if modes]
    shapes = [tag("div", tag("h3", f"Shapes of {one.name}"), picture(one.shapes)) for one in report.articles if one.shapes]
    if not tables:
        return Safe("")
    return section("modes", "Modes", *tables, parts_notes([MODES_NOTE]), *shapes)


def _table(of: Map, modes: tuple[NamedMode, ...]) -> Safe:
    columns = [Column(head="mode", words=True), Column(head="frequency", unit="Hz"), Column(head="damping ratio", unit="%")]
    columns += [Column(head=f"m eff {axis}", unit="kg" if k < 3 else "kg m²") for k, axis in enumerate(AXES)]
    largest = np.max([one.effective_mass or (0.0,) * 6 for one in modes], axis=0)
    rows = [_row(one, SMALL * largest) for one in shown(modes, float(of.frequency[-1]))]
    return joined(table(f"Modes of {of.configuration} ({of.data_set})", columns, rows))


def shown(modes: tuple[NamedMode, ...], top: float) -> tuple[NamedMode, ...]:
    """The modes that a page tells of data up to `top` [Hz]."""
    near = sum(one.frequency <= 2 * top for one in modes)
    return modes[: min(max(near, FEWEST), MOST)]


def _row(one: NamedMode, nothing: Array) -> list[Cell]:
    """A mode; what is below `nothing` along an axis is rounding."""
    masses = [_mass(mass, least) for mass, least in zip(one.effective_mass, nothing, strict=True)] if one.effective_mass else []
    none: list[Cell] = [TABLES_NOTHING] * len(AXES)
    return [one.name, tables_number(one.frequency, ".3f"), tables_number(100 * one.damping_ratio, ".3g"), *(masses or none)]


def _mass(mass: float, least: float) -> Cell:
    return tables_number(mass, ".3g") if mass > least else Number(value=mass, text="0")


# The verification table to print: one page a family, errors beside their bars.


DIGITS = 6

WORDS = 22
"""Columns below which words are not squeezed."""

CHECK, SOURCE = "check", "reference from"
FIGURES = ("reference", "value", "error", "bar", "pass")


def pages(results: Sequence[CheckResult]) -> Iterator[Table]:
    """A table for every family, in order."""
    for family, rows in _by_family(results):
        yield _verification_table(family, rows)


def markdown(results: Sequence[CheckResult]) -> str:
    """The same in Markdown, every family a section."""
    from validation.report.document import Grid, pipes

    header = (CHECK, *FIGURES, SOURCE)
    grids = [(family, Grid(header=header, lines=tuple(map(cells, rows)), words=True)) for family, rows in _by_family(results)]
    return "\n\n".join(f"### {family}\n\n{pipes(grid)}" for family, grid in grids)


def _by_family(results: Sequence[CheckResult]) -> Iterator[tuple[str, list[CheckResult]]]:
    for family, rows in groupby(results, key=lambda result: result.family):
        yield family, list(rows)


def _verification_table(family: str, results: list[CheckResult]) -> Table:
    from rich import box
    from rich.table import Table
    from rich.text import Text

    from validation.reference.statement import add_figures, headline

    table = Table(title=headline(family), title_justify="left", box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0), pad_edge=False)
    lines = [cells(result) for result in results]
    table.add_column(CHECK, min_width=WORDS)
    for heading, column in zip(FIGURES, list(zip(*lines, strict=True))[1:-1], strict=True):
        add_figures(table, heading, column)
    table.add_column(SOURCE, min_width=WORDS)
    for result, line in zip(results, lines, strict=True):
        table.add_row(*(Text(cell) for cell in line), style=None if result.passed else "bold red")
    return table


def cells(result: CheckResult) -> tuple[str, ...]:
    """A row as text: check, reference, value, error, bar, pass, source."""
    relative = result.error_is is Error.RELATIVE and result.reference != 0
    return (
        f"{result.what} [{result.unit}]" if result.unit else result.what,
        number(result.reference),
        number(result.value),
        small(result.error, relative),
        small(result.bar, relative),
        "yes" if result.passed else "NO",
        result.source,
    )


def number(value: float) -> str:
    """Six significant digits, whole numbers as they are."""
    if not math.isfinite(value):
        return NONE
    return f"{value:g}" if value == round(value) and abs(value) < LARGE else f"{value:#.{DIGITS}g}"


def small(error: float, relative: bool) -> str:
    """An error with two digits, a relative one in per cent."""
    if not math.isfinite(error):
        return NONE
    return f"{100 * error:.2g} %" if relative and error else f"{error:.2g}"


def summary(results: Sequence[CheckResult]) -> str:
    """How many checks passed, and the names of those that did not."""
    failed = [result.what for result in results if not result.passed]
    if not failed:
        return f"All {len(results)} checks pass."
    return f"{len(failed)} of {len(results)} checks fail: {'; '.join(failed)}."
