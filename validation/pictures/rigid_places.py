"""An article coloured by how large the elastic motion of its surface is: where pick-ups belong, and where they do not."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from geometry.arrays import Array
from validation.pictures.files import require_format, save
from validation.pictures.mode_scene import colour_map, displaced
from validation.pictures.mode_sheet import DPI, blank, write
from validation.pictures.moving import MovingBody
from validation.pictures.palette import FAINT
from validation.pictures.view import fitted
from validation.pictures.window import off_screen

TILE = (560, 800)
HEAD, FOOT = 84, 88
MARGIN = 30.0

DECADES = 3.0
"""From the limit, where colour begins, to what is drawn darkest red."""


def draw_rigid(title: str, tiles: Mapping[str, Sequence[MovingBody]], limit: float, path: Path, note: str = "") -> None:
    """Write a picture with a tile for each of `tiles`, by caption; the displacement of vertices is their elastic share.

    What stays within `limit` is grey. All tiles show the same bodies from the same side.

    Raises
    ------
    BadInput : the ending of `path` is unknown.
    CheckFailed : nothing can be rendered on this machine.
    """
    require_format(path)
    first = next(iter(tiles.values()))
    with off_screen():
        view = fitted(np.concatenate([body.vertices for body in first]), TILE, MARGIN)
        shots = {caption: displaced(view, _coloured(bodies, limit), 0.0, 1.0) for caption, bodies in tiles.items()}
    width, height = len(tiles) * TILE[0], HEAD + TILE[1] + FOOT
    figure, canvas = blank(width, height)
    write(canvas, 24, 32, title, 22, weight="bold", va="center")
    for k, (caption, shot) in enumerate(shots.items()):
        left = k * TILE[0]
        canvas.imshow(shot, extent=(left, left + TILE[0], HEAD + TILE[1], HEAD), interpolation="none")
        write(canvas, left + 24, HEAD - 14, caption, 15, FAINT, va="center")
    _bar(figure, limit, width, height)
    write(canvas, 24, height - 16, note, 12, FAINT, va="center")
    save(path, lambda temporary: figure.savefig(temporary, dpi=DPI))


def _coloured(bodies: Sequence[MovingBody], limit: float) -> list[MovingBody]:
    return [replace(body, displacement=_scaled(body.size, limit)[:, None] * [1.0, 0.0, 0.0]) for body in bodies]


def _scaled(share: Array, limit: float) -> Array:
    """0 up to `limit`, then by its logarithm up to 1 at `DECADES` above."""
    return np.asarray(np.clip(np.log10(np.maximum(share, limit) / limit) / DECADES, 0.0, 1.0))


def _bar(figure, limit: float, width: int, height: int) -> None:  # type: ignore[no-untyped-def]  # a matplotlib `Figure`
    """What the colours mean."""
    from matplotlib.colorbar import ColorbarBase

    axes = figure.add_axes((60 / width, 50 / height, 380 / width, 12 / height))
    steps = np.linspace(0, 1, int(DECADES) + 1)
    bar = ColorbarBase(axes, cmap=colour_map(), orientation="horizontal", ticks=list(steps))
    words = [f"{100 * limit * 10 ** (DECADES * step):g} %" for step in steps]
    bar.set_ticklabels([f"≤ {words[0]}", *words[1:-1], f"≥ {words[-1]}"])
    bar.ax.tick_params(labelsize=8.5, colors=FAINT, length=2, pad=2)
    bar.outline.set_visible(False)
    axes.set_title("elastic motion over that of a rigid article", fontsize=9, color=FAINT, pad=4, loc="left")
