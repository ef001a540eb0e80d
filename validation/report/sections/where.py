"""Where the model fails: four errors, the worst spots in words, maps in sigmas, runs, classical measurements."""

from __future__ import annotations

from collections.abc import Iterator

from validation.comparing import table as said
from validation.comparing.comparison import Comparison
from validation.comparing.maps import Map
from validation.comparing.modes import NamedMode
from validation.comparing.verdicts import Told, misfit
from validation.comparing.words import run, text
from validation.report.figures import Figures
from validation.report.markup import Safe, joined, tag
from validation.report.nouns import Report
from validation.report.sections.parts import notes, section, verdict
from validation.report.tables import Cell, Column, number, table, toleranced

SCALE = "Pale: what chance reaches. From 4 sigma on it is no chance. Triangles: modes of the model. Empty: nothing checks the row"


def html(report: Report, figures: Figures) -> Safe:
    """The section."""
    from validation.plots.errors import four_errors

    found = report.comparison
    both = zip(found.maps, found.modes, strict=True)
    return section(
        "where",
        "Where it fails",
        _errors(found),
        figures.placed(four_errors(found)),
        _spots(found),
        *(_maps(of, modes, k, figures) for k, (of, modes) in enumerate(both)),
        notes([SCALE]),
        _runs(found),
        _tolerances(found),
        _facts(found),
        notes(said.notes(found)),
    )


def _errors(found: Comparison) -> Safe:
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


def _error(name: str, size: float | None, unit: str, one: Told | None) -> list[Cell]:
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
    from validation.plots.maps import channel_map, pair_map

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


def _runs(found: Comparison) -> Safe:
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
