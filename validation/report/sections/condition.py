"""Condition number of Eqs. 9 to 11, campaign by campaign."""

from __future__ import annotations

import numpy as np

from validation.identifying.findings import Lines
from validation.report.figures import Figures
from validation.report.markup import Safe, joined
from validation.report.nouns import Report
from validation.report.sections.parts import notes, section


def html(report: Report, figures: Figures) -> Safe:
    """The section; empty where no line has a condition number."""
    known = [(one.campaign.source, one.findings.lines) for one in report.campaigns if one.findings is not None]
    parts = [_campaign(name, lines, figures) for name, lines in known if lines is not None]
    return section("condition", "Condition number of Eqs. 9 to 11", *parts) if parts else Safe("")


def _campaign(name: str, lines: Lines, figures: Figures) -> Safe:
    from validation.plots.condition import condition

    worst, used = int(np.argmax(lines.condition)), int(np.sum(np.asarray(lines.kept) > 0))
    told = (
        f"{name}: at most {lines.condition[worst]:.3g}, at {lines.frequency[worst]:.4g} Hz; {used} of "
        f" {len(lines.frequency)} lines are used. Base motions of all runs, every axis divided by its nominal level"
    )
    return joined(figures.placed(condition(lines, name)), notes([told, *lines.reasons]))
