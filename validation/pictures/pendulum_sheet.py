"""The swinging pendulum with its recorded signal below: as a picture, and moving as a GIF."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from geometry.arrays import Array
from geometry.atomic import write_with
from validation.pictures.bodies import DrawnBody
from validation.pictures.files import ABOUT, require_format, save
from validation.pictures.palette import FAINT, INK, PAPER
from validation.pictures.pendulum_scene import Instant, pendulum_scene, rendered
from validation.pictures.scene import Image
from validation.pictures.window import off_screen

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

    A PNG carries the words `about`, which `validation.pictures.said_about` reads again.

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
    head = _head(swing)
    strips = _Strip(swing)
    with off_screen():
        scene = pendulum_scene(swing.bodies, swing.rest, swing.instants, TILE, MARGIN)
        return [
            np.vstack([head, rendered(scene, one), strips.at(float(moment))])
            for one, moment in zip(instants, swing.moments, strict=False)
        ]


def _head(swing: DrawnSwing) -> Image:
    figure = _figure(HEAD)
    font = {"family": "DejaVu Sans", "parse_math": False, "va": "center"}
    figure.text(18 / TILE[0], 1 - 28 / HEAD, swing.title, fontsize=14.4, weight="bold", color=INK, **font)
    figure.text(18 / TILE[0], 1 - 60 / HEAD, swing.text, fontsize=10, color=FAINT, **font)
    return _drawn(figure)


class _Strip:
    """The record, drawn once; only the mark of the present moment moves."""

    def __init__(self, swing: DrawnSwing) -> None:
        self.figure = _figure(STRIP)
        axes: Axes = self.figure.add_axes((0.115, 0.24, 0.86, 0.6))
        unit, factor = _unit(swing.signal)
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


def _unit(signal: Array) -> tuple[str, float]:
    return ("°", 180 / np.pi) if np.abs(signal).max() > 0.02 else ("mrad", 1e3)


def _figure(height: int) -> Any:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(TILE[0] / DPI, height / DPI), dpi=DPI, facecolor=PAPER)
    FigureCanvasAgg(figure)
    return figure


def _drawn(figure: Any) -> Image:
    figure.canvas.draw()
    return np.asarray(figure.canvas.buffer_rgba())[..., :3].copy()
