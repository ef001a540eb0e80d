"""The ladder: every version of the model, how its errors fell, and how identified inertia moved."""

from __future__ import annotations

from validation.ladders.climbing import Standing
from validation.ladders.nouns import Rung
from validation.ladders.table import notes as table_notes
from validation.report.figures import Figures
from validation.report.markup import Safe, joined, tag
from validation.report.nouns import Report
from validation.report.sections.parts import notes, paragraphs, section
from validation.report.tables import Cell, Column, number, table

NONE_YET = "The model has no ladder yet: `massline add MODEL EFFECT DATA ...` adds an effect, fits it and keeps both versions."


def html(report: Report, figures: Figures) -> Safe:
    """The section."""
    at = report.standing
    if at is None or not any(one.errors for one in at.ladder.rungs):
        return section("ladder", "The ladder", paragraphs([NONE_YET]))
    from validation.plots.ladder import falling_errors

    return section(
        "ladder",
        "The ladder",
        figures.placed(falling_errors(at), "Strong: the way to the rung on which the model stands. Open circles: branches."),
        _rungs(at),
        *_inertia(at, figures),
        *(_verdict(one) for one in at.ladder.rungs if one.verdict),
        notes(table_notes(at)),
    )


def _rungs(at: Standing) -> Safe:
    columns = [
        Column(head="rung", words=True),
        Column(head="from", words=True),
        Column(head="what changed", words=True),
        Column(head="nominal", unit="%"),
        Column(head="plain", unit="%"),
        Column(head="held out", unit="%"),
        Column(head="χ² per dof"),
        Column(head="sum z²"),
        Column(head="due"),
        Column(head="evidence", unit="nats"),
        Column(head="when", words=True),
    ]
    here = None if at.rung is None else at.rung.number
    rows = [_row(one, one.number == here) for one in at.ladder.rungs]
    return table("Rungs", columns, rows)


def _row(one: Rung, here: bool) -> list[Cell]:
    of = one.errors
    told = (None,) * 6 if of is None else (of.nominal, of.plain, of.held_out, of.chi2_per_dof, of.tolerance_z2, of.due_z2)
    parent = "" if one.parent is None else f"{one.parent}"
    name = f"{one.number} (here)" if here else f"{one.number}"
    return [
        name,
        parent,
        one.title,
        *(number(each, ".4g") for each in told),
        number(one.gain, "+.1f"),
        one.when.replace("T", " ")[:16],
    ]


def _inertia(at: Standing, figures: Figures) -> list[Safe]:
    """How identified inertia moved along the way, article by article."""
    from validation.plots.inertia import identified_inertia
    from validation.plots.ladder import way_to

    found = []
    way = way_to(at)
    for article in dict.fromkeys(body.article for one in way for body in one.bodies):
        bodies = {f"{one.number} {one.title}": body for one in way for body in one.bodies if body.article == article}
        found.append(
            figures.placed(identified_inertia(bodies, f"{article}: identified less the model of each rung, 95 % intervals"))
        )
    return found


def _verdict(one: Rung) -> Safe:
    return joined(tag("p", tag("strong", f"Rung {one.number}, {one.title}: "), " ".join(one.verdict)))
