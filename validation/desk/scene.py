"""What stands on the shaker, to be drawn in 3-D: bodies and sensors of one campaign, seen from F."""

from __future__ import annotations

from dataclasses import dataclass

from validation.desk.desk import Desk
from validation.pictures.bodies import DrawnBody
from validation.pictures.sensor_page import DrawnSensor


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
    raise NotImplementedError
