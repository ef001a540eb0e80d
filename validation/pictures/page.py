"""One page: the rendered scene, what is written into it, and the figures beside it. Laid out by matplotlib, in pixels."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from geometry.arrays import Array
from geometry.consistency import require_physical
from geometry.errors import BadInput
from geometry.inertia import Inertia
from validation.pictures.bodies import DrawnBody
from validation.pictures.ellipsoid import Ellipsoid, equivalent_ellipsoid
from validation.pictures.files import require_format, save
from validation.pictures.labels import Label, arranged
from validation.pictures.palette import AXES, ELLIPSOID, FAINT, INK, PAPER, UNCOUNTED, colours
from validation.pictures.panel import Block, blocks
from validation.pictures.scene import Arrow, rendered
from validation.pictures.view import View, fitted

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


def picture(title: str, bodies: Sequence[DrawnBody], inertia: Inertia, path: Path, note: str = "") -> None:
    """Write a picture, 1600 x 1200 pixels, of `bodies` with the CoG, principal axes and equivalent ellipsoid of `inertia`.

    Parameters
    ----------
    title : what the picture shows
    bodies : closed meshes in the article's frame; those that do not count are drawn as ghosts
    inertia : of the counted bodies, in the same frame, about any reference point
    path : of the picture; the ending (.png, .jpg) chooses the format; written whole or not at all
    note : sentences under the picture: assumptions, "a reconstruction"

    Raises
    ------
    BadInput : no body counts, no body can have this `inertia`, or the ending of `path` is unknown.
    CheckFailed : nothing can be rendered on this machine.
    """
    require_format(path)
    if not any(body.counted for body in bodies):
        raise BadInput(source=f"picture of {title}", field="bodies", problem="no body counts", remedy="Give at least one")
    ellipsoid = equivalent_ellipsoid(require_physical(inertia, f"picture of {title}"))
    view = view_of(bodies, ellipsoid)
    image = rendered(view, bodies, ellipsoid, [*_frame(view), *_principal(view, ellipsoid)])
    figure, canvas = _blank()
    x, y = SCENE_CORNER
    canvas.imshow(image, extent=(x, x + SCENE[0], y + SCENE[1], y), interpolation="none", zorder=0)
    _title(canvas, title)
    _marks(canvas, view, ellipsoid)
    _scale_bar(canvas, view)
    bottom = _panel(canvas, blocks(bodies, inertia, ellipsoid))
    _legend(canvas, bodies, bottom)
    _note(canvas, note if _origin_shown(view) else f"The frame's origin lies outside the picture; its axes are shown. {note}")
    save(path, lambda temporary: figure.savefig(temporary, dpi=DPI))


def view_of(bodies: Sequence[DrawnBody], ellipsoid: Ellipsoid) -> View:
    """The view that shows all bodies, the whole ellipsoid, and the frame's origin unless that would make them small."""
    points = np.concatenate([*(body.vertices for body in bodies), ellipsoid.stretched(_ball())])
    without = fitted(points, SCENE, MARGIN)
    whole = fitted(np.vstack([points, np.zeros(3)]), SCENE, MARGIN)
    return whole if whole.scale < FAR_ORIGIN * without.scale else without


def _ball() -> Array:
    """Points (n, 3) all over the unit ball, five degrees apart."""
    turn, height = np.meshgrid(np.linspace(0, 2 * np.pi, 73), np.linspace(-np.pi / 2, np.pi / 2, 37))
    return np.column_stack([f.ravel() for f in (np.cos(turn) * np.cos(height), np.sin(turn) * np.cos(height), np.sin(height))])


def _principal(view: View, ellipsoid: Ellipsoid) -> list[Arrow]:
    length, radius = AXIS_LENGTH * view.scale, AXIS_RADIUS * view.scale
    return [
        Arrow(start=ellipsoid.centre, end=ellipsoid.centre + length * axis, radius=radius, colour=colour)
        for axis, colour in zip(ellipsoid.axes.T, AXES, strict=True)
    ]


def _frame(view: View) -> list[Arrow]:
    length, radius, foot = FRAME_LENGTH * view.scale, FRAME_RADIUS * view.scale, _frame_foot(view)
    return [Arrow(start=foot, end=foot + length * axis, radius=radius, colour=INK) for axis in np.eye(3)]


def _frame_foot(view: View) -> Array:
    """Where the frame is drawn (3,) [m]: at its origin, or in the lower left corner when that lies outside the picture."""
    if _origin_shown(view):
        return np.zeros(3)
    width, height = SCENE
    return np.asarray(view.centre + view.scale * ((CORNER[0] - width / 2) * view.right + (CORNER[1] - height / 2) * view.up))


def _origin_shown(view: View) -> bool:
    return bool(np.all((view.pixel(np.zeros(3)) >= 0) & (view.pixel(np.zeros(3)) <= SCENE)))


def _blank() -> tuple[Any, Canvas]:
    """A white figure and axes that cover it, one unit a pixel, y downwards."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(SIZE[0] / DPI, SIZE[1] / DPI), dpi=DPI, facecolor=PAPER)
    FigureCanvasAgg(figure)
    canvas = figure.add_axes((0, 0, 1, 1))
    canvas.set_axis_off()
    canvas.set_autoscale_on(False)
    canvas.set(xlim=(0, SIZE[0]), ylim=(SIZE[1], 0))
    return figure, canvas


def _write(canvas: Canvas, x: float, y: float, text: str, size: float, colour: str = INK, **how: Any) -> Any:
    """Text at a place [pixel], `size` in pixels; dollar signs are mathematics only where `parse_math` says so."""
    return canvas.text(x, y, text, fontsize=size * 72 / DPI, color=colour, family="DejaVu Sans", **{"parse_math": False} | how)


def _title(canvas: Canvas, title: str) -> None:
    _write(canvas, 48, 64, shortened(title, 64), 34, va="center", weight="bold")


def shortened(text: str, longest: int) -> str:
    """`text` with its middle left out when it is longer than `longest` characters: both ends of a path tell something."""
    half = (longest - 1) // 2
    return text if len(text) <= longest else f"{text[:half]}…{text[-half:]}"


def _marks(canvas: Canvas, view: View, ellipsoid: Ellipsoid) -> None:
    """The CoG symbol and the labels of CoG, principal axes and frame."""
    cog = _on_page(view, ellipsoid.centre)
    _cog_symbol(canvas, cog)
    labels = [*_axis_labels(view, ellipsoid), _cog_label(cog), *_frame_labels(view)]
    taken = [(cog, (2 * COG_RADIUS, 2 * COG_RADIUS)), *_shafts(view, [*_frame(view), *_principal(view, ellipsoid)])]
    for label, place in zip(labels, arranged(labels, taken, SCENE_BOX), strict=True):
        canvas.plot(*np.column_stack([label.anchor, place]), color=label.colour, linewidth=0.8, zorder=4)
        box = {"boxstyle": "round,pad=0.22", "facecolor": PAPER, "edgecolor": "none", "alpha": 0.82}
        how = {"ha": "center", "va": "center", "weight": "bold", "bbox": box, "zorder": 6}
        _write(canvas, place[0], place[1], label.text, 19, label.colour, **how)


def _shafts(view: View, arrows: Sequence[Arrow]) -> list[tuple[Array, tuple[float, float]]]:
    """Small squares strung along the arrows, which labels are to keep clear of."""
    steps = np.linspace(0, 1, 24)[:, None]
    points = np.concatenate([arrow.start + steps * (arrow.end - arrow.start) for arrow in arrows])
    return [(place, (8.0, 8.0)) for place in _on_page(view, points)]


def _axis_labels(view: View, ellipsoid: Ellipsoid) -> list[Label]:
    arrows = enumerate(_principal(view, ellipsoid), start=1)
    return [_tip_label(view, str(i), arrow.start, arrow.end, arrow.colour) for i, arrow in arrows]


def _frame_labels(view: View) -> list[Label]:
    return [_tip_label(view, name, arrow.start, arrow.end, INK) for name, arrow in zip("xyz", _frame(view), strict=True)]


def _tip_label(view: View, text: str, start: Array, tip: Array, colour: str) -> Label:
    anchor = _on_page(view, tip)
    return Label(text=text, anchor=anchor, wish=anchor - _on_page(view, start), extent=(26, 30), gap=8, colour=colour)


def _cog_label(cog: Array) -> Label:
    return Label(text="CoG", anchor=cog, wish=np.array([-1.0, -0.35]), extent=(62, 30), gap=COG_RADIUS + 16, colour=INK)


def _cog_symbol(canvas: Canvas, place: Array, radius: float = COG_RADIUS) -> None:
    """The circle with two black and two white quarters."""
    from matplotlib.patches import Circle, Wedge

    centre = (float(place[0]), float(place[1]))
    canvas.add_patch(Circle(centre, radius + 2, facecolor=PAPER, edgecolor="none", zorder=5))
    canvas.add_patch(Circle(centre, radius, facecolor=PAPER, edgecolor=INK, linewidth=1.4, zorder=5))
    for start in (0, 180):
        canvas.add_patch(Wedge(centre, radius, start, start + 90, facecolor="black", edgecolor="none", zorder=5))


def _on_page(view: View, point: Array) -> Array:
    return np.asarray(view.pixel(point) + SCENE_CORNER)


def _scale_bar(canvas: Canvas, view: View) -> None:
    """A bar of a round length, true in every direction of the picture plane."""
    length = _round_length(200 * view.scale)
    x, y, width = 48.0, SCENE_CORNER[1] + SCENE[1] - 6.0, length / view.scale
    canvas.plot([x, x, x, x + width, x + width, x + width], [y - 7, y + 7, y, y, y - 7, y + 7], color=INK, linewidth=1.6)
    text = f"{length * 1e3:g} mm" if length < 1 else f"{length:g} m"
    _write(canvas, x + width / 2, y - 12, text, 16, ha="center", va="bottom")


def _round_length(length: float) -> float:
    """The largest 1, 2 or 5 times a power of ten that is not longer than `length` [m]."""
    power = 10.0 ** np.floor(np.log10(length))
    return float(power * max(step for step in (1, 2, 5) if step * power <= length))


def _panel(canvas: Canvas, contents: Sequence[Block]) -> float:
    """The blocks of figures from top to bottom; returns where they end [pixel]."""
    left, right = PANEL
    y = 132.0
    for block in contents:
        _write(canvas, left, y, block.heading, 18, weight="bold", va="baseline")
        if block.small:
            y += 20
            _write(canvas, left, y, block.small, 13.5, FAINT, va="baseline")
        for row in block.rows:
            y += 26
            _write(canvas, left + 8, y, row.name, 16.5, row.colour or INK, va="baseline", parse_math=True)
            _write(canvas, right - 62, y, row.value, 16.5, ha="right", va="baseline")
            _write(canvas, right - 52, y, row.unit, 16.5, FAINT, va="baseline")
        y += 40
    return y


def _legend(canvas: Canvas, bodies: Sequence[DrawnBody], y: float) -> None:
    """Materials, ghosts, ellipsoid and the CoG symbol with their colours."""
    from matplotlib.patches import Rectangle

    left, _ = PANEL
    _write(canvas, left, y, "Legend", 18, weight="bold", va="baseline")
    shown = colours(body.material for body in bodies if body.counted)
    entries = [(colour, 0.75, name) for name, colour in shown.items()]
    entries += [(UNCOUNTED, 0.25, "not counted")] if any(not body.counted for body in bodies) else []
    entries += [(ELLIPSOID, 0.3, "equivalent ellipsoid")]
    for i, (colour, opacity, text) in enumerate(entries[-LEGEND_ENTRIES:]):
        x, line = left + 8 + 200 * (i % 2), y + 30 + 28 * (i // 2)
        canvas.add_patch(Rectangle((x, line - 15), 26, 18, facecolor=colour, alpha=opacity, edgecolor=INK, linewidth=0.8))
        _write(canvas, x + 36, line, shortened(text, 20), 15.5, va="baseline")


def _note(canvas: Canvas, note: str) -> None:
    for i, line in enumerate(textwrap.wrap(note, 180, max_lines=3, placeholder=" …")):
        _write(canvas, 48, 1142 + 21 * i, line, 14.5, FAINT, va="baseline")
