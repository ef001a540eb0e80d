"""A rope pendulum rendered: the article at one instant, its ropes from the ceiling, and the frame they are tied to."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from fem.exudyn.rope_pendulum import Swing
from fem.exudyn.rope_statics import turned
from geometry.atomic import write_with
from geometry.frames import Array, frozen
from validation.classical.swing import Setup, Simulated
from validation.reference.reference import ArticleOptions, file_name
from validation.report.charts.spec import FAINT, INK, PAPER
from validation.report.charts.static import ABOUT, require_format, save
from validation.report.charts.style import colours
from validation.report.reference import drawing
from validation.report.scenes.motion import Integers, sharp_edges
from validation.report.scenes.scene import (
    SUPERSAMPLING,
    DrawnBody,
    Image,
    Plotter,
    Projection,
    averaged,
    fitted,
    off_screen,
    shot,
)

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
        object.__setattr__(self, "place", frozen(self.place, (3,), "place"))
        object.__setattr__(self, "rotation", frozen(self.rotation, (3, 3), "rotation"))
        object.__setattr__(self, "chains", frozen(self.chains, (*np.shape(self.chains)[:2], 3), "chains"))


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

    bodies: tuple[DrawnBody, ...]
    edges: tuple[Integers, ...]
    rest: Instant
    view: Projection


def rendered(scene: PendulumScene, instant: Instant) -> Image:
    """The pendulum at `instant`. To be called inside of `off_screen`."""
    image = shot(scene.view, lambda plotter: _all(plotter, scene, instant), peels=0)
    return np.round(averaged(image.astype(np.float64))).astype(np.uint8)


def _all(plotter: Plotter, scene: PendulumScene, instant: Instant) -> None:
    colour = colours(body.material for body in scene.bodies)
    plotter.add_mesh(_box(instant.chains[:, 0]), color=CEILING, ambient=0.7, diffuse=0.3)
    for body, edges in zip(scene.bodies, scene.edges, strict=True):
        points = _placed(body, instant)
        _lines(plotter, edges, _placed(body, scene.rest), AT_REST)
        import pyvista

        mesh = pyvista.PolyData(points, np.column_stack([np.full(len(body.faces), 3), body.faces]).ravel())
        plotter.add_mesh(mesh, color=colour[body.material], ambient=0.55, diffuse=0.55, specular=0.05)
        _lines(plotter, edges, points, INK)
    for chain in instant.chains:
        _polyline(plotter, chain, ROPE, 3.0)
    # The light frame that the ropes are tied to: from foot to foot, and from every foot to the axis through the CoG
    feet = instant.chains[:, -1]
    up = instant.rotation[:, 2]
    hub = instant.place + up * float(np.mean((feet - instant.place) @ up))
    _polyline(plotter, np.vstack([feet, feet[:1]]), SPREADER, 3.0)
    for foot in feet:
        _polyline(plotter, np.vstack([foot, hub]), SPREADER, 3.0)
    _polyline(plotter, np.vstack([hub, instant.place]), SPREADER, 3.0)


def _placed(body: DrawnBody, instant: Instant) -> Array:
    return np.asarray(body.vertices @ instant.rotation.T + instant.place)


def _lines(plotter: Plotter, edges: Integers, points: Array, colour: str) -> None:
    import pyvista

    if len(edges):
        lines = pyvista.PolyData(points, lines=np.column_stack([np.full(len(edges), 2), edges]).ravel())
        plotter.add_mesh(lines, color=colour, line_width=0.8 * SUPERSAMPLING, lighting=False)


def _box(anchors: Array):  # type: ignore[no-untyped-def]  # a `pyvista.PolyData`; the library is imported inside
    """The ceiling, as much of it as the ropes need."""
    import pyvista

    (x0, y0, z), (x1, y1, _) = anchors.min(axis=0) - OVERHANG, anchors.max(axis=0) + OVERHANG
    z += OVERHANG
    return pyvista.Box(bounds=(x0, x1, y0, y1, z, z + OVERHANG / 4))


def _polyline(plotter: Plotter, points: Array, colour: str, width: float) -> None:
    import pyvista

    plotter.add_mesh(pyvista.MultipleLines(points=points), color=colour, line_width=width * SUPERSAMPLING / 2, lighting=False)


# The swinging pendulum with its recorded signal below: as a picture, and moving as a GIF.


DPI = 100
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
    bodies: tuple[DrawnBody, ...]
    rest: Instant
    instants: tuple[Instant, ...]
    moments: Array
    time: Array
    signal: Array
    fit: Array


def pendulum_picture(swing: DrawnSwing, path: Path, about: str = "") -> None:
    """Write the first instant of `swing` with its record below.

    A PNG carries the words `about`, which `validation.report.charts.static.said_about` reads again.

    Raises
    ------
    BadInput : the ending of `path` is unknown.
    CheckFailed : nothing can be rendered on this machine.
    """
    require_format(path)
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    (image,) = _frames(swing, swing.instants[:1])
    height, width = image.shape[:2]
    figure = Figure(figsize=(width / DPI, height / DPI), dpi=DPI, facecolor=PAPER)
    FigureCanvasAgg(figure)
    canvas = figure.add_axes((0, 0, 1, 1))
    canvas.set_axis_off()
    canvas.imshow(image, interpolation="none", aspect="auto")
    more: dict[str, Any] = {"metadata": {ABOUT: about}} if about else {}
    save(path, lambda temporary: figure.savefig(temporary, dpi=DPI, **more))


def pendulum_animation(swing: DrawnSwing, path: Path) -> None:
    """Write all instants of `swing` as an endless GIF, in its own time.

    Raises
    ------
    CheckFailed : nothing can be rendered on this machine.
    """
    from PIL import Image as Pictures

    frames = [Pictures.fromarray(image) for image in _frames(swing, swing.instants)]
    palette = frames[0].quantize(255, method=Pictures.Quantize.MEDIANCUT, dither=Pictures.Dither.NONE)
    small = [frame.quantize(palette=palette, dither=Pictures.Dither.NONE) for frame in frames]
    apart = max(20, 10 * round(100 * float(np.mean(np.diff(swing.moments)))))  # a GIF counts hundredths of a second
    how: dict[str, Any] = {"save_all": True, "append_images": small[1:], "duration": apart, "loop": 0}
    write_with(path, lambda temporary: small[0].save(temporary, format="GIF", **how))


def _frames(swing: DrawnSwing, instants: Sequence[Instant]) -> list[Image]:
    """Heading, pendulum and signal of every instant, one above the other."""
    figure = _figure(HEAD)
    font = {"family": "DejaVu Sans", "parse_math": False, "va": "center"}
    figure.text(18 / TILE[0], 1 - 28 / HEAD, swing.title, fontsize=14.4, weight="bold", color=INK, **font)
    figure.text(18 / TILE[0], 1 - 60 / HEAD, swing.text, fontsize=10, color=FAINT, **font)
    head = _drawn(figure)
    strips = _Strip(swing)
    with off_screen():
        # The scene of `bodies` in an image of `TILE` [pixel] into which every one of `swing.instants` fits
        bodies = swing.bodies
        rest = swing.rest
        vertices = np.concatenate([body.vertices for body in bodies])
        seen = [np.vstack([vertices @ one.rotation.T + one.place, one.chains.reshape(-1, 3)]) for one in (rest, *swing.instants)]
        view = fitted(np.concatenate([_box(rest.chains[:, 0]).points, *seen]), TILE, MARGIN)
        scene = PendulumScene(bodies=tuple(bodies), edges=tuple(map(sharp_edges, bodies)), rest=rest, view=view)
        return [
            np.vstack([head, rendered(scene, one), strips.at(float(moment))])
            for one, moment in zip(instants, swing.moments, strict=False)
        ]


class _Strip:
    """The record, drawn once; only the mark of the present moment moves."""

    def __init__(self, swing: DrawnSwing) -> None:
        self.figure = _figure(STRIP)
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

    def at(self, moment: float) -> Image:
        self.mark.set_xdata([moment, moment])
        return _drawn(self.figure)


def _figure(height: int) -> Any:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(TILE[0] / DPI, height / DPI), dpi=DPI, facecolor=PAPER)
    FigureCanvasAgg(figure)
    return figure


def _drawn(figure: Any) -> Image:
    figure.canvas.draw()
    return np.asarray(figure.canvas.buffer_rgba())[..., :3].copy()


# The pictures of `massline swing`: the article on its ropes with the recorded twist below, still and moving.


FRAMES_A_SECOND = 12
CYCLES = 1.0
"""Of the animation, which runs in its own time and begins anew."""


def draw(found: Simulated, asked: ArticleOptions, folder: Path, *, animate: bool, about: str = "") -> list[Path]:
    """Write the picture of `found` into `folder`, and the animation when asked for; say where they are.

    Raises
    ------
    CheckFailed : nothing can be rendered on this machine.
    """
    swing = drawn(found, asked)
    stem = file_name(f"swing-{found.record.setup.article}-{found.record.setup.axis}")
    picture = folder / f"{stem}.png"
    pendulum_picture(swing, picture, about)
    if not animate:
        return [picture]
    moving = folder / f"{stem}.gif"
    pendulum_animation(swing, moving)
    return [picture, moving]


def drawn(found: Simulated, asked: ArticleOptions) -> DrawnSwing:
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


def _hung(body: DrawnBody, hanging: Array, cog: Array) -> DrawnBody:
    return replace(body, vertices=(body.vertices - cog) @ hanging.T)


def _instant(swing: Swing, k: int) -> Instant:
    return Instant(place=swing.place[k], rotation=swing.rotation[k], chains=swing.chains[k])
