"""What stands on the shaker, to be drawn in 3-D: bodies and sensors of one campaign, seen from F."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache

from geometry.articles import built_in, changes_of
from geometry.errors import BadInput
from geometry.frames import Pose
from geometry.keys import nearest
from identification import campaign_file
from identification.campaign import Campaign
from validation.desk.desk import Desk
from validation.desk.recorded import campaigns, model_of
from validation.identifying.known import stated
from validation.models.model import Model
from validation.pictures.bodies import DrawnBody, drawn_bodies
from validation.pictures.sensor_page import DrawnSensor

CHORD = 1e-3
"""[m] of drawn surfaces: a window is small, and turns."""

ARROWS = "Arrows point along positive output; load cells report the force of the table on the article."


@dataclass(frozen=True, eq=False, kw_only=True)
class Scene:
    """Plain arrays, in metres, in the axes of F.

    Attributes
    ----------
    campaign, title : its name, and what it calls itself (text of a stranger, never HTML)
    bodies : with vertices (n, 3) and faces (k, 3); none of an article that is not built in
    sensors : one for every place of a channel, with its direction of positive output and its group
    note : what is to be known about both
    """

    campaign: str
    title: str
    bodies: tuple[DrawnBody, ...]
    sensors: tuple[DrawnSensor, ...]
    note: str


def scene(of: Desk, campaign: str) -> Scene:
    """The set-up of `campaign`; bodies take about a second the first time.

    Raises
    ------
    BadInput : no such campaign, or its description cannot be read.
    """
    described = the_campaign(of, campaign)
    bodies, note = _bodies(described, model_of(of))
    return Scene(campaign=campaign, title=described.title, bodies=bodies, sensors=_sensors(described), note=note)


def the_campaign(of: Desk, name: str) -> Campaign:
    """The description of the campaign of that name.

    Raises
    ------
    BadInput : there is none, with the nearest.
    """
    known = campaigns(of)
    if name not in known:
        remedy = f"{nearest(name, known)}Known are {', '.join(known)}"
        raise BadInput(source="campaign", field=name, problem="no campaign is called so", remedy=remedy)
    return campaign_file.read_description(known[name])


def _sensors(campaign: Campaign) -> tuple[DrawnSensor, ...]:
    """Every place of every channel, seen from F; cells of a sum bear its name, each of them."""
    origin = campaign.table.origin
    return tuple(
        DrawnSensor(name=channel.name, group=channel.group, position=place.position - origin, direction=place.direction)
        for channel in campaign.table.channels
        for place in channel.places
    )


def _bodies(campaign: Campaign, model: Model) -> tuple[tuple[DrawnBody, ...], str]:
    """Seen from F, and what is to be known of them; none of an article that is not built in."""
    article = campaign.article
    try:
        changes = tuple(sorted(changes_of(article, model.changes).items()))
        drawn = _drawn(article, changes)
    except (BadInput, KeyError):
        return (), f"{ARROWS} {article} is no built-in article, so it is not drawn."
    pose = Pose() if article.split("+")[0] == "fmd" else stated(campaign) or Pose()
    placed = tuple(replace(one, vertices=pose.apply(one.vertices)) for one in drawn)
    return placed, f"{ARROWS} {article} as built in, a reconstruction; the campaign's own parts may be of other sizes."


@lru_cache(maxsize=8)
def _drawn(article: str, changes: tuple[tuple[str, float], ...]) -> tuple[DrawnBody, ...]:
    known: Mapping[str, float] = dict(changes)
    return drawn_bodies(built_in(article, known), CHORD)
