"""The sensor map of `massline check --view`: every pick-up and load cell over the article, when that is a built-in one."""

from __future__ import annotations

from pathlib import Path

from geometry.articles import built_in
from geometry.errors import BadInput
from geometry.frames import Pose
from identification.campaign import Campaign
from validation.article_reference import file_name
from validation.pictures.bodies import DrawnBody, drawn_bodies
from validation.pictures.sensor_page import DrawnSensor, sensor_page


def draw(campaign: Campaign, folder: Path) -> Path:
    """Write the map of `campaign` into `folder`, and say where it is.

    Raises
    ------
    CheckFailed : nothing can be rendered on this machine.
    """
    bodies, note = _bodies(campaign)
    path = folder / f"sensors-{file_name(Path(campaign.source).name)}.png"
    sensor_page(f"{campaign.title}: {len(campaign.table)} channels", _sensors(campaign), bodies, path, note)
    return path


def _sensors(campaign: Campaign) -> list[DrawnSensor]:
    """Every element, seen from F; cells of a sum bear its name, each of them."""
    origin = campaign.table.origin
    return [
        DrawnSensor(name=channel.name, group=channel.group, position=place.position - origin, direction=place.direction)
        for channel in campaign.table.channels
        for place in channel.places
    ]


def _bodies(campaign: Campaign) -> tuple[list[DrawnBody], str]:
    """The article's bodies seen from F, and what is to be known about them."""
    arrows = "Arrows point along positive output; load cells report the force of the table on the article."
    try:
        article = built_in(campaign.article)
    except BadInput:
        return [], f"{arrows} {campaign.article} is no built-in article, so it is not drawn."
    pose = _pose(campaign)
    drawn = [
        DrawnBody(
            name=body.name, material=body.material, vertices=pose.apply(body.vertices), faces=body.faces, counted=body.counted
        )
        for body in drawn_bodies(article, 1e-3)
    ]
    return drawn, f"{arrows} {campaign.article} as built in, a reconstruction; the campaign's own parts may be of other sizes."


def _pose(campaign: Campaign) -> Pose:
    """Where the built-in stack stands, seen from F: on the FMD its frame begins at F, else the mounting says it."""
    if campaign.article.split("+")[0] == "fmd" or campaign.mounting is None:
        return Pose()
    return Pose(position=campaign.mounting.position - campaign.table.origin, rotation=campaign.mounting.rotation)
