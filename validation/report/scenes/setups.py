"""Test set-ups as pictures: the sensors of a campaign on its article, and an article that swings on ropes."""

import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from fem.exudyn.rope_pendulum import Swing
from fem.exudyn.rope_statics import turned
from geometry.articles import built_in, changes_of
from geometry.errors import BadInput
from geometry.frames import Array, Integers, Pose, freeze
from identification.campaign import Campaign
from validation.classical.swing import Setup, Simulated
from validation.model.setups import stated
from validation.reference.reference import ArticleOptions, file_name
from validation.report.charts.spec import FAINT, INK, PAPER
from validation.report.charts.static import ABOUT, require_format, save
from validation.report.charts.style import Label, arranged, colours
from validation.report.reference import drawing
from validation.report.scenes import scene as stage
from validation.report.scenes.motion import sharp_edges
from validation.report.scenes.scene import rendered

# The map of sensors: pick-ups and load cells as arrows on the whole article, and with their names near by.


SHEET = (1900, 1130)
TOP, HEIGHT = 110, 900
COLUMNS = ((10, 400), (420, 730), (1160, 730))
"""Left edge and width of the three scenes [pixel]: the whole article, near by from the side, from above."""

WORDS = ("on the article", "from the side, the article as a ghost", "from above, x to the right and y up")
MARGINS = (30.0, 96.0, 84.0)
CHORD = 1e-3
"""[m] of drawn surfaces: they are small here."""

ARROW = 0.13
"""Length of an arrow, as a share of the largest distance of the sensors."""

GROUPS = {"table": "#2456c4", "cover": "#1f8a4c", "fmd": "#c8283c", "article": "#8e44ad"}
"""One a group; the summation of several cells is told by its label."""

LETTER = 8.6
"""Pixels of a letter of a label."""


@dataclass(frozen=True, eq=False, kw_only=True)
class DrawnSensor:
    """One sensing element.

    Attributes
    ----------
    name : of its channel
    group : of its channel, a key of `GROUPS`
    position, direction : (3,) [m], and unit vector of positive output, in the frame of the bodies
    """

    name: str
    group: str
    position: Array
    direction: Array

    def __post_init__(self) -> None:
        freeze(self, position=(3,), direction=(3,))


def sensor_page(
    title: str, sensors: Sequence[DrawnSensor], bodies: Sequence[stage.DrawnBody], path: Path, note: str = ""
) -> None:
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
    arrows = [
        stage.Arrow(start=one.position, end=one.position + length * one.direction, radius=0.03 * length, colour=GROUPS[one.group])
        for one in sensors
    ]
    arrows += _axes(length)
    ghosts = [replace(body, counted=False) for body in bodies]
    figure, canvas = stage.blank(*SHEET)
    stage.write(canvas, 40, 52, title, 30, weight="bold", va="center")
    for k, (view, words) in enumerate(zip(_views(sensors, bodies, length), WORDS, strict=True)):
        left, width = COLUMNS[k]
        image = rendered(view, ghosts if k else bodies, None, arrows)
        canvas.imshow(image, extent=(left, left + width, TOP + HEIGHT, TOP), zorder=0)
        stage.write(canvas, left + 30, TOP - 8, words, 16, FAINT, va="center")
        if k:
            _labels(canvas, view, sensors, length, left)
    groups = {sensor.group for sensor in sensors}
    x = 40.0
    for group in (name for name in GROUPS if name in groups):
        canvas.plot([x, x + 34], [SHEET[1] - 88] * 2, color=GROUPS[group], linewidth=4)
        stage.write(canvas, x + 44, SHEET[1] - 88, group, 17, INK, va="center")
        x += 150
    for i, line in enumerate(textwrap.wrap(note, 200, max_lines=2, placeholder=" …")):
        stage.write(canvas, 40, SHEET[1] - 52 + 22 * i, line, 15, FAINT, va="center")
    save(path, lambda temporary: figure.savefig(temporary, dpi=stage.DPI))


def _views(
    sensors: Sequence[DrawnSensor], bodies: Sequence[stage.DrawnBody], length: float
) -> tuple[stage.Projection, stage.Projection, stage.Projection]:
    """Everything; then twice what lies around the sensors, for a mast would make the plate small."""
    ends = [point for one in sensors for point in (one.position, one.position + length * one.direction)]
    near = np.vstack([np.zeros(3), *ends])
    everything = np.vstack([near, *(body.vertices for body in bodies)])
    sizes = [(width, HEIGHT) for _, width in COLUMNS]
    lower, upper = near.min(axis=0), near.max(axis=0)
    above = stage.Projection(
        right=np.array([1.0, 0.0, 0.0]),
        up=np.array([0.0, 1.0, 0.0]),
        towards=np.array([0.0, 0.0, 1.0]),
        centre=(lower + upper) / 2,
        scale=float(((upper - lower)[:2] / (np.array(sizes[2]) - 2 * MARGINS[2])).max()) or 1e-3,
        size=sizes[2],
    )
    return stage.fitted(everything, sizes[0], MARGINS[0]), stage.fitted(near, sizes[1], MARGINS[1]), above


def _axes(length: float) -> list[stage.Arrow]:
    """The axes of the frame, at its origin."""
    return [stage.Arrow(start=np.zeros(3), end=1.2 * length * axis, radius=0.02 * length, colour=INK) for axis in np.eye(3)]


def _labels(canvas: Any, view: stage.Projection, sensors: Sequence[DrawnSensor], length: float, left: float) -> None:
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
            colour=GROUPS[one.group],
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
        stage.write(canvas, place[0], place[1], label.text, 14.5, label.colour, ha="center", va="center", bbox=box, zorder=6)


# The sensor map of `massline check --view`: every pick-up and load cell over the article, when that is a built-in one.


POINTING = "Arrows point along positive output; load cells report the force of the table on the article."


def sensor_map(campaign: Campaign, folder: Path) -> Path:
    """Write the map of `campaign` into `folder`, and say where it is.

    Raises
    ------
    CheckFailed : nothing can be rendered on this machine.
    """
    bodies, note = bodies_of(campaign)
    path = folder / f"sensors-{file_name(Path(campaign.source).name)}.png"
    sensor_page(f"{campaign.title}: {len(campaign.table)} channels", sensors_of(campaign), bodies, path, note)
    return path


def sensors_of(campaign: Campaign) -> tuple[DrawnSensor, ...]:
    """Every place of every channel, seen from F; cells of a sum bear its name, each of them."""
    origin = campaign.table.origin
    return tuple(
        DrawnSensor(name=channel.name, group=channel.group, position=place.position - origin, direction=place.direction)
        for channel in campaign.table.channels
        for place in channel.places
    )


def bodies_of(campaign: Campaign, changes: Mapping[str, float] | None = None) -> tuple[tuple[stage.DrawnBody, ...], str]:
    """The article's bodies seen from F, and what is to be known of them; none of an article that is not built in.

    Parameters
    ----------
    changes : by the names of a model, sizes that it has otherwise than as built
    """
    article = campaign.article
    try:
        drawn = _built_in(article, tuple(sorted(changes_of(article, changes or {}).items())))
    except (BadInput, KeyError):
        return (), f"{POINTING} {article} is no built-in article, so it is not drawn."
    # Where the built-in stack stands, seen from F: on the FMD its frame begins at F, else the mounting says it
    pose = Pose() if article.split("+")[0] == "fmd" else stated(campaign) or Pose()
    placed = tuple(replace(one, vertices=pose.apply(one.vertices)) for one in drawn)
    return placed, f"{POINTING} {article} as built in, a reconstruction; the campaign's own parts may be of other sizes."


@lru_cache(maxsize=8)
def _built_in(article: str, changes: tuple[tuple[str, float], ...]) -> tuple[stage.DrawnBody, ...]:
    return stage.drawn_bodies(built_in(article, dict(changes)), CHORD)


# A rope pendulum: the article at one instant, its ropes from the ceiling, and the frame they are tied to.


ROPE, SPREADER, CEILING, AT_REST = "#8a6d3b", "#59616d", "#d9dde3", "#c3c8d0"

OVERHANG = 0.06
"""Of the ceiling beyond the ropes [m]."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Instant:
    """A pendulum at one instant, in the fixed frame, z upwards.

    Attributes
    ----------
    place : (3,) [m] of the article's CoG
    rotation : (3, 3) from the axes of `PendulumScene.bodies`
    chains : (ropes, k, 3) [m] every rope, from the ceiling to its foot
    """

    place: Array
    rotation: Array
    chains: Array

    def __post_init__(self) -> None:
        freeze(self, place=(3,), rotation=(3, 3), chains=(*np.shape(self.chains)[:2], 3))

    def placed(self, body: stage.DrawnBody) -> Array:
        """Vertices of a body of the article."""
        return np.asarray(body.vertices @ self.rotation.T + self.place)


@dataclass(frozen=True, eq=False, kw_only=True)
class PendulumScene:
    """What stays the same in every frame.

    Attributes
    ----------
    bodies : of the article, in the axes in which it hangs, origin in its CoG
    edges : of every body, indices (e, 2) of the ends of its sharp edges
    rest : the pendulum at rest, drawn as an outline
    view : in which all instants fit
    """

    bodies: tuple[stage.DrawnBody, ...]
    edges: tuple[Integers, ...]
    rest: Instant
    view: stage.Projection

    def rendered(self, instant: Instant) -> stage.Image:
        """The pendulum at `instant`. To be called inside of `off_screen`."""
        image = stage.shot(self.view, lambda plotter: self.draw(plotter, instant), peels=0)
        return np.round(stage.averaged(image.astype(np.float64))).astype(np.uint8)

    def draw(self, plotter: stage.Plotter, instant: Instant) -> None:
        """Ceiling, article with its outline at rest, ropes, and the light frame that they are tied to."""
        colour = colours(body.material for body in self.bodies)
        plotter.add_mesh(_ceiling(instant.chains[:, 0]), color=CEILING, ambient=0.7, diffuse=0.3)
        for body, edges in zip(self.bodies, self.edges, strict=True):
            points = instant.placed(body)
            stage.draw_edges(plotter, edges, self.rest.placed(body), AT_REST)
            mesh = stage.surface(points, body.faces)
            plotter.add_mesh(mesh, color=colour[body.material], ambient=0.55, diffuse=0.55, specular=0.05)
            stage.draw_edges(plotter, edges, points, INK)
        for chain in instant.chains:
            stage.draw_line(plotter, chain, ROPE, 3.0)
        # From foot to foot, and from every foot to the axis through the CoG
        feet = instant.chains[:, -1]
        up = instant.rotation[:, 2]
        hub = instant.place + up * float(np.mean((feet - instant.place) @ up))
        for ends in (np.vstack([feet, feet[:1]]), *(np.vstack([foot, hub]) for foot in feet), np.vstack([hub, instant.place])):
            stage.draw_line(plotter, ends, SPREADER, 3.0)


def _ceiling(anchors: Array):  # type: ignore[no-untyped-def]  # a `pyvista.PolyData`; the library is imported inside
    """The ceiling, as much of it as the ropes need."""
    import pyvista

    (x0, y0, z), (x1, y1, _) = anchors.min(axis=0) - OVERHANG, anchors.max(axis=0) + OVERHANG
    z += OVERHANG
    return pyvista.Box(bounds=(x0, x1, y0, y1, z, z + OVERHANG / 4))


# The swinging pendulum with its recorded signal below: as a picture, and moving as a GIF.


TILE = (620, 560)
HEAD, STRIP = 84, 210
MARGIN = 22.0

SIGNAL, FIT = "#2456c4", "#d9541e"
Axes = Any


@dataclass(frozen=True, eq=False, kw_only=True)
class DrawnSwing:
    """A swing to be drawn.

    Attributes
    ----------
    title, text : the heading, and a line of small type below it
    bodies : of the article, in the axes in which it hangs, origin in its CoG
    rest : the pendulum at rest
    instants : what is shown, in turn; a picture shows the first
    moments : (f,) [s] of `instants`
    time, signal, fit : (n,) [s], [rad], [rad] the record and the decaying sinusoid fitted to it
    """

    title: str
    text: str
    bodies: tuple[stage.DrawnBody, ...]
    rest: Instant
    instants: tuple[Instant, ...]
    moments: Array
    time: Array
    signal: Array
    fit: Array


def pendulum_picture(swing: DrawnSwing, path: Path, about: str = "") -> None:
    """Write the first instant of `swing` with its record below.

    A PNG carries the words `about` as its comment.

    Raises
    ------
    BadInput : the ending of `path` is unknown.
    CheckFailed : nothing can be rendered on this machine.
    """
    require_format(path)
    (image,) = _frames(swing, swing.instants[:1])
    height, width = image.shape[:2]
    figure, canvas = stage.blank(width, height)
    canvas.imshow(image, extent=(0, width, height, 0), interpolation="none", aspect="auto")
    more: dict[str, Any] = {"metadata": {ABOUT: about}} if about else {}
    save(path, lambda temporary: figure.savefig(temporary, dpi=stage.DPI, **more))


def _frames(swing: DrawnSwing, instants: Sequence[Instant]) -> list[stage.Image]:
    """Heading, pendulum and signal of every instant, one above the other."""
    figure, _ = stage.blank(TILE[0], HEAD)
    font = {"family": "DejaVu Sans", "parse_math": False, "va": "center"}
    figure.text(18 / TILE[0], 1 - 28 / HEAD, swing.title, fontsize=14.4, weight="bold", color=INK, **font)
    figure.text(18 / TILE[0], 1 - 60 / HEAD, swing.text, fontsize=10, color=FAINT, **font)
    head = stage.pixels(figure)
    strips = _Strip(swing)
    with stage.off_screen():
        # The scene of `bodies` in an image of `TILE` [pixel] into which every one of `swing.instants` fits
        bodies = swing.bodies
        rest = swing.rest
        vertices = np.concatenate([body.vertices for body in bodies])
        seen = [np.vstack([vertices @ one.rotation.T + one.place, one.chains.reshape(-1, 3)]) for one in (rest, *swing.instants)]
        view = stage.fitted(np.concatenate([_ceiling(rest.chains[:, 0]).points, *seen]), TILE, MARGIN)
        scene = PendulumScene(bodies=tuple(bodies), edges=tuple(map(sharp_edges, bodies)), rest=rest, view=view)
        return [
            np.vstack([head, scene.rendered(one), strips.at(float(moment))])
            for one, moment in zip(instants, swing.moments, strict=False)
        ]


class _Strip:
    """The record, drawn once; only the mark of the present moment moves."""

    def __init__(self, swing: DrawnSwing) -> None:
        self.figure, _ = stage.blank(TILE[0], STRIP)
        axes: Axes = self.figure.add_axes((0.115, 0.24, 0.86, 0.6))
        unit, factor = ("°", 180 / np.pi) if np.abs(swing.signal).max() > 0.02 else ("mrad", 1e3)
        axes.plot(swing.time, factor * swing.signal, ".", color=SIGNAL, markersize=2.6, label="recorded")
        axes.plot(swing.time, factor * swing.fit, color=FIT, linewidth=1.0, label="decaying sinusoid fitted to it")
        axes.set_xlim(swing.time[0], swing.time[-1])
        axes.set_xlabel("time [s]", fontsize=9)
        axes.set_ylabel(f"twist [{unit}]", fontsize=9)
        axes.tick_params(labelsize=8, colors=INK)
        axes.grid(visible=True, color="#e3e6ec", linewidth=0.7)
        axes.set_axisbelow(True)
        axes.legend(fontsize=8, loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, frameon=False, borderaxespad=0.2)
        self.mark = axes.axvline(swing.time[0], color=INK, linewidth=1.2)

    def at(self, moment: float) -> stage.Image:
        self.mark.set_xdata([moment, moment])
        return stage.pixels(self.figure)


# The pictures of `massline swing`: the article on its ropes with the recorded twist below, still and moving.


FRAMES_A_SECOND = 12
CYCLES = 1.0
"""Of the animation, which runs in its own time and begins anew."""


def draw_swing(found: Simulated, asked: ArticleOptions, folder: Path, *, animate: bool) -> list[Path]:
    """Write the picture of `found` into `folder`, and the animation when asked for; say where they are.

    Raises
    ------
    CheckFailed : nothing can be rendered on this machine.
    """
    swing = drawn_swing(found, asked)
    stem = file_name(f"swing-{found.record.setup.article}-{found.record.setup.axis}")
    picture = folder / f"{stem}.png"
    pendulum_picture(swing, picture)
    if not animate:
        return [picture]
    moving = folder / f"{stem}.gif"
    apart = max(20, 10 * round(100 * float(np.mean(np.diff(swing.moments)))))  # a GIF counts hundredths of a second
    stage.write_gif(moving, _frames(swing, swing.instants), apart)
    return [picture, moving]


def drawn_swing(found: Simulated, asked: ArticleOptions) -> DrawnSwing:
    """What a picture of `found` shows.

    Raises
    ------
    BadInput : the article has no surface that can be drawn.
    """
    record, setup = found.record, found.record.setup
    _, bodies, inertia, _ = drawing(setup.article, asked)
    hanging = turned(setup.axis, setup.along)
    # Samples of the frames: whole cycles from the start, in equal steps
    time = record.swing.time
    end = min(CYCLES * record.period, float(time[-1]))
    moments = np.arange(0.0, end, 1 / FRAMES_A_SECOND)
    frames = sorted(set(np.searchsorted(time, moments).tolist()))
    return DrawnSwing(
        title=f"{setup.article} on {setup.suspension.ropes} ropes",
        text=f"T = {record.period:.4f} s ({100 * record.shift:+.3f} % from Eq. 5); inertia by Eq. 5 {100 * found.plain:+.3f} %, "
        f"corrected {100 * found.corrected:+.3f} %",
        bodies=tuple(_hung(body, hanging, inertia.cog) for body in bodies),
        # The sample nearest to no twist
        rest=_instant(record.swing, int(np.argmin(np.abs(record.swing.yaw)))),
        instants=tuple(_instant(record.swing, k) for k in frames),
        moments=record.swing.time[frames],
        time=record.swing.time,
        signal=record.signal,
        fit=record.decay.fitted,
    )


def in_the_way(setup: Setup, asked: ArticleOptions) -> str:
    """A sentence where the article reaches out beyond the nearest rope above the ropes' feet; empty where nothing is in the way.

    Raises
    ------
    BadInput : the article has no surface that can be drawn.
    """
    _, bodies, inertia, _ = drawing(setup.article, asked)
    hanging = turned(setup.axis, setup.along)
    points = np.concatenate([_hung(body, hanging, inertia.cog).vertices for body in bodies])
    near = float(np.linalg.norm(setup.suspension.feet[:, :2], axis=1).min())
    beyond = points[np.linalg.norm(points[:, :2], axis=1) > near, 2]
    top = float(beyond.max(initial=-np.inf))
    if top <= setup.height:
        return ""
    return (
        f"{setup.article} reaches beyond the ropes up to {1000 * top:.0f} mm above its CoG, their feet are "
        f"{1000 * setup.height:.0f} mm above it: ropes may pass through it, which the simulation does not know. "
        f'With --height "{10 * np.ceil(100 * top):.0f} mm" they do not.'
    )


def _hung(body: stage.DrawnBody, hanging: Array, cog: Array) -> stage.DrawnBody:
    return replace(body, vertices=(body.vertices - cog) @ hanging.T)


def _instant(swing: Swing, k: int) -> Instant:
    return Instant(place=swing.place[k], rotation=swing.rotation[k], chains=swing.chains[k])
