"""A map of sensors: pick-ups and load cells as arrows on the whole article, and with their names near by."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from geometry.articles import built_in
from geometry.errors import BadInput
from geometry.frames import Array, Pose, frozen
from identification.campaign import Campaign
from validation.reference.reference import file_name
from validation.report.charts.spec import FAINT, INK, PAPER
from validation.report.charts.static import require_format, save
from validation.report.charts.style import Label, arranged
from validation.report.scenes.motion import DPI, blank, write
from validation.report.scenes.scene import Arrow, DrawnBody, Projection, drawn_bodies, fitted, rendered

SIZE = (1900, 1130)
TOP, HEIGHT = 110, 900
COLUMNS = ((10, 400), (420, 730), (1160, 730))
"""Left edge and width of the three scenes [pixel]: the whole article, near by from the side, from above."""

WORDS = ("on the article", "from the side, the article as a ghost", "from above, x to the right and y up")
MARGINS = (30.0, 96.0, 84.0)
ARROW = 0.13
"""Length of an arrow, as a share of the largest distance of the sensors."""

COLOURS = {"table": "#2456c4", "cover": "#1f8a4c", "fmd": "#c8283c", "article": "#8e44ad"}
"""One a group; the summation of several cells is told by its label."""

LETTER = 8.6
"""Pixels of a letter of a label."""


@dataclass(frozen=True, eq=False, kw_only=True)
class DrawnSensor:
    """One sensing element.

    Attributes
    ----------
    name : of its channel
    group : of its channel, a key of `COLOURS`
    position, direction : (3,) [m], and unit vector of positive output, in the frame of the bodies
    """

    name: str
    group: str
    position: Array
    direction: Array

    def __post_init__(self) -> None:
        for name in ("position", "direction"):
            object.__setattr__(self, name, frozen(getattr(self, name), (3,), name))


def sensor_page(title: str, sensors: Sequence[DrawnSensor], bodies: Sequence[DrawnBody], path: Path, note: str = "") -> None:
    """Write a picture of `sensors` on `bodies`, of which there may be none; the frame's origin is labelled F.

    Raises
    ------
    BadInput : the ending of `path` is unknown.
    CheckFailed : nothing can be rendered on this machine.
    """
    require_format(path)
    # Largest distance of the sensors along an axis [m]; 1 of a single one
    extent = float(np.ptp([sensor.position for sensor in sensors], axis=0).max()) or 1.0
    length = ARROW * extent
    arrows = [*(_arrow(sensor, length) for sensor in sensors), *_axes(length)]
    ghosts = [replace(body, counted=False) for body in bodies]
    figure, canvas = blank(*SIZE)
    write(canvas, 40, 52, title, 30, weight="bold", va="center")
    for k, (view, words) in enumerate(zip(_views(sensors, bodies, length), WORDS, strict=True)):
        left, width = COLUMNS[k]
        image = rendered(view, ghosts if k else bodies, None, arrows)
        canvas.imshow(image, extent=(left, left + width, TOP + HEIGHT, TOP), zorder=0)
        write(canvas, left + 30, TOP - 8, words, 16, FAINT, va="center")
        if k:
            _labels(canvas, view, sensors, length, left)
    groups = {sensor.group for sensor in sensors}
    x = 40.0
    for group in (name for name in COLOURS if name in groups):
        canvas.plot([x, x + 34], [SIZE[1] - 88] * 2, color=COLOURS[group], linewidth=4)
        write(canvas, x + 44, SIZE[1] - 88, group, 17, INK, va="center")
        x += 150
    for i, line in enumerate(textwrap.wrap(note, 200, max_lines=2, placeholder=" …")):
        write(canvas, 40, SIZE[1] - 52 + 22 * i, line, 15, FAINT, va="center")
    save(path, lambda temporary: figure.savefig(temporary, dpi=DPI))


def _points(sensors: Sequence[DrawnSensor], bodies: Sequence[DrawnBody], length: float) -> Array:
    ends = [np.zeros(3)]
    ends += [point for one in sensors for point in (one.position, one.position + length * one.direction)]
    return np.vstack([np.asarray(ends), *(body.vertices for body in bodies)])


def _views(
    sensors: Sequence[DrawnSensor], bodies: Sequence[DrawnBody], length: float
) -> tuple[Projection, Projection, Projection]:
    """Everything; then twice what lies around the sensors, for a mast would make the plate small."""
    near = _points(sensors, (), length)
    sizes = [(width, HEIGHT) for _, width in COLUMNS]
    lower, upper = near.min(axis=0), near.max(axis=0)
    above = Projection(
        right=np.array([1.0, 0.0, 0.0]),
        up=np.array([0.0, 1.0, 0.0]),
        towards=np.array([0.0, 0.0, 1.0]),
        centre=(lower + upper) / 2,
        scale=float(((upper - lower)[:2] / (np.array(sizes[2]) - 2 * MARGINS[2])).max()) or 1e-3,
        size=sizes[2],
    )
    return fitted(_points(sensors, bodies, length), sizes[0], MARGINS[0]), fitted(near, sizes[1], MARGINS[1]), above


def _arrow(sensor: DrawnSensor, length: float) -> Arrow:
    end = sensor.position + length * sensor.direction
    return Arrow(start=sensor.position, end=end, radius=0.03 * length, colour=COLOURS[sensor.group])


def _axes(length: float) -> list[Arrow]:
    """The axes of the frame, at its origin."""
    return [Arrow(start=np.zeros(3), end=1.2 * length * axis, radius=0.02 * length, colour=INK) for axis in np.eye(3)]


def _labels(canvas: Any, view: Projection, sensors: Sequence[DrawnSensor], length: float, left: float) -> None:
    corner = np.array([left, TOP])
    tips = [view.pixel(one.position + 0.7 * length * one.direction) + corner for one in sensors]
    middle = np.mean(tips, axis=0)
    taken = [(tip, (10.0, 10.0)) for tip in tips]
    taken += [(view.pixel(one.position) + corner, (10.0, 10.0)) for one in sensors]
    labels = [
        Label(
            text=one.name,
            anchor=tip,
            wish=tip - middle,
            extent=(LETTER * len(one.name) + 8, 20),
            gap=10,
            colour=COLOURS[one.group],
        )
        for one, tip in zip(sensors, tips, strict=True)
    ]
    origin = view.pixel(np.zeros(3)) + corner
    tips_of_axes = [(view.pixel(arrow.end) + corner, name) for arrow, name in zip(_axes(length), "xyz", strict=True)]
    labels += [
        Label(text=name, anchor=tip, wish=tip - origin, extent=(LETTER + 8, 20), gap=8, colour=INK)
        for tip, name in tips_of_axes
        if np.linalg.norm(tip - origin) > 1
    ]
    labels.append(Label(text="F", anchor=origin, wish=np.array([-1.0, 1.0]), extent=(LETTER + 8, 20), gap=8, colour=INK))
    room = (corner + np.array(view.size) / 2, view.size)
    for label, place in zip(labels, arranged(labels, taken, room), strict=True):
        canvas.plot(*np.column_stack([label.anchor, place]), color=label.colour, linewidth=0.7, zorder=4)
        box = {"boxstyle": "round,pad=0.12", "facecolor": PAPER, "edgecolor": "none", "alpha": 0.85}
        write(canvas, place[0], place[1], label.text, 14.5, label.colour, ha="center", va="center", bbox=box, zorder=6)


# The sensor map of `massline check --view`: every pick-up and load cell over the article, when that is a built-in one.


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
    # Where the built-in stack stands, seen from F: on the FMD its frame begins at F, else the mounting says it
    if campaign.article.split("+")[0] == "fmd" or campaign.mounting is None:
        pose = Pose()
    else:
        pose = Pose(position=campaign.mounting.position - campaign.table.origin, rotation=campaign.mounting.rotation)
    drawn = [
        DrawnBody(
            name=body.name, material=body.material, vertices=pose.apply(body.vertices), faces=body.faces, counted=body.counted
        )
        for body in drawn_bodies(article, 1e-3)
    ]
    return drawn, f"{arrows} {campaign.article} as built in, a reconstruction; the campaign's own parts may be of other sizes."
