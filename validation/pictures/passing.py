"""A sweep that passes a resonance, moving: the article as it bends, and below it the load with the moment that is shown."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from geometry.arrays import Array
from validation.pictures.mode_scene import REACH, displaced
from validation.pictures.mode_sheet import DPI, MARGIN, MOVING_TILE, blank, pixels, write, write_gif
from validation.pictures.moving import MovingBody, largest
from validation.pictures.palette import FAINT, INK
from validation.pictures.scene import Image
from validation.pictures.view import fitted
from validation.pictures.window import off_screen

PACE = 90
"""[ms] a frame."""

HEAD, STRIP = 84, 250
"""Pixels above and below the article."""

SHOWN, TO_COME, NOW = "#2456c4", "#c9d3ea", "#c8283c"


@dataclass(frozen=True, eq=False, kw_only=True)
class Frame:
    """One moment.

    Attributes
    ----------
    time : [s]
    frequency : of the sweep [Hz]
    bodies : with their displacement [m]
    """

    time: float
    frequency: float
    bodies: tuple[MovingBody, ...]


@dataclass(frozen=True, eq=False, kw_only=True)
class Passing:
    """All that is drawn.

    Attributes
    ----------
    title, text : above the article
    frames : in the order of their times
    time, load : (n,) [s], [N, N m] the curve below
    rigid : (n,) amplitude of the rigid body's load
    label : of the load, with its unit
    resonance : when [s] the sweep has the resonance's frequency
    """

    title: str
    text: str
    frames: tuple[Frame, ...]
    time: Array
    load: Array
    rigid: Array
    label: str
    resonance: float


def animate(passing: Passing, path: Path) -> None:
    """Write `passing` as an endless GIF.

    Raises
    ------
    CheckFailed : nothing can be rendered on this machine.
    """
    most = max(largest(frame.bodies) for frame in passing.frames)
    rest = np.concatenate([body.vertices for body in passing.frames[0].bodies])
    factor = REACH * float(np.linalg.norm(np.ptp(rest, axis=0))) / most if most > 0 else 0.0
    head = _head(passing, factor)
    with off_screen():
        swung = np.concatenate([b.vertices + factor * b.displacement for frame in passing.frames for b in frame.bodies])
        view = fitted(np.concatenate([rest, swung]), MOVING_TILE, MARGIN)
        images = [
            np.vstack([head, displaced(view, frame.bodies, factor, most), _strip(passing, frame)]) for frame in passing.frames
        ]
    write_gif(path, images, PACE, _liveliest(passing.frames))


def _liveliest(frames: Sequence[Frame]) -> int:
    """The frame with the largest displacement, which has all the colours."""
    return int(np.argmax([largest(frame.bodies) for frame in frames]))


def _head(passing: Passing, factor: float) -> Image:
    figure, canvas = blank(MOVING_TILE[0], HEAD)
    write(canvas, 18, 28, passing.title, 20, weight="bold", va="center")
    write(canvas, 18, 60, f"{passing.text}, displacement drawn {factor:.0f} times as large", 14, FAINT, va="center")
    return pixels(figure)


def _strip(passing: Passing, frame: Frame) -> Image:
    """The load up to the moment of `frame` and, paler, what is still to come."""
    width = MOVING_TILE[0]
    figure, canvas = blank(width, STRIP)
    write(canvas, 18, 20, f"{frame.frequency:.2f} Hz", 22, weight="bold", va="center")
    write(canvas, 150, 21, f"at {frame.time:.2f} s", 15, FAINT, va="center")
    write(canvas, width - 18, 21, "dashed: the rigid body, M a", 14, FAINT, va="center", ha="right")
    axes = figure.add_axes((78 / width, 46 / STRIP, (width - 98) / width, (STRIP - 90) / STRIP))
    past = passing.time <= frame.time
    axes.plot(passing.time, passing.load, color=TO_COME, linewidth=0.7)
    axes.plot(passing.time[past], passing.load[past], color=SHOWN, linewidth=0.8)
    for sign in (-1, 1):
        axes.plot(passing.time, sign * passing.rigid, color=INK, linewidth=1.0, linestyle=(0, (5, 3)))
    axes.axvline(passing.resonance, color=FAINT, linewidth=0.9)
    axes.axvline(frame.time, color=NOW, linewidth=1.2)
    axes.set_xlim(passing.time[0], passing.time[-1])
    reach = 1.08 * max(float(np.abs(passing.load).max()), float(passing.rigid.max()), float(np.finfo(np.float64).tiny))
    axes.set_ylim(-reach, reach)
    axes.tick_params(labelsize=13 * 72 / DPI, colors=INK)
    axes.set_xlabel("time [s]", fontsize=13 * 72 / DPI, labelpad=1)
    axes.set_ylabel(passing.label, fontsize=13 * 72 / DPI)
    return pixels(figure)
