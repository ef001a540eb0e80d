"""Mode shapes on one sheet, each with its number, frequency and words; and one of them moving, as a GIF."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from geometry.errors import BadInput
from validation.pictures.files import ABOUT, require_format, save
from validation.pictures.mode_scene import colour_map, rendered, view_of
from validation.pictures.moving import MovingBody
from validation.pictures.palette import FAINT, INK, PAPER
from validation.pictures.scene import Image
from validation.pictures.window import off_screen

DPI = 100
COLUMNS = 4
TILE = (400, 500)
CAPTION = 62
"""Pixels above a tile for number, frequency and words."""

HEAD, FOOT = 78, 66
MARGIN = 14.0

FRAMES = 24
PERIOD = 1560
"""Frames of one cycle of a GIF, and its duration [ms]."""

MOVING_TILE = (620, 640)


@dataclass(frozen=True, eq=False, kw_only=True)
class DrawnMode:
    """One mode to be drawn.

    Attributes
    ----------
    number : from 1
    frequency : [Hz]
    text : what it is
    bodies : with their displacement
    """

    number: int
    frequency: float
    text: str
    bodies: tuple[MovingBody, ...]

    @property
    def caption(self) -> str:
        """Number and frequency."""
        return f"{self.number}   {self.frequency:.2f} Hz"


def mode_sheet(title: str, modes: Sequence[DrawnMode], path: Path, note: str = "", about: str = "") -> None:
    """Write all of `modes` on one sheet, all seen from the same side and in the same scale.

    A PNG carries the words `about`, which `validation.pictures.said_about` reads again.

    Raises
    ------
    BadInput : there is no mode, or the ending of `path` is unknown.
    CheckFailed : nothing can be rendered on this machine.
    """
    require_format(path)
    if not modes:
        raise BadInput(source=title, problem="there is no mode to draw", remedy="A rigid article has none in this range")
    columns = min(COLUMNS, len(modes))
    rows = -(-len(modes) // columns)
    with off_screen():
        view = view_of([mode.bodies for mode in modes], TILE, MARGIN)
        tiles = [rendered(view, mode.bodies, 1.0) for mode in modes]
    width, height = max(columns * TILE[0], 2 * TILE[0]), HEAD + rows * (TILE[1] + CAPTION) + FOOT
    figure, canvas = blank(width, height)
    write(canvas, 24, 40, title, 26, weight="bold", va="center")
    for k, (mode, tile) in enumerate(zip(modes, tiles, strict=True)):
        _tile(canvas, mode, tile, k % columns * TILE[0], HEAD + k // columns * (TILE[1] + CAPTION))
    _bar(figure, width, height)
    for i, line in enumerate(textwrap.wrap(note, (width - 420) // 8, max_lines=2, placeholder=" …")):
        write(canvas, 24, height - FOOT + 26 + 20 * i, line, 14, FAINT, va="center")
    more = {"metadata": {ABOUT: about}} if about else {}
    save(path, lambda temporary: figure.savefig(temporary, dpi=DPI, **more))


def animation(title: str, mode: DrawnMode, path: Path) -> None:
    """Write one cycle of `mode` as an endless GIF.

    Raises
    ------
    CheckFailed : nothing can be rendered on this machine.
    """
    head = _head(title, mode)
    with off_screen():
        view = view_of([mode.bodies], MOVING_TILE, MARGIN)
        shares = np.sin(2 * np.pi * np.arange(FRAMES) / FRAMES)
        frames = [np.vstack([head, rendered(view, mode.bodies, share)]) for share in shares]
    write_gif(path, frames, PERIOD // FRAMES, FRAMES // 4)


def write_gif(path: Path, frames: Sequence[Image], duration: int, colourful: int) -> None:
    """Write `frames` as an endless GIF, `duration` [ms] each, in the colours of the frame with the number `colourful`."""
    from PIL import Image as Pictures

    from geometry.atomic import write_with

    pictures = [Pictures.fromarray(frame) for frame in frames]
    palette = pictures[colourful].quantize(255, method=Pictures.Quantize.MEDIANCUT, dither=Pictures.Dither.NONE)
    small = [picture.quantize(palette=palette, dither=Pictures.Dither.NONE) for picture in pictures]
    how: dict[str, Any] = {"save_all": True, "append_images": small[1:], "duration": duration, "loop": 0}
    write_with(path, lambda temporary: small[0].save(temporary, format="GIF", **how))


def _head(title: str, mode: DrawnMode) -> Image:
    """The strip above the moving picture."""
    figure, canvas = blank(MOVING_TILE[0], 84)
    write(canvas, 18, 28, f"{title}, mode {mode.caption}", 20, weight="bold", va="center")
    write(canvas, 18, 60, textwrap.shorten(mode.text, 84, placeholder=" …"), 14, FAINT, va="center")
    return pixels(figure)


def pixels(figure: Any) -> Image:
    """What `figure` shows, as an image."""
    figure.canvas.draw()
    return np.asarray(figure.canvas.buffer_rgba())[..., :3].copy()


def _tile(canvas: Any, mode: DrawnMode, tile: Image, x: float, y: float) -> None:
    canvas.imshow(tile, extent=(x, x + TILE[0], y + CAPTION + TILE[1], y + CAPTION), interpolation="none")
    write(canvas, x + 24, y + 16, mode.caption, 19, weight="bold", va="center")
    for i, line in enumerate(textwrap.wrap(mode.text, 50, max_lines=2, placeholder=" …")):
        write(canvas, x + 24, y + 38 + 16 * i, line, 13, FAINT, va="center")


def _bar(figure: Any, width: float, height: float) -> None:
    """What the colours mean."""
    from matplotlib.colorbar import ColorbarBase

    axes = figure.add_axes(((width - 330) / width, 34 / height, 290 / width, 12 / height))
    bar = ColorbarBase(axes, cmap=colour_map(), orientation="horizontal", ticks=[0, 0.5, 1])
    bar.ax.tick_params(labelsize=8.5, colors=FAINT, length=2, pad=2)
    bar.outline.set_visible(False)
    axes.set_title("displacement over its largest", fontsize=9, color=FAINT, pad=4)


def blank(width: int, height: int) -> tuple[Any, Any]:
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


def write(canvas: Any, x: float, y: float, text: str, size: float, colour: str = INK, **how: Any) -> None:
    """Put `text` of so many pixels onto the axes of `blank`."""
    canvas.text(x, y, text, fontsize=size * 72 / DPI, color=colour, family="DejaVu Sans", parse_math=False, **how)
