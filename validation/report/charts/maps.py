"""Where a model fails, in sigmas: channels and loads, pairs of axes, runs; and measured beside predicted dynamic mass."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from geometry.dynamic_mass import SIGNS, ComplexArray
from geometry.frames import Array
from validation.compare.compare import SENSED, run
from validation.compare.correlation import NamedMode
from validation.compare.maps import Map, Pairs
from validation.report.charts import interactive, spec, static
from validation.report.charts.figure import Figure
from validation.report.charts.interactive import LEGEND_ROOM, TITLE_ROOM, add_entry, dressed, escaped, legend_above
from validation.report.charts.style import unit

LOADS = ("force along x", "force along y", "force along z", "moment about x", "moment about y", "moment about z")
MOTIONS = tuple(f"{kind} {axis}" for kind in ("acceleration along", "angular acceleration about") for axis in "xyz")

HEIGHTS = ((0.09, 0.60), (0.64, 0.86))
"""Where magnitude and phase begin and end in a third of the page, from its top."""

NONE: Mapping[str, ComplexArray] = MappingProxyType({})


def entry(load: int, motion: int) -> str:
    """ "H xβ": the name of an entry."""
    return f"H {SIGNS[load]}{SIGNS[motion]}"


def entry_of(
    pairs: Pairs, load: int, motion: int, modes: Sequence[NamedMode], further: Mapping[str, ComplexArray]
) -> spec.EntryPanel:
    """Measured beside predicted, and what else is predicted by name."""
    f = pairs.frequency

    def curve(name: str, matrix: ComplexArray, role: str, **more: Any) -> spec.Curve:
        return spec.Curve(name=name, frequency=f, values=matrix[:, load, motion], role=role, **more)

    named = [(one.name, one.frequency) for one in modes if f[0] <= one.frequency <= f[-1]]
    others = [curve(name, matrix, (spec.FURTHER, spec.ASIDE)[k % 2]) for k, (name, matrix) in enumerate(further.items())]
    measured = curve("measured, Eqs. 9 to 11", pairs.measured, spec.MEASURED, dots=True)
    predicted = curve("predicted", pairs.predicted, spec.PREDICTED, expected=pairs.expected[:, load, motion])
    return spec.EntryPanel(unit=unit(load, motion), curves=(measured, predicted, *others), modes=named)


def function_of(of: Map, run: int, channel: int, further: Mapping[str, ComplexArray]) -> spec.EntryPanel:
    """One response function of `of`, and what else is predicted by name (r, n, c)."""
    whole = of.functions
    if whole is None:
        raise ValueError("`of` must have functions")

    def curve(name: str, values: ComplexArray, role: str, **more: Any) -> spec.Curve:
        return spec.Curve(name=name, frequency=of.frequency, values=values[run, :, channel], role=role, **more)

    measured = curve("measured", whole.measured, spec.MEASURED, dots=True)
    predicted = curve("predicted", whole.predicted, spec.PREDICTED, expected=whole.expected[run, :, channel])
    others = [curve(name, values, spec.FURTHER) for name, values in further.items()]
    return spec.EntryPanel(unit=whole.unit, curves=(measured, predicted, *others))


SECOND_ROW = 20
"""[pixels] that a legend takes when curves more than the usual ones are named in it."""


def overlay(
    pairs: Pairs,
    load: int,
    motion: int,
    *,
    modes: Sequence[NamedMode] = (),
    further: Mapping[str, ComplexArray] = NONE,
    marked: float | None = None,
    dark: bool = False,
) -> Figure:
    """One entry of the blocked dynamic mass about F: measured as dots, predicted as a line, what is expected as a band.

    Parameters
    ----------
    pairs : both, of one campaign
    load, motion : 0 to 5 in the order of `geometry.dynamic_mass.MOTIONS`
    modes : of the model, marked above
    further : by name, more predictions (n, 6, 6) on the lines of `pairs`: with an effect, or before it was added
    marked : [Hz] where a line is drawn
    """
    figure = Figure(rows=2, heights=(0.68, 0.32), vertical=0.04, shared=True)
    add_entry(figure, entry_of(pairs, load, motion, modes, further), 1, 1)
    if marked is not None:
        figure.rule(x=marked, color=spec.COLOURS["limit"][1], width=1.5, dash="dash")
    title = f"{entry(load, motion)} of {pairs.campaign}: {LOADS[load]} by {MOTIONS[motion]}"
    how: dict[str, Any] = {"hovermode": "x unified", "uirevision": escaped(f"{pairs.campaign} {load} {motion}")}
    room = LEGEND_ROOM + (SECOND_ROW if further else 0)
    return dressed(figure, title, 470, dark, legend=legend_above(), margin={"t": TITLE_ROOM + room}, **how)


def diagonal(pairs: Pairs, *, modes: Sequence[NamedMode] = (), dark: bool = False) -> Figure:
    """The six entries of the diagonal, as `overlay` draws each: translations on the left, rotations on the right."""
    panels = [(f"{entry(k, k)}: {LOADS[k]} by {MOTIONS[k]}", entry_of(pairs, k, k, modes, NONE)) for k in range(6)]
    return side_by_side(panels, f"{pairs.campaign}: the diagonal of the dynamic mass", dark)


def side_by_side(panels: Sequence[tuple[str, spec.EntryPanel]], title: str, dark: bool = False) -> Figure:
    """Panels with their names, magnitude above phase, in two columns of which the left one is filled first."""
    high = (len(panels) + 1) // 2
    figure = Figure(rows=2 * high, columns=2, horizontal=0.11)
    for k, (said, panel) in enumerate(panels):
        row, column = 1 + 2 * (k % high), 1 + k // high
        add_entry(figure, panel, row, column, legend=k == 0, last=k % high == high - 1 or k == len(panels) - 1)
        # Put magnitude and phase of a panel close together, below their title and apart from the pair below
        top = 1 - (k % high) / high
        for below, (upper, lower) in enumerate(HEIGHTS):
            figure.up(domain=[top - lower / high, top - upper / high], row=row + below, column=column)
        name = {
            "text": escaped(said),
            "x": 0.0 if column == 1 else 0.555,
            "y": top - HEIGHTS[0][0] / high,
            "xref": "paper",
            "yref": "paper",
        }
        figure.note(**name, xanchor="left", yanchor="bottom", font={"size": 12})
    margin = {"t": TITLE_ROOM + LEGEND_ROOM, "b": 24}
    height = margin["t"] + margin["b"] + round((1010 - margin["t"] - margin["b"]) * high / 3)
    return dressed(figure, title, height, dark, legend=legend_above(), margin=margin)


# Maps of sigmas: channels and loads of a run, the 36 pairs of axes, and runs of campaigns.


PAIRS = tuple(f"{load}{motion}" for load in SIGNS for motion in SIGNS)
"""Rows of a map of pairs: load, then base motion; entry 6 i + j of the 6 x 6."""

PERCENT = (0.0, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0)
"""Per cent of the dynamic mass at which the colour changes."""


def labels(of: Map) -> tuple[str, ...]:
    """Names of the rows of `of`: channels by name, loads in words."""
    return tuple(SENSED.get(name, name) for name in of.rows)


def channels_of(of: Map, modes: Sequence[NamedMode]) -> list[spec.HeatMap]:
    """A map a run, and one of the worst of all runs; cells of a row that nothing checks stay empty.

    Of a table of modes, which has no lines, the modes stand side by side, and a map of one mode is its column.
    """
    sigma = np.where(np.isfinite(of.expected), of.sigma, np.nan)
    kinds = [name.partition("-")[0] for name in of.rows[: of.channels]]
    worst = spec.HeatMap(
        title="the worst of all runs",
        frequency=of.frequency,
        rows=labels(of),
        values=np.fmax.reduce(sigma, axis=0),
        modes=[(one.name, one.frequency) for one in modes],
        rules=(of.channels,) if of.channels < len(of.rows) else (),
        finer=tuple(k for k in range(1, len(kinds)) if kinds[k] != kinds[k - 1]) if len(set(kinds)) <= 4 else (),
    )
    if not of.has_lines:
        numbers = np.arange(1.0, len(of.runs) + 1)
        every = replace(worst, title="all modes", frequency=numbers, values=sigma[:, 0], modes=[], along="mode")
        of_one = zip(of.runs, numbers, sigma, strict=True)
        return [*(replace(every, title=name, frequency=np.array([k]), values=own) for name, k, own in of_one), every]
    runs = zip(of.runs, of.axes, sigma, strict=True)
    return [*(replace(worst, title=run(name, axis), values=own) for name, axis, own in runs), worst]


def pairs_of(pairs: Pairs, modes: Sequence[NamedMode]) -> spec.HeatMap:
    """Predicted beside measured dynamic mass about F: load and base motion over frequency."""
    return spec.HeatMap(
        title=f"{pairs.campaign}: dynamic mass, load and base motion",
        frequency=pairs.frequency,
        rows=PAIRS,
        values=pairs.sigma.reshape(len(pairs.frequency), 36),
        modes=[(one.name, one.frequency) for one in modes],
        rules=(6, 12, 18, 24, 30),
    )


def channel_map(of: Map, run_index: int | None = None, *, modes: Sequence[NamedMode] = (), dark: bool = False) -> Figure:
    """Channels and loads of one run over frequency; the worst of all runs where `run_index` is None."""
    one = channels_of(of, modes)[-1 if run_index is None else run_index]
    return interactive.heat_map(replace(one, title=f"{of.data_set}, {one.title}: {of.shown}"), dark)


def pair_map(pairs: Pairs, *, modes: Sequence[NamedMode] = (), dark: bool = False) -> Figure:
    """The map of `pairs` on a page."""
    return interactive.heat_map(pairs_of(pairs, modes), dark)


def draw_channels(of: Map, modes: Sequence[NamedMode], path: Path, note: str = "") -> None:
    """Write one panel a run.

    Raises
    ------
    BadInput : the ending of `path` is unknown.
    """
    *maps, every = channels_of(of, modes)
    maps = maps if of.has_lines else [every]
    columns = min(3, len(maps))
    lines, most = -(-len(maps) // columns), len(of.rows)
    height = 1.9 + lines * (0.75 + 0.155 * most)
    figure = static.new_figure(15.5, height)
    room = {"left": 0.085, "right": 0.925, "top": 1 - 1.05 / height, "bottom": 0.85 / height}
    grid = figure.add_gridspec(lines, columns, hspace=0.6 / (0.155 * most + 0.3), wspace=0.06, **room)
    mesh = None
    for k, one in enumerate(maps):
        axes = figure.add_subplot(grid[k // columns, k % columns])
        mesh = static.heat_map(axes, one, static.sigmas())
        axes.set_yticks(np.arange(most), one.rows if k % columns == 0 else [""] * most, parse_math=False)
        if k >= len(maps) - columns:
            axes.set_xlabel(one.along, fontsize=10)
    static.colour_bar(figure, mesh, (0.94, room["bottom"], 0.012, min(room["top"] - room["bottom"], 5.0 / height)))
    static.finish(figure, f"{of.data_set}: {of.shown}", note, path)


def draw_pairs(of: Pairs, modes: Sequence[NamedMode], path: Path, note: str = "") -> None:
    """Write the map of `of` in sigmas, and beside it in per cent of the dynamic mass.

    Raises
    ------
    BadInput : the ending of `path` is unknown.
    """
    from matplotlib.colors import BoundaryNorm, LinearSegmentedColormap

    figure, one = static.new_figure(15.5, 8.6), pairs_of(of, modes)
    blues = LinearSegmentedColormap.from_list(
        "per cent", (spec.PAPER, "#d3e3f3", "#7fb2d8", "#2f72b0", "#0b2f63"), N=len(PERCENT)
    )
    shares = (blues, BoundaryNorm(PERCENT, len(PERCENT), extend="max"))
    percent = replace(one, title="in per cent of the dynamic mass", values=of.percent.reshape(len(of.frequency), 36))
    sides = (
        (0.06, replace(one, title="in sigmas"), static.sigmas(), spec.BOUNDS, "sigma"),
        (0.55, percent, shares, PERCENT, "per cent"),
    )
    for left, shown, scale, bounds, name in sides:
        axes = figure.add_axes((left, 0.105, 0.37, 0.755))
        mesh = static.heat_map(axes, shown, scale)
        axes.set_yticks(np.arange(36), one.rows)
        axes.set_xlabel("frequency [Hz]", fontsize=10)
        axes.set_ylabel("load, base motion", fontsize=10)
        static.colour_bar(figure, mesh, (left + 0.385, 0.105, 0.012, 0.6), bounds, name)
    static.finish(figure, one.title, note, path)


def draw_runs(
    title: str, rows: Sequence[str], columns: Sequence[str], sigma: Array, percent: Array, path: Path, note: str = ""
) -> None:
    """Write the map of runs and configurations, the plain error in every cell.

    Parameters
    ----------
    rows, columns : names of the data sets and of the runs
    sigma, percent : (a, b) worst cell and plain error; NaN where a data set has no such run

    Raises
    ------
    BadInput : the ending of `path` is unknown.
    """
    height = 2.4 + 0.75 * len(rows)
    figure = static.new_figure(max(9.0, 4.0 + 1.25 * len(columns)), height)
    room = {"left": 0.2, "right": 0.87, "top": 1 - 1.25 / height, "bottom": 0.75 / height}
    axes = figure.add_subplot(figure.add_gridspec(1, 1, **room)[0])
    colours, norm = static.sigmas()
    axes.set_facecolor("#e9ebef")
    mesh = axes.pcolormesh(np.ma.masked_invalid(sigma), cmap=colours, norm=norm, edgecolors=spec.PAPER, linewidth=2)
    for (a, b), worst in np.ndenumerate(sigma):
        if np.isfinite(worst):
            words = f"{worst:.{1 if worst < 100 else 0}f} σ" + (f"\n{percent[a, b]:.2g} %" if np.isfinite(percent[a, b]) else "")
            axes.text(
                b + 0.5, a + 0.5, words, ha="center", va="center", fontsize=9.5, color=spec.PAPER if worst >= 10 else spec.INK
            )
    axes.set_xticks(np.arange(len(columns)) + 0.5, columns, fontsize=9.5, parse_math=False)
    axes.set_yticks(np.arange(len(rows)) + 0.5, rows, fontsize=9.5, parse_math=False)
    axes.xaxis.tick_top()
    axes.invert_yaxis()
    axes.tick_params(length=0, colors=spec.INK)
    for side in axes.spines.values():
        side.set_visible(False)
    static.colour_bar(figure, mesh, (0.9, room["bottom"], 0.015, room["top"] - room["bottom"]))
    static.finish(figure, title, note, path)
