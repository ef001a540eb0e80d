"""Pictures of a comparison: maps of deviations in sigmas, predicted beside measured dynamic mass, the four errors.

One scale of colours for all maps: what chance reaches stays pale, beyond the threshold the colour changes at once from blue-
grey to yellow and darkens towards purple. Lightness falls throughout, so the scale reads without colours, too.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from geometry.frames import Array
from validation.compare.compare import Comparison
from validation.diagnose import diagnosis
from validation.diagnose.diagnosis import Cause, Diagnosis
from validation.effects.effect import evidence_threshold
from validation.estimation.result import Evaluation, Share
from validation.estimation.verdicts import DOUBTFUL, FAILED, GOOD, expected_z2, misfit
from validation.report.charts.style import (
    ASIDE,
    CURVES,
    FAINT,
    INK,
    LEGEND_ROOM,
    PAPER,
    PREDICTED,
    THEME_MEASURED,
    TITLE_ROOM,
    Axes,
    dressed,
    escaped,
    finish,
    grid_lines,
    legend_above,
    new_figure,
    require_format,
)

if TYPE_CHECKING:
    from plotly.graph_objects import Figure


BARS = 10
"""Causes that are drawn."""


def tried(found: Diagnosis) -> tuple[Cause, ...]:
    """What is drawn: what was accepted, then what was tried, each once."""
    every = {one.id: one for one in (*found.ranking, *found.accepted)}
    return tuple(sorted(every.values(), key=lambda one: -one.evidence))[:BARS]


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
class ResidualMap:
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


def draw_maps(title: str, maps: Sequence[ResidualMap], path: Path, note: str = "", columns: int = 3) -> None:
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


def draw_pairs(title: str, sigma: ResidualMap, percent: ResidualMap, path: Path, note: str = "") -> None:
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


def _panel(axes: Axes, one: ResidualMap, scale: tuple[Any, Any] | None = None) -> Any:
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


# Pictures of a diagnosis: how surely each effect explains the data, and the errors before and after what was found.


ACCEPTED, ALIKE, LESS, TOO_MUCH_LEFT = STANDINGS = ("accepted", "cannot be told from it", "explains less", "leaves too much")

COLOURS: Mapping[str, str] = MappingProxyType(dict(zip(STANDINGS, ("#2456c4", "#f39b2c", "#b4bcc8", "#b8415f"), strict=True)))
"""By where a cause stands; dark, middle and light, so that they differ without colours, too."""

BEFORE, AFTER = "#b4bcc8", "#2456c4"

LINEAR = 10.0
"""[nats] below which the axis of evidence is linear, and logarithmic beyond."""

LONGEST = 34
"""Letters of an id before it is cut."""


@dataclass(frozen=True, kw_only=True)
class DrawnCause:
    """One bar.

    Attributes
    ----------
    name : id
    size : with its interval, in words
    evidence : [nats]
    standing : of `STANDINGS`
    """

    name: str
    size: str
    evidence: float
    standing: str


@dataclass(frozen=True, kw_only=True)
class DrawnPair:
    """One error before and after.

    Attributes
    ----------
    name : of the error
    before, after : its size; None where nothing was found that could change it
    unit : behind the figures
    """

    name: str
    before: float
    after: float | None
    unit: str = ""


def draw_evidence(title: str, causes: Sequence[DrawnCause], path: Path, note: str = "", threshold: float | None = None) -> None:
    """Write one bar a cause, the best on top, with its size behind it.

    Parameters
    ----------
    threshold : [nats] from which an effect is accepted; None where it is not known

    Raises
    ------
    BadInput : the ending of `path` is unknown.
    """
    require_format(path)
    height = 2.5 + 0.46 * len(causes)
    figure = new_figure(13.5, height)
    axes = figure.add_axes((0.235, 0.98 / height, 0.45, 1 - 2.15 / height))
    places = np.arange(len(causes))
    axes.set_xscale("symlog", linthresh=LINEAR)
    axes.barh(places, [one.evidence for one in causes], color=[COLOURS[one.standing] for one in causes], height=0.64)
    axes.set_ylim(len(causes) - 0.4, -0.6)
    axes.set_xlim(min(0.0, *(1.3 * one.evidence for one in causes)), max(2 * LINEAR, *(1.6 * one.evidence for one in causes)))
    for place, one in zip(places, causes, strict=True):
        words = f"{one.evidence:+.1f} nats   {one.size}"
        axes.text(1.02, place, words, transform=axes.get_yaxis_transform(), va="center", fontsize=10, color=INK, parse_math=False)
    axes.axvline(0.0, color=FAINT, linewidth=0.8)
    if threshold is not None:
        axes.axvline(threshold, color=INK, linewidth=1.6, linestyle=(0, (5, 3)))
    axes.set_xlabel("evidence [nats], logarithmic beyond 10", fontsize=9.5, color=INK)
    grid_lines(axes)
    axes.set_yticks(places, [_short(one.name) for one in causes], parse_math=False)
    axes.tick_params(axis="y", labelsize=10.5)
    axes.xaxis.set_major_formatter("{x:g}")
    axes.grid(visible=False, axis="y")
    _diagnosis_legend(figure, [one for one in STANDINGS if any(cause.standing == one for cause in causes)], height, threshold)
    finish(figure, title, note, path)


def draw_before_after(title: str, percents: Sequence[DrawnPair], prices: Sequence[DrawnPair], path: Path, note: str = "") -> None:
    """Write pairs of bars: `percents` of the measured forces above, ratios to what is due where nothing is wrong below.

    Raises
    ------
    BadInput : the ending of `path` is unknown.
    """
    require_format(path)
    height = 2.9 + 0.62 * (len(percents) + len(prices))
    figure = new_figure(12.0, height)
    grid = figure.add_gridspec(
        2,
        1,
        height_ratios=(len(percents), len(prices)),
        hspace=0.5,
        left=0.19,
        right=0.95,
        top=1 - 1.15 / height,
        bottom=0.95 / height,
    )
    upper, lower = figure.add_subplot(grid[0]), figure.add_subplot(grid[1])
    _pairs(upper, percents, "per cent of the measured forces")
    _pairs(lower, prices, "times what is due where nothing is wrong, logarithmic", log=True)
    lower.axvline(1.0, color=INK, linewidth=1.6, linestyle=(0, (5, 3)))
    _before_after(figure, height, both=any(one.after is not None for one in percents))
    finish(figure, title, note, path)


def _pairs(axes: Axes, pairs: Sequence[DrawnPair], label: str, *, log: bool = False) -> None:
    both = any(one.after is not None for one in pairs)
    bars = [(k - 0.19 * both, one.before, BEFORE, one.unit) for k, one in enumerate(pairs)]
    bars += [(k + 0.19, one.after, AFTER, one.unit) for k, one in enumerate(pairs) if one.after is not None]
    places, sizes, colours, units = zip(*bars, strict=True)
    axes.barh(places, sizes, color=colours, height=0.36 if both else 0.5)
    if log:
        axes.set_xscale("log")
        axes.set_xlim(0.5 * min(0.2, *(size for size in sizes if size > 0)), 2.5 * max(2.0, *sizes))
        axes.xaxis.set_major_formatter("{x:g}")
        axes.xaxis.set_minor_formatter("")
    else:
        axes.set_xlim(0, 1.14 * max(1e-9, *sizes))
    for place, size, unit in zip(places, sizes, units, strict=True):
        where = {"textcoords": "offset points", "va": "center", "fontsize": 9.5, "color": INK, "zorder": 5}
        behind = {"facecolor": PAPER, "edgecolor": "none", "pad": 1.0}
        axes.annotate(f"{size:.3g}{unit}", (size, place), (6, 0), bbox=behind, **where)
    axes.set_xlabel(label, fontsize=9.5, color=INK)
    grid_lines(axes)
    axes.set_yticks(np.arange(len(pairs)), [one.name for one in pairs], parse_math=False)
    axes.tick_params(axis="y", labelsize=10.5)
    axes.invert_yaxis()
    axes.grid(visible=False, axis="y")


def _diagnosis_legend(figure: Any, standings: Sequence[str], height: float, threshold: float | None) -> None:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles: list[Any] = [Patch(color=COLOURS[word], label=word) for word in standings]
    if threshold is not None:
        handles.append(Line2D([], [], color=INK, linewidth=1.6, linestyle=(0, (5, 3)), label="asked for"))
    _place(figure, handles, height)


def _before_after(figure: Any, height: float, *, both: bool) -> None:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    line = Line2D([], [], color=INK, linewidth=1.6, linestyle=(0, (5, 3)), label="due, nothing wrong")
    patches = [Patch(color=BEFORE, label="before"), Patch(color=AFTER, label="with what was found")]
    _place(figure, [*(patches if both else ()), line], height)


def _place(figure: Any, handles: Sequence[Any], height: float) -> None:
    """Below the title."""
    at = (0.4 / figure.get_figwidth(), 1 - 0.62 / height)
    figure.legend(handles=handles, loc="upper left", bbox_to_anchor=at, ncols=5, fontsize=9.5, frameon=False)


def _short(name: str) -> str:
    return name if len(name) <= LONGEST else f"{name[: LONGEST - 1]}…"


# Explanations beside what they are to explain: grouped bars of a few numbers, and shares as lying bars.


EXPLANATIONS_COLOURS = (FAINT, *CURVES, "#8e6fc0", "#c9a227")
"""Of explanations, one after the other."""

SHOWN = 0.05
"""Below which a figure of one decimal is nothing."""

WIDTH = 0.82
"""Of a group of bars, where the distance of groups is 1."""


@dataclass(frozen=True, eq=False, kw_only=True)
class DrawnNumbers:
    """A few numbers and what explanations make of them.

    Attributes
    ----------
    labels : (k,) with their units
    found : (k,) to be explained
    deviation : (k,) standard deviation of each
    explained : by explanation (k,); at most as many as `COLOURS`
    """

    labels: tuple[str, ...]
    found: Array
    deviation: Array
    explained: Mapping[str, Array]


@dataclass(frozen=True, eq=False, kw_only=True)
class ShareBars:
    """A panel of lying bars.

    Attributes
    ----------
    title, unit : of the panel
    shares : by name, from top to bottom
    limit : where a dashed line stands, and what it is; None for none
    """

    title: str
    unit: str
    shares: Mapping[str, float]
    limit: tuple[float, str] | None = None


def draw_numbers(title: str, drawn: DrawnNumbers, path: Path, note: str = "", about: str = "") -> None:
    """Write a picture of `drawn`; a PNG carries the words `about`.

    Raises
    ------
    BadInput : the ending of `path` is unknown.
    """
    require_format(path)
    figure = new_figure(14.0, 7.0)
    axes = figure.add_axes((0.06, 0.13, 0.92, 0.75))
    places, width = np.arange(len(drawn.labels)), WIDTH / (1 + len(drawn.explained))
    every = {"found": drawn.found, **drawn.explained}
    for k, ((name, values), colour) in enumerate(zip(every.items(), (INK, *EXPLANATIONS_COLOURS), strict=False)):
        at = places + (k - len(drawn.explained) / 2) * width
        axes.bar(at, values, 0.92 * width, color=colour, label="Table 2, ± 1 sd" if not k else name)
        reach = drawn.deviation if not k else np.zeros(len(values))
        for x, value, beyond in zip(at, values, np.copysign(reach, values), strict=True):
            low = value < -SHOWN
            axes.text(
                x,
                value + beyond,
                f"{value + 0.0 if abs(value) > SHOWN else 0.0:.1f}",
                ha="center",
                va="top" if low else "bottom",
                fontsize=6.8,
                color=INK,
            )
        if not k:
            axes.errorbar(at, values, drawn.deviation, fmt="none", ecolor="#f28a1c", elinewidth=1.6, capsize=3)
    axes.axhline(0.0, color=INK, linewidth=0.8)
    axes.set_xticks(places, drawn.labels, fontsize=10)
    axes.set_ylabel("deviation from the reference", fontsize=9.5)
    axes.legend(fontsize=9, loc="upper left", framealpha=0.9)
    grid_lines(axes)
    axes.tick_params(axis="x", labelsize=10)
    finish(figure, title, note, path, about)


def draw_shares(title: str, panels: Sequence[ShareBars], path: Path, note: str = "", about: str = "") -> None:
    """Write a picture of `panels` side by side; a PNG carries the words `about`.

    Raises
    ------
    BadInput : the ending of `path` is unknown.
    """
    require_format(path)
    figure = new_figure(15.0, 6.0)
    for k, (panel, left) in enumerate(zip(panels, np.linspace(0.0, 1.0, len(panels) + 1), strict=False)):
        whole = 1.0 / len(panels)
        axes = figure.add_axes((left + 0.5 * whole, 0.14, 0.44 * whole, 0.7))
        _explanations_bars(axes, panel, CURVES[k % len(CURVES)])
    finish(figure, title, note, path, about)


def _explanations_bars(axes: Axes, panel: ShareBars, colour: str) -> None:
    places, values = np.arange(len(panel.shares)), np.array(list(panel.shares.values()))
    axes.barh(places, values, 0.7, color=colour)
    for place, value in zip(places, values, strict=True):
        axes.text(value, place, f" {value:.2g}", va="center", fontsize=8.5, color=INK)
    most = float(values.max(initial=0.0))
    if panel.limit is not None:
        at, words = panel.limit
        most = max(most, at)
        axes.axvline(at, color=INK, linewidth=1.2, linestyle=(0, (5, 3)))
        axes.text(at, -0.75, words, ha="right", va="center", fontsize=8.5, color=INK)
    axes.set_xlim(0.0, 1.18 * most)
    axes.set_ylim(len(values) - 0.4, -1.1 if panel.limit else -0.6)
    axes.set_yticks(places, list(panel.shares), fontsize=9)
    axes.set_title(panel.title, fontsize=11, loc="right", color=INK)
    axes.set_xlabel(panel.unit, fontsize=9.5)
    grid_lines(axes)
    axes.grid(visible=False, axis="y")


# The four errors as bars: of a comparison, and before and after what was found is added.


SHARES: tuple[tuple[str, Callable[[Evaluation], Share | None]], ...] = (
    ("nominal", lambda of: of.nominal),
    ("plain", lambda of: of.plain),
    ("plain, held out", lambda of: of.held_out),
    ("a configuration never seen", lambda of: of.held_out_configurations),
)

ERRORS_VERDICTS = {"": ASIDE, GOOD: PREDICTED, DOUBTFUL: "#e0952b", FAILED: "#c2476b"}


def four_errors(found: Comparison, *, dark: bool = False) -> Figure:
    """Nominal, plain and held-out error in per cent, coloured by their verdicts, and what tolerances let expect as a line."""
    from plotly import graph_objects as go

    verdicts = dict(zip(("nominal", "plain", "fitted", "plain, held out"), (one.verdict for one in found.errors), strict=True))
    seen = [(name, share.percent) for name, tell in SHARES if (share := tell(found.evaluation)) is not None]
    names, sizes = [name for name, _ in seen], [size for _, size in seen]
    colours = [ERRORS_VERDICTS[verdicts.get(name, "")] for name in names]
    bars = go.Bar(
        orientation="h",
        x=sizes,
        y=names,
        marker={"color": colours},
        text=[f"{size:.3g} %" for size in sizes],
        textposition="outside",
        cliponaxis=False,
        hovertemplate="%{y}: %{text}<extra></extra>",
    )
    figure = go.Figure(bars)
    figure.update_yaxes(autorange="reversed", showgrid=False, automargin=True)
    figure.update_xaxes(title_text="per cent of the measured forces", range=[0, 1.18 * max(1e-9, *sizes)])
    expected = found.explained.measurement
    note = {"text": f"expected: {expected:.2g} %", "yanchor": "bottom", "y": 1, "xanchor": "left"}
    figure.add_vline(expected, line={"dash": "dash", "width": 1.5}, annotation=note)
    return dressed(figure, "The errors of the model", 130 + 42 * len(names), dark, margin={"t": 66})


def before_and_after(before: Evaluation, after: Evaluation | None, *, dark: bool = False) -> Figure:
    """The errors in per cent, and chi² and the price of the tolerances over what is due, before and after an effect is added."""
    from plotly import graph_objects as go
    from plotly.subplots import make_subplots

    titles = ("per cent of the measured forces", "over what is due, nothing wrong")
    figure = make_subplots(rows=1, cols=2, column_widths=[0.6, 0.4], horizontal_spacing=0.17, subplot_titles=titles)
    for name, of, colour in (("before", before, ASIDE), ("with what was found", after, PREDICTED)):
        if of is None:
            continue
        shares = [(label, share.percent) for label, tell in SHARES if (share := tell(of)) is not None]
        prices = [("χ² per dof", misfit(of.fitted)), ("z² of tolerances", prior_penalty(of))]
        for column, told in ((1, shares), (2, prices)):
            labels, sizes = zip(*told, strict=True)
            unit = " %" if column == 1 else ""
            bars = go.Bar(
                name=name,
                orientation="h",
                x=sizes,
                y=labels,
                marker={"color": colour},
                text=[f"{size:.3g}{unit}" for size in sizes],
                textposition="outside",
                cliponaxis=False,
                legendgroup=name,
                showlegend=column == 1,
                hovertemplate=f"%{{y}}, {name}: %{{text}}<extra></extra>",
            )
            figure.add_trace(bars, 1, column)
    figure.update_yaxes(autorange="reversed", showgrid=False, automargin=True)
    _room(figure)
    figure.add_vline(1.0, line={"dash": "dash", "width": 1.5}, row=1, col=2)
    legend = legend_above(0.1) | {"traceorder": "normal"}
    return dressed(
        figure, "Errors before and after", 350, dark, legend=legend, margin={"t": TITLE_ROOM + LEGEND_ROOM + 26, "b": 40}
    )


def prior_penalty(of: Evaluation) -> float:
    """Sum of z² of the tolerances over what is due where nothing is wrong."""
    return of.fitted.tolerance_z2 / max(expected_z2(of.fitted), 1.0)


def _room(figure: Figure) -> None:
    """For the figures behind the bars."""
    for column in (1, 2):
        own = [one for one in figure.data if one.xaxis == ("x" if column == 1 else "x2")]
        most = max((max(one.x) for one in own), default=1.0)
        figure.update_xaxes(range=[0, 1.3 * max(most, 1e-9 if column == 1 else 1.5)], row=1, col=column)


# Ranked causes as bars of evidence, each with its size and interval.


EVIDENCE_ACCEPTED, EVIDENCE_ALIKE, EVIDENCE_LESS, EVIDENCE_TOO_MUCH_LEFT = EVIDENCE_STANDINGS = (
    "accepted",
    "cannot be told from it",
    "explains less",
    "leaves too much",
)
EVIDENCE_COLOURS = dict(zip(EVIDENCE_STANDINGS, ("#3b7ddd", "#e0952b", "#97a1b0", "#c2476b"), strict=True))

TICKS = (-1000, -100, -10, -5, 0, 5, 10, 30, 100, 300, 1000, 3000, 10_000, 100_000, 1_000_000)


def evidence(found: Diagnosis, *, dark: bool = False) -> Figure:
    """What was tried, the best on top: a bar a cause in nats, coloured by where it stands, its size behind it.

    A click tells the id of the cause as `y`.
    """
    from plotly import graph_objects as go

    causes = tried(found)
    figure = go.Figure()
    for standing in EVIDENCE_STANDINGS:
        own = [one for one in causes if standing_of(found, one) == standing]
        if own:
            figure.add_trace(_evidence_bars(go, standing, own))
    ids = [escaped(one.id) for one in causes]
    reach = place(np.array([one.evidence for one in causes] or [0.0]))
    low, high = min(0.0, 1.15 * float(reach.min())), max(1.35 * LINEAR, float(reach.max()))
    figure.update_xaxes(range=[low, low + 1.75 * (high - low)], tickvals=place(np.array(TICKS, dtype=float)), zeroline=True)
    figure.update_xaxes(
        ticktext=[f"{one:,}".replace(",", " ") for one in TICKS], title_text="evidence [nats], logarithmic beyond 10"
    )
    figure.update_yaxes(categoryorder="array", categoryarray=ids, range=[len(ids) - 0.5, -0.5], showgrid=False, automargin=True)
    figure.add_traces([_asked(go, causes), _words(go, causes)])
    height = 170 + 34 * len(ids)
    title = "Evidence of each cause, with its size and 90 % interval"
    return dressed(figure, title, height, dark, legend=legend_above(), barmode="overlay", margin={"t": TITLE_ROOM + LEGEND_ROOM})


def place(nats: Array) -> Array:
    """Where `nats` stand on the axis: as they are to `LINEAR`, a decade as long as that beyond."""
    beyond = LINEAR * (1 + np.log10(np.maximum(np.abs(nats), LINEAR) / LINEAR))
    return np.asarray(np.where(np.abs(nats) <= LINEAR, nats, np.sign(nats) * beyond))


def _asked(go: Any, causes: Sequence[Cause]) -> Any:
    """What each family has to bring."""
    asked = [evidence_threshold(one.named.family) for one in causes]
    return go.Scatter(
        x=place(np.array(asked)),
        y=[escaped(one.id) for one in causes],
        customdata=asked,
        mode="markers",
        marker={"symbol": "line-ns", "size": 24, "line": {"width": 2.5, "color": THEME_MEASURED}},
        name="asked for",
        hovertemplate="%{customdata:g} nats are asked for<extra></extra>",
    )


def standing_of(found: Diagnosis, one: Cause) -> str:
    """Of `STANDINGS`."""
    if one.id in {cause.id for cause in found.accepted}:
        return EVIDENCE_ACCEPTED
    if one.id in found.equivalence_class:
        return EVIDENCE_ALIKE
    return EVIDENCE_LESS if one.null else EVIDENCE_TOO_MUCH_LEFT


def _evidence_bars(go: Any, standing: str, causes: Sequence[Cause]) -> Any:
    return go.Bar(
        name=standing,
        orientation="h",
        x=place(np.array([one.evidence for one in causes])),
        y=[escaped(one.id) for one in causes],
        marker={"color": EVIDENCE_COLOURS[standing]},
        customdata=[(escaped(one.named.what), _told(one)) for one in causes],
        hovertemplate="%{y}: %{customdata[0]}<br>%{customdata[1]}<extra></extra>",
    )


def _words(go: Any, causes: Sequence[Cause]) -> Any:
    """Evidence and size behind each bar; of one that speaks against a cause they stand behind the axis."""
    return go.Scatter(
        x=np.maximum(place(np.array([one.evidence for one in causes])), 0.0),
        y=[escaped(one.id) for one in causes],
        text=[f"  {_told(one)}" for one in causes],
        mode="text",
        textposition="middle right",
        cliponaxis=False,
        showlegend=False,
        hoverinfo="skip",
    )


def _told(one: Cause) -> str:
    return escaped(f"{one.evidence:+.1f} nats   " + "; ".join(diagnosis.sized(one, size) for size in one.sizes[:1]))
