"""Pictures of an identification: its lines, residuals of redundant channels, shares of the uncertainty, the stability map."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from geometry.frames import Array
from validation.identify.identify import DrawnResiduals, UsedLines
from validation.report.charts import interactive, static
from validation.report.charts.figure import Figure
from validation.report.charts.spec import CURVES, FAINT, INK, PAPER, SpectralLines
from validation.report.scenes.motion import MovingBody, colour_map, displaced
from validation.report.scenes.scene import DPI, blank, colours, fitted, off_screen, write

RUNS = ("#c8283c", "#1f8a4c", "#2456c4", "#d9541e", "#8e6fc0", "#c9a227", "#33373d", "#5f9ea0", "#b5838d")
"""Of runs in turn."""

EMPTY = "#e9ebef"
"""Of a band that is too short to say anything."""

OTHERS = "#c9ced6"
SMALL = 0.03
"""An input whose share is smaller everywhere goes to the others."""

MOST_INPUTS = 9

FLOOR, CEILING = 1e-4, 1e-1
"""Shares from which a residual is white, and from which it is darkest."""


def draw_lines(title: str, drawn: SpectralLines, path: Path, note: str = "") -> None:
    """Write condition number and quality over frequency.

    Raises
    ------
    BadInput : the ending of `path` is unknown.
    """
    figure = static.new_figure(13.0, 8.2)
    grid = figure.add_gridspec(2, 1, hspace=0.12, left=0.075, right=0.84, top=0.895, bottom=0.1)
    upper = figure.add_subplot(grid[0])
    lower = figure.add_subplot(grid[1], sharex=upper)
    f = drawn.frequency
    for axes in (upper, lower):
        static.shade_left_out(axes, drawn)
    static.draw_condition(upper, drawn)
    upper.set_ylabel("condition of the scaled base motions", fontsize=10)
    for k, (name, share) in enumerate(zip(drawn.runs, drawn.unexplained, strict=True)):
        lower.semilogy(f, np.maximum(share, 1e-8), color=RUNS[k % len(RUNS)], linewidth=1.1, label=f"run {name}")
    lower.set_ylabel("share that rigid motion\nand resultants leave unexplained", fontsize=10)
    lower.set_xlabel("frequency [Hz]", fontsize=10)
    upper.tick_params(labelbottom=False)
    for axes in (upper, lower):
        static.grid_lines(axes)
        axes.grid(visible=True, which="minor", axis="y", color="#f0f2f5", linewidth=0.5)
        from matplotlib.patches import Patch

        handles, labels = axes.get_legend_handles_labels()
        if np.any(drawn.left_out):
            handles, labels = [*handles, Patch(color=static.SHADE)], [*labels, "left out"]
        axes.legend(handles, labels, fontsize=9, loc="upper left", bbox_to_anchor=(1.01, 1.0), borderaxespad=0.0, frameon=False)
    static.finish(figure, title, note, path)


def draw_residuals(title: str, drawn: DrawnResiduals, path: Path, note: str = "") -> None:
    """Write one panel a run, channels over frequency, coloured by the residual.

    Raises
    ------
    BadInput : the ending of `path` is unknown.
    """
    from matplotlib.colors import LinearSegmentedColormap, LogNorm

    columns = 3 if len(drawn.runs) > 1 else 1
    rows = -(-len(drawn.runs) // columns)
    height = 1.7 + rows * (0.8 + 0.19 * len(drawn.channels))
    figure = static.new_figure(15.5, height)
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
    static.finish(figure, title, note, path)


@dataclass(frozen=True, eq=False, kw_only=True)
class UncertaintyShares:
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


def draw_shares(title: str, drawn: Sequence[UncertaintyShares], path: Path, note: str = "") -> None:
    """Write stacked bars: what contributes how much to the variance of every parameter, way by way.

    Raises
    ------
    BadInput : the ending of `path` is unknown.
    """
    figure = static.new_figure(15.0, 7.2)
    grid = figure.add_gridspec(1, len(drawn), wspace=0.2, left=0.065, right=0.915, top=0.865, bottom=0.21)
    # Inputs with a colour of their own, the one with the largest share first
    largest: dict[str, float] = {}
    for one in drawn:
        for name, values in one.shares.items():
            largest[name] = max(largest.get(name, 0.0), float(values.max(initial=0.0)))
    ordered = sorted(largest, key=lambda name: -largest[name])
    colour = colours([name for name in ordered if largest[name] >= SMALL][:MOST_INPUTS])
    for k, one in enumerate(drawn):
        axes = figure.add_subplot(grid[k])
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
        axes.tick_params(labelleft=k == 0)
        axes.set_title(one.way, fontsize=12, loc="left", color=INK, weight="bold")
        axes.text(1.015, 1.02, "± 95 %", transform=axes.transAxes, fontsize=9.5, color=FAINT)
    from matplotlib.patches import Patch

    handles = [Patch(color=hue, label=name) for name, hue in colour.items()] + [Patch(color=OTHERS, label="all others")]
    figure.legend(handles=handles, loc="lower center", bbox_to_anchor=(0.5, 0.055), ncols=5, fontsize=9.5, frameon=False)
    static.finish(figure, title, note, path)


@dataclass(frozen=True, eq=False, kw_only=True)
class BandMap:
    """One quantity over start and stop frequency.

    Attributes
    ----------
    label, unit : of the quantity and of `deviation`
    deviation : (a, b) from the chosen result; NaN where a band says nothing
    half_width : (a, b) of the 95 % interval of the deviation, in the same unit
    most : deviation at which the colours end at the latest
    """

    label: str
    unit: str
    deviation: Array
    half_width: Array
    most: float


def draw_stability(
    title: str, maps: Sequence[BandMap], start: Array, stop: Array, chosen: tuple[float, float], path: Path, note: str = ""
) -> None:
    """Write the band-stability map of ten quantities, `start` (a,) and `stop` (b,) [Hz].

    Raises
    ------
    BadInput : the ending of `path` is unknown.
    """
    figure = static.new_figure(17.5, 8.2)
    grid = figure.add_gridspec(2, 5, hspace=0.3, wspace=0.42, left=0.045, right=0.965, top=0.865, bottom=0.115)
    for k, one in enumerate(maps):
        axes = figure.add_subplot(grid[k // 5, k % 5])
        from matplotlib.colors import LinearSegmentedColormap
        from matplotlib.patches import Rectangle

        colours = LinearSegmentedColormap.from_list("deviation", ("#14296b", "#6f93dc", PAPER, "#ea8a78", "#7d1220"))
        axes.set_facecolor(EMPTY)
        known = np.abs(one.deviation[np.isfinite(one.deviation)])
        largest = float(np.quantile(known, 0.9)) if known.size else 0.0
        reach = max(min(largest, one.most), float(np.nanmin(one.half_width, initial=one.most)), np.finfo(np.float64).tiny)
        mesh = axes.pcolormesh(
            np.arange(len(start)),
            np.arange(len(stop)),
            np.ma.masked_invalid(one.deviation.T),
            cmap=colours,
            vmin=-reach,
            vmax=reach,
        )
        size = np.nan_to_num(np.abs(one.deviation))
        for i, j in np.argwhere(size > one.half_width):
            axes.plot(i, j, marker="x", markersize=3.2, color=PAPER if size[i, j] > 0.7 * reach else INK, markeredgewidth=0.7)
        axes.set_xticks(np.arange(len(start)), [f"{f:.3g}" for f in start], rotation=90 if len(start) > 7 else 0)
        axes.set_yticks(np.arange(len(stop)), [f"{f:.3g}" for f in stop])
        axes.tick_params(labelsize=8, colors=INK, length=2)
        bar = axes.figure.colorbar(mesh, ax=axes, fraction=0.05, pad=0.03, extend="both")
        bar.ax.tick_params(labelsize=8, colors=INK, length=2)
        i, j = int(np.argmin(np.abs(start - chosen[0]))), int(np.argmin(np.abs(stop - chosen[1])))
        axes.add_patch(Rectangle((i - 0.5, j - 0.5), 1, 1, fill=False, edgecolor=INK, linewidth=2.2, clip_on=False, zorder=5))
        axes.set_title(f"{one.label} [{one.unit}]", fontsize=11, loc="left", color=INK)
        if k % 5 == 0:
            axes.set_ylabel("stop [Hz]", fontsize=10)
        if k >= len(maps) - 5:
            axes.set_xlabel("start [Hz]", fontsize=10)
    static.finish(figure, title, note, path)


# A pretest on one page: condition number over frequency, expected intervals, the price of losing a channel.


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
    lost = bool(drawn.growth)
    figure = static.new_figure(15.0 if lost else 9.0, 10.4)
    room = _ROOM if lost else {**_ROOM, "left": 0.13}
    grid = figure.add_gridspec(2, 2 if lost else 1, hspace=0.2, wspace=0.2, height_ratios=(1, 1.7), **room)
    axes = figure.add_subplot(grid[0, 0])
    none = np.zeros(len(drawn.frequency), dtype=bool)
    lines = SpectralLines(frequency=drawn.frequency, condition=drawn.condition, limit=drawn.limit, left_out=none)
    static.draw_condition(axes, lines)
    axes.set_title("condition number of the base motions", fontsize=11, loc="left", color=INK)
    axes.set_xlabel("frequency [Hz]", fontsize=9.5)
    axes.legend(fontsize=9, loc="center right")
    static.grid_lines(axes)
    # A panel for each unit, so that every bar has an axis that measures it
    place = grid[1, 0]
    units = [name.rpartition("[")[2].rstrip("]") for name in drawn.quantities]
    kinds = list(dict.fromkeys(units))
    intervals_grid = place.subgridspec(len(kinds), 1, hspace=0.45, height_ratios=[1 + units.count(unit) for unit in kinds])
    for k, unit in enumerate(kinds):
        intervals_axes = figure.add_subplot(intervals_grid[k])
        _pretest_bars(intervals_axes, drawn, [i for i, own in enumerate(units) if own == unit])
        intervals_axes.set_xlabel(f"[{unit}]", fontsize=9, labelpad=1)
        if not k:
            intervals_axes.set_title("expected ± 95 %", fontsize=11, loc="left", color=INK)
            intervals_axes.legend(
                fontsize=8.5, loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=3, frameon=False, borderaxespad=0.2
            )
    if lost:
        _growth(figure, figure.add_subplot(grid[:, 1]), drawn)
    static.finish(figure, title, note, path)


_ROOM = {"left": 0.085, "right": 0.975, "top": 0.9, "bottom": 0.09}


def _pretest_bars(axes: static.Axes, drawn: DrawnPretest, chosen: list[int]) -> None:
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
    static.grid_lines(axes)
    axes.grid(visible=False, axis="y")


def _growth(figure: Any, axes: static.Axes, drawn: DrawnPretest) -> None:
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


# An article coloured by how large the elastic motion of its surface is: where pick-ups belong, and where they do not.


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
    first = next(iter(tiles.values()))
    with off_screen():
        view = fitted(np.concatenate([body.vertices for body in first]), TILE, MARGIN)
        shots = {}
        for caption, bodies in tiles.items():
            # Coloured by 0 up to `limit`, then by the logarithm up to 1 at `DECADES` above
            shares = [np.log10(np.maximum(body.size, limit) / limit) / DECADES for body in bodies]
            coloured = [
                replace(body, displacement=np.clip(share, 0.0, 1.0)[:, None] * [1.0, 0.0, 0.0])
                for body, share in zip(bodies, shares, strict=True)
            ]
            shots[caption] = displaced(view, coloured, 0.0, 1.0)
    width, height = len(tiles) * TILE[0], HEAD + TILE[1] + FOOT
    figure, canvas = blank(width, height)
    write(canvas, 24, 32, title, 22, weight="bold", va="center")
    for k, (caption, shot) in enumerate(shots.items()):
        left = k * TILE[0]
        canvas.imshow(shot, extent=(left, left + TILE[0], HEAD + TILE[1], HEAD), interpolation="none")
        write(canvas, left + 24, HEAD - 14, caption, 15, FAINT, va="center")
    from matplotlib.colorbar import ColorbarBase

    # What the colours mean
    axes = figure.add_axes((60 / width, 50 / height, 380 / width, 12 / height))
    steps = np.linspace(0, 1, int(DECADES) + 1)
    bar = ColorbarBase(axes, cmap=colour_map(), orientation="horizontal", ticks=list(steps))
    words = [f"{100 * limit * 10 ** (DECADES * step):g} %" for step in steps]
    bar.set_ticklabels([f"≤ {words[0]}", *words[1:-1], f"≥ {words[-1]}"])
    bar.ax.tick_params(labelsize=8.5, colors=FAINT, length=2, pad=2)
    bar.outline.set_visible(False)
    axes.set_title("elastic motion over that of a rigid article", fontsize=9, color=FAINT, pad=4, loc="left")
    write(canvas, 24, height - 16, note, 12, FAINT, va="center")
    static.save(path, lambda temporary: figure.savefig(temporary, dpi=DPI))


# Condition number of Eqs. 9 to 11, line by line.


def condition(lines: UsedLines, name: str = "", *, dark: bool = False) -> Figure:
    """Scaled condition number of the base motions of all runs over frequency, its limit, and the lines that were left out.

    Parameters
    ----------
    name : of the campaign
    """
    left_out = np.asarray(lines.kept) <= 0
    said = SpectralLines(frequency=lines.frequency, condition=lines.condition, limit=lines.limit, left_out=left_out)
    title = f"Eqs. 9 to 11: condition number{' of ' + name if name else ''}"
    return interactive.condition(said, title, dark)
