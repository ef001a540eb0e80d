"""Pictures of an identification: its lines, residuals of redundant channels, shares of the uncertainty, the stability map."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from geometry.arrays import Array
from validation.pictures.curves import Axes, finish, grid_lines, new_figure
from validation.pictures.files import require_format
from validation.pictures.palette import FAINT, INK, PAPER, input_colours

RUNS = ("#c8283c", "#1f8a4c", "#2456c4", "#d9541e", "#8e6fc0", "#c9a227", "#33373d", "#5f9ea0", "#b5838d")
"""Of runs, in turn."""

LIMIT = "#c8283c"
LEFT_OUT = "#f6d9dc"
EMPTY = "#e9ebef"
"""Of a band that is too short to say anything."""

OTHERS = "#c9ced6"
SMALL = 0.03
"""An input whose share is smaller everywhere goes to the others."""

MOST_INPUTS = 9

FLOOR, CEILING = 1e-4, 1e-1
"""Shares from which a residual is white, and from which it is darkest."""


@dataclass(frozen=True, eq=False, kw_only=True)
class DrawnLines:
    """The lines of the spectra.

    Attributes
    ----------
    frequency : (n,) [Hz]
    condition : (n,) scaled condition number
    limit : above which a line is left out
    left_out : (n,) bool
    runs : names
    unexplained : (r, n) share of what the channels read that no rigid base motion and no resultant load explains
    """

    frequency: Array
    condition: Array
    limit: float
    left_out: np.ndarray
    runs: tuple[str, ...]
    unexplained: Array


def draw_lines(title: str, drawn: DrawnLines, path: Path, note: str = "") -> None:
    """Write condition number and quality over frequency.

    Raises
    ------
    BadInput : the ending of `path` is unknown.
    """
    require_format(path)
    figure = new_figure(13.0, 8.2)
    grid = figure.add_gridspec(2, 1, hspace=0.12, left=0.075, right=0.84, top=0.895, bottom=0.1)
    upper = figure.add_subplot(grid[0])
    lower = figure.add_subplot(grid[1], sharex=upper)
    f = drawn.frequency
    for axes in (upper, lower):
        _spans(axes, f, drawn.left_out)
    upper.semilogy(f, drawn.condition, color=RUNS[2], linewidth=1.4, label="condition number")
    upper.axhline(drawn.limit, color=LIMIT, linewidth=1.2, linestyle=(0, (5, 3)), label=f"limit {drawn.limit:g}")
    upper.set_ylabel("condition of the scaled base motions", fontsize=10)
    upper.set_ylim(min(1.0, float(drawn.condition.min())), 2 * max(float(drawn.condition.max()), drawn.limit))
    for name, colour, share in zip(drawn.runs, _turns(len(drawn.runs)), drawn.unexplained, strict=True):
        lower.semilogy(f, np.maximum(share, 1e-8), color=colour, linewidth=1.1, label=f"run {name}")
    lower.set_ylabel("share that rigid motion\nand resultants leave unexplained", fontsize=10)
    lower.set_xlabel("frequency [Hz]", fontsize=10)
    upper.set_xlim(f[0], f[-1])
    upper.tick_params(labelbottom=False)
    for axes in (upper, lower):
        grid_lines(axes)
        axes.grid(visible=True, which="minor", axis="y", color="#f0f2f5", linewidth=0.5)
        _legend(axes, bool(np.any(drawn.left_out)))
    finish(figure, title, note, path)


def _spans(axes: Axes, f: Array, out: np.ndarray) -> None:
    """Shade every stretch of lines that were left out, half a line to either side."""
    half = 0.5 * float(np.median(np.diff(f))) if len(f) > 1 else 0.5
    edges = np.flatnonzero(np.diff(np.concatenate([[0], out.astype(int), [0]])))
    for first, last in zip(edges[::2], edges[1::2], strict=True):
        axes.axvspan(f[first] - half, f[last - 1] + half, color=LEFT_OUT, linewidth=0, zorder=0)


def _legend(axes: Axes, with_spans: bool) -> None:
    from matplotlib.patches import Patch

    handles, labels = axes.get_legend_handles_labels()
    if with_spans:
        handles, labels = [*handles, Patch(color=LEFT_OUT)], [*labels, "left out"]
    axes.legend(handles, labels, fontsize=9, loc="upper left", bbox_to_anchor=(1.01, 1.0), borderaxespad=0.0, frameon=False)


def _turns(count: int) -> list[str]:
    return [RUNS[k % len(RUNS)] for k in range(count)]


@dataclass(frozen=True, eq=False, kw_only=True)
class DrawnResiduals:
    """What redundant channels disagree by.

    Attributes
    ----------
    frequency : (n,) [Hz]
    runs, channels : names
    share : (r, n, c) residual over the level of the channel's kind in that run
    """

    frequency: Array
    runs: tuple[str, ...]
    channels: tuple[str, ...]
    share: Array


def draw_residuals(title: str, drawn: DrawnResiduals, path: Path, note: str = "") -> None:
    """Write one panel a run, channels over frequency, coloured by the residual.

    Raises
    ------
    BadInput : the ending of `path` is unknown.
    """
    from matplotlib.colors import LinearSegmentedColormap, LogNorm

    require_format(path)
    columns = 3 if len(drawn.runs) > 1 else 1
    rows = -(-len(drawn.runs) // columns)
    height = 1.7 + rows * (0.8 + 0.19 * len(drawn.channels))
    figure = new_figure(15.5, height)
    room = {"left": 0.075, "right": 0.915, "top": 1 - 1.0 / height, "bottom": 0.85 / height}
    grid = figure.add_gridspec(rows, columns, hspace=0.22, wspace=0.06, **room)
    colours = LinearSegmentedColormap.from_list("residual", (PAPER, "#dfe7f6", "#9db6e6", "#f2c14e", "#d9541e", "#7d1220"))
    mesh = None
    for k, name in enumerate(drawn.runs):
        axes = figure.add_subplot(grid[k // columns, k % columns])
        share = np.clip(drawn.share[k].T, FLOOR, CEILING)
        places = np.arange(len(drawn.channels))
        mesh = axes.pcolormesh(
            drawn.frequency, places, share, cmap=colours, norm=LogNorm(FLOOR, CEILING), shading="nearest", rasterized=True
        )
        axes.set_yticks(places, drawn.channels if k % columns == 0 else [""] * len(places))
        axes.invert_yaxis()
        axes.tick_params(labelsize=8.5, colors=INK, length=2)
        axes.set_title(f"run {name}", fontsize=11, loc="left", color=INK)
        if k >= len(drawn.runs) - columns:
            axes.set_xlabel("frequency [Hz]", fontsize=10)
    if mesh is not None:
        bar = figure.add_axes((0.935, room["bottom"], 0.013, room["top"] - room["bottom"]))
        figure.colorbar(mesh, cax=bar, extend="both")
        ticks = [1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2, 1e-1]
        bar.set_yticks(ticks, [f"{100 * tick:g} %" for tick in ticks])
        bar.minorticks_off()
        bar.tick_params(labelsize=9, colors=INK)
    finish(figure, title, note, path)


@dataclass(frozen=True, eq=False, kw_only=True)
class DrawnShares:
    """Where the uncertainty of one way's result comes from.

    Attributes
    ----------
    way : "plain" or "self-calibrated"
    parameters : labels
    intervals : half-widths in words, one a parameter
    shares : (p,) by the name of an input, adding up to 1
    """

    way: str
    parameters: tuple[str, ...]
    intervals: tuple[str, ...]
    shares: Mapping[str, Array]


def draw_shares(title: str, drawn: Sequence[DrawnShares], path: Path, note: str = "") -> None:
    """Write stacked bars: what contributes how much to the variance of every parameter, way by way.

    Raises
    ------
    BadInput : the ending of `path` is unknown.
    """
    require_format(path)
    figure = new_figure(15.0, 7.2)
    grid = figure.add_gridspec(1, len(drawn), wspace=0.2, left=0.065, right=0.915, top=0.865, bottom=0.21)
    names = _important([one.shares for one in drawn])
    colour = input_colours(names)
    for k, one in enumerate(drawn):
        axes = figure.add_subplot(grid[k])
        _bars(axes, one, colour)
        axes.tick_params(labelleft=k == 0)
        axes.set_title(one.way, fontsize=12, loc="left", color=INK, weight="bold")
        axes.text(1.015, 1.02, "± 95 %", transform=axes.transAxes, fontsize=9.5, color=FAINT)
    _bar_legend(figure, colour)
    finish(figure, title, note, path)


def _important(shares: Sequence[Mapping[str, Array]]) -> list[str]:
    """Names of the inputs with a colour of their own, the one with the largest share first."""
    largest: dict[str, float] = {}
    for one in shares:
        for name, share in one.items():
            largest[name] = max(largest.get(name, 0.0), float(share.max(initial=0.0)))
    ordered = sorted(largest, key=lambda name: -largest[name])
    return [name for name in ordered if largest[name] >= SMALL][:MOST_INPUTS]


def _bars(axes: Axes, one: DrawnShares, colour: Mapping[str, str]) -> None:
    places = np.arange(len(one.parameters))
    left = np.zeros(len(places))
    for name, hue in colour.items():
        share = one.shares.get(name)
        if share is not None:
            axes.barh(places, share, left=left, color=hue, height=0.72, edgecolor=PAPER, linewidth=0.6)
            left = left + share
    total = np.sum(list(one.shares.values()), axis=0) if one.shares else np.zeros(len(places))
    axes.barh(places, np.maximum(total - left, 0), left=left, color=OTHERS, height=0.72, edgecolor=PAPER, linewidth=0.6)
    axes.set_yticks(places, one.parameters)
    axes.invert_yaxis()
    axes.set_xlim(0, 1)
    axes.set_xticks([0, 0.25, 0.5, 0.75, 1], ["0", "25", "50", "75", "100 %"])
    axes.set_xlabel("share of the variance", fontsize=10)
    for place, text in zip(places, one.intervals, strict=True):
        axes.text(1.015, place, text, transform=axes.get_yaxis_transform(), va="center", fontsize=9.5, color=INK)
    axes.tick_params(labelsize=10, colors=INK, length=2)


def _bar_legend(figure: Any, colour: Mapping[str, str]) -> None:
    from matplotlib.patches import Patch

    handles = [Patch(color=hue, label=name) for name, hue in colour.items()] + [Patch(color=OTHERS, label="all others")]
    figure.legend(handles=handles, loc="lower center", bbox_to_anchor=(0.5, 0.055), ncols=5, fontsize=9.5, frameon=False)


@dataclass(frozen=True, eq=False, kw_only=True)
class DrawnMap:
    """One quantity over start and stop frequency.

    Attributes
    ----------
    label, unit : of the quantity and of `deviation`
    deviation : (a, b) from the chosen result; NaN where a band says nothing
    half_width : of the chosen result's 95 % interval, in the same unit
    """

    label: str
    unit: str
    deviation: Array
    half_width: float


def draw_stability(
    title: str,
    maps: Sequence[DrawnMap],
    start: Array,
    stop: Array,
    chosen: tuple[float, float],
    path: Path,
    note: str = "",
) -> None:
    """Write the band-stability map of ten quantities, `start` (a,) and `stop` (b,) [Hz].

    Raises
    ------
    BadInput : the ending of `path` is unknown.
    """
    require_format(path)
    figure = new_figure(17.5, 8.2)
    grid = figure.add_gridspec(2, 5, hspace=0.3, wspace=0.42, left=0.045, right=0.965, top=0.865, bottom=0.115)
    for k, one in enumerate(maps):
        axes = figure.add_subplot(grid[k // 5, k % 5])
        _map(axes, one, start, stop)
        _choice(axes, start, stop, chosen)
        axes.set_title(f"{one.label} [{one.unit}]", fontsize=11, loc="left", color=INK)
        if k % 5 == 0:
            axes.set_ylabel("stop [Hz]", fontsize=10)
        if k >= len(maps) - 5:
            axes.set_xlabel("start [Hz]", fontsize=10)
    finish(figure, title, note, path)


def _map(axes: Axes, one: DrawnMap, start: Array, stop: Array) -> None:
    from matplotlib.colors import LinearSegmentedColormap

    colours = LinearSegmentedColormap.from_list("deviation", ("#14296b", "#6f93dc", PAPER, "#ea8a78", "#7d1220"))
    axes.set_facecolor(EMPTY)
    known = np.abs(one.deviation[np.isfinite(one.deviation)])
    reach = max(float(np.quantile(known, 0.9)) if known.size else 0.0, 2 * one.half_width, np.finfo(np.float64).tiny)
    mesh = axes.pcolormesh(
        np.arange(len(start)), np.arange(len(stop)), np.ma.masked_invalid(one.deviation.T), cmap=colours, vmin=-reach, vmax=reach
    )
    size = np.nan_to_num(np.abs(one.deviation))
    for i, j in np.argwhere(size > one.half_width):
        axes.plot(i, j, marker="x", markersize=3.2, color=PAPER if size[i, j] > 0.7 * reach else INK, markeredgewidth=0.7)
    axes.set_xticks(np.arange(len(start)), [f"{f:.3g}" for f in start], rotation=90 if len(start) > 7 else 0)
    axes.set_yticks(np.arange(len(stop)), [f"{f:.3g}" for f in stop])
    axes.tick_params(labelsize=8, colors=INK, length=2)
    bar = axes.figure.colorbar(mesh, ax=axes, fraction=0.05, pad=0.03, extend="both")
    bar.ax.tick_params(labelsize=8, colors=INK, length=2)


def _choice(axes: Axes, start: Array, stop: Array, chosen: tuple[float, float]) -> None:
    from matplotlib.patches import Rectangle

    i, j = int(np.argmin(np.abs(start - chosen[0]))), int(np.argmin(np.abs(stop - chosen[1])))
    axes.add_patch(Rectangle((i - 0.5, j - 0.5), 1, 1, fill=False, edgecolor=INK, linewidth=2.2, clip_on=False, zorder=5))
