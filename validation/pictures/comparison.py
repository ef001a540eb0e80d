"""Pictures of a comparison: maps of deviations in sigmas, predicted beside measured dynamic mass, the four errors.

One scale of colours for all maps: what chance reaches stays pale, beyond the threshold the colour changes at once from blue-
grey to yellow and darkens towards purple. Lightness falls throughout, so the scale reads without colours, too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from geometry.arrays import Array
from validation.pictures.curves import Axes, finish, grid_lines, new_figure
from validation.pictures.files import require_format
from validation.pictures.palette import INK, PAPER

BOUNDS = (0.0, 1.0, 2.0, 3.0, 4.0, 6.0, 10.0, 20.0, 50.0, 100.0)
"""Sigmas at which the colour changes."""

PERCENT = (0.0, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0)
"""Per cent of the dynamic mass at which the colour changes."""

PALE = ("#ffffff", "#f3f5f8", "#e3e9f0", "#ccd8e4")
STRONG = ("#f7d13d", "#f39b2c", "#dd6a3c", "#b8415f", "#7b2a76", "#3d1559")
"""Below and above the threshold of 4."""

THRESHOLD = 4.0

UNCHECKED = "#9aa0a6"
"""Of a row that nothing checks."""


@dataclass(frozen=True, eq=False, kw_only=True)
class DrawnMap:
    """One panel.

    Attributes
    ----------
    title : what it is of
    frequency : (n,) [Hz]
    rows : (m,) names, from top to bottom
    sigma : (n, m); NaN where nothing checks a row
    modes : eigenfrequencies [Hz] to be marked
    rules : numbers of rows above which a line separates kinds
    """

    title: str
    frequency: Array
    rows: tuple[str, ...]
    sigma: Array
    modes: tuple[float, ...] = ()
    rules: tuple[int, ...] = ()


def draw_maps(title: str, maps: Sequence[DrawnMap], path: Path, note: str = "", columns: int = 3) -> None:
    """Write one panel a map, rows over frequency, coloured by sigma.

    Raises
    ------
    BadInput : the ending of `path` is unknown.
    """
    require_format(path)
    columns = min(columns, len(maps))
    lines, most = -(-len(maps) // columns), max(len(one.rows) for one in maps)
    height = 1.9 + lines * (0.75 + 0.155 * most)
    figure = new_figure(15.5, height)
    room = {"left": 0.085, "right": 0.925, "top": 1 - 1.05 / height, "bottom": 0.85 / height}
    grid = figure.add_gridspec(lines, columns, hspace=0.6 / (0.155 * most + 0.3), wspace=0.06, **room)
    mesh = None
    for k, one in enumerate(maps):
        axes = figure.add_subplot(grid[k // columns, k % columns])
        mesh = _panel(axes, one)
        axes.set_yticks(np.arange(len(one.rows)), one.rows if k % columns == 0 else [""] * len(one.rows), parse_math=False)
        if k >= len(maps) - columns:
            axes.set_xlabel("frequency [Hz]", fontsize=10)
    _bar(figure, mesh, (0.94, room["bottom"], 0.012, min(room["top"] - room["bottom"], 5.0 / height)))
    finish(figure, title, note, path)


def draw_pairs(title: str, sigma: DrawnMap, percent: DrawnMap, path: Path, note: str = "") -> None:
    """Write two maps of the same rows side by side: `sigma`, and `percent`, whose cells are per cent.

    Raises
    ------
    BadInput : the ending of `path` is unknown.
    """
    require_format(path)
    figure = new_figure(15.5, 8.6)
    for left, one, scale, name in ((0.06, sigma, _scale(), "sigma"), (0.55, percent, _shares(), "per cent")):
        axes = figure.add_axes((left, 0.105, 0.37, 0.755))
        mesh = _panel(axes, one, scale)
        axes.set_yticks(np.arange(len(one.rows)), one.rows)
        axes.set_xlabel("frequency [Hz]", fontsize=10)
        axes.set_ylabel("load, base motion", fontsize=10)
        bounds, threshold = (BOUNDS, THRESHOLD) if one is sigma else (PERCENT, None)
        _bar(figure, mesh, (left + 0.385, 0.105, 0.012, 0.6), bounds, threshold, name)
    finish(figure, title, note, path)


def _panel(axes: Axes, one: DrawnMap, scale: tuple[Any, Any] | None = None) -> Any:
    colours, norm = scale or _scale()
    axes.set_facecolor(UNCHECKED)
    mesh = axes.pcolormesh(
        one.frequency,
        np.arange(len(one.rows)),
        np.ma.masked_invalid(one.sigma.T),
        cmap=colours,
        norm=norm,
        shading="nearest",
        rasterized=True,
    )
    axes.invert_yaxis()
    axes.tick_params(labelsize=8, colors=INK, length=2)
    axes.set_title(one.title, fontsize=10.5, loc="left", color=INK, pad=9, parse_math=False)
    for rule in one.rules:
        axes.axhline(rule - 0.5, color=INK, linewidth=0.8)
    low, high = axes.get_xlim()
    for f in [f for f in one.modes if low < f < high]:
        axes.plot([f], [1.0], marker="v", markersize=5, color=INK, transform=axes.get_xaxis_transform(), clip_on=False)
    return mesh


def _scale() -> tuple[Any, Any]:
    from matplotlib.colors import BoundaryNorm, ListedColormap

    colours = ListedColormap((*PALE, *STRONG[:-1])).with_extremes(over=STRONG[-1])
    return colours, BoundaryNorm(BOUNDS, colours.N)


def _shares() -> tuple[Any, Any]:
    from matplotlib.colors import BoundaryNorm, LinearSegmentedColormap

    colours = LinearSegmentedColormap.from_list("per cent", (PAPER, "#d3e3f3", "#7fb2d8", "#2f72b0", "#0b2f63"), N=len(PERCENT))
    return colours, BoundaryNorm(PERCENT, len(PERCENT), extend="max")


def _bar(
    figure: Any,
    mesh: Any,
    place: tuple[float, float, float, float],
    bounds: tuple[float, ...] = BOUNDS,
    threshold: float | None = THRESHOLD,
    name: str = "sigma",
) -> None:
    bar = figure.add_axes(place)
    figure.colorbar(mesh, cax=bar, extend="max", spacing="uniform", ticks=bounds)
    bar.set_yticklabels([f"{bound:g}" for bound in bounds])
    bar.tick_params(labelsize=9, colors=INK, length=2)
    if threshold is not None:
        bar.axhline(threshold, color=INK, linewidth=2.5)
    bar.set_title(name, fontsize=9.5, color=INK, loc="left")


@dataclass(frozen=True, eq=False, kw_only=True)
class DrawnRuns:
    """Runs and configurations.

    Attributes
    ----------
    rows, columns : names of the data sets and of the runs
    sigma : (a, b) worst cell; NaN where a data set has no such run
    percent : (a, b) plain error
    """

    rows: tuple[str, ...]
    columns: tuple[str, ...]
    sigma: Array
    percent: Array


def draw_runs(title: str, drawn: DrawnRuns, path: Path, note: str = "") -> None:
    """Write the map of runs and configurations, the plain error in every cell.

    Raises
    ------
    BadInput : the ending of `path` is unknown.
    """
    require_format(path)
    height = 2.4 + 0.75 * len(drawn.rows)
    figure = new_figure(max(9.0, 4.0 + 1.25 * len(drawn.columns)), height)
    room = {"left": 0.2, "right": 0.87, "top": 1 - 1.25 / height, "bottom": 0.75 / height}
    axes = figure.add_subplot(figure.add_gridspec(1, 1, **room)[0])
    colours, norm = _scale()
    axes.set_facecolor("#e9ebef")
    mesh = axes.pcolormesh(np.ma.masked_invalid(drawn.sigma), cmap=colours, norm=norm, edgecolors=PAPER, linewidth=2)
    for (a, b), sigma in np.ndenumerate(drawn.sigma):
        if np.isfinite(sigma):
            text = f"{sigma:.1f} σ\n{drawn.percent[a, b]:.2g} %" if sigma < 100 else f"{sigma:.0f} σ\n{drawn.percent[a, b]:.2g} %"
            axes.text(b + 0.5, a + 0.5, text, ha="center", va="center", fontsize=9.5, color=PAPER if sigma >= 10 else INK)
    axes.set_xticks(np.arange(len(drawn.columns)) + 0.5, drawn.columns, fontsize=9.5, parse_math=False)
    axes.set_yticks(np.arange(len(drawn.rows)) + 0.5, drawn.rows, fontsize=9.5, parse_math=False)
    axes.xaxis.tick_top()
    axes.invert_yaxis()
    axes.tick_params(length=0, colors=INK)
    for side in axes.spines.values():
        side.set_visible(False)
    _bar(figure, mesh, (0.9, room["bottom"], 0.015, room["top"] - room["bottom"]))
    finish(figure, title, note, path)


@dataclass(frozen=True, kw_only=True)
class DrawnError:
    """One bar.

    Attributes
    ----------
    name : of the error
    percent : its size
    verdict : its colour, by the word
    """

    name: str
    percent: float
    verdict: str = ""


VERDICTS = {"": "#7c8798", "good": "#2456c4", "doubtful": "#f39b2c", "failed": "#b8415f"}
"""Blue against orange and red-purple: told apart by everybody."""


def draw_errors(
    title: str, bars: Sequence[DrawnError], explained: float, prices: Sequence[DrawnError], path: Path, note: str = ""
) -> None:
    """Write the bars of errors in per cent, and below them chi² and z² over what is expected of them.

    Parameters
    ----------
    explained : per cent that tolerances of the measurement let expect of the plain error
    prices : ratios to what is expected

    Raises
    ------
    BadInput : the ending of `path` is unknown.
    """
    require_format(path)
    figure = new_figure(12.0, 6.4)
    grid = figure.add_gridspec(
        2, 1, height_ratios=(len(bars), len(prices)), hspace=0.55, left=0.19, right=0.975, top=0.85, bottom=0.14
    )
    upper, lower = figure.add_subplot(grid[0]), figure.add_subplot(grid[1])
    _bars(upper, bars, "per cent of the measured forces", "{:.3g} %")
    upper.axvline(explained, color=INK, linewidth=1.6, linestyle=(0, (5, 3)))
    _bars(lower, prices, "times what is expected where nothing is wrong", "{:.3g}")
    lower.axvline(1.0, color=INK, linewidth=1.6, linestyle=(0, (5, 3)))
    _legend(figure)
    finish(figure, title, note, path)


def _bars(axes: Axes, bars: Sequence[DrawnError], label: str, form: str) -> None:
    places = np.arange(len(bars))
    axes.barh(places, [one.percent for one in bars], color=[VERDICTS[one.verdict] for one in bars], height=0.62)
    axes.set_yticks(places, [one.name for one in bars], fontsize=10.5)
    axes.invert_yaxis()
    most = max(1.0, *(one.percent for one in bars))
    axes.set_xlim(0, 1.12 * most)
    for place, one in zip(places, bars, strict=True):
        box = {"facecolor": PAPER, "edgecolor": "none", "pad": 1.0}
        axes.text(one.percent + 0.012 * most, place, form.format(one.percent), va="center", fontsize=10, color=INK, bbox=box)
    axes.set_xlabel(label, fontsize=9.5, color=INK)
    grid_lines(axes)
    axes.grid(visible=False, axis="y")


def _legend(figure: Any) -> None:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles: list[Any] = [Patch(color=VERDICTS[word], label=word or "not judged") for word in VERDICTS]
    handles.append(Line2D([], [], color=INK, linewidth=1.6, linestyle=(0, (5, 3)), label="expected, nothing wrong"))
    figure.legend(handles=handles, loc="upper right", bbox_to_anchor=(0.985, 0.914), ncols=5, fontsize=9.5, frameon=False)
