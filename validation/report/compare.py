"""The pictures of `massline compare`: what each of them shows, from the comparison."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
import numpy as np

from geometry.atomic import write_text
from geometry.dynamic_mass import MOTIONS, DynamicMass
from geometry.frames import Array
from geometry.inertia import LOADS
from validation.compare.compare import Comparison, FactComparison, WorstPair, compared, worst_pairs
from validation.compare.maps import Map, NamedMode, Pairs
from validation.compare.spots import SENSED, Spot, run, text
from validation.estimation.result import Fit, Share
from validation.estimation.verdicts import ABSURD, MISFIT, STANDS_OUT, StatedError, Tolerance, absurd, expected_z2, figure, misfit
from validation.identify.identify import UsedLines
from validation.output import json_text, plain_unit, shown, stages
from validation.reference.reference import file_name
from validation.reference.statement import NONE, rounded
from validation.report.charts import crosscheck
from validation.report.charts.style import MEASURED, DynamicMassCurve, chosen
from validation.report.document import Cell, Column, Figures, Grid, Safe, aligned, joined, number, page, table, tag, toleranced
from validation.report.parts import CampaignPart, Report, picture, section, verdict
from validation.report.parts import notes as parts_notes
from validation.study import Options, Study, read

if TYPE_CHECKING:
    from validation.report.charts.style import Figure


# The page of `massline compare`: four errors, the worst spots in words, runs and configurations, pairs of axes,
# tolerances, facts.


COMPARISON_PAIRS = 5

CHANCE = 3
"""Spots that are shown where none stands out."""

SIGNS = ("x", "y", "z", "α", "β", "γ")
"""Of loads and base motions in the name of an entry of H."""


def title(found: Comparison) -> str:
    """Model and data."""
    return f"{found.title} beside {', '.join(found.data_sets)}"


def grids(found: Comparison) -> list[Grid]:
    """All tables, in the order in which they are read."""
    pairs = worst_pairs(found.maps, COMPARISON_PAIRS)
    return [
        errors(found),
        spots(found),
        runs(found.maps),
        *([entries(found)] if pairs else []),
        *([moved(found)] if absurd(found.evaluation.fitted) else []),
        *([facts(found)] if found.facts else []),
    ]


def errors(found: Comparison) -> Grid:
    """The four errors: figure, meaning, verdict."""
    lines = tuple((one.name, one.figure, _judged(one.verdict, one.text, one.meaning)) for one in found.errors)
    return Grid(header=("", "error", "what it means, and what is to be thought of it"), lines=lines, words=True)


def _judged(verdict: str, text: str, meaning: str) -> str:
    said = f"{verdict.upper()}: {text}" if verdict else text
    return f"{meaning}. {said}" if said else meaning


def spots(found: Comparison) -> Grid:
    """The worst spots in words; where none stands out the worst three, as chance leaves them."""
    count = len(found.maps)
    shown = [one for one in found.worst if one.sigma >= STANDS_OUT] or found.worst[:CHANCE]
    lines = tuple((f"{k:>2}", figure(one.sigma), text(one, count)) for k, one in enumerate(shown, start=1))
    return Grid(header=("", "sigma", "where it fails"), lines=lines, words=True)


def runs(maps: tuple[Map, ...]) -> Grid:
    """Chi² per degree of freedom of every run of every data set, tolerances counted."""
    names = list(dict.fromkeys(name for one in maps for name in one.runs))
    by_name = [dict(zip(one.runs, one.misfit.mean(axis=1), strict=True)) for one in maps]
    columns = [aligned(tuple(figure(of[name]) if name in of else NONE for of in by_name)) for name in names]
    lines = tuple(zip((one.data_set for one in maps), *columns, strict=True))
    return Grid(header=("chi² by run", *names), lines=lines)


def entries(found: Comparison) -> Grid:
    """The pairs of axes in which predicted and measured dynamic mass differ most."""
    lines = [
        (
            f"H {SIGNS[one.load]}{SIGNS[one.motion]} of {one.data_set}",
            figure(one.sigma),
            f"{figure(one.percent)} %",
            f"{one.frequency:.2f}",
        )
        for one in worst_pairs(found.maps, COMPARISON_PAIRS)
    ]
    first, *rest = zip(*lines, strict=True)
    return Grid(header=("dynamic mass", "sigma", "of it", "at [Hz]"), lines=tuple(zip(first, *map(aligned, rest), strict=True)))


def moved(found: Comparison) -> Grid:
    """The most absurd tolerances."""
    lines = [
        (one.parameter.name, f"{one.z:+.1f}", f"{one.offset:+.3g} {_unit(one.parameter.unit)}".rstrip())
        for one in found.absurd
        if abs(one.z) >= min(ABSURD, abs(found.absurd[0].z))
    ]
    first, *rest = zip(*lines, strict=True)
    return Grid(header=("absurd tolerances", "z", "moved by"), lines=tuple(zip(first, *map(aligned, rest), strict=True)))


def _unit(unit: str) -> str:
    return "" if unit == "1" else unit


def facts(found: Comparison) -> Grid:
    """Classical measurements, predicted minus measured."""
    lines = [
        (
            f"{one.name} [{one.unit}]",
            rounded(one.measured, one.tolerance),
            rounded(one.tolerance, one.tolerance),
            rounded(one.predicted, one.tolerance),
            f"{one.sigma:+.1f}",
            f"{one.nominal_sigma:+.1f}",
        )
        for one in found.facts
    ]
    first, *rest = zip(*lines, strict=True)
    header = ("classical measurements", "measured", "sd", "predicted", "sigma", "nominal")
    return Grid(header=header, lines=tuple(zip(first, *map(aligned, rest), strict=True)))


def notes(found: Comparison) -> Iterator[str]:
    """What must be known to read the tables, then what was assumed."""
    first = found.worst[0].sigma if found.worst else 0.0
    if first < STANDS_OUT:
        yield f"Nothing stands out: the worst spot is {figure(first)} sigma, and chance reaches about {STANDS_OUT - 1:g}."
    elif below := sum(one.sigma < STANDS_OUT for one in found.worst):
        yield f"{below} more of the ten worst spots are below {STANDS_OUT:g} sigma, as chance leaves them."
    yield (
        "Sigma: deviation at the plain fit over what noise, a model error of 0.15 % and all tolerances that were not fitted let "
        "expect. A channel's is from what all other channels and the model say of it."
    )
    yield from _resonances(found)
    if found.evaluation.held_out_names:
        yield f"Held out: {_some(found.evaluation.held_out_names)}."
    if found.effects:
        yield f"Effects in the model: {', '.join(found.effects)}."
    yield from (f"warning: {text}." for text in found.remarks)


def _resonances(found: Comparison) -> Iterator[str]:
    """Modes within the band by name."""
    for of, modes in zip(found.maps, found.modes, strict=True):
        inside = [one for one in modes if of.frequency[0] <= one.frequency <= of.frequency[-1]]
        if inside:
            yield f"Modes of {of.data_set}: {_some([f'{one.name} {one.frequency:.2f} Hz' for one in inside], 8)}."


def _some(names: tuple[str, ...] | list[str], most: int = 4) -> str:
    more = len(names) - most
    return ", ".join(names) if more <= 0 else f"{', '.join(names[:most])} and {more} more"


PAIRS = 6

NOTE = "Deviation at the plain fit over what noise, a model error of 0.15 % and all tolerances that were not fitted let expect. "
THRESHOLD = f"Beyond {crosscheck.THRESHOLD:g} (black bar of the scale) it is no chance. Triangles: modes of the model."


@dataclass(frozen=True, eq=False, kw_only=True)
class _Marks:
    """Modes as resonances to be marked."""

    frequency: Array
    effective_mass: Array


def draw(found: Comparison, folder: Path) -> tuple[Path, ...]:
    """Write every picture that `found` has the evidence for into `folder`, and say where they are."""
    made: list[Path] = []

    def to(name: str) -> Path:
        made.append(folder / f"{file_name(f'compare-{name}')}.png")
        return made[-1]

    _errors(found, to("errors"))
    _runs(found, to("runs"))
    for of, modes in zip(found.maps, found.modes, strict=True):
        draw_channels(of, modes, to(f"{of.data_set}-channels"))
        if of.pairs is not None:
            _pairs(of.pairs, modes, to(f"{of.data_set}-pairs"))
    if any(of.pairs is not None for of in found.maps):
        _dynamic_mass(found, to("dynamic-mass"))
    return tuple(made)


def _errors(found: Comparison, path: Path) -> None:
    of = found.evaluation
    nominal, plain, fitted, held = found.errors
    bars = [
        crosscheck.DrawnError(name="nominal", percent=of.nominal.percent, verdict=nominal.verdict),
        crosscheck.DrawnError(name="plain", percent=of.plain.percent, verdict=plain.verdict),
    ]
    if of.held_out is not None:
        bars.append(crosscheck.DrawnError(name="held out, plain", percent=of.held_out.percent, verdict=held.verdict))
    price = of.fitted.tolerance_z2 / max(expected_z2(of.fitted), 1.0)
    prices = [
        crosscheck.DrawnError(name="chi² per degree of freedom", percent=misfit(of.fitted), verdict=_chi2(found)),
        crosscheck.DrawnError(name="z² of the tolerances", percent=price, verdict="failed" if absurd(of.fitted) else "good"),
    ]
    note = f"Fitted: {fitted.text}."
    crosscheck.draw_errors(f"{found.title}: the four errors", bars, found.explained.measurement, prices, path, note)


def _chi2(found: Comparison) -> str:
    return "failed" if misfit(found.evaluation.fitted) > MISFIT else "good"


def _runs(found: Comparison, path: Path) -> None:
    columns = tuple(dict.fromkeys(name for of in found.maps for name in of.runs))
    sigma = np.full((len(found.maps), len(columns)), np.nan)
    percent = sigma.copy()
    for a, of in enumerate(found.maps):
        for k, name in enumerate(of.runs):
            at = (a, columns.index(name))
            sigma[at] = of.sigma[k].max()
            percent[at] = found.evaluation.plain.by_run.get(f"{of.data_set}/{name}", np.nan)
    drawn = crosscheck.DrawnRuns(rows=found.data_sets, columns=columns, sigma=sigma, percent=percent)
    crosscheck.draw_runs(
        f"{found.title}: runs", drawn, path, "The worst cell of each run in sigmas, and its plain error in per cent."
    )


def draw_channels(of: Map, modes: Sequence[NamedMode], path: Path) -> None:
    """Write the map of channels and loads over frequency, a panel a run."""
    rows = tuple(SENSED.get(name, name) for name in of.rows)
    sigma = np.where(np.isfinite(of.expected), of.sigma, np.nan)
    maps = [
        crosscheck.ResidualMap(
            title=run(name, axis),
            frequency=of.frequency,
            rows=rows,
            sigma=sigma[k],
            modes=_frequencies(modes),
            rules=_rules(of),
        )
        for k, (name, axis) in enumerate(zip(of.runs, of.axes, strict=True))
    ]
    note = NOTE + THRESHOLD
    crosscheck.draw_maps(f"{of.data_set}: channels and loads", maps, path, note)


def _frequencies(modes: Sequence[NamedMode]) -> tuple[float, ...]:
    return tuple(one.frequency for one in modes)


def _rules(of: Map) -> tuple[int, ...]:
    """Between channels of different kinds, told by the first part of their names, and the loads."""
    kinds = [name.partition("-")[0] for name in of.rows[: of.channels]]
    changes = [k for k in range(1, len(kinds)) if kinds[k] != kinds[k - 1]] if len(set(kinds)) <= 4 else []
    return (*changes, *([of.channels] if of.channels < len(of.rows) else []))


def _pairs(of: Pairs, modes: Sequence[NamedMode], path: Path) -> None:
    pairs = [(i, j) for i in range(6) for j in range(6)]
    rows = tuple(f"{SIGNS[i]}{SIGNS[j]}" for i, j in pairs)
    sigma = crosscheck.ResidualMap(
        title="in sigmas",
        frequency=of.frequency,
        rows=rows,
        sigma=of.sigma.reshape(len(of.frequency), 36),
        modes=_frequencies(modes),
        rules=(6, 12, 18, 24, 30),
    )
    percent = replace(sigma, title="in per cent of the dynamic mass", sigma=of.percent.reshape(len(of.frequency), 36))
    note = f"Predicted beside measured, about F; sigma as in the maps of the channels. {THRESHOLD}"
    crosscheck.draw_pairs(f"{of.campaign}: dynamic mass, load and base motion", sigma, percent, path, note)


def _dynamic_mass(found: Comparison, path: Path) -> None:
    by_name = {of.data_set: (of.pairs, modes) for of, modes in zip(found.maps, found.modes, strict=True) if of.pairs is not None}
    panels = [_entry(pair, *by_name[pair.data_set]) for pair in worst_pairs(found.maps, PAIRS)]
    note = "Blocked, about F: the pairs of axes that differ most. Dots: Eqs. 9 to 11. Line: model, plain fit, made likewise."
    chosen(f"{found.title}: predicted beside measured", panels, path, note)


def _entry(pair: WorstPair, of: Pairs, modes: Sequence[NamedMode]) -> tuple[str, int, int, tuple[DynamicMassCurve, ...]]:
    marks = _Marks(frequency=np.array(_frequencies(modes)), effective_mass=np.full((len(modes), 6), np.inf))
    both = ((of.predicted, "predicted", ""), (of.measured, "measured", MEASURED))
    curves = tuple(
        DynamicMassCurve(
            name=name, mass=DynamicMass(frequency=of.frequency, matrix=matrix), rigid=np.zeros((6, 6)), modes=marks, dots=dots
        )
        for matrix, name, dots in both
    )
    return f"{pair.data_set}, {pair.sigma:.0f} σ at {pair.frequency:.1f} Hz", pair.load, pair.motion, curves


# What `massline compare --json` prints: the contract's keys, and more beside them. Keys end in their unit.


COMPARING_AS_JSON_PAIRS = 10


def comparison_json(found: Comparison) -> dict[str, Any]:
    """The comparison as one object."""
    of = found.evaluation
    return {
        "model": found.source,
        "title": found.title,
        "effects": list(found.effects),
        "plain_error_percent": of.plain.percent,
        "fitted_chi2_per_dof": misfit(of.fitted),
        "tolerance_z2": of.fitted.tolerance_z2,
        "worst": [_spot(one, len(found.maps)) for one in found.worst],
        "nominal_error_percent": of.nominal.percent,
        "held_out_error_percent": _percent(of.held_out),
        "held_out_nominal_error_percent": _percent(of.held_out_nominal),
        "held_out_configurations_error_percent": _percent(of.held_out_configurations),
        "held_out_configurations_nominal_error_percent": _percent(of.held_out_configurations_nominal),
        "held_out": list(of.held_out_names),
        "explained_error_percent": found.explained.measurement,
        "explained_error_with_modes_percent": found.explained.with_modes,
        "tolerances": of.fitted.tolerances,
        "tolerance_z2_expected": expected_z2(of.fitted),
        "evidence_nats": of.fitted.log_evidence,
        "converged": of.plain_fit.converged and of.fitted.converged,
        "errors": [_told(one) for one in found.errors],
        "error_percent": {"nominal": _share(of.nominal), "plain": _share(of.plain), "held_out": _share(of.held_out)},
        "absurd_tolerances": [_tolerance(one) for one in found.absurd],
        "parameters": {"plain": parameters(of.plain_fit), "fitted": parameters(of.fitted)},
        "worst_pairs": [
            {
                "campaign": one.data_set,
                "load": LOADS[one.load],
                "motion": MOTIONS[one.motion],
                "frequency_hz": one.frequency,
                "sigma": one.sigma,
                "percent": one.percent,
            }
            for one in worst_pairs(found.maps, COMPARING_AS_JSON_PAIRS)
        ],
        "maps": [_map(one, modes) for one, modes in zip(found.maps, found.modes, strict=True)],
        "classical": [_fact(one) for one in found.facts],
        "warnings": list(found.remarks),
    }


def _spot(one: Spot, count: int) -> dict[str, Any]:
    return {
        "campaign": one.data_set,
        "run": one.run,
        "channel": one.row,
        "frequency_hz": one.frequency,
        "sigma": one.sigma,
        "text": text(one, count),
        "band_hz": list(one.band),
        "percent": one.percent,
        "follows": one.course or None,
        "also_in_channels": list(one.others),
        "also_in": [{"campaign": data_set, "run": run, "sigma": sigma} for data_set, run, sigma in one.elsewhere],
    }


def _told(one: StatedError) -> dict[str, Any]:
    return {"name": one.name, "figure": one.figure, "meaning": one.meaning, "verdict": one.verdict or None, "text": one.text}


def _percent(of: Share | None) -> float | None:
    return None if of is None else of.percent


def _share(of: Share | None) -> dict[str, Any] | None:
    if of is None:
        return None
    return {
        "percent": of.percent,
        "by_channel": dict(of.by_channel),
        "by_run": dict(of.by_run),
        "by_campaign": dict(of.by_data_set),
        "by_what_was_held_out": dict(of.by_fold),
    }


def _tolerance(one: Tolerance) -> dict[str, Any]:
    return {"name": one.parameter.name, "z": one.z, "offset_si": one.offset, "tolerance_si": one.parameter.tolerance}


def parameters(of: Fit) -> dict[str, Any]:
    """Every parameter of a fit by its name."""
    sd = np.sqrt(np.maximum(np.diag(of.covariance), 0.0))
    return {
        one.name: {"value_si": one.value(float(x)), "offset": float(x), "sd": float(s), "kind": one.kind}
        for one, x, s in zip(of.parameters, of.offsets, sd, strict=True)
    }


def _map(of: Map, modes: tuple[NamedMode, ...]) -> dict[str, Any]:
    """A map without its lines: every row's peak in every run. The pictures show the rest."""
    sigma = of.sigma
    return {
        "campaign": of.data_set,
        "article": of.configuration,
        "runs": list(of.runs),
        "channels": list(of.rows),
        "frequency_band_hz": [float(of.frequency[0]), float(of.frequency[-1])],
        "peak_sigma": sigma.max(axis=1).tolist(),
        "peak_frequency_hz": of.frequency[sigma.argmax(axis=1)].tolist(),
        "rms_sigma": np.sqrt(np.mean(sigma**2, axis=1)).tolist(),
        "chi2_per_dof_by_run": of.misfit.mean(axis=1).tolist(),
        "pairs_peak_sigma": None if of.pairs is None else _peak(of.pairs.sigma),
        "pairs_peak_percent": None if of.pairs is None else _peak(of.pairs.percent),
        "modes": [{"name": one.name, "frequency_hz": one.frequency, "damping_ratio": one.damping_ratio} for one in modes],
    }


def _peak(values: Array) -> Any:
    return values.max(axis=0).tolist()


def _fact(one: FactComparison) -> dict[str, Any]:
    return {
        "name": one.name,
        "sigma": one.sigma,
        "nominal_sigma": one.nominal_sigma,
        "unit": plain_unit(one.unit),
        "predicted": one.predicted,
        "measured": one.measured,
        "tolerance": one.tolerance,
    }


# `massline compare` from options to output: read, fit, map, show.


RESULT = "compare.json"
"""The file of a comparison in its folder."""


def answer(asked: Options, *, as_json: bool, folder: Path | None) -> None:
    """Compare what is `asked`, print it, and write JSON and pictures into `folder` (None: nowhere).

    Raises
    ------
    BadInput : something that was asked cannot be used.
    CheckFailed : a fit that does not converge.
    """
    found = comparison(asked, quiet=as_json)
    if as_json:
        click.echo(json_text(comparison_json(found)))
    else:
        click.echo(page(title(found), grids(found), notes(found)), nl=False)
    if folder is not None:
        _write(found, folder, quiet=as_json)


def comparison(asked: Options, *, quiet: bool = True) -> Comparison:
    """The comparison that `asked` leads to.

    Raises
    ------
    BadInput, CheckFailed : see `answer`.
    """
    with stages("reading", quiet=quiet) as told:
        model, data = read(asked, told)
    with stages("comparing", quiet=quiet) as told:
        return compared(Study.of(model, data, asked, told), told)


def _write(found: Comparison, folder: Path, *, quiet: bool) -> None:

    write_text(folder / RESULT, json_text(comparison_json(found)) + "\n")
    click.echo(f"massline: wrote {folder / RESULT}.", err=True)
    with shown("pictures", quiet=quiet):
        paths = draw(found, folder)
    for path in paths:
        click.echo(f"massline: wrote {path}.", err=True)


# Condition number of Eqs. 9 to 11, campaign by campaign.


def html(report: Report, figures: Figures) -> Safe:
    """The section; empty where no line has a condition number."""
    known = [(one.campaign.source, one.findings.lines) for one in report.campaigns if one.findings is not None]
    parts = [_campaign(name, lines, figures) for name, lines in known if lines is not None]
    return section("condition", "Condition number of Eqs. 9 to 11", *parts) if parts else Safe("")


def _campaign(name: str, lines: UsedLines, figures: Figures) -> Safe:
    from validation.report.charts.identification import condition

    worst, used = int(np.argmax(lines.condition)), int(np.sum(np.asarray(lines.kept) > 0))
    told = (
        f"{name}: at most {lines.condition[worst]:.3g}, at {lines.frequency[worst]:.4g} Hz; {used} of "
        f" {len(lines.frequency)} lines are used. Base motions of all runs, every axis divided by its nominal level"
    )
    return joined(figures.placed(condition(lines, name)), parts_notes([told, *lines.reasons]))


# Measured beside predicted dynamic mass: the six diagonals of every campaign, and any other entry by choice.


DYNAMIC_MASS_PAIRS = 10
"""Worst pairs that are listed."""

DYNAMIC_MASS_NOTE = (
    "Blocked dynamic mass of all that stands on the load cells, about F. Dots: measured, Eqs. 9 to 11. Line: the model at the "
    "plain fit, its channels put through the same equations. Band: two standard deviations, the σ of the maps, of the complex "
    "difference that noise and unfitted tolerances let expect. Phase of an entry that is next to nothing means nothing"
)


def dynamic_mass_html(report: Report, figures: Figures) -> Safe:
    """The section; empty where no dynamic mass was measured."""
    found = report.comparison
    both = [(of.pairs, modes) for of, modes in zip(found.maps, found.modes, strict=True) if of.pairs is not None]
    if not both:
        return Safe("")
    worst = worst_pairs(found.maps, 36 * len(both))
    parts = [_dynamic_mass_campaign(pairs, modes, worst, k, figures) for k, (pairs, modes) in enumerate(both)]
    return section(
        "dynamic-mass",
        "Dynamic mass, measured and predicted",
        parts_notes([DYNAMIC_MASS_NOTE]),
        _worst(worst[:DYNAMIC_MASS_PAIRS]),
        *parts,
    )


def _dynamic_mass_campaign(
    pairs: Pairs, modes: Sequence[NamedMode], worst: Sequence[WorstPair], k: int, figures: Figures
) -> Safe:
    from validation.report.charts.maps import diagonal

    group = f"entry-{k}"
    first = next(one for one in worst if one.data_set == pairs.campaign)
    every = _entries(pairs, modes)
    figures.choices(group, every)
    key = f"{first.load}-{first.motion}"
    choice = tag(
        "div", _select("load", group, first.load), _select("base motion", group, first.motion), class_="choice screen-only"
    )
    return tag(
        "div",
        tag("h3", pairs.campaign),
        figures.placed(diagonal(pairs, modes=modes)),
        tag("h4", "Any entry", class_="screen-only"),
        choice,
        figures.placed(every[key], screen_only=True, group=group, shown=key),
        class_="part",
    )


def _entries(pairs: Pairs, modes: Sequence[NamedMode]) -> dict[str, Figure]:
    from validation.report.charts.maps import overlay

    return {f"{i}-{j}": overlay(pairs, i, j, modes=modes) for i in range(6) for j in range(6)}


def _select(what: str, group: str, chosen: int) -> Safe:
    from validation.report.charts.maps import LOADS, MOTIONS, SIGNS

    names = LOADS if what == "load" else MOTIONS
    options = [
        tag("option", f"{sign}: {name}", value=str(k), selected=k == chosen)
        for k, (sign, name) in enumerate(zip(SIGNS, names, strict=True))
    ]
    part = "load" if what == "load" else "motion"
    return tag("label", f"{what} ", tag("select", *options, data_choice=group, data_part=part))


def _worst(worst: Sequence[WorstPair]) -> Safe:
    from validation.report.charts.maps import LOADS, MOTIONS, entry

    columns = [
        Column(head="entry", words=True),
        Column(head="campaign", words=True),
        Column(head="load", words=True),
        Column(head="base motion", words=True),
        Column(head="at", unit="Hz"),
        Column(head="deviation", unit="σ"),
        Column(head="of the dynamic mass", unit="%"),
    ]
    rows: list[list[Cell]] = [
        [
            entry(one.load, one.motion),
            one.data_set,
            LOADS[one.load],
            MOTIONS[one.motion],
            number(one.frequency, ".2f"),
            number(one.sigma, ".3g"),
            number(one.percent, ".3g"),
        ]
        for one in worst
    ]
    return joined(table("The entries that differ most", columns, rows))


# The sensors of every campaign on a map.


def sensors_html(report: Report, figures: Figures) -> Safe:
    """The section; empty where nothing could be drawn."""
    parts = [_sensors_campaign(one) for one in report.campaigns if one.sensors is not None]
    return section("sensors", "Sensors", *parts) if parts else Safe("")


def _sensors_campaign(one: CampaignPart) -> Safe:
    return tag("div", tag("h3", f"{one.campaign.title} ({one.campaign.source})"), picture(one.sensors), class_="part")


# Where the model fails: four errors, the worst spots in words, maps in sigmas, runs, classical measurements.


SCALE = "Pale: what chance reaches. From 4 sigma on it is no chance. Triangles: modes of the model. Empty: nothing checks the row"


def where_html(report: Report, figures: Figures) -> Safe:
    """The section."""
    from validation.report.charts.crosscheck import four_errors

    found = report.comparison
    both = zip(found.maps, found.modes, strict=True)
    return section(
        "where",
        "Where it fails",
        _where_errors(found),
        figures.placed(four_errors(found)),
        _spots(found),
        *(_maps(of, modes, k, figures) for k, (of, modes) in enumerate(both)),
        parts_notes([SCALE]),
        _where_runs(found),
        _tolerances(found),
        _facts(found),
        parts_notes(notes(found)),
    )


def _where_errors(found: Comparison) -> Safe:
    columns = [
        Column(head="error", words=True),
        Column(head="size"),
        Column(head="unit", words=True),
        Column(head="verdict", words=True),
        Column(head="what it means, and what is to be thought of it", words=True),
    ]
    of, (nominal, plain, fitted, held) = found.evaluation, found.errors
    rows = [
        _error(nominal.name, of.nominal.percent, "%", nominal),
        _error(plain.name, of.plain.percent, "%", plain),
        _error("fitted error, χ² per degree of freedom", misfit(of.fitted), "1", fitted),
        _error("its price, the sum of z² of the tolerances", of.fitted.tolerance_z2, "1", None),
        _error(held.name, None if of.held_out is None else of.held_out.percent, "%", held),
    ]
    return table("The four errors", columns, rows)


def _error(name: str, size: float | None, unit: str, one: StatedError | None) -> list[Cell]:
    if one is None:
        return [name, number(size, ".4g"), unit, "", ""]
    said = f"{one.meaning}. {one.text[:1].upper()}{one.text[1:]}" if one.text else one.meaning
    return [name, number(size, ".4g"), unit, verdict(one.verdict), said]


def _spots(found: Comparison) -> Safe:
    columns = [
        Column(head="", words=True),
        Column(head="deviation", unit="σ"),
        Column(head="of the reading", unit="%"),
        Column(head="at", unit="Hz"),
        Column(head="row", words=True),
        Column(head="run", words=True),
        Column(head="campaign", words=True),
        Column(head="in words", words=True),
    ]
    rows: list[list[Cell]] = [
        [
            f"{k}",
            number(one.sigma, ".3g"),
            number(one.percent, ".3g"),
            number(one.frequency, ".2f"),
            one.row,
            one.run,
            one.data_set,
            text(one, len(found.maps)),
        ]
        for k, one in enumerate(found.worst, start=1)
    ]
    return table("The worst spots", columns, rows)


def _maps(of: Map, modes: tuple[NamedMode, ...], k: int, figures: Figures) -> Safe:
    from validation.report.charts.maps import channel_map, pair_map

    group = f"map-{k}"
    every = {"worst": channel_map(of, modes=modes)}
    every |= {str(at): channel_map(of, at, modes=modes) for at in range(len(of.runs))}
    figures.choices(group, every)
    pairs = figures.placed(pair_map(of.pairs, modes=modes)) if of.pairs is not None else None
    choice = tag(
        "div", tag("label", "run ", tag("select", *_options(of), data_choice=group, data_part="run")), class_="choice screen-only"
    )
    return tag(
        "div",
        tag("h3", f"Map of {of.data_set}"),
        choice,
        figures.placed(every["worst"], group=group, shown="worst"),
        pairs,
        class_="part",
    )


def _options(of: Map) -> Iterator[Safe]:
    yield tag("option", "the worst of all runs", value="worst", selected=True)
    for k, (name, axis) in enumerate(zip(of.runs, of.axes, strict=True)):
        yield tag("option", run(name, axis), value=str(k))


def _where_runs(found: Comparison) -> Safe:
    columns = [
        Column(head="run", words=True),
        Column(head="campaign", words=True),
        Column(head="plain error", unit="%"),
        Column(head="χ² per degree of freedom"),
        Column(head="worst cell", unit="σ"),
    ]
    by_run = found.evaluation.plain.by_run
    rows: list[list[Cell]] = [
        [
            name,
            of.data_set,
            number(by_run.get(f"{of.data_set}/{name}"), ".3g"),
            number(float(of.misfit[k].mean()), ".3g"),
            number(float(of.sigma[k].max()), ".3g"),
        ]
        for of in found.maps
        for k, name in enumerate(of.runs)
    ]
    return table("Runs", columns, rows)


def _tolerances(found: Comparison) -> Safe:
    columns = [
        Column(head="tolerance", words=True),
        Column(head="moved by", unit="z"),
        Column(head="moved by"),
        Column(head="unit", words=True),
    ]
    rows: list[list[Cell]] = [
        [one.parameter.name, number(one.z, "+.2f"), number(one.offset, "+.3g"), one.parameter.unit] for one in found.absurd
    ]
    note = "One standard deviation of what was known beforehand is 1 z. Beyond 4 no careful laboratory has it."
    return table("Tolerances that the fit of everything moved farthest", columns, rows, note=note)


def _facts(found: Comparison) -> Safe:
    columns = [
        Column(head="classical measurement", words=True),
        Column(head="unit", words=True),
        Column(head="measured"),
        Column(head="standard deviation"),
        Column(head="predicted"),
        Column(head="deviation", unit="σ"),
        Column(head="nothing fitted", unit="σ"),
    ]
    rows: list[list[Cell]] = [
        [
            one.name,
            one.unit,
            toleranced(one.measured, one.tolerance),
            toleranced(one.tolerance, one.tolerance),
            toleranced(one.predicted, one.tolerance),
            number(one.sigma, "+.2f"),
            number(one.nominal_sigma, "+.2f"),
        ]
        for one in found.facts
    ]
    return joined(table("Classical measurements beside the model", columns, rows))
