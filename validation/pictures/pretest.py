"""A pretest on one page: condition number over frequency, expected intervals, the price of losing a channel."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from geometry.arrays import Array
from validation.pictures.curves import CURVES, Axes, finish, grid_lines, new_figure
from validation.pictures.files import require_format
from validation.pictures.identification import LIMIT
from validation.pictures.palette import INK

DARKEST = 1.5
"""Growth of an interval that is drawn darkest; more is as dark."""


@dataclass(frozen=True, eq=False, kw_only=True)
class DrawnPretest:
    """What is drawn.

    Attributes
    ----------
    frequency, condition : (n,) [Hz], [1]
    limit : of the condition number
    quantities : (q,) labels with their unit
    intervals : by case, (q,) half-widths of 95 % in these units
    growth : by channel, (q,) factor on the self-calibrated half-widths without it
    """

    frequency: Array
    condition: Array
    limit: float
    quantities: tuple[str, ...]
    intervals: Mapping[str, Array]
    growth: Mapping[str, Array]


def draw_pretest(title: str, drawn: DrawnPretest, path: Path, note: str = "") -> None:
    """Write the page; the panel of lost channels is left out where none was.

    Raises
    ------
    BadInput : the ending of `path` is unknown.
    """
    require_format(path)
    lost = bool(drawn.growth)
    figure = new_figure(15.0 if lost else 9.0, 10.4)
    room = _ROOM if lost else {**_ROOM, "left": 0.13}
    grid = figure.add_gridspec(2, 2 if lost else 1, hspace=0.2, wspace=0.2, height_ratios=(1, 1.7), **room)
    _condition(figure.add_subplot(grid[0, 0]), drawn)
    _intervals(figure, grid[1, 0], drawn)
    if lost:
        _growth(figure, figure.add_subplot(grid[:, 1]), drawn)
    finish(figure, title, note, path)


_ROOM = {"left": 0.085, "right": 0.975, "top": 0.9, "bottom": 0.09}


def _condition(axes: Axes, drawn: DrawnPretest) -> None:
    axes.semilogy(drawn.frequency, drawn.condition, color=CURVES[0], linewidth=1.4, label="condition number")
    axes.axhline(drawn.limit, color=LIMIT, linewidth=1.2, linestyle=(0, (5, 3)), label=f"limit {drawn.limit:g}")
    axes.set_ylim(1.0, 2 * max(float(drawn.condition.max()), drawn.limit))
    axes.set_xlim(drawn.frequency[0], drawn.frequency[-1])
    axes.set_title("condition number of the base motions", fontsize=11, loc="left", color=INK)
    axes.set_xlabel("frequency [Hz]", fontsize=9.5)
    axes.legend(fontsize=9, loc="center right")
    grid_lines(axes)


def _intervals(figure: Any, place: Any, drawn: DrawnPretest) -> None:
    """A panel for each unit, so that every bar has an axis that measures it."""
    units = [name.rpartition("[")[2].rstrip("]") for name in drawn.quantities]
    kinds = list(dict.fromkeys(units))
    grid = place.subgridspec(len(kinds), 1, hspace=0.45, height_ratios=[1 + units.count(unit) for unit in kinds])
    for k, unit in enumerate(kinds):
        axes = figure.add_subplot(grid[k])
        _bars(axes, drawn, [i for i, own in enumerate(units) if own == unit])
        axes.set_xlabel(f"[{unit}]", fontsize=9, labelpad=1)
        if not k:
            axes.set_title("expected ± 95 %", fontsize=11, loc="left", color=INK)
            axes.legend(fontsize=8.5, loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=3, frameon=False, borderaxespad=0.2)


def _bars(axes: Axes, drawn: DrawnPretest, chosen: list[int]) -> None:
    count, places = len(drawn.intervals), np.arange(len(chosen))
    height = 0.8 / count
    for k, ((name, half), colour) in enumerate(zip(drawn.intervals.items(), CURVES, strict=False)):
        at = places + (k - (count - 1) / 2) * height
        axes.barh(at, half[chosen], height=0.9 * height, color=colour, label=name)
        for place, value in zip(at, half[chosen], strict=True):
            axes.text(value, place, f" {value:.2g}", va="center", fontsize=7.5, color=INK)
    axes.set_xscale("log")
    axes.set_yticks(places, [drawn.quantities[i].partition(" [")[0] for i in chosen])
    axes.invert_yaxis()
    low, high = axes.get_xlim()
    axes.set_xlim(low / 1.5, high * 1.6)
    grid_lines(axes)
    axes.grid(visible=False, axis="y")


def _growth(figure: Any, axes: Axes, drawn: DrawnPretest) -> None:
    from matplotlib.colors import LinearSegmentedColormap

    values = np.array(list(drawn.growth.values()))
    colours = LinearSegmentedColormap.from_list("growth", ["#ffffff", "#f3c9b4", "#d9541e", "#7a2408"])
    axes.imshow(np.clip(values, 1.0, DARKEST), cmap=colours, vmin=1.0, vmax=DARKEST, aspect="auto")
    for (row, column), value in np.ndenumerate(values):
        dark = value > 1 + 0.6 * (DARKEST - 1)
        axes.text(column, row, f"{value:.2f}", ha="center", va="center", fontsize=7.5, color="#ffffff" if dark else INK)
    axes.set_yticks(np.arange(len(values)), list(drawn.growth), fontsize=8.5)
    axes.set_xticks(np.arange(len(drawn.quantities)), [name.partition(" [")[0] for name in drawn.quantities], fontsize=8.5)
    axes.set_title("half-width without a channel, times that with all", fontsize=11, loc="left", color=INK)
    axes.tick_params(length=0)
    for side in axes.spines.values():
        side.set_visible(False)
