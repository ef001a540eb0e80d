"""The title block: what this is about, who made it of what and when, and where somebody signs."""

from __future__ import annotations

from collections.abc import Iterator

from validation.report.figures import Figures
from validation.report.markup import Safe, tag
from validation.report.nouns import Report


def html(report: Report, figures: Figures) -> Safe:
    """The head of the page."""
    rows = [tag("tr", tag("th", name, scope="row"), tag("td", said)) for name, said in _rows(report)]
    signed = (_line("prepared by", report.provenance.by), _line("checked by"), _line("released by, date"))
    return tag(
        "header",
        tag("p", "massline · report of a model and its measurements", class_="kind"),
        tag("h1", report.comparison.title),
        tag("table", tag("tbody", *rows), class_="facts"),
        tag("div", *signed, class_="signatures"),
        id="top",
    )


def _rows(report: Report) -> Iterator[tuple[str, str]]:
    made = report.provenance
    yield "model", report.comparison.source
    yield "articles", ", ".join(dict.fromkeys(part.campaign.article for part in report.campaigns))
    yield (
        "campaigns",
        "; ".join(_campaign(part.campaign.title, part.campaign.source, len(part.campaign.runs)) for part in report.campaigns),
    )
    if report.classical:
        yield "classical", "; ".join(one.title for one in report.classical)
    if report.comparison.effects:
        yield "effects in it", ", ".join(report.comparison.effects)
    yield "date", made.when
    yield "made with", f"massline {made.versions.get('massline', '')}{', by ' + made.by if made.by else ''}"


def _campaign(title: str, source: str, runs: int) -> str:
    return f"{title} ({source}, {runs} run{'s' if runs != 1 else ''})"


def _line(what: str, name: str = "") -> Safe:
    return tag("div", tag("span", name, class_="signed"), tag("span", what, class_="what"))
