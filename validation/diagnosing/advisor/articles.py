"""Tests of the menu in which something else stands on the FMD, or the same otherwise."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import pi

import numpy as np

from geometry.articles.dimensions import load
from geometry.errors import BadInput
from geometry.frames import Pose, rotation_about
from identification.campaign import Campaign
from validation.diagnosing.advisor.offer import Offer
from validation.diagnosing.advisor.planned import Template, planned
from validation.identifying.known import FMD, above_fmd, mounted

CUBOID, TARE = "cuboid", "disc+cuboid"

FAMILY = ("clumod-1", "clumod-4")
"""Configurations of one article: whoever has tested one can test the other."""

IN_WORDS = {
    "": "the FMD alone",
    CUBOID: "the Cuboid",
    TARE: "the Cuboid on the disc",
    "clumod-1": "Clumod with one blade",
    "clumod-4": "Clumod with four blades",
}


@dataclass(frozen=True, kw_only=True)
class Other:
    """What may be mounted instead.

    Attributes
    ----------
    article : on the FMD
    hours : of work
    """

    article: str
    hours: float


OTHERS = (
    Other(article="", hours=1.0),
    Other(article=TARE, hours=2.0),
    Other(article="clumod-1", hours=8.0),
    Other(article="clumod-4", hours=8.0),
)

TURNS = ((90.0, 2.0), (180.0, 2.0))
"""[degrees] about z, and hours of work."""


def named(article: str) -> str:
    """What stands on the FMD, in words."""
    return IN_WORDS.get(article, article)


def others(templates: Sequence[Template]) -> Iterator[Offer]:
    """Articles that were not tested yet."""
    there = {above_fmd(one.tested.campaign.article) for one in templates}
    for other in OTHERS:
        if other.article in there or (other.article in FAMILY and not there & set(FAMILY)):
            continue
        yield from _run(
            other.article, f"Run {named(other.article)}", other.hours, templates[0], _with(templates[0], other.article)
        )


def turned(templates: Sequence[Template]) -> Iterator[Offer]:
    """What was tested, and the Cuboid, turned about z."""
    for one in templates:
        campaign = one.tested.campaign
        if above_fmd(campaign.article):
            for angle, hours in TURNS:
                words = f"Run {named(above_fmd(campaign.article))} turned by {angle:g} degrees about z"
                yield from _run("turned", words, hours, one, _posed(campaign, _about_z(campaign, angle)))
    if not any(CUBOID in one.tested.campaign.article for one in templates):
        campaign = _with(templates[0], TARE)
        words = f"Run {named(TARE)} turned by 90 degrees about z"
        yield from _run("turned", words, TURNS[0][1], templates[0], _posed(campaign, _about_z(campaign, TURNS[0][0])))


def lying(templates: Sequence[Template]) -> Iterator[Offer]:
    """The Cuboid on its broad side: the same mass at another height."""
    campaign = _with(templates[0], CUBOID)
    yield from _run(
        "lying", "Run the Cuboid lying on its broad side", 2.0, templates[0], _posed(campaign, _on_its_side(campaign))
    )


def _run(kind: str, words: str, hours: float, of: Template, campaign: Campaign) -> Iterator[Offer]:
    """The offer; none where the model cannot describe what would stand there."""
    try:
        yield Offer(kind=kind, words=words, hours=hours, test=planned(of, campaign))
    except BadInput:
        return


def _with(of: Template, article: str) -> Campaign:
    """The campaign with another article, mounted where articles are."""
    campaign = of.tested.campaign
    pose, _ = mounted(campaign)
    upright = Pose(position=pose.position + campaign.table.origin)
    return replace(campaign, article="+".join(part for part in (FMD, article) if part), mounting=upright if article else None)


def _posed(campaign: Campaign, pose: Pose) -> Campaign:
    return replace(campaign, mounting=Pose(position=pose.position + campaign.table.origin, rotation=pose.rotation))


def _about_z(campaign: Campaign, degrees: float) -> Pose:
    pose, _ = mounted(campaign)
    return Pose(position=pose.position, rotation=rotation_about("z", degrees * pi / 180) @ pose.rotation)


def _on_its_side(campaign: Campaign) -> Pose:
    pose, _ = mounted(campaign)
    _, depth, height = load(CUBOID)["size"]
    down = Pose(position=np.array([0.0, height / 2, depth / 2]), rotation=rotation_about("x", pi / 2))
    return pose @ down
