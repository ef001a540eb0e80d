"""The page: one file of HTML that needs nothing else, neither a network nor a folder beside it."""

from __future__ import annotations

from collections.abc import Callable
from importlib.resources import files
from pathlib import Path

from geometry.atomic import write_text
from validation.report.figures import Figures
from validation.report.markup import Safe, joined, tag
from validation.report.nouns import Report
from validation.report.sections import (
    articles,
    condition,
    dynamic_mass,
    inertia,
    ladder,
    missing,
    modes,
    provenance,
    sensors,
    summary,
    title,
    where,
)

Section = Callable[[Report, Figures], Safe]

SECTIONS: tuple[tuple[str, str, Section], ...] = (
    ("summary", "Summary", summary.html),
    ("articles", "Articles and reference", articles.html),
    ("modes", "Modes", modes.html),
    ("sensors", "Sensors", sensors.html),
    ("dynamic-mass", "Dynamic mass", dynamic_mass.html),
    ("condition", "Condition number", condition.html),
    ("inertia", "Identified inertia", inertia.html),
    ("where", "Where it fails", where.html),
    ("missing", "What is missing", missing.html),
    ("ladder", "The ladder", ladder.html),
    ("provenance", "Provenance", provenance.html),
)
"""Name, heading in the table of contents, and what writes it, in the order of the page."""

ALLOWED = "; ".join(
    (
        "default-src 'none'",
        "img-src data: blob:",
        "style-src 'unsafe-inline'",
        "script-src 'unsafe-inline'",
        "base-uri 'none'",
        "form-action 'none'",
    )
)
"""What the page may load: itself. A browser refuses it everything else, whatever stands in it."""

Progress = Callable[[str, float], None]


def write(report: Report, path: Path, progress: Progress | None = None) -> None:
    """Write the page to `path`, whole or not at all.

    Raises
    ------
    OSError : it cannot be written.
    """
    write_text(path, html(report, progress))


def html(report: Report, progress: Progress | None = None) -> str:
    """The whole page."""
    figures, tell = Figures(), progress or (lambda what, share: None)
    parts: list[tuple[str, str, Safe]] = []
    for k, (name, heading, write_section) in enumerate(SECTIONS):
        tell(heading, k / len(SECTIONS))
        if made := write_section(report, figures):
            parts.append((name, heading, made))
    main = tag("main", title.html(report, figures), *(made for _, _, made in parts))
    body = tag(
        "body",
        _bar(),
        tag("div", _contents([(name, heading) for name, heading, _ in parts]), main, class_="page"),
        _script(figures),
    )
    return f"<!DOCTYPE html>\n{tag('html', _head(report), body, lang='en')}\n"


def _head(report: Report) -> Safe:
    return tag(
        "head",
        tag("meta", charset="utf-8"),
        Safe(f'<meta http-equiv="Content-Security-Policy" content="{ALLOWED}">'),
        tag("meta", name="viewport", content="width=device-width, initial-scale=1"),
        tag("meta", name="generator", content=f"massline {report.provenance.versions.get('massline', '')}".strip()),
        tag("title", f"{report.comparison.title} · massline report"),
        tag("style", Safe(_resource("page.css"))),
    )


def _bar() -> Safe:
    """What a reader can do, above the page."""
    light = tag("button", "light or dark", type="button", id="theme", aria_pressed="false")
    printed = tag("button", "print", type="button", id="print")
    skip = tag("a", "Skip to the report", href="#top", class_="skip")
    return tag("div", skip, tag("span", "massline report", class_="brand"), light, printed, class_="bar screen-only")


def _contents(parts: list[tuple[str, str]]) -> Safe:
    links = [tag("li", tag("a", heading, href=f"#{name}")) for name, heading in parts]
    return tag("nav", tag("ol", *links), aria_label="Contents", class_="screen-only")


def _script(figures: Figures) -> Safe:
    without = tag("noscript", tag("p", "Figures need JavaScript; the tables hold their numbers.", class_="warning"))
    told = tag("div", id="told", role="status", aria_live="polite", class_="screen-only")
    return joined(without, told, figures.packed(), tag("script", Safe(_resource("page.js"))))


def _resource(name: str) -> str:
    return files("validation.report").joinpath(name).read_text(encoding="utf-8")
