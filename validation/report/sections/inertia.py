"""Identified inertia with intervals and verdicts, plain and self-calibrated, beside its reference."""

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


def html(report: Report, figures: Figures) -> Safe:
    """The section; empty where nobody identified anything."""
    parts = [_campaign(one, figures) for one in report.campaigns if one.findings is not None or one.missing]
    return section("inertia", "Identified inertia", *parts) if parts else Safe("")


def _campaign(one: CampaignPart, figures: Figures) -> Safe:
    from validation.plots.inertia import identified_inertia

    found = one.findings
    if found is None:
        return joined(tag("h3", one.campaign.source), notes(one.missing))
    bodies = bodies_of(found, one.reference)
    figure = (
        figures.placed(identified_inertia(bodies, f"{found.article}: identified less drawn, 95 % intervals")) if bodies else None
    )
    return tag(
        "div",
        tag("h3", f"{found.article}, from {one.campaign.source}"),
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
    return table(f"{found.article}: mass, CoG and inertia, {found.result.identified.way} counts", columns, rows, note=note)


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
