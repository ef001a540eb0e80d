"""The pictures of `massline identify`: what each of them shows, from the findings."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from importlib.metadata import version
from math import isfinite
from pathlib import Path
from typing import Any

import click
import numpy as np
import numpy.typing as npt

from geometry.atomic import write_text
from geometry.dynamic_mass import MOTIONS, DynamicMass
from geometry.errors import BadInput, CheckFailed
from geometry.frames import Array, Pose
from geometry.inertia import PARAMETERS, Inertia, judge
from identification import request
from identification.base_motion import Loss
from identification.campaign import Campaign
from identification.consistency import Finding
from identification.dynamic_mass import CrossMotion
from identification.elastic.model import ElasticTerms, dynamic_mass
from identification.quality import NORMAL_95, impossible
from identification.request import QUANTITIES as CLASSICAL_QUANTITIES
from identification.request import Request
from validation.compare.compare import Comparison
from validation.flexible.model import Flexible
from validation.history.add import body_of, conditions_of
from validation.history.history import Body, Conditions, HistoryPosition
from validation.identify import identify
from validation.identify.identify import DrawnBandStudy, IdentificationFindings, IdentifyOptions, Reported, UsedLines
from validation.identify.identify import identified as identification_identified
from validation.identify.pretest import PretestFindings, PretestOptions, coarse_lines, findings, largest_share
from validation.model.model import Model
from validation.model.setups import FMD, above_fmd, is_stack, stated, takes_fmd_off
from validation.output import inertia_json, json_text, percent, require_folder, shown
from validation.reference.published import published
from validation.reference.reference import ArticleOptions, file_name, reference, route_statement
from validation.reference.statement import NONE, QUANTITIES, Stated, Statement, rounded
from validation.report.charts import identification, spec
from validation.report.charts.identification import DrawnPretest, UncertaintyShares, draw_pretest, draw_rigid, draw_shares
from validation.report.charts.spec import LEFT_OUT, MEASURED, QUOTIENT
from validation.report.charts.style import DynamicMassCurve, diagonal, full
from validation.report.document import NOTHING as TABLES_NOTHING
from validation.report.document import (
    Cell,
    Column,
    Figures,
    Grid,
    Safe,
    aligned,
    grid_number,
    joined,
    number,
    page,
    table,
    tag,
    toleranced,
)
from validation.report.flexible import moved_bodies
from validation.report.parts import CampaignPart, Picture, Report, paragraphs, section
from validation.report.parts import notes as parts_notes
from validation.report.reference import drawing_of, drawn
from validation.report.scenes.motion import MovingBody
from validation.report.scenes.setups import sensor_map
from validation.study import Study

PRODUCT = 1e3
"""Products are shown in g m²: as a share of a product that is almost zero their deviation says nothing."""

FINE = 1401
"""Lines of the fitted curve: narrow resonances stay round."""

SHARP = 0.05
"""Damping ratio above which a term is no resonance that could be pointed at, but bends the curve where the others leave it."""

POINT = "about F; loads of the table on the article"


@dataclass(frozen=True, eq=False, kw_only=True)
class _Terms:
    """Elastic terms as resonances to be marked, in ascending order."""

    frequency: Array
    effective_mass: Array


def draw(found: IdentificationFindings, folder: Path) -> tuple[Path, ...]:
    """Write every picture that `found` has the evidence for into `folder`, and say where they are."""
    made = []

    def to(name: str) -> Path:
        made.append(folder / f"{file_name(f'identify-{found.article}-{name}')}.png")
        return made[-1]

    if found.lines is not None:
        _lines(found, found.lines, to("lines"))
    if found.dynamic_mass is not None:
        _diagonal(found, found.dynamic_mass, to("dynamic-mass"))
        _full(found, found.dynamic_mass, to("dynamic-mass-6x6"))
    if found.residuals is not None:
        _residuals(found, found.residuals, to("residuals"))
    if found.study is not None:
        for number, what in enumerate(found.study.maps):
            _stability(found, found.study, what, to(f"stability{'-rigid' if number else ''}"))
    if any(one.quality.shares for one in found.results):
        _shares(found, to("shares"))
    return tuple(made)


def _lines(found: IdentificationFindings, lines: UsedLines, path: Path) -> None:
    spectra = found.spectra
    drawn = spec.SpectralLines(
        frequency=lines.frequency,
        condition=lines.condition,
        limit=lines.limit,
        left_out=lines.kept == 0,
        runs=() if spectra is None else spectra.runs,
        unexplained=np.zeros((0, len(lines.frequency))) if spectra is None else 1 - spectra.quality,
    )
    note = "Condition number of the base motions of all runs at a line, every axis divided by its nominal level."
    identification.draw_lines(f"{_stack(found)}: lines of the spectra", drawn, path, note)


def _stack(found: IdentificationFindings) -> str:
    """What was on the load cells: pictures of measurements are about all of it."""
    return found.request.campaign.article


def curves(found: IdentificationFindings, H: DynamicMass) -> tuple[DynamicMassCurve, ...]:
    """The measured dynamic mass H about F, lines that were left out apart, and what was fitted to it."""
    own = found.result.identified.inertia.mass_matrix
    rigid, modes = own if found.rigid is None else found.rigid, _Terms(frequency=np.zeros(0), effective_mass=np.zeros((0, 6)))
    terms = found.result.identified.elastic
    fine = np.linspace(H.frequency[0], H.frequency[-1], FINE)
    fitted = np.tile(rigid + 0j, (FINE, 1, 1)) if terms is None else dynamic_mass(rigid, terms, fine)
    count = 0 if terms is None else len(terms.frequency)
    if terms is not None:
        modes = _marks(terms)
    kept = np.ones(len(H.frequency), dtype=bool) if found.lines is None else found.lines.kept > 0
    model = DynamicMass(frequency=fine, matrix=fitted, reference_point=H.reference_point)
    drawn = [
        *_quotient(found, H, rigid, modes),
        DynamicMassCurve(name="measured, channels as they are", mass=_at(H, kept), rigid=rigid, modes=modes, dots=MEASURED),
        DynamicMassCurve(name=f"{found.result.identified.way}, {count} elastic terms", mass=model, rigid=rigid, modes=modes),
    ]
    if not kept.all():
        drawn.append(DynamicMassCurve(name="left out", mass=_at(H, ~kept), rigid=rigid, modes=modes, dots=LEFT_OUT))
    return tuple(drawn)


def _quotient(found: IdentificationFindings, H: DynamicMass, rigid: Array, modes: _Terms) -> list[DynamicMassCurve]:
    if found.crossed is None:
        return []
    mass = DynamicMass(frequency=H.frequency, matrix=found.crossed.quotient, reference_point=H.reference_point)
    return [DynamicMassCurve(name="quotient of the driven axis, Eq. 8a", mass=mass, rigid=rigid, modes=modes, dots=QUOTIENT)]


def _at(H: DynamicMass, chosen: np.ndarray) -> DynamicMass:
    return DynamicMass(frequency=H.frequency[chosen], matrix=H.matrix[chosen], reference_point=H.reference_point)


def _marks(terms: ElasticTerms) -> _Terms:
    sharp = np.flatnonzero(terms.damping_ratio < SHARP)
    order = sharp[np.argsort(terms.frequency[sharp])]
    return _Terms(frequency=terms.frequency[order], effective_mass=terms.participation[order] ** 2)


def _diagonal(found: IdentificationFindings, H: DynamicMass, path: Path) -> None:
    note = f"Blocked, {POINT}. {_measured(found)} Dashed: rigid body identified. Ticks: elastic terms [Hz]."
    diagonal(f"{_stack(found)}: dynamic mass", curves(found, H), path, note)


def _measured(found: IdentificationFindings) -> str:
    """Why dots and line need not lie on each other."""
    told = "Dots: Eqs. 9 to 11"
    if found.result.identified.way == "plain":
        return f"{told}."
    return f"{told}, channels uncorrected; line: sensors put right, which moves what is small."


def _full(found: IdentificationFindings, H: DynamicMass, path: Path) -> None:
    note = f"Blocked, {POINT}. {_measured(found)} Dashed: rigid body identified."
    full(f"{_stack(found)}: dynamic mass, rows loads, columns base motions", curves(found, H), path, note)


def _residuals(found: IdentificationFindings, residuals: identify.DrawnResiduals, path: Path) -> None:
    note = (
        "What a pick-up reads beyond the motion that all of them agree on, and what redundant load cells contradict each other "
        "by, as a share of the readings of their kind at the line."
    )
    identification.draw_residuals(f"{_stack(found)}: what redundant channels disagree by", residuals, path, note)


def _stability(found: IdentificationFindings, study: DrawnBandStudy, what: str, path: Path) -> None:
    maps = [_map(study, what, found.result, k) for k in range(len(QUANTITIES))]
    counts, *_ = study.maps
    at = np.asarray(np.isfinite(study.maps[what]).any(axis=(0, 2)))
    note = (
        f"Plain fits, Eqs. 9 to 11, with {what} over each band, less the plain fit with {counts} over the chosen band (square). "
        "Cross: apart by more than the 95 % interval of the difference. Grey: too few lines."
    )
    title = f"{_alone(found)}: stability over the band, plain fits with {what}"
    identification.draw_stability(title, [_rows(one, at) for one in maps], study.start, study.stop[at], study.chosen, path, note)


def _rows(one: identification.BandMap, at: npt.NDArray[np.bool_]) -> identification.BandMap:
    """Without the stops of which nothing is known."""
    return replace(one, deviation=one.deviation[:, at], half_width=one.half_width[:, at])


def _alone(found: IdentificationFindings) -> str:
    """What the result is about, where that is not all that was on the load cells."""
    return f"{found.article} alone, FMD taken off" if found.article != _stack(found) else found.article


def _map(study: DrawnBandStudy, what: str, chosen: Reported, k: int) -> identification.BandMap:
    quantity, value = QUANTITIES[k], chosen.values[k]
    kind = "mm" if 1 <= k <= 3 else "g m²" if k >= 7 else "%"
    scale = {"mm": 1e3, "g m²": PRODUCT, "%": 100 / abs(value)}[kind]
    apart = study.maps[what][..., k] - study.reference[k]
    half = np.full(apart.shape, chosen.half_width[k])
    if what in study.half_widths:
        half = np.hypot(half, study.half_widths[what][..., k])
    return identification.BandMap(
        label=quantity.label, unit=kind, deviation=scale * apart, half_width=scale * half, most=_most(kind, chosen)
    )


def _most(kind: str, chosen: Reported) -> float:
    """Deviation of the darkest colour at most: what lies beyond is wrong, by how much is no matter."""
    return {"mm": 20.0, "g m²": 0.05 * PRODUCT * float(np.abs(chosen.values[4:7]).min()), "%": 5.0}[kind]


def _shares(found: IdentificationFindings, path: Path) -> None:
    drawn = [
        identification.UncertaintyShares(
            way=one.identified.way,
            parameters=tuple(quantity.label for quantity in QUANTITIES),
            intervals=tuple(f"{half * q.per_si:.2g} {q.unit}" for half, q in zip(one.half_width, QUANTITIES, strict=True)),
            shares=one.quality.shares,
        )
        for one in found.results
        if one.quality.shares
    ]
    note = "What every input contributes to the variance of mass, CoG, and moments and products about the CoG."
    identification.draw_shares(f"{_alone(found)}: where the uncertainty comes from", drawn, path, note)


# What `massline identify --json` prints: the contract's keys, and more beside them. Keys end in their unit.


LIBRARIES = ("massline", "numpy", "scipy", "pin")
"""Whose versions stand in the settings."""


def identification_json(found: IdentificationFindings) -> dict[str, Any]:
    """The findings as one object."""
    best = found.result
    return {
        "article": found.article,
        "origin": found.origin,
        "frequency_band_hz": list(best.identified.band),
        "inertia": inertia_json(best.inertia),
        "interval95": _interval(best),
        "verdict": {name: found.verdict.get(name, "") for name in PARAMETERS},
        "doubts": list(found.doubts),
        "warnings": [*found.doubts, *found.warnings],
        "result": best.identified.way,
        **{one.identified.way.replace("-", "_"): _way(one) for one in found.results},
        "checks": [_check(one) for one in found.checks],
        "losing_a_sensor": [_loss(one) for one in found.losses],
        "cross_motion": [] if found.crossed is None else list(found.crossed.text),
        "lines": None if found.lines is None else _identification_lines(found.lines),
        "study": None if found.study is None else _study(found.study),
        "frame": None if found.frame is None else _frame(found.frame),
        "settings": _settings(found.request),
    }


def _interval(one: Reported) -> dict[str, Any]:
    pairs = one.quality.intervals
    return {
        "mass_kg": pairs[0].tolist(),
        "cog_mm": (1e3 * pairs[1:4]).tolist(),
        "moi_cog_kgm2": pairs[4:7].tolist(),
        "poi_cog_kgm2": pairs[7:].tolist(),
    }


def _check(one: Finding) -> dict[str, Any]:
    suspects = [
        {"effects": [name for mistake in suspect.mistakes for name in mistake.identifiers], "text": suspect.text}
        for suspect in one.suspects
    ]
    return {"name": one.name, "holds": one.holds, "tolerances": one.value, "text": one.text, "suspects": suspects}


def _loss(one: Loss) -> dict[str, Any]:
    return {
        "channel": one.channel,
        "lost": list(one.lost),
        "moved": one.moved.max(axis=0).tolist(),
        "noise_times": None if one.lost else one.amplification.tolist(),
        "text": one.text,
    }


def _way(one: Reported) -> dict[str, Any]:
    found = one.identified
    return {
        "inertia": inertia_json(one.inertia),
        "interval95": _interval(one),
        "about_f": {
            "parameters": dict(zip(PARAMETERS, found.inertia.parameters.tolist(), strict=True)),
            "covariance": found.covariance.tolist(),
            "reference_point_m": found.inertia.reference_point.tolist(),
        },
        "from_raw_spectra_about_f": None if found.raw is None else dict(zip(PARAMETERS, found.raw.tolist(), strict=True)),
        "shares_about_f": {name: dict(zip(PARAMETERS, share.tolist(), strict=True)) for name, share in found.shares.items()},
        "shares": {
            name: dict(zip(CLASSICAL_QUANTITIES, share.tolist(), strict=True)) for name, share in one.quality.shares.items()
        },
        "narrowed_by": {name: dict(zip(PARAMETERS, times.tolist(), strict=True)) for name, times in found.gained.items()},
        "bootstrap_sd_about_f": None if found.resampled is None else np.sqrt(np.diag(found.resampled)).tolist(),
        "bootstrap_over_parametric_sd": dict(one.quality.bootstrap) or None,
        "modes": 0 if found.elastic is None else len(found.elastic.frequency),
        "elastic": None if found.elastic is None else _elastic(found.elastic),
        "chi2_per_dof": found.misfit if isfinite(found.misfit) else None,
        "tolerance_z2": found.surprise,
        "tolerances": found.tolerances,
        "converged": found.converged,
        "warnings": list(found.warnings),
    }


def _elastic(terms: ElasticTerms) -> dict[str, Any]:
    return {
        "frequency_hz": terms.frequency.tolist(),
        "damping_ratio": terms.damping_ratio.tolist(),
        "damping_rad_s": terms.damping.tolist(),
        "participation": terms.participation.tolist(),
        "residual": terms.residual.tolist(),
    }


def _identification_lines(lines: UsedLines) -> dict[str, Any]:
    return {
        "frequency_hz": lines.frequency.tolist(),
        "condition": lines.condition.tolist(),
        "condition_limit": lines.limit,
        "used": [bool(one) for one in lines.kept],
        "left_out": list(lines.reasons),
    }


def _study(study: DrawnBandStudy) -> dict[str, Any]:
    return {
        "start_hz": study.start.tolist(),
        "stop_hz": study.stop.tolist(),
        "maps": {
            what: {
                "mass_kg": _nulled(values[..., 0]),
                "cog_mm": _nulled(1e3 * values[..., 1:4]),
                "moi_cog_kgm2": _nulled(values[..., 4:7]),
                "poi_cog_kgm2": _nulled(values[..., 7:]),
            }
            for what, values in study.maps.items()
        },
    }


def _frame(frame: Pose) -> dict[str, Any]:
    """As a result file states a frame, so that the result can be read again."""
    return {"origin": " ".join(f"{x:.15g}" for x in frame.position) + " m", "rotation": frame.rotation.tolist()}


def _nulled(values: Array) -> Any:
    """Nested lists with null for NaN, which is no JSON."""
    if values.ndim == 0:
        return float(values) if isfinite(float(values)) else None
    return [_nulled(one) for one in values]


def _settings(request: Request) -> dict[str, Any]:
    tolerances = request.tolerances
    return {
        "campaign": request.campaign.source,
        "campaign_article": request.campaign.article,
        "hardware": request.campaign.hardware,
        "tares": [
            {
                "campaign": tare.campaign.source,
                "campaign_article": tare.campaign.article,
                "hardware": tare.campaign.hardware,
                "known": None if tare.known is None else inertia_json(tare.known),
                "known_relative_sd": tare.relative_sd,
            }
            for tare in request.tares
        ],
        "facts": [
            {"quantity": fact.quantity, "value_si": fact.value, "sd_si": fact.sd, "source": fact.source} for fact in request.facts
        ],
        "band_hz": None if request.band is None else list(request.band),
        "spectra": request.method,
        "modes": "auto" if request.modes is None else request.modes,
        "condition_limit": request.condition_limit,
        "any_hardware": request.any_hardware,
        "robust": request.robust,
        "study": request.study,
        "tolerances_si": {name: getattr(tolerances, name) for name in tolerances.__dataclass_fields__},
        "fmd": None if request.fmd is None else inertia_json(request.fmd),
        "cell_stiffness_n_m": None if request.cell_stiffness is None else request.cell_stiffness.tolist(),
        "versions": {name: version(name) for name in LIBRARIES},
    }


# The closure table: what CAD, exudyn, a pendulum, identification and print say about one article, in one row each.
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
    from geometry.frames import Pose

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
    from validation.flexible.model import FlexibleOptions as Flexible
    from validation.flexible.model import flexible

    modes = flexible(article, "exudyn", Flexible(count=1)).modes
    body = Inertia.from_mass_matrix(_symmetric(modes.rigid_mass), modes.reference_point)
    return route_statement("exudyn", body.about(np.zeros(3)))


def _symmetric(matrix: Array) -> Array:
    return np.asarray((matrix + matrix.T) / 2)


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
    return grid_number(stated.value * scale, DECIMALS[k] if stated.decimals is None else stated.decimals)


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


# The page of `massline identify`: both results side by side, what each parameter rests on, elastic terms, what was left out.


ORIGINS = {"article": "the article's own origin", "F": "F, the centre of the force-measuring plane"}

WORTH = 0.1
"""Share of the variance from which a second input is named."""


def title(found: IdentificationFindings) -> str:
    """Article, number of runs, band."""
    low, high = found.result.identified.band
    count = len(found.request.campaign.runs)
    return f"{found.article}: identified from {count} runs, {low:g} to {high:g} Hz"


def identification_grids(found: IdentificationFindings) -> list[Grid]:
    """All tables, in the order in which they are read."""
    elastic = found.result.identified.elastic
    return [
        *([doubts(found.doubts)] if found.doubts else []),
        values(found),
        verdicts(found),
        *([modes(elastic)] if elastic is not None and len(elastic.frequency) else []),
        *([single_axis(found.crossed)] if found.crossed is not None else []),
    ]


def doubts(said: tuple[str, ...]) -> Grid:
    """What stands above every figure: why none of them is to be trusted."""
    lines = tuple((str(k), text) for k, text in enumerate(said, start=1))
    return Grid(header=("", "the data contradict themselves: do not trust these figures"), lines=lines, words=True)


def values(found: IdentificationFindings) -> Grid:
    """Mass, CoG, moments and products of both ways with their 95 % intervals, and how far the second lies from the first."""
    ways = [one.identified.way for one in found.results]
    columns = [aligned(tuple(_identification_value(one, k) for k in range(10))) for one in found.results]
    if len(found.results) > 1:
        ways += ["moved by", "half-widths"]
        moved = [_moved(found.results[0], found.results[-1], k) for k in range(10)]
        columns += [aligned(cells) for cells in zip(*moved, strict=True)]
    return Grid(header=("± 95 %", *ways), lines=tuple(zip(_labels(), *columns, strict=True)))


def _moved(plain: Reported, better: Reported, k: int) -> tuple[str, str]:
    """By how much quantity `k` lies elsewhere in the better result: in its unit or in per cent, and in plain half-widths."""
    moved, width, scale = float(better.values[k] - plain.values[k]), float(plain.half_width[k]), QUANTITIES[k].per_si
    finest = min(width, float(better.half_width[k])) * scale
    relative = plain.values[k] != 0 and QUANTITIES[k].key.partition("_")[0] in ("mass", "moi")
    own = f"{100 * moved / abs(plain.values[k]):+.2f} %" if relative else f"{rounded(moved * scale, finest)} "
    return own.rstrip() if relative else f"{own}{QUANTITIES[k].unit}", f"{moved / width:+.2f}" if width else NONE


def verdicts(found: IdentificationFindings) -> Grid:
    """What is to be thought of every value, and what its uncertainty comes from."""
    lines = []
    for k, (quantity, name) in enumerate(zip(QUANTITIES, request.QUANTITIES, strict=True)):
        said = found.verdict.get(name, NONE)
        second = _next(found.result.dominating(k)) if "of the variance" in said else ""
        lines.append((quantity.label, said + second))
    return Grid(header=("", f"verdict on the {found.result.identified.way} result"), lines=tuple(lines), words=True)


def _next(inputs: tuple[tuple[str, float], ...]) -> str:
    """The input behind the one that dominates, where it matters."""
    return f"; then {inputs[1][0]} {100 * inputs[1][1]:.0f} %" if len(inputs) > 1 and inputs[1][1] > WORTH else ""


def single_axis(crossed: CrossMotion) -> Grid:
    """What the quotient of the driven axis alone would have cost."""
    lines = [
        (axis, *(f"{100 * share:.2g} %" for share in shares))
        for axis, *shares in zip(MOTIONS, crossed.cross_motion, crossed.diagonal, crossed.column, strict=True)
    ]
    return Grid(header=("Eq. 8a alone", "other axes move", "off on the diagonal", "off beside it, up to"), lines=tuple(lines))


def modes(terms: ElasticTerms) -> Grid:
    """Elastic terms: frequency, damping, and the axis that each shows on most, with its effective mass."""
    lines = []
    for r in np.argsort(terms.frequency):
        f, zeta, L = terms.frequency[r], terms.damping_ratio[r], terms.participation[r]
        most = sorted(range(6), key=lambda k: -_weight(L, k))[:2]
        shown = ", ".join(f"{MOTIONS[k]} {L[k] ** 2:.3g} {'kg' if k < 3 else 'kg m²'}" for k in most)
        lines.append((f"{f:.3f}", f"{100 * zeta:.3f}", shown))
    columns = list(zip(*lines, strict=True))
    return Grid(
        header=("elastic terms [Hz]", "damping [%]", "effective mass about F"),
        lines=tuple(zip(*map(aligned, columns[:2]), columns[2], strict=True)),
        words=True,
    )


def _weight(participation: np.ndarray, k: int) -> float:
    """Effective mass along axis `k`, rotations weighed as at a lever of half a metre."""
    return float(participation[k] ** 2) * (1.0 if k < 3 else 4.0)


def identification_notes(found: IdentificationFindings) -> Iterator[str]:
    """What must be known to read the tables, then what was left out, checked and warned of."""
    where = ORIGINS[found.origin] if found.frame is None else f"your own frame, seen from {ORIGINS[found.origin]}"
    yield f"CoG from {where}. Moments and products about the CoG; products are matrix entries, Θxy = -∫xy dm."
    yield _method(found)
    for one in found.results:
        yield _fit(one)
    yield from _bootstrap(found.result)
    if found.lines is not None:
        yield from _left_out(found.lines)
    yield from _checked(found.checks)
    yield from _lost(found.losses)
    yield from _gained(found.result)
    yield from (f"warning: {words}." for words in found.warnings)


def _method(found: IdentificationFindings) -> str:
    tares = ", ".join(tare.campaign.article for tare in found.request.tares)
    facts = dict.fromkeys(fact.source for fact in found.request.facts)
    told = f"tare {tares}" if tares else "the FMD as stated" if found.request.fmd is not None else "no tare"
    taken = told if takes_fmd_off(found.request) else f"{told}, so the FMD's moving part is in the result"
    method = found.request.method if found.spectra is None else found.spectra.method
    made = "as the files hold them" if method == "spectra" else method
    if tares and not takes_fmd_off(found.request):
        taken = f"tare {tares} on other hardware, which takes no FMD off: its moving part is in the result"
    return f"Spectra: {made}; {taken}{'; data of ' + ', '.join(facts) if facts else ''}."


def _fit(one: Reported) -> str:
    found = one.identified
    terms = 0 if found.elastic is None else len(found.elastic.frequency)
    misfit = "" if np.isnan(found.misfit) else f", chi² per degree of freedom {found.misfit:.3g}"
    surprise = f", sum z² of {found.tolerances} tolerances {found.surprise:.3g}" if found.surprise else ""
    stopped = "" if found.converged else "; it did not converge"
    by_spectra = "" if found.raw is None else f"; from raw spectra instead of H the mass is {found.raw[0]:.5g} kg"
    return f"{found.way[0].upper()}{found.way[1:]}: {terms} elastic terms{misfit}{surprise}{stopped}{by_spectra}."


def _bootstrap(one: Reported) -> Iterator[str]:
    """Whether the interval would be another one were lines not taken for independent."""
    if one.quality.bootstrap:
        ratios = [one.quality.bootstrap[name] for name in request.QUANTITIES]
        low, high = min(ratios), max(ratios)
        yield f"Block bootstrap of the lines: standard deviations {low:.2f} to {high:.2f} times those of the intervals."


def _left_out(lines: UsedLines) -> Iterator[str]:
    worst = int(np.argmax(lines.condition))
    yield (
        f"Lines: {int(np.sum(lines.kept))} of {len(lines.frequency)} used; condition number at most "
        f"{lines.condition[worst]:.3g}, at {lines.frequency[worst]:g} Hz; the limit is {lines.limit:g}."
    )
    yield from (f"left out: {reason}." for reason in lines.reasons)


def _checked(checks: tuple[Finding, ...]) -> Iterator[str]:
    """What does not hold, each in a sentence; what holds, together in one."""
    yield from (f"check: {one.text}." for one in checks if not one.holds)
    if sound := [one.name for one in checks if one.holds]:
        yield f"Closed checks that hold: {', '.join(sound)}."


def _lost(losses: tuple[Loss, ...]) -> Iterator[str]:
    """The accelerometers that nothing stands in for, or else the one whose absence moves the base motion most."""
    alone = [one for one in losses if one.lost]
    if alone:
        yield from (f"Losing a sensor: {one.text}." for one in alone)
    elif losses:
        yield f"Losing a sensor: {max(losses, key=lambda one: one.moved.max()).text}."


def _gained(one: Reported) -> Iterator[str]:
    """What every classical result was good for: the parameter whose interval it narrows most."""
    for name, times in one.identified.gained.items():
        k = int(np.argmax(times))
        yield f"Without {name} the interval of {PARAMETERS[k]} would be {times[k]:.3g} times as wide."


def _labels() -> tuple[str, ...]:
    return tuple(f"{q.label} [{q.unit}]" for q in QUANTITIES)


def _identification_value(one: Reported, k: int) -> str:
    scale = QUANTITIES[k].per_si
    value, half = float(one.values[k]) * scale, float(one.half_width[k]) * scale
    return f"{rounded(value, half)} ± {rounded(half, half)}" if half else rounded(value, None)


# `massline identify` from options to output: read, identify, show.


RESULT = "identify.json"
"""The file of a result in its folder."""


def answer(asked: IdentifyOptions, frame: str | None, *, as_json: bool, folder: Path | None, keep: bool) -> None:
    """Identify what is `asked`, print it, and draw it into `folder` (None: nowhere); `keep` writes the JSON there, too.

    Raises
    ------
    BadInput : something that was asked cannot be used.
    CheckFailed : no body can have what comes out; raised when everything is printed.
    """
    found = identification_identified(asked, frame, quiet=as_json)
    if as_json:
        click.echo(json_text(identification_json(found)))
    else:
        click.echo(page(title(found), identification_grids(found), identification_notes(found)), nl=False)
    if folder is not None:
        _write(found, folder, keep=keep, quiet=as_json)
    if impossible(found.result.quality):
        raise CheckFailed(_impossible(found))


def _impossible(found: IdentificationFindings) -> str:
    said = f"no body can have the {found.result.identified.way} result: {judge(found.result.inertia).text}"
    if found.request.modes == 0:
        return f"{said}. The article was taken for rigid: allow for elastic terms, --modes auto"
    return f"{said}. Look at the checks on the page, and drive the sweeps lower or at a higher level"


def _write(found: IdentificationFindings, folder: Path, *, keep: bool, quiet: bool) -> None:

    if keep:
        write_text(folder / RESULT, json_text(identification_json(found)) + "\n")
        click.echo(f"massline: wrote {folder / RESULT}.", err=True)
    with shown(f"pictures of {found.article}", quiet=quiet):
        paths = draw(found, folder)
    for path in paths:
        click.echo(f"massline: wrote {path}.", err=True)


# What `massline pretest --json` prints; keys end in their unit.


def pretest_json(found: PretestFindings) -> dict[str, Any]:
    """The findings as one object."""
    question, plan = found.question, found.question.plan
    return {
        "article": plan.article,
        "tare": None if question.tare is None else question.tare.article,
        "origin": "article",
        "runs": list(found.spectra.runs),
        "frequency_hz": found.spectra.frequency.tolist(),
        "condition": found.condition.tolist(),
        "condition_limit": question.condition_limit,
        "lines_left_out": int(np.sum(found.left_out)),
        "inertia": inertia_json(found.best.inertia),
        "self_calibrated": _pretest_way(found.best),
        "plain": _pretest_way(found.plain),
        "without_tare": None if found.untared is None else {"half_width95": _half(found.untared)},
        "without": {name: {"half_width95": _half(half), "plain_loses": found.lost[name]} for name, half in found.without.items()},
        "rigid_share": question.rigid,
        "rigid_height_m": found.rigid_height,
        "places": [
            {
                "name": one.name,
                "position_m": one.position.tolist(),
                "elastic_share_at_start": one.at_start,
                "elastic_share": one.largest,
                "axis": one.axis,
                "frequency_hz": one.frequency,
                "rigid_up_to_hz": one.up_to,
                "share_of_lines": one.within,
            }
            for one in found.places
        ],
        "tolerances": asdict(question.tolerances),
        "warnings": list(found.warnings),
    }


def _pretest_way(one: Reported) -> dict[str, Any]:
    shares = one.quality.shares
    return {
        "half_width95": _half(one.half_width),
        "shares": {name: dict(zip(CLASSICAL_QUANTITIES, share.tolist(), strict=True)) for name, share in shares.items()},
        "verdict": {name: one.quality.verdict[name] for name in CLASSICAL_QUANTITIES},
    }


def _half(half: Array) -> dict[str, Any]:
    return {
        "mass_kg": float(half[0]),
        "cog_mm": (1e3 * half[1:4]).tolist(),
        "moi_cog_kgm2": half[4:7].tolist(),
        "poi_cog_kgm2": half[7:].tolist(),
    }


# The page of `massline pretest`: expected intervals, what dominates them, the price of every channel, rigid places.


SHOWN_INPUTS = 2

ALL = slice(0, 7)
"""Mass, CoG, moments: products are left to the JSON."""

NOTHING = 1e-5
"""Elastic shares below it are not worth their digits."""

HUGE = 10.0
"""Elastic shares above it are a resonance; how high it is hangs on damping."""


def pretest_title(found: PretestFindings) -> str:
    """Article, number of runs, band."""
    plan = found.question.plan
    low, high = plan.band
    return f"Pretest of {plan.article}: {len(found.spectra.runs)} runs ({plan.pattern}), {low:g} to {high:g} Hz"


def pretest_grids(found: PretestFindings) -> list[Grid]:
    """All tables, in the order in which they are read."""
    further = [*([losses(found)] if found.without else []), *([places(found)] if found.places else [])]
    return [intervals(found), rests(found), *further]


def intervals(found: PretestFindings) -> Grid:
    """Half-widths of the expected 95 % intervals: plain, self-calibrated, and that without a tare."""
    columns = [("plain", found.plain.half_width), ("self-calibrated", found.best.half_width)]
    columns += [] if found.untared is None else [("and without tare", found.untared)]
    labels = tuple(f"{q.label} [{q.unit}]" for q in QUANTITIES)
    values = aligned(tuple(_pretest_value(found, k) for k in range(10)))
    cells = [aligned(tuple(_pretest_half(found, half, k) for k in range(10))) for _, half in columns]
    header = ("expected ± 95 %", "value", *(name for name, _ in columns))
    return Grid(header=header, lines=tuple(zip(labels, values, *cells, strict=True)))


def _pretest_value(found: PretestFindings, k: int) -> str:
    per_si = QUANTITIES[k].per_si
    value = found.best.values[k] * per_si
    return rounded(value if abs(value) > 1e-6 * per_si * _size(found, k) else 0.0, found.best.half_width[k] * per_si)


def _size(found: PretestFindings, k: int) -> float:
    """Largest value of the kind of quantity `k`."""
    kind = slice(0, 1) if k == 0 else slice(1, 4) if k < 4 else slice(4, 10)
    return float(np.abs(found.best.values[kind]).max())


def _pretest_half(found: PretestFindings, half: Array, k: int) -> str:
    """In the unit of the quantity, and in per cent where that says more."""
    per_si, value = QUANTITIES[k].per_si, abs(found.best.values[k])
    own = f"{half[k] * per_si:.2g}"
    relative = QUANTITIES[k].key.partition("_")[0] in ("mass", "moi") and value > 0
    return f"{own} ({100 * half[k] / value:.2g} %)" if relative else own


def rests(found: PretestFindings) -> Grid:
    """What dominates the uncertainty of every value, by both ways."""
    lines = []
    for k, quantity in enumerate(QUANTITIES):
        said = [", ".join(_inputs(one, k)) or NONE for one in (found.plain, found.best)]
        lines.append((quantity.label, *said))
    width = max(len(line[1]) for line in lines)
    header = ("dominated by", f"{'plain':<{width}}", "self-calibrated")
    return Grid(header=header, lines=tuple((n, f"{a:<{width}}", b) for n, a, b in lines), words=True)


def _inputs(one: Reported, k: int) -> list[str]:
    return [f"{what} {100 * share:.0f} %" for what, share in one.dominating(k)[:SHOWN_INPUTS]]


def losses(found: PretestFindings) -> Grid:
    """By how much intervals grow when a channel is lost, and what the plain way loses."""
    lines = []
    for name, half in found.without.items():
        growth = half / np.where(found.best.half_width > 0, found.best.half_width, 1.0)
        worst = {what: float(growth[kind].max()) for what, kind in _KINDS.items()}
        lines.append((name, *(f"{value:.2f}" for value in worst.values()), found.lost[name] or NONE))
    header = ("without", *(f"{what} ×" for what in _KINDS), "the plain way has then")
    return Grid(header=header, lines=tuple(lines), words=True)


_KINDS = {"mass": slice(0, 1), "CoG": slice(1, 4), "MoI": slice(4, 7)}


def places(found: PretestFindings) -> Grid:
    """Rigid and elastic places."""
    limit = f"{100 * found.question.rigid:g} %"
    lines = []
    for one in found.places:
        up_to = "the whole band" if one.within == 1 else "nowhere" if one.up_to is None else f"{one.up_to:.2f} Hz"
        worst = NONE if one.largest == 0 else f"{one.axis} at {one.frequency:.2f} Hz"
        lines.append((one.name, f"{one.position[2]:.3f}", _share(one.at_start), _share(one.largest), up_to, worst))
    columns = list(zip(*lines, strict=True))
    return Grid(
        header=("pick-up at", "m above F", f"at {start_of(found):g} Hz", "at most", f"below {limit} up to", "largest in"),
        lines=tuple(zip(columns[0], *map(aligned, columns[1:4]), *columns[4:], strict=True)),
        words=True,
    )


def start_of(found: PretestFindings) -> float:
    """[Hz] of the lowest line."""
    return float(found.spectra.frequency[0])


def _share(value: float) -> str:
    if 0 < value < NOTHING:
        return f"< {100 * NOTHING:g} %"
    return "resonance" if value > HUGE else f"{100 * value:.2g} %"


def pretest_notes(found: PretestFindings) -> Iterator[str]:
    """What must be known to read the tables."""
    question, worst = found.question, int(np.argmax(found.condition))
    yield (
        f"Condition number of the base motions: median {np.median(found.condition):.3g}, at most {found.condition[worst]:.3g} at "
        f"{found.spectra.frequency[worst]:g} Hz; {int(np.sum(found.left_out))} of {len(found.condition)} lines above the limit "
        f"of {question.condition_limit:g}."
    )
    fmd = "" if question.above else " The FMD alone: its moving part is what is asked for."
    tared = f"tare {question.tare.article}" if question.tare else "no tare, the FMD known within its tolerance"
    yield f"Expected from the model and the planned chain, {tared}; CoG from the article's own origin.{fmd}"
    yield "Linearised at the drawn article with exact channels: what the model does not hold is in no interval."
    if found.places:
        yield (
            "Elastic motion: of a place relative to the base, over what a rigid article would do there; the largest of six axes. "
            f"{_height(found)} The cover plate counts as rigid."
        )
    yield from (f"warning: {words}." for words in found.warnings)


def _height(found: PretestFindings) -> str:
    limit = f"below {100 * found.question.rigid:g} %"
    if found.rigid_height is None:
        return f"All of the article's axis stays {limit}."
    return f"Its axis stays {limit} up to {found.rigid_height:.3f} m above F."


# The pictures of `massline pretest`: condition and expected intervals, shares of the variance, rigid places.


NOTE = "Expected before any measurement, linearised at the drawn article; see docs/pretest.md."


def pretest_draw(found: PretestFindings, folder: Path) -> tuple[Path, ...]:
    """Write every picture of `found` into `folder`, and say where they are.

    Raises
    ------
    CheckFailed : nothing can be rendered on this machine.
    """
    stem = file_name(f"pretest-{found.question.plan.article}")
    paths = [folder / f"{stem}.png", folder / f"{stem}-shares.png"]
    draw_pretest(pretest_title(found), _intervals(found), paths[0], NOTE)
    draw_shares(f"{pretest_title(found)}: where the uncertainty comes from", _pretest_shares(found), paths[1], NOTE)
    if found.model is not None and found.model.drawn is not None:
        paths.append(folder / f"{stem}-places.png")
        note = "Elastic motion, the largest of six axes, over that of a rigid article at the same place."
        heading = f"{found.question.above}: where a pick-up moves with the base"
        draw_rigid(heading, _surfaces(found, found.model), found.question.rigid, paths[2], note)
    return tuple(paths)


def _intervals(found: PretestFindings) -> DrawnPretest:
    cases = {"plain": found.plain.half_width, "self-calibrated": found.best.half_width}
    cases |= {} if found.untared is None else {"self-calibrated, no tare": found.untared}
    best = found.best.half_width
    return DrawnPretest(
        frequency=found.spectra.frequency,
        condition=found.condition,
        limit=found.question.condition_limit,
        quantities=tuple(f"{one.label} [{one.unit}]" for one in QUANTITIES[:7]),
        intervals={name: half[:7] * np.array([one.per_si for one in QUANTITIES[:7]]) for name, half in cases.items()},
        growth={name: (half / np.where(best > 0, best, 1.0))[:7] for name, half in found.without.items()},
    )


def _pretest_shares(found: PretestFindings) -> list[UncertaintyShares]:
    return [
        UncertaintyShares(
            way=one.identified.way,
            parameters=tuple(quantity.label for quantity in QUANTITIES),
            intervals=tuple(f"{half * q.per_si:.2g} {q.unit}" for half, q in zip(one.half_width, QUANTITIES, strict=True)),
            shares=one.quality.shares,
        )
        for one in (found.plain, found.best)
    ]


def _surfaces(found: PretestFindings, model: Flexible) -> dict[str, tuple[MovingBody, ...]]:
    """The surface of the article by caption; the length of a vertex's displacement is its elastic share."""
    lines = coarse_lines(found.spectra.frequency, model.modes)
    start: list[MovingBody] = []
    most: list[MovingBody] = []
    for body, edges, moved in moved_bodies(model, model.modes.shapes):
        shares = largest_share(moved, body.vertices + found.seat, model.modes, found.seat, lines)
        for sheet, size in zip((start, most), shares, strict=True):
            motion = size[:, None] * [1.0, 0.0, 0.0]
            sheet.append(MovingBody(name=body.name, vertices=body.vertices, faces=body.faces, edges=edges, displacement=motion))
    low, high = float(lines[0]), float(lines[-1])
    return {f"at {low:g} Hz": tuple(start), f"at most, {low:g} to {high:g} Hz": tuple(most)}


# `massline pretest` from options to output.


PRETEST_RESULT = "pretest.json"


def pretest_answer(question: PretestOptions, *, as_json: bool, plot: bool, out: Path | None) -> None:
    """Find out what is asked, print it, and draw it into `out`, or into ``out/`` where only `plot` is asked for.

    Raises
    ------
    BadInput : something that was asked cannot be used.
    CheckFailed : nothing can be rendered on this machine.
    """
    if out is not None:
        require_folder(out, "--out")
    with percent(f"pretest of {question.plan.article}", quiet=as_json) as told:
        found = findings(question, told)
    if as_json:
        click.echo(json_text(pretest_json(found)))
    else:
        click.echo(page(pretest_title(found), pretest_grids(found), pretest_notes(found)), nl=False)
    if out is not None:
        write_text(out / PRETEST_RESULT, json_text(pretest_json(found)) + "\n")
        click.echo(f"massline: wrote {out / PRETEST_RESULT}.", err=True)
    if plot or out is not None:
        _draw(found, out or Path("out"), quiet=as_json)


def _draw(found: PretestFindings, folder: Path, *, quiet: bool) -> None:

    with shown(f"pictures of {found.question.plan.article}", quiet=quiet):
        paths = pretest_draw(found, folder)
    for path in paths:
        click.echo(f"massline: wrote {path}.", err=True)


# What is known of a campaign by itself: the map of its sensors, and the inertia that is identified from it without any model.


KNOWN = ("cuboid", "disc")
"""Parts that are known well enough to tell the FMD by: a campaign of nothing else is the tare of the others."""


NOT_MOUNTED = (
    "the result is seen from F and the drawing from its own origin, and campaign.toml has no [mounting] that says how the "
    "article stands; state it, and both are compared"
)


def campaign_part(
    one: Campaign, series: Sequence[Campaign], model: Model, band: tuple[float, float] | None, method: str
) -> CampaignPart:
    """What is known of the campaign `one` of a `series`; its tare is a campaign of the series whose article is known."""
    missing: list[str] = []
    tares = tuple(other.source for other in series if other is not one and is_tare(other) and not is_tare(one))
    asked = IdentifyOptions(campaign=one.source, tares=tares, band=band, spectra=method, study=False)
    findings = _findings(asked, missing)
    return CampaignPart(
        campaign=one,
        sensors=_sensors(one, missing),
        findings=findings,
        reference=None if findings is None else _reference(findings, model, missing),
        command=command(asked),
        missing=tuple(missing),
    )


def is_tare(one: Campaign) -> bool:
    """Whether nothing but known parts stand on the FMD."""
    parts = above_fmd(one.article).split("+")
    return bool(parts) and set(parts) <= set(KNOWN)


def command(asked: IdentifyOptions) -> str:
    """The command line that gives the same findings."""
    band = [] if asked.band is None else ["--band", *(f"{one:g}" for one in asked.band)]
    tares = [word for tare in asked.tares for word in ("--tare", tare)]
    return " ".join(["massline identify", asked.campaign, *tares, *band, "--spectra", asked.spectra, "--no-study"])


def _findings(asked: IdentifyOptions, missing: list[str]) -> IdentificationFindings | None:
    try:
        return identification_identified(asked)
    except (BadInput, CheckFailed) as error:
        missing.append(f"No inertia was identified: {error}")
        return None


def _sensors(one: Campaign, missing: list[str]) -> Picture | None:
    said = f"Sensors of {Path(one.source).name}, seen from F: accelerometers of table, cover plate and article, and load cells"
    try:
        return drawn(lambda folder: sensor_map(one, folder), said)
    except CheckFailed as error:
        missing.append(f"No map of the sensors: {error}")
        return None


def _reference(found: IdentificationFindings, model: Model, missing: list[str]) -> Statement | None:
    """Of what was identified, as it is drawn, in the frame of the result.

    None where no drawing is known, with an FMD that the model knows otherwise, and where nothing says how the article stands.
    """
    if found.article.split("+")[0] == FMD and model.fmd is not None:
        return None
    source = drawing_of(found.article, model)
    if not source:
        return None
    frame = _campaigns_frame(found)
    if frame is None:
        missing.append(f"Nothing is held against the drawing of {found.article}: {NOT_MOUNTED}")
        return None
    changes = model.changes if is_stack(found.article) else {}
    try:
        return reference(source, None, ArticleOptions(changes=changes), frame)[1]
    except (BadInput, CheckFailed):
        return None


def _campaigns_frame(found: IdentificationFindings) -> Pose | None:
    """That of the result, seen from the drawing's; None where nobody stated it. The frame of a stack from the FMD up is F's."""
    if found.origin != "F" or found.article.split("+")[0] == FMD:
        return Pose()
    mount = stated(found.request.campaign)
    return None if mount is None else mount.inverse


# Identified inertia with the effects of the model: what its ladder says, or what a fit finds where no rung says it.
#
# Identification from raw records knows no effect: a load cell that reads too much makes an article too heavy there. With the
# effects of the model its fault is taken out.


Progress = Callable[[str, float], None]


def identified(
    study: Study, comparison: Comparison, at: HistoryPosition | None, progress: Progress
) -> tuple[tuple[Body, ...], str]:
    """Of the rung on which the model stands, where that stands on the same data; else of a fit. None of a model without effects
    that no rung has, and none where there is a reason, which is told.

    Parameters
    ----------
    comparison : of the `study`

    Raises
    ------
    OSError : a file cannot be read.
    """
    if at is not None and _is_of(at, conditions_of(study), comparison):
        return (() if at.rung is None else at.rung.bodies), ""
    if not study.model.effects:
        return (), ""
    try:
        body = body_of(study, comparison.evaluation.plain_fit, lambda share: progress("identifying", share))
    except (BadInput, CheckFailed) as error:
        return (), str(error)
    return ((body,), "") if body is not None else ((), "no article stood on the FMD")


def _is_of(at: HistoryPosition, conditions: Conditions, comparison: Comparison) -> bool:
    """Whether the rung stands on the data of `conditions`, with the same held out."""
    rung = at.rung
    if rung is None or rung.errors is None:
        return False
    held = rung.errors.held_out_names == comparison.evaluation.held_out_names
    return held and replace(rung.conditions, hold_out=()).same(replace(conditions, hold_out=()))


# Identified inertia with intervals and verdicts beside its reference: with the effects of the model, then from raw records.


RAW = "Identified from the records as they were read: no effect of the model is taken out of them."


def html(report: Report, figures: Figures) -> Safe:
    """The section; empty where nobody identified anything."""
    parts = [_with_effects(one, report, figures) for one in report.identified]
    if report.not_identified:
        parts.append(parts_notes([f"With the effects of the model no inertia was identified: {report.not_identified}"]))
    parts += [_campaign(one, figures) for one in report.campaigns if one.findings is not None or one.missing]
    return section("inertia", "Identified inertia", *parts) if parts else Safe("")


def _with_effects(body: Body, report: Report, figures: Figures) -> Safe:
    from validation.report.charts.history import identified_inertia

    effects = report.comparison.effects
    title = (
        f"{body.article}, with the effects of the model" if effects else f"{body.article}, with the model, which has no effects"
    )
    columns = [Column(head="quantity", words=True), Column(head="unit", words=True), Column(head="identified")]
    columns += [Column(head="± 95 %"), Column(head="the model"), Column(head="less the model"), Column(head="in intervals")]
    rows: list[list[Cell]] = [[quantity.label, quantity.unit, *_held(body, k)] for k, quantity in enumerate(QUANTITIES)]
    note = "CoG from the article's own origin; moments and products about it, as matrix entries. In intervals: 1 is its end."
    said = [
        f"Effects of the model: {', '.join(effects)}" if effects else "",
        "From all data that are fitted, ten parameters free beside what the plain fit frees",
        "The model: its own inertia with its effects",
        "" if body.converged else "The fit did not end by itself",
    ]
    return tag(
        "div",
        tag("h3", title),
        table(f"{title}: mass, CoG and inertia", columns, rows, note=note),
        figures.placed(identified_inertia({"identified": body}, f"{title}: identified less the model, 95 % intervals")),
        parts_notes(said),
        class_="part",
    )


def _held(body: Body, k: int) -> tuple[Cell, ...]:
    """One quantity: identified, half of its interval, the model's, how far apart."""
    value, half, model = (float(one[k]) * QUANTITIES[k].per_si for one in (body.values, body.half_width, body.reference))
    many = (value - model) / half if half else None
    return (
        toleranced(value, half),
        toleranced(half, half),
        toleranced(model, half),
        toleranced(value - model, half),
        number(many, "+.2f"),
    )


def _campaign(one: CampaignPart, figures: Figures) -> Safe:
    from validation.report.charts.history import identified_inertia

    found = one.findings
    if found is None:
        return joined(tag("h3", f"From the raw records of {one.campaign.source}"), parts_notes(one.missing))
    bodies = bodies_of(found, one.reference)
    figure = (
        figures.placed(identified_inertia(bodies, f"{found.article}: identified less drawn, 95 % intervals")) if bodies else None
    )
    return tag(
        "div",
        tag("h3", f"{found.article}, from the raw records of {one.campaign.source}"),
        paragraphs([RAW]),
        parts_notes(found.doubts),
        _table(found, one.reference),
        figure,
        _verdicts(found),
        parts_notes([*identification_notes(found), *one.missing, f"The same by itself: {one.command}" if one.command else ""]),
        class_="part",
    )


def bodies_of(found: IdentificationFindings, reference: Statement | None) -> dict[str, Body]:
    """Every result beside the reference; none where a value of that is not known."""
    if reference is None or not reference.complete:
        return {}
    drawn = np.array([0.0 if one is None else one.value for one in reference.values])
    return {one.identified.way: _body(found.article, one, drawn) for one in found.results}


def _body(article: str, one: Reported, reference: Array) -> Body:
    return Body(article=article, values=one.values, deviation=one.half_width / NORMAL_95, reference=reference)


def _table(found: IdentificationFindings, reference: Statement | None) -> Safe:
    columns = [Column(head="quantity", words=True), Column(head="unit", words=True), Column(head="drawn")]
    for one in found.results:
        way = one.identified.way
        columns += [Column(head=way), Column(head="± 95 %"), Column(head=f"{way} less drawn"), Column(head="in intervals")]
    rows = [
        [
            quantity.label,
            quantity.unit,
            _drawn(reference, k),
            *(cell for one in found.results for cell in _cells(one, reference, k)),
        ]
        for k, quantity in enumerate(QUANTITIES)
    ]
    where = "from the article's own origin" if found.origin == "article" else "from F"
    note = f"CoG {where}; moments and products about the CoG, products as matrix entries. In intervals: 1 is its end."
    return table(
        f"{found.article}: mass, CoG and inertia, {found.result.identified.way} counts, raw records", columns, rows, note=note
    )


def _drawn(reference: Statement | None, k: int) -> Cell:
    known = None if reference is None else reference.values[k]
    return TABLES_NOTHING if known is None else number(known.value * QUANTITIES[k].per_si, ".6g")


def _cells(one: Reported, reference: Statement | None, k: int) -> tuple[Cell, ...]:
    per_si = QUANTITIES[k].per_si
    value, half = float(one.values[k]) * per_si, float(one.half_width[k]) * per_si
    known = None if reference is None else reference.values[k]
    apart = None if known is None else value - known.value * per_si
    many = None if apart is None or not half else apart / half
    return toleranced(value, half), toleranced(half, half), toleranced(apart, half), number(many, "+.2f")


def _verdicts(found: IdentificationFindings) -> Safe:
    if len(alike := set(found.verdict.values())) == 1:
        return paragraphs([f"All ten values: {alike.pop()}."])
    names = zip(QUANTITIES, request.QUANTITIES, strict=True)
    rows: list[list[Cell]] = [[quantity.label, found.verdict.get(name, NONE)] for quantity, name in names]
    columns = [Column(head="quantity", words=True), Column(head="what is to be thought of it", words=True)]
    return table(f"{found.article}: verdicts on the {found.result.identified.way} result", columns, rows)
