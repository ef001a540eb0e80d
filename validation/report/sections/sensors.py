"""The sensors of every campaign on a map."""

from __future__ import annotations

from validation.report.figures import Figures
from validation.report.markup import Safe, tag
from validation.report.nouns import CampaignPart, Report
from validation.report.sections.parts import picture, section


def html(report: Report, figures: Figures) -> Safe:
    """The section; empty where nothing could be drawn."""
    parts = [_campaign(one) for one in report.campaigns if one.sensors is not None]
    return section("sensors", "Sensors", *parts) if parts else Safe("")


def _campaign(one: CampaignPart) -> Safe:
    return tag("div", tag("h3", f"{one.campaign.title} ({one.campaign.source})"), picture(one.sensors), class_="part")
