"""Where everything comes from: versions, settings, inputs with their digests, the model, and the command line."""

from __future__ import annotations

import json
from collections.abc import Mapping

from validation.diagnosing.as_json import plain
from validation.report.figures import Figures
from validation.report.markup import Safe, joined, tag
from validation.report.nouns import Report
from validation.report.sections.parts import section
from validation.report.tables import Column, table

SEEDS = "none: the same data give the same answer (of a simulated campaign the seed stands in its own description)"
"""Of the random numbers behind figures of this page."""


def html(report: Report, figures: Figures) -> Safe:
    """The section."""
    made = report.provenance
    settings = {"random numbers": SEEDS, **made.settings}
    if report.diagnosis is not None:
        settings |= {f"diagnosis: {key}": value for key, value in report.diagnosis.settings.items() if key != "random_numbers"}
    return section(
        "provenance",
        "Provenance",
        tag("p", "Command line: ", tag("code", made.command)) if made.command else None,
        _pairs("Versions", "program", "version", made.versions),
        table(
            "Inputs",
            [Column(head="file or folder", words=True), Column(head="SHA-256", words=True)],
            [[one.path, tag("code", one.digest)] for one in made.inputs],
            note="Of a campaign: of its description and all of its signals.",
        ),
        _pairs("Settings", "setting", "value", {key: _text(value) for key, value in settings.items()}),
        tag("details", tag("summary", "The model file"), tag("pre", made.model_text)) if made.model_text else None,
    )


def _pairs(caption: str, key: str, value: str, pairs: Mapping[str, str]) -> Safe:
    columns = [Column(head=key, words=True), Column(head=value, words=True)]
    return joined(table(caption, columns, [[name, said] for name, said in pairs.items()]))


def _text(value: object) -> str:
    said = plain(value)
    if isinstance(said, dict):
        return "; ".join(f"{key or 'any other'}: {_text(one)}" for key, one in said.items())
    if isinstance(said, list):
        return ", ".join(map(_text, said)) or "none"
    return said if isinstance(said, str) else json.dumps(said)
