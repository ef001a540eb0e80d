"""An article as a picture: its bodies, centre of gravity, principal axes, equivalent ellipsoid, and figures beside them."""

import os
import subprocess
import sys
import textwrap
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from geometry.article import Article
from geometry.atomic import write_with
from geometry.errors import BadInput, CheckFailed
from geometry.frames import Array, frozen
from geometry.inertia import Inertia, require_physical
from validation.report.charts.spec import FAINT, INK, PAPER
from validation.report.charts.static import require_format, save
from validation.report.charts.style import AXES, ELLIPSOID, UNCOUNTED, Label, arranged
from validation.report.charts.style import colours as palette_colours

# What a picture draws: closed meshes with a name, a material, and whether their mass counts.


CHORD = 1e-4
"""Chord error [m] of drawn surfaces: less than a pixel for anything that fills a picture."""


@dataclass(frozen=True, eq=False, kw_only=True)
class DrawnBody:
    """One body of a picture.

    Attributes
    ----------
    name : as in the article
    material : name of the material; bodies of one material share a colour
    vertices : (n, 3) [m], in the article's frame
    faces : (k, 3), indices of the vertices of each triangle
    counted : False for what is drawn but does not belong to the inertia
    """

    name: str
    material: str
    vertices: Array
    faces: npt.NDArray[np.int64]
    counted: bool = True

    def __post_init__(self) -> None:
        vertices = np.asarray(self.vertices)
        object.__setattr__(self, "vertices", frozen(vertices, (len(vertices), 3), "vertices"))
        faces = np.array(self.faces, dtype=np.int64)
        if faces.ndim != 2 or faces.shape[1] != 3 or faces.min(initial=0) < 0 or faces.max(initial=0) >= len(vertices):
            raise ValueError(f"`faces` must be (k, 3) indices of {len(vertices)} vertices, found shape {faces.shape}")
        faces.setflags(write=False)
        object.__setattr__(self, "faces", faces)


def drawn_bodies(article: Article, chord: float = CHORD) -> tuple[DrawnBody, ...]:
    """Every part of `article`, counted or not, tessellated with chord error `chord` [m], in the article's frame."""
    from geometry.cad import tessellate

    meshes = [(part, tessellate(part, chord)) for part in article.parts]
    return tuple(
        DrawnBody(name=part.name, material=part.material.name, vertices=mesh.vertices, faces=mesh.faces, counted=part.counted)
        for part, mesh in meshes
    )


# Principal axes fit to be drawn, and the homogeneous ellipsoid that has a body's mass and moments.


EQUAL = 1e-6
"""Principal moments closer than this, relative to the largest, are equal: their axes are free to turn."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Ellipsoid:
    """Equivalent inertia ellipsoid of a body.

    Attributes
    ----------
    centre : (3,) [m], the CoG in the body's frame
    axes : (3, 3), principal axes as columns, right-handed
    moments : (3,) [kg m²], principal moments about the CoG, ascending
    semi_axes : (3,) [m] along the principal axes
    """

    centre: Array
    axes: Array
    moments: Array
    semi_axes: Array

    def stretched(self, unit: npt.ArrayLike) -> Array:
        """Points (n, 3) of the unit ball laid into the ellipsoid [m], in the body's frame."""
        return np.asarray(unit, dtype=np.float64) * self.semi_axes @ self.axes.T + self.centre

    @property
    def equal(self) -> tuple[tuple[int, int], ...]:
        """Neighbouring principal axes, counted from 0, whose moments are equal."""
        close = np.diff(self.moments) <= EQUAL * self.moments[2]
        return tuple((i, i + 1) for i in range(2) if close[i])


def equivalent_ellipsoid(inertia: Inertia) -> Ellipsoid:
    """The homogeneous ellipsoid of the body's mass, CoG and principal moments.

    A homogeneous ellipsoid has I1 = m/5 (b² + c²) and so on, hence a² = 5 (I2 + I3 - I1) / (2 m). Exists for every physical
    body; a semi-axis of an ideal one is zero.
    """
    moments, axes = inertia.principal()
    squares = 5 * (moments.sum() - 2 * moments) / (2 * inertia.mass)
    # The axes with their freedom used up: those of equal moments along the frame, all as far as can be its positive way
    first, second = np.diff(moments) <= EQUAL * moments[2]
    # `axis` or its opposite, whichever has its largest component positive
    one, two, three = (np.asarray(axis * np.sign(axis[np.argmax(np.abs(axis))])) for axis in axes.T)
    if first and second:
        settled = np.eye(3)
    else:
        if first:
            one = _nearest_in_plane(three)
            two = np.cross(three, one)
        elif second:
            two = _nearest_in_plane(one)
            three = np.cross(one, two)
        settled = np.column_stack([one, two, three])
        # When all forward axes are left-handed one has to point back: that along y, so that up stays up
        if np.linalg.det(settled) < 0:
            settled[:, np.argmax(np.abs(settled[1]))] *= -1
    return Ellipsoid(
        centre=frozen(inertia.cog, (3,), "centre"),
        axes=frozen(settled, (3, 3), "axes"),
        moments=frozen(moments, (3,), "moments"),
        semi_axes=frozen(np.sqrt(np.maximum(squares, 0)), (3,), "semi_axes"),
    )


def _nearest_in_plane(normal: Array) -> Array:
    """The frame axis that lies best in the plane across `normal`, laid into it."""
    axis = np.eye(3)[np.argmin(np.round(np.abs(normal), 6))]
    flat = axis - np.dot(axis, normal) * normal
    return np.asarray(flat / np.linalg.norm(flat))


MM = 1e3
NOTHING = 1e-9
"""Products smaller than this, relative to the largest moment, are rounding and print as 0."""


@dataclass(frozen=True, kw_only=True)
class LegendRow:
    """One line: name, value, unit and, for a principal axis, its colour."""

    name: str
    value: str
    unit: str = ""
    colour: str = ""


@dataclass(frozen=True, kw_only=True)
class Block:
    """A heading, an explanation in small type, and rows."""

    heading: str
    rows: tuple[LegendRow, ...]
    small: str = ""


def blocks(bodies: Sequence[DrawnBody], inertia: Inertia, ellipsoid: Ellipsoid) -> tuple[Block, ...]:
    """All figures of a picture, from top to bottom."""
    zero = NOTHING * float(inertia.moments_cog.max())
    named = zip(("xx", "yy", "zz", "xy", "xz", "yz"), (*inertia.moments_cog, *inertia.products_cog), strict=True)
    rows = tuple(
        LegendRow(name=rf"$\Theta_{{{axes}}}$", value=significant(0.0 if abs(value) < zero else value, 5), unit="kg m²")
        for axes, value in named
    )
    tensor = Block(heading="Inertia about the CoG", small="frame axes; products as matrix entries", rows=rows)
    principal_rows = tuple(
        LegendRow(
            name=rf"$I_{i + 1}$ {direction(ellipsoid.axes[:, i])}", value=significant(moment, 5), unit="kg m²", colour=AXES[i]
        )
        for i, moment in enumerate(ellipsoid.moments)
    )
    freedom = ""
    if len(ellipsoid.equal) == 2:
        freedom = "all equal: every axis is a principal axis"
    elif ellipsoid.equal:
        freedom = "{} and {} equal: any axes in their plane".format(*(k + 1 for k in ellipsoid.equal[0]))
    cog = tuple(
        LegendRow(name=f"${axis}$", value=millimetres(value), unit="mm") for axis, value in zip("xyz", inertia.cog, strict=True)
    )
    semi_axes = " × ".join(millimetres(semi_axis, 1) for semi_axis in ellipsoid.semi_axes)
    points = np.concatenate([body.vertices for body in bodies if body.counted])
    box = " × ".join(millimetres(extent, 1) for extent in np.ptp(points, axis=0))
    mass = LegendRow(name="$m$", value=significant(inertia.mass, 5), unit="kg")
    semi_axes_row = LegendRow(name="semi-axes", value=semi_axes, unit="mm")
    box_row = LegendRow(name="$x, y, z$", value=box, unit="mm")
    return (
        Block(heading="Mass", rows=(mass,)),
        Block(heading="Centre of gravity", small="from the origin of the frame", rows=cog),
        tensor,
        Block(heading="Principal moments", small=freedom, rows=principal_rows),
        Block(heading="Equivalent ellipsoid", small="homogeneous, same mass and principal moments", rows=(semi_axes_row,)),
        Block(heading="Bounding box", small="of the counted bodies", rows=(box_row,)),
    )


def significant(value: float, digits: int) -> str:
    """`value` with so many significant digits, trailing zeros kept, without an exponent while that is readable."""
    if value == 0:
        return "0"
    exponent = int(np.floor(np.log10(abs(value))))
    if not -4 <= exponent < 7:
        return f"{value:.{digits - 1}e}".replace("-", "−")
    return f"{value:.{max(digits - 1 - exponent, 0)}f}".replace("-", "−")


def millimetres(length: float, digits: int = 2) -> str:
    """`length` [m] in millimetres, without a negative zero."""
    text = f"{round(length * MM, digits) + 0.0:.{digits}f}"
    return text.replace("-", "−")


def direction(axis: Array) -> str:
    """A unit vector (3,) in words: ``along z`` when it is a frame axis, else its components."""
    k = int(np.argmax(np.abs(axis)))
    if abs(axis[k]) > 1 - 1e-9:
        return f"along {'−' if axis[k] < 0 else ''}${'xyz'[k]}$"
    return "(" + ", ".join(f"{round(c, 3) + 0.0:.3f}" for c in axis).replace("-", "−") + ")"


# The camera: a parallel projection, so that a scale bar is true everywhere in the picture.


AZIMUTH = np.radians(-62.0)
"""Where the camera stands, from +x towards +y: x runs to the right, y into the picture."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Projection:
    """A parallel projection onto an image.

    Attributes
    ----------
    right, up, towards : (3,), the image's axes and the way to the camera, an orthonormal right-handed set in the article's frame
    centre : (3,) [m], what is in the middle of the image
    scale : [m] a pixel
    size : width and height of the image [pixel]
    """

    right: Array
    up: Array
    towards: Array
    centre: Array
    scale: float
    size: tuple[int, int]

    def pixel(self, points: npt.ArrayLike) -> Array:
        """Where `points` (..., 3) [m] appear: (..., 2) [pixel], to the right and down from the upper left corner."""
        arm = np.asarray(points, dtype=np.float64) - self.centre
        across, upwards = arm @ self.right / self.scale, arm @ self.up / self.scale
        width, height = self.size
        return np.stack([width / 2 + across, height / 2 - upwards], axis=-1)


def fitted(points: Array, size: tuple[int, int], margin: float) -> Projection:
    """The view in which `points` (n, 3) [m] fill an image of `size` [pixel] but for `margin` [pixel] on every side.

    A flat article is looked at from higher up, so that its upper face shows.
    """
    # Camera height above the horizon [rad]: 18° for what is at least as tall as wide, 34° for a plate
    extent = np.ptp(points, axis=0)
    slender = min(extent[2] / max(extent[0], extent[1], 1e-12), 1.0)
    elevation = float(np.radians(34.0 - 16.0 * slender))
    c, s = np.cos(elevation), np.sin(elevation)
    towards = np.array([c * np.cos(AZIMUTH), c * np.sin(AZIMUTH), s])
    right = np.cross([0.0, 0.0, 1.0], towards)
    right /= np.linalg.norm(right)
    up = np.cross(towards, right)
    axes = np.column_stack([right, up, towards])
    lower, upper = (points @ axes).min(axis=0), (points @ axes).max(axis=0)
    room = np.array(size) - 2 * margin
    return Projection(
        right=frozen(right, (3,), "right"),
        up=frozen(up, (3,), "up"),
        towards=frozen(towards, (3,), "towards"),
        centre=frozen(axes @ ((lower + upper) / 2), (3,), "centre"),
        scale=float(((upper - lower)[:2] / room).max()),
        size=size,
    )


# An OpenGL window that nobody sees: where VTK gets it from, and what is said when there is none.
#
# Left alone, VTK asks an X server first, complains on standard error, tries EGL, then OSMesa, and crashes when all are missing.
# Pictures need no screen, so on Linux EGL is asked at once, whether a display exists or not: the same picture everywhere. A
# child process tries it first, because a crash in the driver cannot be caught in this one.


OFF_SCREEN = {"VTK_DEFAULT_OPENGL_WINDOW": "vtkEGLRenderWindow", "EGL_LOG_LEVEL": "fatal"}
"""Environment that makes VTK render through EGL, and Mesa keep to itself which hardware it did not find."""

TRIAL = """
import pyvista
plotter = pyvista.Plotter(off_screen=True, window_size=(16, 16))
plotter.add_mesh(pyvista.Sphere(), color="black")
if plotter.screenshot(return_img=True).min() > 128:
    raise SystemExit(3)
"""

PATIENCE = 120
"""Seconds after which a driver that does not answer counts as none."""


@contextmanager
def off_screen() -> Iterator[None]:
    """Windows made inside need no screen; the environment is restored afterwards.

    Raises
    ------
    CheckFailed : nothing can be rendered on this machine; the message names the packages that are missing.
    """
    _require_renderer()
    before = {name: os.environ.get(name) for name in _environment()}
    os.environ.update(_environment())
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value


@cache
def _require_renderer() -> None:
    """Render a black ball in a child process, once a session."""
    if find_spec("pyvista") is None:
        raise ModuleNotFoundError("No module named 'pyvista'", name="pyvista")
    environment = os.environ | _environment()
    try:
        command = [sys.executable, "-P", "-c", TRIAL]
        trial = subprocess.run(command, env=environment, capture_output=True, timeout=PATIENCE, check=False)
    except subprocess.TimeoutExpired:
        raise _no_renderer("it did not answer") from None
    if trial.returncode != 0:
        raise _no_renderer(f"a trial ended with code {trial.returncode}", trial.stderr.decode(errors="replace"))


def _no_renderer(what: str, said: str = "") -> CheckFailed:
    return CheckFailed(
        f"no picture can be rendered: OpenGL is not available without a screen ({what}). "
        "On Debian install the packages libegl1, libgl1 and libgl1-mesa-dri (software rendering, no graphics card needed), "
        "or ask for the tables without pictures",
        said=said,
    )


def _environment() -> dict[str, str]:
    return OFF_SCREEN if sys.platform == "linux" else {}


# The three-dimensional part of a picture, rendered by pyvista: bodies one can look into, ellipsoid, axes and frame.


Image = npt.NDArray[np.uint8]
"""Pixels (height, width, 3), red, green and blue."""

SUPERSAMPLING = 2
"""Pixels are rendered so many times finer in each direction and averaged."""

PEELS = 12
"""Layers of translucent surfaces that are sorted; what lies deeper than that no one sees."""

SEEN_THROUGH = 0.45
"""How strongly arrows shine through the bodies in front of them."""

Plotter = Any
"""A `pyvista.Plotter`; the library is imported inside the functions."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Arrow:
    """An arrow from `start` to `end` (3,) [m] with a shaft of `radius` [m]."""

    start: Array
    end: Array
    radius: float
    colour: str


def rendered(view: Projection, bodies: Sequence[DrawnBody], ellipsoid: Ellipsoid | None, arrows: Sequence[Arrow]) -> Image:
    """The scene as seen by `view`, without an ellipsoid where there is none.

    Raises
    ------
    CheckFailed : nothing can be rendered on this machine.
    """
    with off_screen():
        whole = shot(view, lambda plotter: _draw_bodies(plotter, bodies, ellipsoid, arrows))
        on_top = shot(view, lambda plotter: _arrows(plotter, arrows), transparent=True)
    alpha = SEEN_THROUGH * on_top[..., 3:] / 255.0
    blended = whole * (1 - alpha) + on_top[..., :3] * alpha
    return np.round(averaged(blended)).astype(np.uint8)


def shot(view: Projection, draw: Any, transparent: bool = False, peels: int = PEELS) -> npt.NDArray[np.uint8]:
    """One rendering, `SUPERSAMPLING` times finer than the view; with an alpha channel when `transparent`.

    `draw` puts things into the plotter it is given; `peels` layers of translucent surfaces are sorted, 0 where there are none.
    To be called inside of `off_screen`.
    """
    import pyvista

    width, height = view.size
    pixels = [width * SUPERSAMPLING, height * SUPERSAMPLING]
    plotter: Plotter = pyvista.Plotter(off_screen=True, window_size=pixels, lighting="none")
    try:
        plotter.disable_anti_aliasing()  # multisampling and depth peeling together lose the translucent bodies under Mesa
        plotter.set_background(PAPER)
        light(plotter)
        draw(plotter)
        camera = plotter.camera
        camera.enable_parallel_projection()
        distance = 10 * view.scale * max(view.size)
        camera.focal_point, camera.position, camera.up = view.centre, view.centre + distance * view.towards, view.up
        camera.parallel_scale = view.scale * view.size[1] / 2
        camera.clipping_range = (distance * 0.5, distance * 1.5)
        if peels and not transparent:
            plotter.enable_depth_peeling(peels, 0.0)
        return np.asarray(plotter.screenshot(return_img=True, transparent_background=transparent))
    finally:
        plotter.close()


def light(plotter: Plotter) -> None:
    """Key light over the left shoulder, fill from the right, a little from behind; all move with the camera."""
    import pyvista

    for position, intensity in (((-1.0, 1.2, 2.0), 0.62), ((2.0, 0.3, 1.2), 0.36), ((0.0, 1.0, -1.5), 0.15)):
        lamp = pyvista.Light(light_type="camera light", intensity=intensity)
        lamp.position = position
        plotter.add_light(lamp)


def surface(vertices: Array, faces: npt.NDArray[np.int64]) -> Any:
    """Triangles as a `pyvista.PolyData`, whose points may be moved."""
    import pyvista

    return pyvista.PolyData(np.array(vertices), np.column_stack([np.full(len(faces), 3), faces]).ravel())


def draw_edges(plotter: Plotter, edges: npt.NDArray[np.int64], points: Array, colour: str) -> None:
    """Pieces of lines between `points`, by the numbers (e, 2) of their ends."""
    import pyvista

    if len(edges):
        lines = pyvista.PolyData(points, lines=np.column_stack([np.full(len(edges), 2), edges]).ravel())
        plotter.add_mesh(lines, color=colour, line_width=0.8 * SUPERSAMPLING, lighting=False)


def draw_line(plotter: Plotter, points: Array, colour: str, width: float) -> None:
    """A line along `points`, `width` pixels wide."""
    import pyvista

    plotter.add_mesh(pyvista.MultipleLines(points=points), color=colour, line_width=width * SUPERSAMPLING / 2, lighting=False)


def _draw_bodies(plotter: Plotter, bodies: Sequence[DrawnBody], ellipsoid: Ellipsoid | None, arrows: Sequence[Arrow]) -> None:
    """Bodies that one can look into, those that do not count as ghosts, the ellipsoid with its three rings, and arrows."""
    import pyvista

    colour = palette_colours(body.material for body in bodies)
    for body in bodies:
        shown, opacity, line = (colour[body.material], 0.55, 1.6) if body.counted else (UNCOUNTED, 0.10, 1.0)
        mesh = surface(body.vertices, body.faces)
        plotter.add_mesh(mesh, color=shown, opacity=opacity, ambient=0.62, diffuse=0.5, specular=0.08)
        edges = mesh.extract_feature_edges(30, boundary_edges=False, manifold_edges=False, non_manifold_edges=False)
        if edges.n_cells:
            edge_colour = pyvista.Color(shown).float_rgb
            darker = tuple(0.55 * c for c in edge_colour) if body.counted else edge_colour
            plotter.add_mesh(edges, color=darker, line_width=line * SUPERSAMPLING / 2, lighting=False)
    if ellipsoid is not None:
        _draw_ellipsoid(plotter, ellipsoid)
    _arrows(plotter, arrows)


def _draw_ellipsoid(plotter: Plotter, ellipsoid: Ellipsoid) -> None:
    import pyvista

    ball = pyvista.Sphere(radius=1.0, theta_resolution=96, phi_resolution=96)
    look = {"ambient": 0.75, "diffuse": 0.35, "smooth_shading": True}
    plotter.add_mesh(pyvista.PolyData(ellipsoid.stretched(ball.points), ball.faces), color=ELLIPSOID, opacity=0.13, **look)
    turn = np.linspace(0, 2 * np.pi, 181)
    for i in range(3):
        ring = np.zeros((len(turn), 3))
        ring[:, i - 2], ring[:, i - 1] = np.cos(turn), np.sin(turn)
        draw_line(plotter, ellipsoid.stretched(ring), ELLIPSOID, 1.2)


def _arrows(plotter: Plotter, arrows: Sequence[Arrow]) -> None:
    import pyvista

    for arrow in arrows:
        reach = arrow.end - arrow.start
        length = float(np.linalg.norm(reach))
        mesh = pyvista.Arrow(
            start=arrow.start,
            direction=reach,
            scale=length,
            shaft_radius=arrow.radius / length,
            tip_radius=3 * arrow.radius / length,
            tip_length=9 * arrow.radius / length,
            shaft_resolution=24,
            tip_resolution=32,
        )
        plotter.add_mesh(mesh, color=arrow.colour, ambient=0.45, diffuse=0.6, specular=0.1)


def averaged(image: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """`image`, `SUPERSAMPLING` times finer than wanted, at the size wanted."""
    height, width = (length // SUPERSAMPLING for length in image.shape[:2])
    return np.asarray(image.reshape(height, SUPERSAMPLING, width, SUPERSAMPLING, 3).mean(axis=(1, 3)))


# One page: the rendered scene, what is written into it, and the figures beside it. Laid out by matplotlib, in pixels.


SIZE = (1600, 1200)
SCENE = (1120, 1010)
SCENE_CORNER = (10, 100)
SCENE_BOX = (np.array([SCENE_CORNER[0] + SCENE[0] / 2, SCENE_CORNER[1] + SCENE[1] / 2]), SCENE)
"""Middle and size of the scene on the page: labels stay inside."""

MARGIN = 44.0
DPI = 100

PANEL = (1156, 1556)
"""Left and right edge of the panel [pixel]."""

LEGEND_ENTRIES = 20
"""There is no room for more; of very many materials the last in the alphabet are named."""

AXIS_LENGTH, FRAME_LENGTH = 190.0, 95.0
AXIS_RADIUS, FRAME_RADIUS = 3.6, 2.2
CORNER = (150, 110)
FAR_ORIGIN = 1.6
"""An origin that would make the article smaller by this factor stays outside; the frame then stands in the corner."""

COG_RADIUS = 13.0

Canvas = Any
"""Matplotlib axes in pixels from the upper left corner; the library is imported inside the functions."""


PLAIN_SIZE, PLAIN_LETTERS = (1140, 1070), 1.75
"""[pixel], and times those of a sheet: on paper, 88 mm high, the letters of a picture without title and panel have 7 pt."""


def picture(title: str, bodies: Sequence[DrawnBody], inertia: Inertia, path: Path, note: str = "", *, sheet: bool = True) -> None:
    """Write a picture of `bodies` with the CoG, principal axes and equivalent ellipsoid of `inertia`.

    Parameters
    ----------
    title : what the picture shows
    bodies : closed meshes in the article's frame; those that do not count are drawn as ghosts
    inertia : of the counted bodies, in the same frame, about any reference point
    path : of the picture; the ending (.png, .jpg) chooses the format; written whole or not at all
    note : sentences under the picture: assumptions, "a reconstruction"
    sheet : 1600 x 1200 pixels with title, all figures and the note; else what is drawn alone, with larger letters

    Raises
    ------
    BadInput : no body counts, no body can have this `inertia`, or the ending of `path` is unknown.
    CheckFailed : nothing can be rendered on this machine.
    """
    require_format(path)
    if not any(body.counted for body in bodies):
        raise BadInput(f"picture of {title}", "bodies", "no body counts", "Give at least one")
    ellipsoid = equivalent_ellipsoid(require_physical(inertia, f"picture of {title}"))
    page = _Page(view=view_of(bodies, ellipsoid), ellipsoid=ellipsoid)
    image = rendered(page.view, bodies, ellipsoid, [*page.frame, *page.principal])
    figure, canvas = blank(*(SIZE if sheet else PLAIN_SIZE))
    (x, y), larger = SCENE_CORNER, 1.0 if sheet else PLAIN_LETTERS
    if sheet:
        write(canvas, 48, 64, shortened(title, 64), 34, va="center", weight="bold")
    else:
        canvas.set_ylim(y - 10 + PLAIN_SIZE[1], y - 10)
    canvas.imshow(image, extent=(x, x + SCENE[0], y + SCENE[1], y), interpolation="none", zorder=0)
    cog = page.place(ellipsoid.centre)
    _cog_symbol(canvas, cog)
    # Labels keep clear of the CoG, and of small squares strung along the arrows
    steps = np.linspace(0, 1, 24)[:, None]
    along = np.concatenate([one.start + steps * (one.end - one.start) for one in (*page.frame, *page.principal)])
    taken = [(cog, (2 * COG_RADIUS, 2 * COG_RADIUS)), *((place, (8.0, 8.0)) for place in page.place(along))]
    labels = [
        *page.labels("123", page.principal),
        Label(text="CoG", anchor=cog, wish=np.array([-1.0, -0.35]), extent=(62, 30), gap=COG_RADIUS + 16, colour=INK),
        *page.labels("xyz", page.frame),
    ]
    labels = [replace(one, extent=(larger * one.extent[0], larger * one.extent[1])) for one in labels]
    for label, place in zip(labels, arranged(labels, taken, SCENE_BOX), strict=True):
        canvas.plot(*np.column_stack([label.anchor, place]), color=label.colour, linewidth=0.8, zorder=4)
        box = {"boxstyle": "round,pad=0.22", "facecolor": PAPER, "edgecolor": "none", "alpha": 0.82}
        how = {"ha": "center", "va": "center", "weight": "bold", "bbox": box, "zorder": 6}
        write(canvas, place[0], place[1], label.text, 19 * larger, label.colour, **how)
    # A bar true in every direction of the picture plane: the largest 1, 2 or 5 times a power of ten within 200 pixels
    longest = 200 * page.view.scale
    power = 10.0 ** np.floor(np.log10(longest))
    length = float(power * max(step for step in (1, 2, 5) if step * power <= longest))
    left, below, width = 48.0, SCENE_CORNER[1] + SCENE[1] - 6.0, length / page.view.scale
    right = left + width
    ends = ([left, left, left, right, right, right], [below - 7, below + 7, below, below, below - 7, below + 7])
    canvas.plot(*ends, color=INK, linewidth=1.6)
    text = f"{length * 1e3:g} mm" if length < 1 else f"{length:g} m"
    write(canvas, left + width / 2, below - 12, text, 16 * larger, ha="center", va="bottom")
    if sheet:
        _write_figures(canvas, blocks(bodies, inertia, ellipsoid), bodies)
        whole = note if page.origin_shown else f"The frame's origin lies outside the picture; its axes are shown. {note}"
        for i, line in enumerate(textwrap.wrap(whole, 180, max_lines=3, placeholder=" …")):
            write(canvas, 48, 1142 + 21 * i, line, 14.5, FAINT, va="baseline")
    save(path, lambda temporary: figure.savefig(temporary, dpi=DPI))


def blank(width: int, height: int) -> tuple[Any, Canvas]:
    """A white figure and axes that cover it, one unit a pixel, y downwards."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width / DPI, height / DPI), dpi=DPI, facecolor=PAPER)
    FigureCanvasAgg(figure)
    canvas = figure.add_axes((0, 0, 1, 1))
    canvas.set_axis_off()
    canvas.set_autoscale_on(False)
    canvas.set(xlim=(0, width), ylim=(height, 0))
    return figure, canvas


def write(canvas: Canvas, x: float, y: float, text: str, size: float, colour: str = INK, **how: Any) -> None:
    """Text at a place of `blank`, `size` in pixels; dollar signs are mathematics only where `parse_math` says so."""
    canvas.text(x, y, text, fontsize=size * 72 / DPI, color=colour, family="DejaVu Sans", **{"parse_math": False} | how)


def pixels(figure: Any) -> Image:
    """What `figure` shows, as an image."""
    figure.canvas.draw()
    return np.asarray(figure.canvas.buffer_rgba())[..., :3].copy()


def write_gif(path: Path, frames: Sequence[Image], duration: int, colourful: int = 0) -> None:
    """Write `frames` as an endless GIF, `duration` [ms] each, in the colours of the frame with the number `colourful`."""
    from PIL import Image as Pictures

    pictures = [Pictures.fromarray(frame) for frame in frames]
    palette = pictures[colourful].quantize(255, method=Pictures.Quantize.MEDIANCUT, dither=Pictures.Dither.NONE)
    small = [picture.quantize(palette=palette, dither=Pictures.Dither.NONE) for picture in pictures]
    how: dict[str, Any] = {"save_all": True, "append_images": small[1:], "duration": duration, "loop": 0}
    write_with(path, lambda temporary: small[0].save(temporary, format="GIF", **how))


def view_of(bodies: Sequence[DrawnBody], ellipsoid: Ellipsoid) -> Projection:
    """The view that shows all bodies, the whole ellipsoid, and the frame's origin unless that would make them small."""
    # All over the unit ball, five degrees apart
    turn, height = np.meshgrid(np.linspace(0, 2 * np.pi, 73), np.linspace(-np.pi / 2, np.pi / 2, 37))
    ball = np.column_stack([f.ravel() for f in (np.cos(turn) * np.cos(height), np.sin(turn) * np.cos(height), np.sin(height))])
    points = np.concatenate([*(body.vertices for body in bodies), ellipsoid.stretched(ball)])
    without = fitted(points, SCENE, MARGIN)
    whole = fitted(np.vstack([points, np.zeros(3)]), SCENE, MARGIN)
    return whole if whole.scale < FAR_ORIGIN * without.scale else without


@dataclass(frozen=True, eq=False, kw_only=True)
class _Page:
    """The scene on its page, with the arrows of the principal axes and of the frame."""

    view: Projection
    ellipsoid: Ellipsoid

    @property
    def principal(self) -> list[Arrow]:
        """At the CoG."""
        length, radius, foot = AXIS_LENGTH * self.view.scale, AXIS_RADIUS * self.view.scale, self.ellipsoid.centre
        axes = zip(self.ellipsoid.axes.T, AXES, strict=True)
        return [Arrow(start=foot, end=foot + length * axis, radius=radius, colour=colour) for axis, colour in axes]

    @property
    def frame(self) -> list[Arrow]:
        """At the origin, or in the lower left corner when that lies outside the picture."""
        view, foot = self.view, np.zeros(3)
        if not self.origin_shown:
            across, upwards = CORNER[0] - SCENE[0] / 2, CORNER[1] - SCENE[1] / 2
            foot = np.asarray(view.centre + view.scale * (across * view.right + upwards * view.up))
        length, radius = FRAME_LENGTH * view.scale, FRAME_RADIUS * view.scale
        return [Arrow(start=foot, end=foot + length * axis, radius=radius, colour=INK) for axis in np.eye(3)]

    @property
    def origin_shown(self) -> bool:
        """Whether the frame's origin lies within the picture."""
        return bool(np.all((self.view.pixel(np.zeros(3)) >= 0) & (self.view.pixel(np.zeros(3)) <= SCENE)))

    def place(self, points: Array) -> Array:
        """Where `points` (..., 3) [m] stand [pixel]."""
        return np.asarray(self.view.pixel(points) + SCENE_CORNER)

    def labels(self, names: Sequence[str], arrows: Sequence[Arrow]) -> list[Label]:
        """At the tips of `arrows`, beyond them."""
        found = []
        for name, arrow in zip(names, arrows, strict=True):
            tip = self.place(arrow.end)
            wish = tip - self.place(arrow.start)
            found.append(Label(text=name, anchor=tip, wish=wish, extent=(26, 30), gap=8, colour=arrow.colour))
        return found


def shortened(text: str, longest: int) -> str:
    """`text` with its middle left out when it is longer than `longest` characters: both ends of a path tell something."""
    half = (longest - 1) // 2
    return text if len(text) <= longest else f"{text[:half]}…{text[-half:]}"


def _cog_symbol(canvas: Canvas, place: Array) -> None:
    """The circle with two black and two white quarters."""
    from matplotlib.patches import Circle, Wedge

    centre = (float(place[0]), float(place[1]))
    canvas.add_patch(Circle(centre, COG_RADIUS + 2, facecolor=PAPER, edgecolor="none", zorder=5))
    canvas.add_patch(Circle(centre, COG_RADIUS, facecolor=PAPER, edgecolor=INK, linewidth=1.4, zorder=5))
    for start in (0, 180):
        canvas.add_patch(Wedge(centre, COG_RADIUS, start, start + 90, facecolor="black", edgecolor="none", zorder=5))


def _write_figures(canvas: Canvas, contents: Sequence[Block], bodies: Sequence[DrawnBody]) -> None:
    """The blocks of figures from top to bottom, and below them materials, ghosts and the ellipsoid with their colours."""
    from matplotlib.patches import Rectangle

    left, right = PANEL
    y = 132.0
    for block in contents:
        write(canvas, left, y, block.heading, 18, weight="bold", va="baseline")
        if block.small:
            y += 20
            write(canvas, left, y, block.small, 13.5, FAINT, va="baseline")
        for row in block.rows:
            y += 26
            write(canvas, left + 8, y, row.name, 16.5, row.colour or INK, va="baseline", parse_math=True)
            write(canvas, right - 62, y, row.value, 16.5, ha="right", va="baseline")
            write(canvas, right - 52, y, row.unit, 16.5, FAINT, va="baseline")
        y += 40
    write(canvas, left, y, "Legend", 18, weight="bold", va="baseline")
    shown = palette_colours(body.material for body in bodies if body.counted)
    entries = [(colour, 0.75, name) for name, colour in shown.items()]
    entries += [(UNCOUNTED, 0.25, "not counted")] if any(not body.counted for body in bodies) else []
    entries += [(ELLIPSOID, 0.3, "equivalent ellipsoid")]
    for i, (colour, opacity, text) in enumerate(entries[-LEGEND_ENTRIES:]):
        x, line = left + 8 + 200 * (i % 2), y + 30 + 28 * (i // 2)
        canvas.add_patch(Rectangle((x, line - 15), 26, 18, facecolor=colour, alpha=opacity, edgecolor=INK, linewidth=0.8))
        write(canvas, x + 36, line, shortened(text, 20), 15.5, va="baseline")


# Colours of the inputs of an uncertainty: the same input has the same colour in every picture, expected and found.


OF_INPUTS = {
    "noise": "#2456c4",
    "elasticity": "#c8283c",
    "tare": "#33373d",
    "force-gain": "#1f8a4c",
    "force-delay": "#7fc29b",
    "force-crosstalk": "#5f9ea0",
    "accelerometer-gain": "#d9541e",
    "accelerometer-delay": "#f0b27a",
    "accelerometer-position": "#c9a227",
    "accelerometer-misalignment": "#8e6fc0",
    "cell-stiffness": "#b5838d",
    "fmd-compliance": "#6b7a3a",
}

FURTHER = ("#4aa3df", "#a0522d", "#d987b9", "#7a869a")
"""Of inputs that are not among these, in turn."""


def colours(names: Iterable[str]) -> dict[str, str]:
    """By input its colour, in the order of `names`."""
    wanted = list(names)
    others = [name for name in wanted if name not in OF_INPUTS]
    further = {name: FURTHER[k % len(FURTHER)] for k, name in enumerate(others)}
    return {name: OF_INPUTS.get(name) or further[name] for name in wanted}
