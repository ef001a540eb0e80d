"""What stands on the shaker, to be turned: picture after picture from a window that is kept open, quick enough for a hand.

Bodies are opaque here, and sensors shine through them; the pictures of `scene` look better and take longer. To be used by one
thread only, as OpenGL asks.
"""

import io
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fem.base_excitation.patterns import BaseMotion
from fem.base_excitation.response import Response
from geometry.errors import BadInput, CheckFailed
from geometry.frames import Array, frozen, rigid_transformation_6
from validation.excite.question import LARGE, LINEAR
from validation.excite.results import LOAD_UNITS, LOADS, Passed, amplitude, rigid_load
from validation.excite.runs import Done, PreparedRuns
from validation.reference.reference import file_name
from validation.report.charts.style import Label, arranged, colours
from validation.report.flexible import moved_bodies
from validation.report.scenes.motion import Frame, MovingBody, Passing, colour_map, largest
from validation.report.scenes.motion import animate as draw
from validation.report.scenes.scene import Arrow, DrawnBody, Image, Plotter, Projection, fitted, light, off_screen, surface
from validation.report.scenes.setups import ARROW, DrawnSensor

if TYPE_CHECKING:
    from fem.base_excitation.patterns import Sweep


PAPER = {False: "#ffffff", True: "#171b22"}
INK = {False: "#1d2330", True: "#e4e8ef"}
AT_REST = {False: "#b4bac4", True: "#4a5463"}
DRIVE, FAILS = "drive", "fails"
"""Groups of a test by forces: where a force acts, and what deviates."""

SENSORS = {
    False: {"table": "#2456c4", "cover": "#1f8a4c", "fmd": "#c8283c", "article": "#8e44ad", DRIVE: "#2456c4", FAILS: "#c8283c"},
    True: {"table": "#8fb4ff", "cover": "#6fd39d", "fmd": "#ff8d9b", "article": "#d6a4f0", DRIVE: "#8fb4ff", FAILS: "#ff8d9b"},
}
"""Colours of the groups, by whether the page is dark."""

HIT = 16.0
"""Pixels from a node within which a click means it."""

BAR = 90
"""Length [pixel] that the bar of lengths has at most, and the bar of colours has."""

LETTER, LINE = 6.6, 14.0
"""Width and height of a letter of a label [pixel]."""

MARGIN = 34.0
ROOMY = 330
"""Height [pixel] from which on sensors bear their names."""

SHINES = 0.55
"""How strongly sensors shine through the bodies in front of them."""

LARGEST = (2400, 1600)
"""Pixels of a picture at most."""


@dataclass(frozen=True, kw_only=True)
class Turn:
    """How the scene is looked at.

    Attributes
    ----------
    azimuth, elevation : [°] from the first view, about the vertical and above it
    zoom : 1 for all of it
    size : width and height [pixel]
    dark : whether the page is
    share : of the swing of a mode, -1 to 1
    """

    azimuth: float = 0.0
    elevation: float = 0.0
    zoom: float = 1.0
    size: tuple[int, int] = (600, 400)
    dark: bool = False
    share: float = 1.0


def ready() -> None:
    """Try whether anything can be rendered here, which takes a second or more the first time; what is wrong is said when a
    picture is asked for."""
    with suppress(CheckFailed), off_screen():
        pass


class Turntable:
    """Bodies at rest with sensors on them, or bodies that swing in a mode."""

    def __init__(
        self,
        bodies: Sequence[DrawnBody | MovingBody],
        sensors: Sequence[DrawnSensor] = (),
        scale: float = 0.0,
        carried: Array | None = None,
        nodes: Array | None = None,
    ) -> None:
        """`carried` (s, 3) is how the sensors move with bodies that do, in their scale; they stand still where it is not said.

        `nodes` (p, 3) [m] are what `picked` finds; none by default.
        """
        self._nodes = np.zeros((0, 3)) if nodes is None else nodes
        self._bodies, self._sensors, self._scale = tuple(bodies), tuple(sensors), scale
        self._carried = np.zeros((len(self._sensors), 3)) if carried is None else carried
        # Largest distance along an axis [m] of the sensors, or of the bodies where there are none or few
        places = np.array([one.position for one in sensors]) if len(sensors) > 1 else np.zeros((1, 3))
        whole = np.concatenate([one.vertices for one in bodies]) if bodies else places
        extent = float(np.ptp(places, axis=0).max()) or float(np.ptp(whole, axis=0).max()) or 1.0
        self._length = ARROW * extent
        # Everything that has to fit, at both ends of a swing
        length = self._length
        found = [one.vertices for one in bodies if isinstance(one, DrawnBody)]
        found += [
            one.vertices + sign * scale * one.displacement for one in bodies if isinstance(one, MovingBody) for sign in (-1, 1)
        ]
        found += [np.array([one.position, one.position + length * one.direction]) for one in sensors]
        self._points = np.concatenate(found)
        self._near = np.mean([one.position for one in sensors], axis=0) if sensors else None
        self._stages: dict[bool, _Stage] = {}

    @property
    def moves(self) -> bool:
        """Whether anything swings."""
        return self._scale > 0

    def jpeg(self, turn: Turn) -> bytes:
        """One picture.

        Raises
        ------
        CheckFailed : nothing can be rendered on this machine.
        """
        width, height = (min(max(asked, 40), most) for asked, most in zip(turn.size, LARGEST, strict=True))
        turn = replace(turn, size=(width, height))
        view = turned(fitted(self._points, turn.size, MARGIN), turn, self._points, self._near)
        with off_screen():
            stage = self._stages.get(turn.dark)
            if stage is None:
                stage = _Stage(self._bodies, self._arrows(turn.dark), self._scale, turn.dark, self._carried)
                self._stages[turn.dark] = stage
            image = stage.shot(view, turn.share)
        from matplotlib import font_manager
        from PIL import Image as Pictures
        from PIL import ImageDraw, ImageFont

        # The letters that come with matplotlib, which keeps where they are: no system has to have any
        font = ImageFont.truetype(font_manager.findfont("DejaVu Sans"), 11)
        labels = self._labels(view, turn.dark, turn.share)
        dark = turn.dark
        picture = Pictures.fromarray(image)
        pen = ImageDraw.Draw(picture)
        for label, place in labels:
            pen.line([tuple(label.anchor), tuple(place)], fill=label.colour, width=1)
        for label, place in labels:
            x, y = place - np.array(label.extent) / 2
            pen.rectangle([x, y, x + label.extent[0], y + label.extent[1]], fill=PAPER[dark])
            pen.text((x + 2, y), label.text, fill=label.colour, font=font)
        # How long things are, and how far they swing
        metres = round_length(BAR * view.scale)
        left, low = 10.0, view.size[1] - 12.0
        pen.line([(left, low), (left + metres / view.scale, low)], fill=INK[dark], width=3)
        said = f"{1e3 * metres:g} mm" if metres < 1.0 else f"{metres:g} m"
        pen.text((left, low - 16), said, fill=INK[dark], font=font)
        if any(isinstance(one, MovingBody) for one in self._bodies):
            begin = view.size[0] - BAR - 10.0
            for k, colour in enumerate(colour_map()(np.linspace(0, 1, BAR))[:, :3]):
                pen.line([(begin + k, low - 5), (begin + k, low + 3)], fill=tuple(int(255 * one) for one in colour), width=1)
            pen.text((begin, low - 20), "0", fill=INK[dark], font=font)
            pen.text((begin + BAR - 41, low - 20), "largest", fill=INK[dark], font=font)
        kept = io.BytesIO()
        picture.save(kept, "JPEG", quality=88)
        return kept.getvalue()

    def picked(self, turn: Turn, at: tuple[float, float]) -> Array | None:
        """The node (3,) [m] that a click on the pixel `at` means, of those as near the one in front; None for none."""
        if not len(self._nodes):
            return None
        view = turned(fitted(self._points, turn.size, MARGIN), turn, self._points, self._near)
        away = np.linalg.norm(view.pixel(self._nodes) - np.array(at), axis=1)
        near = away <= max(float(away.min()), 0.0) + HIT / 2
        if away.min() > HIT:
            return None
        return np.asarray(self._nodes[np.flatnonzero(near)[np.argmax(self._nodes[near] @ view.towards)]])

    def close(self) -> None:
        """Let go of the windows."""
        for stage in self._stages.values():
            stage.close()
        self._stages.clear()

    def _arrows(self, dark: bool) -> list[Arrow]:
        length = self._length
        shown = [
            Arrow(
                start=one.position,
                end=one.position + length * one.direction,
                radius=0.03 * length,
                colour=_colour(one.group, dark),
            )
            for one in self._sensors
        ]
        axes = [Arrow(start=np.zeros(3), end=1.2 * length * e, radius=0.02 * length, colour=INK[dark]) for e in np.eye(3)]
        return shown + (axes if self._sensors else [])

    def _labels(self, view: Projection, dark: bool, share: float) -> list[tuple[Label, Array]]:
        """Names of the sensors and of the axes, each at a free place."""
        if not self._sensors:
            return []
        moved = self._carried * (share * self._scale)
        tips = [
            view.pixel(one.position + by + self._length * one.direction) for one, by in zip(self._sensors, moved, strict=True)
        ]
        middle = np.mean(tips, axis=0)
        origin = view.pixel(np.zeros(3))
        labels = []
        if view.size[1] >= ROOMY:
            named = zip(self._sensors, tips, strict=True)
            labels = [_label(one.name, tip, tip - middle, _colour(one.group, dark)) for one, tip in named]
        for name, axis in zip("xyz", np.eye(3), strict=True):
            tip = view.pixel(1.2 * self._length * axis)
            if np.linalg.norm(tip - origin) > 8:
                labels.append(_label(name, tip, tip - origin, INK[dark]))
        room = (np.array(view.size) / 2, (float(view.size[0]), float(view.size[1])))
        inside = [one for one in labels if np.all(np.abs(one.anchor - room[0]) < np.array(view.size) / 2)]
        return list(zip(inside, arranged(inside, [(tip, (6.0, 6.0)) for tip in tips], room), strict=True))


class _Stage:
    """Windows with everything in them; only camera and displacement move from picture to picture."""

    def __init__(
        self, bodies: Sequence[DrawnBody | MovingBody], arrows: Sequence[Arrow], scale: float, dark: bool, carried: Array
    ) -> None:
        import pyvista

        self._scale = scale
        self._whole: Plotter = pyvista.Plotter(off_screen=True, lighting="none")
        background: Any = PAPER[dark]
        self._whole.set_background(background)
        self._moving: list[tuple[MovingBody, list[Any]]] = []
        self._riding: list[tuple[Any, Array, Array]] = []
        self._fill(bodies, dark)
        self._above: Plotter | None = None
        if arrows:
            self._above = pyvista.Plotter(off_screen=True, lighting="none")
            for plotter in (self._whole, self._above):
                drawn = zip(_arrows(plotter, arrows), carried, strict=False)  # the axes at the end stand still
                self._riding += [(mesh, np.array(mesh.points), by) for mesh, by in drawn if np.any(by)]
        for plotter in self._plotters:
            light(plotter)
            plotter.show(auto_close=False)  # from here on it draws when it is told to

    @property
    def _plotters(self) -> list[Plotter]:
        return [self._whole] if self._above is None else [self._whole, self._above]

    def shot(self, view: Projection, share: float) -> Image:
        """The scene as seen by `view`, at `share` of its swing."""
        for body, meshes in self._moving:
            for mesh in meshes:
                mesh.points = body.vertices + share * self._scale * body.displacement
        for mesh, points, by in self._riding:
            mesh.points = points + share * self._scale * by
        for plotter in self._plotters:
            if tuple(plotter.window_size) != view.size:
                plotter.window_size = list(view.size)
            camera, distance = plotter.camera, 10 * view.scale * max(view.size) + 10
            camera.enable_parallel_projection()
            camera.focal_point, camera.position, camera.up = view.centre, view.centre + distance * view.towards, view.up
            camera.parallel_scale = view.scale * view.size[1] / 2
            camera.clipping_range = (distance * 0.2, distance * 1.8)
        whole = _shot(self._whole)[..., :3]
        if self._above is None:
            return whole
        above = _shot(self._above, transparent_background=True)
        alpha = SHINES * above[..., 3:] / 255.0
        return np.round(whole * (1 - alpha) + above[..., :3] * alpha).astype(np.uint8)

    def close(self) -> None:
        for plotter in self._plotters:
            plotter.close()

    def _fill(self, bodies: Sequence[DrawnBody | MovingBody], dark: bool) -> None:
        most = largest([one for one in bodies if isinstance(one, MovingBody)]) or 1.0
        colour = colours(one.material for one in bodies if isinstance(one, DrawnBody))
        for body in bodies:
            if isinstance(body, MovingBody):
                self._moving.append((body, self._swing(body, most, dark)))
            else:
                mesh = surface(body.vertices, body.faces)
                self._whole.add_mesh(mesh, color=colour[body.material], ambient=0.5, diffuse=0.55, specular=0.06)
                edges = mesh.extract_feature_edges(30, boundary_edges=False, manifold_edges=False, non_manifold_edges=False)
                if edges.n_cells:
                    self._whole.add_mesh(edges, color=INK[dark], line_width=1.0, opacity=0.6, lighting=False)

    def _swing(self, body: MovingBody, most: float, dark: bool) -> list[Any]:
        """The meshes of one body that move, in the window; its edges at rest stay behind."""
        import pyvista

        plotter = self._whole
        mesh = surface(body.vertices, body.faces)
        mesh.point_data["displacement"] = body.size / most
        look = {"ambient": 0.55, "diffuse": 0.55, "specular": 0.05, "show_scalar_bar": False}
        plotter.add_mesh(mesh, scalars="displacement", cmap=colour_map(), clim=(0, 1), **look)
        if not len(body.edges):
            return [mesh]
        lines = np.column_stack([np.full(len(body.edges), 2), body.edges]).ravel()
        plotter.add_mesh(
            pyvista.PolyData(np.array(body.vertices), lines=lines), color=AT_REST[dark], line_width=1.0, lighting=False
        )
        sharp = pyvista.PolyData(np.array(body.vertices), lines=lines)
        plotter.add_mesh(sharp, color=INK[dark], line_width=1.0, lighting=False)
        return [mesh, sharp]


def _shot(plotter: Plotter, **how: Any) -> Image:
    """What the window shows now: left alone, a screenshot is of what was drawn last, by the camera before this one."""
    plotter.render()
    return np.asarray(plotter.screenshot(return_img=True, **how))


def turned(view: Projection, turn: Turn, points: Array, near: Array | None = None) -> Projection:
    """`view` turned about the middle of what it shows, never over the top, and as near as `turn` says; from close by it looks at
    the point `near`, where sensors are, and not at the middle of a mast."""
    start = np.degrees(np.arcsin(np.clip(view.towards[2], -1, 1)))
    azimuth = np.arctan2(view.towards[1], view.towards[0]) + np.radians(turn.azimuth)
    elevation = np.radians(np.clip(start + turn.elevation, -89.0, 89.0))
    c, s = np.cos(elevation), np.sin(elevation)
    towards = np.array([c * np.cos(azimuth), c * np.sin(azimuth), s])
    right = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
    first = not (turn.azimuth or turn.elevation)
    centre = view.centre if first else (points.min(axis=0) + points.max(axis=0)) / 2
    if near is not None:
        centre = centre + max(0.0, 1 - 1 / turn.zoom) * (near - centre)
    return Projection(
        right=frozen(right, (3,), "right"),
        up=frozen(np.cross(towards, right), (3,), "up"),
        towards=frozen(towards, (3,), "towards"),
        centre=centre,
        scale=view.scale / turn.zoom,
        size=turn.size,
    )


def round_length(longest: float) -> float:
    """The largest of 1, 2 or 5 times a power of ten up to `longest`."""
    power = 10.0 ** np.floor(np.log10(longest))
    return float(power * max(one for one in (1, 2, 5) if one * power <= longest * (1 + 1e-9)))


def _arrows(plotter: Plotter, arrows: Sequence[Arrow]) -> list[Any]:
    import pyvista

    made = []
    for arrow in arrows:
        reach = arrow.end - arrow.start
        length = float(np.linalg.norm(reach))
        shape = {"shaft_radius": arrow.radius / length, "tip_radius": 3 * arrow.radius / length, "tip_length": 0.27}
        mesh = pyvista.Arrow(start=arrow.start, direction=reach, scale=length, shaft_resolution=12, tip_resolution=16, **shape)
        plotter.add_mesh(mesh, color=arrow.colour, ambient=0.5, diffuse=0.55)
        made.append(mesh)
    return made


def _colour(group: str, dark: bool) -> str:
    return SENSORS[dark].get(group, INK[dark])


def _label(text: str, anchor: Array, wish: Array, colour: str) -> Label:
    return Label(text=text, anchor=anchor, wish=wish, extent=(LETTER * len(text) + 4, LINE), gap=5, colour=colour)


# The animation of `massline excite --animate`: the article as the sweep passes its largest resonance.
#
# Frames are stroboscopic: from one to the next the drive goes on by a whole number of cycles and a tenth, so that the swing is
# seen slowly while the load swells and falls as it does.


FRAMES = 42
STROBE = 10
"""Frames in which one swing is seen."""

BEFORE, AFTER = 3.0, 4.0
"""How long is shown before and after the resonance, in 1 / sqrt(d(omega)/dt): a sweep needs that to swell and to leave."""

BASE = 6


def require_animable(made: PreparedRuns) -> None:
    """Refuse an animation of what has no shape, no resonance in the band or no one frequency, before it is driven.

    Raises
    ------
    BadInput : one of these.
    """
    model = made.mounted.model
    if made.route.name == LARGE:
        raise _refused("the large route keeps no coordinates", "Take --route linear or exudyn, or leave it out")
    if any(run.sweep is None for run in made.runs):
        raise _refused(f"{made.question.drive.pattern} passes no resonance", "Take --pattern sweep, or leave it out")
    if model is None or model.structure is None or model.drawn is None or not len(made.mounted.rig.article.kept):
        what = "a rigid article" if model is None else f"the {model.model} model of {model.article}"
        raise _refused(f"{what} has no shape that could be drawn", "Draw a beam or solid model, or leave it out")


def animate(made: PreparedRuns, one: Done, folder: Path) -> Path | None:
    """Write the passage of the largest resonance of `one` run into `folder`, and say where it is; None without a resonance.

    Raises
    ------
    CheckFailed : nothing can be rendered on this machine.
    """
    if one.run.sweep is None or not one.outcome.passed:
        return None
    path = folder / f"{file_name(f'excite-{made.question.article}-{made.route.name}-{one.run.name}')}.gif"
    draw(passing(made, one, one.run.sweep, max(one.outcome.passed, key=lambda p: p.amplification)), path)
    return path


def passing(made: PreparedRuns, one: Done, sweep: "Sweep", mode: Passed) -> Passing:
    """What the animation of the passage of `mode` shows."""
    response = one.response
    swells = 1 / np.sqrt(2 * np.pi * mode.frequency * sweep.rate * np.log(2) / 60)
    begin = max(mode.time - BEFORE * swells, 0.0)
    end = min(max(mode.time + AFTER * swells, mode.peak_time + swells), response.time[-1])
    times = strobe(sweep, begin, end, mode.peak_time)
    shown = (response.time >= begin) & (response.time <= end)
    rigid = amplitude(rigid_load(response, made.modes.rigid_mass)[:, mode.axis])
    return Passing(
        title=f"{made.question.article} passes {mode.frequency:.2f} Hz",
        text=f"{one.run.pattern.label}",
        frames=_frames(made, one, times, sweep.frequency_at(times)),
        time=response.time[shown],
        load=response.load[shown, mode.axis],
        rigid=rigid[shown],
        label=f"{LOADS[mode.axis]} [{LOAD_UNITS[mode.axis]}]",
        resonance=mode.time,
    )


def strobe(sweep: "Sweep", begin: float, end: float, peak: float) -> Array:
    """(`FRAMES`,) times [s] from `begin` to `end`, each a whole number of cycles and 1 / `STROBE` after the one before.

    Where there are fewer cycles than that, the frames are evenly spaced in the phase of the drive.
    """
    fine = np.linspace(begin, end, 20_000)
    frequency = sweep.frequency_at(fine)
    phase = np.concatenate([[0.0], np.cumsum((frequency[1:] + frequency[:-1]) / 2 * np.diff(fine))])
    step = phase[-1] / FRAMES
    if step > 1:
        step = np.floor(step - 1 / STROBE) + 1 / STROBE
    first = float(np.interp(peak, fine, phase)) % step
    return np.asarray(np.interp(first + step * np.arange(FRAMES), phase, fine))


def _frames(made: PreparedRuns, one: Done, times: Array, frequency: Array) -> tuple[Frame, ...]:
    from scipy.interpolate import CubicSpline

    model, body = made.mounted.model, made.mounted.rig.article
    if model is None:
        return ()
    coordinates = CubicSpline(one.response.time, relative_coordinates(made, one.motion, one.response), axis=0)(times)
    surfaces = moved_bodies(model, body.reduced.basis)
    return tuple(
        Frame(
            time=float(at),
            frequency=float(f),
            bodies=tuple(
                MovingBody(name=drawn.name, vertices=drawn.vertices, faces=drawn.faces, edges=edges, displacement=u @ x)
                for drawn, edges, u in surfaces
            ),
        )
        for at, f, x in zip(times, frequency, coordinates, strict=True)
    )


def relative_coordinates(made: PreparedRuns, motion: BaseMotion, response: Response) -> Array:
    """(n, 6 + m) coordinates of the article's reduced body, its base relative to the table."""
    from fem.base_excitation.response import decimated
    from fem.base_excitation.rig import matrices

    rig = made.mounted.rig
    if made.route.name == LINEAR:
        return np.asarray(response.coordinates @ matrices(rig).article[:, BASE:].T)
    coordinates = np.array(response.coordinates)
    table = decimated(motion, response.sampling_rate).displacement
    coordinates[:, :BASE] -= table @ rigid_transformation_6(rig.seat).T
    return coordinates


def _refused(problem: str, remedy: str) -> BadInput:
    return BadInput("--animate", "", problem, remedy)
