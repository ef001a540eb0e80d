"""`Report`: everything that a page says, found by the rooms; the page adds nothing to it."""

from base64 import b64encode
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING

from geometry.frames import Array
from identification.campaign import Campaign
from validation.estimation.problem import Evaluation
from validation.estimation.verdicts import DOUBTFUL, FAILED, GOOD, expected_z2, misfit
from validation.model.setups import above_fmd
from validation.output import NONE, percent, rounded
from validation.reference.statement import QUANTITIES
from validation.report.document import Cell, Column, Figures, Number, Safe, joined, table, tag, worded

if TYPE_CHECKING:
    from validation.classical.files import Reduction
    from validation.compare.compare import Comparison
    from validation.diagnose.diagnosis import Diagnosis
    from validation.history.history import Body, Errors, HistoryPosition, Source
    from validation.identify.identify import IdentificationFindings
    from validation.model.model import Model, Requirement
    from validation.reference.reference import ReferenceTable
    from validation.reference.statement import Statement


@dataclass(frozen=True, eq=False, kw_only=True)
class Picture:
    """A picture as it lies in a file.

    Attributes
    ----------
    png : its bytes
    said : what it shows, for who cannot see it, and below it
    """

    png: bytes
    said: str


@dataclass(frozen=True, eq=False, kw_only=True)
class ArticlePart:
    """What is known of an article by itself.

    Attributes
    ----------
    name : what stands on the FMD
    table : by three routes, in print, weighed and swung; None where `missing` says why
    picture : rendered, with CoG and principal axes
    shapes : its mode shapes
    missing : sentences: what cannot be shown, and why
    """

    name: str
    table: "ReferenceTable | None" = None
    picture: Picture | None = None
    shapes: Picture | None = None
    missing: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False, kw_only=True)
class CampaignPart:
    """What is known of a campaign by itself.

    Attributes
    ----------
    campaign : as it was read
    sensors : map of its sensors
    findings : identified inertia, plain and self-calibrated; None where `missing` says why
    reference : of the article that was identified; None where none is known
    command : which command line gives the same findings
    missing : sentences: what cannot be shown, and why
    """

    campaign: "Campaign"
    sensors: Picture | None = None
    findings: "IdentificationFindings | None" = None
    reference: "Statement | None" = None
    command: str = ""
    missing: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False, kw_only=True)
class Provenance:
    """Where the page comes from.

    Attributes
    ----------
    when : local date and time, ISO 8601
    by : who made it; empty where nobody said
    command : the command line
    versions : of the programs
    inputs : model, campaigns and files with their SHA-256
    settings : method, band, what was held out
    model_text : of the model file
    """

    when: str
    by: str = ""
    command: str = ""
    versions: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    inputs: "tuple[Source, ...]" = ()
    settings: Mapping[str, object] = field(default_factory=lambda: MappingProxyType({}))
    model_text: str = ""


@dataclass(frozen=True, eq=False, kw_only=True)
class Report:
    """A model and data, and all that was found.

    Attributes
    ----------
    model : as it was read
    comparison : four errors, maps and worst spots
    provenance : where it comes from
    articles, campaigns : each by itself
    identified : inertia of the model's article from all data, with the effects of the model
    not_identified : why there is none, where the model has effects
    classical : weighings, CoG and pendulum tests, reduced
    diagnosis : what is missing; None where nobody asked, and `not_diagnosed` says why
    standing : the model's ladder; without rungs where there is none
    """

    model: "Model"
    comparison: "Comparison"
    provenance: Provenance
    articles: tuple[ArticlePart, ...] = ()
    campaigns: tuple[CampaignPart, ...] = ()
    identified: "tuple[Body, ...]" = ()
    not_identified: str = ""
    classical: "tuple[Reduction, ...]" = ()
    diagnosis: "Diagnosis | None" = None
    not_diagnosed: str = ""
    standing: "HistoryPosition | None" = None


# The errors of a model, wherever they stand beside those of another: each once, by name, unit and key.


ERRORS = (
    ("nominal error", "%", "nominal"),
    ("plain error, fitted data", "%", "plain"),
    ("plain error, used only for checking", "%", "held_out"),
    ("nominal error, used only for checking", "%", "held_out_nominal"),
    ("plain error, a configuration never seen", "%", "held_out_configurations"),
    ("fitted: χ² per degree of freedom", "1", "chi2_per_dof"),
    ("fitted: sum of z² of the tolerances", "1", "tolerance_z2"),
    ("... of which is due where nothing is wrong", "1", "due_z2"),
)
"""Name on a page, unit, and key of `error_figures`."""

SAID = {"chi2_per_dof": "fitted: chi² per degree of freedom", "tolerance_z2": "fitted: sum z² of the tolerances, and what is due"}
"""Names on a terminal, where they are others; what is due stands beside its sum there."""


def error_figures(of: "Evaluation | Errors | None") -> dict[str, float | None]:
    """By key the errors of a model, or of a version of it; None for what was not held out, or where nobody evaluated it."""
    if not isinstance(of, Evaluation):
        return {key: getattr(of, key, None) for _, _, key in ERRORS}
    fitted = {"chi2_per_dof": misfit(of.fitted), "tolerance_z2": of.fitted.tolerance_z2, "due_z2": expected_z2(of.fitted)}
    shares = {key: getattr(of, key) for _, unit, key in ERRORS if unit == "%"}
    return {key: None if one is None else one.percent for key, one in shares.items()} | fitted


def error_lines(*several: "Evaluation | Errors | None") -> Iterator[tuple[str, list[str]]]:
    """Name and figures of every error, as a terminal has them."""
    figures = [error_figures(of) for of in several]
    for name, unit, key in ERRORS:
        if key == "due_z2":
            continue
        texts = []
        for of in figures:
            value, due = of[key], of["due_z2"]
            if value is None:
                texts.append(NONE)
            else:
                beside = f" of {due:.0f}" if key == "tolerance_z2" else ""
                texts.append(percent(value) if unit == "%" else f"{value:.3g}{beside}")
        yield SAID.get(key, name), texts


# What several sections are made of: headings, verdicts, pictures, notes.


def section(name: str, title: str, *inside: str | None) -> Safe:
    """A section with its heading; `name` is what the table of contents jumps to."""
    return tag("section", tag("h2", title, id=f"{name}-title"), *inside, id=name, aria_labelledby=f"{name}-title")


def verdict(word: str, kind: str = "") -> Safe:
    """A verdict that is seen: one of `validation.estimation.verdicts.VERDICTS`, or another word that is as good as the `kind`."""
    kind = kind or (word if word in (GOOD, DOUBTFUL, FAILED) else "plain")
    return tag("span", word.upper(), class_=f"verdict {kind}") if word else Safe("")


def picture(of: Picture | None) -> Safe:
    """A picture inside the page."""
    if of is None:
        return Safe("")
    width, height = (str(int.from_bytes(of.png[at : at + 4], "big")) for at in (16, 20))  # PNG: its first block says its size
    source = "data:image/png;base64," + b64encode(of.png).decode("ascii")
    image = tag("img", src=source, alt=of.said, width=width, height=height)
    return tag("figure", image, tag("figcaption", of.said), class_="picture")


def notes(sentences: Iterable[str]) -> Safe:
    """Sentences in small print; nothing where there are none."""
    said = [f"{one.rstrip('.')}." for one in sentences if one]
    return tag("div", *(tag("p", worded(one)) for one in said), class_="note") if said else Safe("")


def paragraphs(sentences: Iterable[str | Safe]) -> Safe:
    """One paragraph each."""
    return joined(*(tag("p", worded(one)) for one in sentences))


# The head of a page, for whoever signs it: the test, its instruments, the requirements and whether they are met.
#
# All of it is what campaign and model files state; what they leave out is an empty line, to be filled in by hand.


BLANK = tag("span", class_="blank")
"""What nobody stated: a line to write on."""

MET, NOT_MET, OPEN = "pass", "fail", "open"
KINDS = {MET: GOOD, NOT_MET: FAILED, OPEN: DOUBTFUL}
"""Verdicts on a requirement, and how they look: open is an interval of 95 % with the limit inside."""

TOO_OLD = "its calibration had run out"
"""Said of an instrument that was due before the day of the test."""


def head_html(report: Report, figures: Figures) -> Safe:
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
    met = BLANK
    if asked := report.model.requirements:
        values, half, _ = _identified(report)
        met = joined(f"{len(asked)} stated, none judged: see below")
        if values is not None and half is not None:
            words = [judged(one, values, half) for one in asked]
            worst = next((word for word in (NOT_MET, OPEN) if word in words), MET)
            met = joined(f"{words.count(MET)} of {len(asked)} met ", verdict(worst, KINDS[worst]))
    facts = {
        "articles": ", ".join(dict.fromkeys(one.configuration for one in found.maps)),
        "serial number": _stated(campaigns, "serial_number"),
        "date of the test": _stated(campaigns, "date"),
        "place": _stated(campaigns, "place"),
        "operator": _stated(campaigns, "operator"),
        "requirements": met,
        **{name: said for name, said in optional.items() if said},
        "model": found.source,
        "revision": report.model.revision or BLANK,
        "report made": f"{made.when}, with massline {made.versions.get('massline', '')}{', by ' + made.by if made.by else ''}",
    }
    columns = [Column(head=head, words=True) for head in ("instrument", "serial number", "calibrated", "due", "channels")]
    tools: list[list[Cell]] = []
    for campaign in campaigns:
        for one in campaign.instruments:
            due = f"{one.due}: {TOO_OLD}" if one.due and campaign.date and one.due[:10] < campaign.date[:10] else one.due
            row = [said or BLANK for said in (one.name, one.serial_number, one.calibrated, due)]
            tools += [[*row, ", ".join(one.channels)]]
    tools = [row for k, row in enumerate(tools) if row not in tools[:k]]  # campaigns share their instruments
    signed = {"prepared by": made.by, "checked by": "", "released by, date": ""}
    lines = [tag("div", tag("span", name, class_="signed"), tag("span", what, class_="what")) for what, name in signed.items()]
    rows = [tag("tr", tag("th", name, scope="row"), tag("td", said)) for name, said in facts.items()]
    return tag(
        "header",
        tag("p", "massline · report of a model and its measurements", class_="kind"),
        tag("h1", found.title),
        tag("table", tag("tbody", *rows), class_="facts"),
        table("Instruments", columns, tools or [[BLANK] * len(columns)]) if campaigns else None,
        tag("div", *lines, class_="signatures"),
        id="top",
    )


def _stated(campaigns: Sequence[Campaign], key: str) -> str:
    """What the `campaigns` state under `key`, each once; a blank where none does."""
    return "; ".join(dict.fromkeys(value for one in campaigns if (value := getattr(one, key)))) or BLANK


# Requirements of the model file, held against what was identified.


def requirements_html(report: Report, figures: Figures) -> Safe:
    """The section; nothing where nothing is required."""
    if not report.model.requirements:
        return Safe("")
    values, half, whence = _identified(report)
    rows: list[list[Cell]] = []
    for one in report.model.requirements:
        k, shown = next((k, shown) for k, shown in enumerate(QUANTITIES) if shown.key == one.quantity)
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


def judged(one: "Requirement", values: Array, half: Array) -> str:
    """Whether the requirement is met by `values` (10,) and every point of their intervals, `half` (10,) to each side; SI."""
    k = [shown.key for shown in QUANTITIES].index(one.quantity)
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
