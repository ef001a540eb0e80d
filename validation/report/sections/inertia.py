"""Identified inertia with intervals and verdicts beside its reference: with the effects of the model, then from raw records."""

from __future__ import annotations

import numpy as np

from geometry.arrays import Array
from identification import classical
from identification.quality import NORMAL_95
from validation.identifying.findings import Findings
from validation.identifying.reported import Reported
from validation.identifying.table import notes as table_notes
from validation.ladders.nouns import Body
from validation.report.figures import Figures
from validation.report.markup import Safe, joined, tag
from validation.report.nouns import CampaignPart, Report
from validation.report.sections.parts import notes, paragraphs, section
from validation.report.tables import NOTHING, Cell, Column, number, table, toleranced
from validation.rows import NONE
from validation.statement import QUANTITIES, Statement

RAW = "Identified from the records as they were read: no effect of the model is taken out of them."


def html(report: Report, figures: Figures) -> Safe:
    """The section; empty where nobody identified anything."""
    parts = [_with_effects(one, report, figures) for one in report.identified]
    if report.not_identified:
        parts.append(notes([f"With the effects of the model no inertia was identified: {report.not_identified}"]))
    parts += [_campaign(one, figures) for one in report.campaigns if one.findings is not None or one.missing]
    return section("inertia", "Identified inertia", *parts) if parts else Safe("")


def _with_effects(body: Body, report: Report, figures: Figures) -> Safe:
    from validation.plots.inertia import identified_inertia

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
        notes(said),
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
    from validation.plots.inertia import identified_inertia

    found = one.findings
    if found is None:
        return joined(tag("h3", f"From the raw records of {one.campaign.source}"), notes(one.missing))
    bodies = bodies_of(found, one.reference)
    figure = (
        figures.placed(identified_inertia(bodies, f"{found.article}: identified less drawn, 95 % intervals")) if bodies else None
    )
    return tag(
        "div",
        tag("h3", f"{found.article}, from the raw records of {one.campaign.source}"),
        paragraphs([RAW]),
        notes(found.doubts),
        _table(found, one.reference),
        figure,
        _verdicts(found),
        notes([*table_notes(found), *one.missing, f"The same by itself: {one.command}" if one.command else ""]),
        class_="part",
    )


def bodies_of(found: Findings, reference: Statement | None) -> dict[str, Body]:
    """Every result beside the reference; none where a value of that is not known."""
    if reference is None or not reference.complete:
        return {}
    drawn = np.array([0.0 if one is None else one.value for one in reference.values])
    return {one.identified.way: _body(found.article, one, drawn) for one in found.results}


def _body(article: str, one: Reported, reference: Array) -> Body:
    return Body(article=article, values=one.values, deviation=one.half_width / NORMAL_95, reference=reference)


def _table(found: Findings, reference: Statement | None) -> Safe:
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
    return NOTHING if known is None else number(known.value * QUANTITIES[k].per_si, ".6g")


def _cells(one: Reported, reference: Statement | None, k: int) -> tuple[Cell, ...]:
    per_si = QUANTITIES[k].per_si
    value, half = float(one.values[k]) * per_si, float(one.half_width[k]) * per_si
    known = None if reference is None else reference.values[k]
    apart = None if known is None else value - known.value * per_si
    many = None if apart is None or not half else apart / half
    return toleranced(value, half), toleranced(half, half), toleranced(apart, half), number(many, "+.2f")


def _verdicts(found: Findings) -> Safe:
    if len(alike := set(found.verdict.values())) == 1:
        return paragraphs([f"All ten values: {alike.pop()}."])
    names = zip(QUANTITIES, classical.QUANTITIES, strict=True)
    rows: list[list[Cell]] = [[quantity.label, found.verdict.get(name, NONE)] for quantity, name in names]
    columns = [Column(head="quantity", words=True), Column(head="what is to be thought of it", words=True)]
    return table(f"{found.article}: verdicts on the {found.result.identified.way} result", columns, rows)
