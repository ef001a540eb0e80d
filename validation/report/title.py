"""The head of a page, for whoever signs it: the test, its instruments, the requirements and whether they are met.

All of it is what campaign and model files state; what they leave out is an empty line, to be filled in by hand.
"""

from collections.abc import Sequence

from geometry.frames import Array
from identification.campaign import Campaign
from validation.estimation.verdicts import DOUBTFUL, FAILED, GOOD
from validation.model.model import LIMITED, Requirement
from validation.model.setups import above_fmd
from validation.output import rounded
from validation.reference.statement import QUANTITIES
from validation.report.document import Cell, Column, Figures, Number, Safe, joined, table, tag
from validation.report.parts import Report, section, verdict

BLANK = tag("span", class_="blank")
"""What nobody stated: a line to write on."""

MET, NOT_MET, OPEN = "pass", "fail", "open"
KINDS = {MET: GOOD, NOT_MET: FAILED, OPEN: DOUBTFUL}
"""Verdicts on a requirement, and how they look: open is an interval of 95 % with the limit inside."""

TOO_OLD = "its calibration had run out"
"""Said of an instrument that was due before the day of the test."""


def html(report: Report, figures: Figures) -> Safe:
    """The head: what was tested, by whom, of what and when it was made; instruments; room for signatures."""
    made, found, campaigns = report.provenance, report.comparison, [part.campaign for part in report.campaigns]
    runs = [f"{one.title} ({one.source}, {len(one.runs)} run{'s' if len(one.runs) != 1 else ''})" for one in campaigns]
    tests = [one.data_set for one in found.maps[len(campaigns) :]]  # campaigns come first
    optional = {
        "campaigns": "; ".join(runs),
        "tests": "; ".join(tests),
        "classical": "; ".join(one.title for one in report.classical),
        "effects in it": ", ".join(found.effects),
    }
    facts = {
        "articles": ", ".join(dict.fromkeys(one.configuration for one in found.maps)),
        "serial number": _stated(campaigns, "serial_number"),
        "date of the test": _stated(campaigns, "date"),
        "place": _stated(campaigns, "place"),
        "operator": _stated(campaigns, "operator"),
        "requirements": _met(report) if report.model.requirements else BLANK,
        **{name: said for name, said in optional.items() if said},
        "model": found.source,
        "revision": report.model.revision or BLANK,
        "report made": f"{made.when}, with massline {made.versions.get('massline', '')}{', by ' + made.by if made.by else ''}",
    }
    signed = {"prepared by": made.by, "checked by": "", "released by, date": ""}
    lines = [tag("div", tag("span", name, class_="signed"), tag("span", what, class_="what")) for what, name in signed.items()]
    rows = [tag("tr", tag("th", name, scope="row"), tag("td", said)) for name, said in facts.items()]
    return tag(
        "header",
        tag("p", "massline · report of a model and its measurements", class_="kind"),
        tag("h1", found.title),
        tag("table", tag("tbody", *rows), class_="facts"),
        _instruments(campaigns) if campaigns else None,
        tag("div", *lines, class_="signatures"),
        id="top",
    )


def _stated(campaigns: Sequence[Campaign], key: str) -> str:
    """What the `campaigns` state under `key`, each once; a blank where none does."""
    return "; ".join(dict.fromkeys(value for one in campaigns if (value := getattr(one, key)))) or BLANK


def _instruments(campaigns: Sequence[Campaign]) -> Safe:
    rows: list[list[Cell]] = []
    for campaign in campaigns:
        for one in campaign.instruments:
            late = f"{one.due}: {TOO_OLD}" if one.due and campaign.date and one.due[:10] < campaign.date[:10] else one.due
            row: list[Cell] = [
                *(said or BLANK for said in (one.name, one.serial_number, one.calibrated, late)),
                ", ".join(one.channels),
            ]
            if row not in rows:
                rows.append(row)
    columns = [Column(head=head, words=True) for head in ("instrument", "serial number", "calibrated", "due", "channels")]
    return table("Instruments", columns, rows or [[BLANK] * len(columns)])


# Requirements of the model file, held against what was identified.


def requirements_html(report: Report, figures: Figures) -> Safe:
    """The section; nothing where nothing is required."""
    if not report.model.requirements:
        return Safe("")
    values, half, whence = _identified(report)
    rows: list[list[Cell]] = []
    for one in report.model.requirements:
        k = list(LIMITED).index(one.quantity)
        shown = QUANTITIES[k]
        limits = [Number(text="" if at is None else f"{at * shown.per_si:.6g}", value=at) for at in (one.low, one.high)]
        if values is None or half is None:
            found: list[Cell] = [BLANK, BLANK, BLANK]
        else:
            size, width = (float(x[k]) * shown.per_si for x in (values, half))
            word = judged(one, values, half)
            texts = Number(text=rounded(size, width), value=size), Number(text=f"{width:.2g}", value=width)
            found = [*texts, verdict(word, KINDS[word])]
        rows.append([shown.label, shown.unit, *limits, *found, one.clause or BLANK])
    columns = [
        Column(head="quantity", words=True),
        Column(head="unit", words=True),
        *(Column(head=head) for head in ("min", "max", "found", "±95 %")),
        *(Column(head=head, words=True) for head in ("verdict", "clause")),
    ]
    note = f"{whence} Open: the limit lies inside the interval of 95 %."
    return section("requirements", "Requirements", table("Requirements of the model file", columns, rows, note=note))


def judged(one: Requirement, values: Array, half: Array) -> str:
    """Whether the requirement is met by `values` (10,) and every point of their intervals, `half` (10,) to each side; SI."""
    k = list(LIMITED).index(one.quantity)
    low, high = values[k] - half[k], values[k] + half[k]
    if (one.low is not None and high < one.low) or (one.high is not None and low > one.high):
        return NOT_MET
    inside = (one.low is None or low >= one.low) and (one.high is None or high <= one.high)
    return MET if inside else OPEN


def _identified(report: Report) -> tuple[Array | None, Array | None, str]:
    """(10,) values and half widths of the model's article, and whence: with the effects of the model, else from raw records."""
    article = above_fmd(report.model.article)
    for body in report.identified:
        if body.article in (article, report.model.article):
            lead = "with the effects of the model" if report.comparison.effects else "with the model, which has no effects"
            return body.values, body.half_width, f"Found: {body.article}, identified {lead}."
    for part in report.campaigns:
        if part.findings is not None and part.findings.article == article:
            return part.findings.result.values, part.findings.result.half_width, f"Found: {article}, from the raw records alone."
    return None, None, f"No inertia of {article} alone was identified, so nothing is judged."


def _met(report: Report) -> Safe:
    """How many of the requirements are met, in the head."""
    values, half, _ = _identified(report)
    asked = report.model.requirements
    if values is None or half is None:
        return joined(f"{len(asked)} stated, none judged: see below")
    words = [judged(one, values, half) for one in asked]
    worst = NOT_MET if NOT_MET in words else OPEN if OPEN in words else MET
    return joined(f"{words.count(MET)} of {len(asked)} met ", verdict(worst, KINDS[worst]))
