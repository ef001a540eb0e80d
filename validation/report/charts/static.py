"""Charts drawn into files with matplotlib: what `spec` says, on a page of its own, whole or not at all."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from geometry.atomic import write_with
from geometry.errors import BadInput
from geometry.frames import Array
from validation.report.charts import spec

DPI = 110

Axes = Any
Figure = Any
"""Matplotlib's; the library is imported inside the functions."""

FORMATS = (".png", ".jpg", ".jpeg")


def require_format(path: Path) -> None:
    """Look at the ending of `path` before anything is drawn.

    Raises
    ------
    BadInput : it is not one of `FORMATS`.
    """
    if path.suffix.lower() not in FORMATS:
        problem = f"a picture ends in {', '.join(FORMATS)}, found {path.suffix or 'no ending'}"
        raise BadInput(str(path), "", problem, "Name the file so, the ending chooses the format")


def save(path: Path, write: Callable[[Path], object]) -> None:
    """Let `write` fill the picture; an interruption leaves the old one or none."""
    require_format(path)
    write_with(path, write)


ABOUT = "Comment"
"""The key of a PNG's own words."""


def new_figure(width: float, height: float) -> Figure:
    """An empty page of so many inches."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure as Page

    figure = Page(figsize=(width, height), dpi=DPI, facecolor=spec.PAPER)
    FigureCanvasAgg(figure)
    return figure


def finish(figure: Figure, title: str, note: str, path: Path, about: str = "") -> None:
    """Write title and note onto `figure`, and `figure` to `path`; a PNG carries the words `about`."""
    width, height = figure.get_size_inches()
    figure.text(0.4 / width, 1 - 0.3 / height, title, fontsize=17, weight="bold", color=spec.INK, va="top", parse_math=False)
    figure.text(0.4 / width, 0.14 / height, note, fontsize=9.5, color=spec.FAINT, va="bottom", parse_math=False)
    more = {"metadata": {ABOUT: about}} if about else {}
    save(path, lambda temporary: figure.savefig(temporary, dpi=DPI, **more))


def grid_lines(axes: Axes) -> None:
    """Faint lines behind the curves, small figures beside them."""
    axes.grid(visible=True, which="major", color="#e3e6ec", linewidth=0.7)
    axes.tick_params(labelsize=8.5, colors=spec.INK)
    axes.set_axisbelow(True)


DASHED = (0, (5, 3))
"""Of limits and of what is due."""

LONGEST = 34
"""Letters of a row's name before it is cut."""


def draw_bars(
    chart: spec.BarChart,
    path: Path,
    *,
    size: tuple[float, float],
    room: Mapping[str, float],
    legend: Mapping[str, Any] | None = None,
    thickness: float,
    further: float = 1.14,
    lettering: float = 10.5,
) -> None:
    """Write the panels of `chart` one above the other.

    Parameters
    ----------
    size : width and height [inches]
    room : of the panels, for a grid of matplotlib's
    legend : where it stands; below the title if nothing is said
    thickness : of a bar, where the distance of rows is 1
    further : where a linear axis ends, over the longest bar
    lettering : size of the names of rows [points]

    Raises
    ------
    BadInput : the ending of `path` is unknown.
    """
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    figure = new_figure(*size)
    grid = figure.add_gridspec(len(chart.panels), 1, height_ratios=[len(one.rows) for one in chart.panels], **room)
    for place, panel in zip(grid, chart.panels, strict=True):
        _bars(figure.add_subplot(place), panel, thickness, further, lettering)
    handles: list[Any] = [Patch(color=spec.COLOURS[role][0], label=word) for role, word in chart.legend.items()]
    if chart.limit:
        handles.append(Line2D([], [], color=spec.INK, linewidth=1.6, linestyle=DASHED, label=chart.limit))
    below_title = {"loc": "upper left", "bbox_to_anchor": (0.4 / size[0], 1 - 0.62 / size[1])}
    figure.legend(handles=handles, ncols=5, fontsize=9.5, frameon=False, **(legend or below_title))
    finish(figure, chart.title, chart.note, path)


def _bars(axes: Axes, panel: spec.BarPanel, thickness: float, further: float, lettering: float) -> None:
    apart = 0.0 if panel.scale == spec.EVIDENCE else 0.19 * (len(panel.bars) - 1)
    beside: dict[str, Any] = {"va": "center", "color": spec.INK, "parse_math": False}
    behind = beside | {"textcoords": "offset points", "fontsize": 9.5, "zorder": 5}
    behind["bbox"] = {"facecolor": spec.PAPER, "edgecolor": "none", "pad": 1.0}
    for k, one in enumerate(panel.bars):
        places = [panel.rows.index(row) + apart * (2 * k - 1) for row in one.rows]
        roles = [one.roles] * len(places) if isinstance(one.roles, str) else one.roles
        axes.barh(places, one.values, color=[spec.COLOURS[role][0] for role in roles], height=thickness)
        for place, value, words in zip(places, one.values, one.words, strict=True):
            if panel.scale == spec.EVIDENCE:
                axes.text(1.02, place, words, transform=axes.get_yaxis_transform(), fontsize=10, **beside)
            else:
                axes.annotate(words, (value, place), (6, 0), **behind)
    every = [value for one in panel.bars for value in one.values]
    if panel.scale == spec.LOG:
        axes.set_xscale("log")
        axes.set_xlim(0.5 * min(0.2, *(value for value in every if value > 0)), 2.5 * max(2.0, *every))
        axes.xaxis.set_minor_formatter("")
    elif panel.scale == spec.EVIDENCE:
        axes.set_xscale("symlog", linthresh=spec.LINEAR_NATS)
        axes.set_xlim(min(0.0, *(1.3 * value for value in every)), max(2 * spec.LINEAR_NATS, *(1.6 * value for value in every)))
        axes.axvline(0.0, color=spec.FAINT, linewidth=0.8)
    else:
        axes.set_xlim(0, further * max(panel.least, *every))
    if panel.limit is not None:
        axes.axvline(panel.limit, color=spec.INK, linewidth=1.6, linestyle=DASHED)
    axes.set_xlabel(panel.label, fontsize=9.5, color=spec.INK)
    grid_lines(axes)
    names = [name if len(name) <= LONGEST else f"{name[: LONGEST - 1]}…" for name in panel.rows]
    axes.set_yticks(np.arange(len(names)), names, parse_math=False)
    axes.tick_params(axis="y", labelsize=lettering)
    if panel.scale != spec.LINEAR:
        axes.xaxis.set_major_formatter("{x:g}")
    axes.set_ylim(len(names) - 0.4, -0.6) if panel.scale == spec.EVIDENCE else axes.invert_yaxis()
    axes.grid(visible=False, axis="y")


DASHES = ("-", "--", ":")
"""Of curves in turn."""


def draw_entry(upper: Axes, lower: Axes, panel: spec.EntryPanel) -> None:
    """Magnitude into `upper`, phase into `lower`; what is nothing is said to be."""
    if not panel.curves:
        for axes in (upper, lower):
            axes.set(xticks=[], yticks=[])
            for side in axes.spines.values():
                side.set_color("#d9dde3")
        upper.text(0.5, 0.4, "below 1e-6 of its block", transform=upper.transAxes, ha="center", color=spec.FAINT, fontsize=9)
        return
    lines, measured = iter(zip(spec.CURVES, DASHES, strict=False)), any(one.dots for one in panel.curves)
    for one in panel.curves:
        if not one.dots:
            draw_curve(upper, lower, one, *next(lines), above=measured)
            continue
        look: dict[str, Any] = {"linestyle": "none", "marker": "o", "markersize": 4.2, "markeredgewidth": 0}
        upper.semilogy(one.frequency, np.abs(one.values), label=one.name, color=spec.COLOURS[one.role][0], **look)
        lower.plot(one.frequency, np.degrees(np.angle(one.values)), color=spec.COLOURS[one.role][0], **look)
    if panel.rigid is not None:
        upper.axhline(panel.rigid, color=spec.INK, linewidth=1.0, linestyle=DASHED, label="rigid body", zorder=1)
    dress_entry(upper, lower, np.concatenate([one.frequency for one in panel.curves]))
    at_least_a_decade(upper)


def draw_curve(
    upper: Axes, lower: Axes, one: spec.Curve, colour: str, dash: str = DASHES[0], width: float = 1.3, *, above: bool = False
) -> None:
    """A curve; `above` dots it has a rim, so that both are seen where they agree."""
    from matplotlib.patheffects import Normal, withStroke

    look: dict[str, Any] = {"color": colour, "linestyle": dash, "linewidth": width, "zorder": 3 if above else 2}
    if above:
        look["path_effects"] = [withStroke(linewidth=width + 1.0, foreground=spec.INK), Normal()]
    upper.semilogy(one.frequency, np.abs(one.values), label=one.name, **look)
    # Phase [°], -180 to 180, broken where it jumps from one end to the other: a line there would be no phase
    phase = np.degrees(np.angle(one.values))
    phase[np.flatnonzero(np.abs(np.diff(phase)) > 270)] = np.nan
    lower.plot(one.frequency, phase, **look)


def dress_entry(upper: Axes, lower: Axes, f: Array) -> None:
    """Limits, ticks and grid of magnitude and phase over the lines `f`."""
    from matplotlib.ticker import MaxNLocator

    upper.set_xlim(f.min(), f.max())
    lower.set_ylim(-195, 195)
    lower.set_yticks([-180, -90, 0, 90, 180])
    lower.xaxis.set_major_locator(MaxNLocator(7, steps=[1, 2, 4, 5, 10]))
    upper.tick_params(labelbottom=False)
    for axes in (upper, lower):
        grid_lines(axes)
    upper.grid(visible=True, which="minor", axis="y", color="#f0f2f5", linewidth=0.5)


def at_least_a_decade(upper: Axes) -> None:
    """What is flat is to look flat."""
    low, high = upper.get_ylim()
    if high < 10 * low:
        middle = np.sqrt(low * high)
        upper.set_ylim(middle / 10, middle * 10)


SHADE = "#f6d9dc"
"""Behind lines that were left out."""


def draw_condition(axes: Axes, lines: spec.SpectralLines) -> None:
    """Condition number and its limit over frequency."""
    axes.semilogy(
        lines.frequency, lines.condition, color=spec.COLOURS[spec.PREDICTED][0], linewidth=1.4, label="condition number"
    )
    limit: dict[str, Any] = {"color": spec.COLOURS["limit"][0], "linewidth": 1.2, "linestyle": DASHED}
    axes.axhline(lines.limit, label=f"limit {lines.limit:g}", **limit)
    axes.set_ylim(min(1.0, float(lines.condition.min())), 2 * max(float(lines.condition.max()), lines.limit))
    axes.set_xlim(lines.frequency[0], lines.frequency[-1])


def shade_left_out(axes: Axes, lines: spec.SpectralLines) -> None:
    """Shade every stretch of lines that were left out, half a line to either side."""
    f = lines.frequency
    half = 0.5 * float(np.median(np.diff(f))) if len(f) > 1 else 0.5
    edges = np.flatnonzero(np.diff(np.concatenate([[0], lines.left_out.astype(int), [0]])))
    for first, last in zip(edges[::2], edges[1::2], strict=True):
        axes.axvspan(f[first] - half, f[last - 1] + half, color=SHADE, linewidth=0, zorder=0)


def draw_intervals(chart: spec.IntervalChart, path: Path) -> None:
    """Write ten quantities, a panel each: what was identified on every rung with its interval, beside the reference.

    Raises
    ------
    BadInput : the ending of `path` is unknown.
    """
    figure = new_figure(16.0, 8.6)
    grid = figure.add_gridspec(2, 5, hspace=0.24, wspace=0.36, left=0.055, right=0.985, top=0.85, bottom=0.19)
    values, half, reference = (
        np.array([getattr(one, name) for one in chart.bodies]) for name in ("values", "half_width", "reference")
    )
    at, blue, red = np.arange(len(chart.bodies)), spec.COLOURS[spec.PREDICTED][0], spec.COLOURS["limit"][0]
    look: dict[str, Any] = {"color": blue, "marker": "o", "markersize": 6, "capsize": 4, "linewidth": 1.4, "elinewidth": 1.4}
    dash: dict[str, Any] = {"color": red, "linewidth": 1.6, "marker": "_", "markersize": 16}
    for k, (label, unit) in enumerate(chart.quantities):
        axes = figure.add_subplot(grid[k // 5, k % 5])
        axes.plot(at, reference[:, k], label="reference: the model", zorder=2, **dash)
        axes.errorbar(at, values[:, k], half[:, k], label="identified, 95 % interval", zorder=3, **look)
        axes.set_xlim(-0.4, len(at) - 0.6)
        axes.ticklabel_format(axis="y", useOffset=False)
        grid_lines(axes)
        axes.set_title(f"{label} [{unit}]", fontsize=11, loc="left", color=spec.INK)
        last = k >= len(chart.quantities) - 5
        axes.set_xticks(at, [cut(one.name) for one in chart.bodies] if last else [""] * len(at))
        if last:
            axes.tick_params(axis="x", rotation=28, labelsize=8.5)
            for words in axes.get_xticklabels():
                words.set(ha="right", rotation_mode="anchor")
        if k == 0:
            place: dict[str, Any] = {"loc": "upper right", "bbox_to_anchor": (0.985, 1.0 - 0.25 / 8.6), "ncols": 2}
            figure.legend(*axes.get_legend_handles_labels(), fontsize=10, frameon=False, **place)
    finish(figure, chart.title, chart.note, path)


LARGEST = 30
"""Letters of a name below an axis."""


def cut(text: str, most: int = LARGEST, end: str = " …") -> str:
    """`text` in at most so many letters."""
    return text if len(text) <= most else text[: most - len(end)] + end


def heat_map(axes: Axes, one: spec.HeatMap, scale: tuple[Any, Any]) -> Any:
    """Fill `axes` with `one`; `scale` is the colours and how values choose among them."""
    axes.set_facecolor("#9aa0a6")  # of a row that nothing checks
    colours, norm = scale
    look: dict[str, Any] = {"cmap": colours, "norm": norm, "shading": "nearest", "rasterized": True}
    numbers, rows = one.frequency, np.arange(len(one.rows), dtype=np.float64)
    if len(numbers) == 1 or len(rows) == 1:  # a cell alone has no neighbour that tells how wide it is
        numbers, rows = _edges(numbers), _edges(rows)
        look["shading"] = "flat"
    mesh = axes.pcolormesh(numbers, rows, np.ma.masked_invalid(one.values.T), **look)
    axes.invert_yaxis()
    axes.tick_params(labelsize=8, colors=spec.INK, length=2)
    axes.set_title(one.title, fontsize=10.5, loc="left", color=spec.INK, pad=9, parse_math=False)
    for rule in (*one.finer, *one.rules):
        axes.axhline(rule - 0.5, color=spec.INK, linewidth=0.8)
    for _, f in one.shown_modes:
        axes.plot([f], [1.0], marker="v", markersize=5, color=spec.INK, transform=axes.get_xaxis_transform(), clip_on=False)
    return mesh


def _edges(middles: Array) -> Array:
    """(n + 1,) of cells about `middles`, the outer ones as wide as their neighbours, one alone of width 1."""
    half = np.diff(middles) / 2 if len(middles) > 1 else np.array([0.5])
    return np.concatenate([[middles[0] - half[0]], middles[:-1] + half[: len(middles) - 1], [middles[-1] + half[-1]]])


def sigmas() -> tuple[Any, Any]:
    """Colours of sigmas, and how values choose among them."""
    from matplotlib.colors import BoundaryNorm, ListedColormap

    colours = ListedColormap((*spec.PALE[False], *spec.STRONG[False][:-1])).with_extremes(over=spec.STRONG[False][-1])
    return colours, BoundaryNorm(spec.BOUNDS, colours.N)


def colour_bar(
    figure: Figure, mesh: Any, place: tuple[float, ...], bounds: Sequence[float] = spec.BOUNDS, name: str = "sigma"
) -> None:
    """What the colours of `mesh` mean; a black bar where sigmas are no chance any more."""
    bar = figure.add_axes(place)
    figure.colorbar(mesh, cax=bar, extend="max", spacing="uniform", ticks=bounds)
    bar.set_yticklabels([f"{bound:g}" for bound in bounds])
    bar.tick_params(labelsize=9, colors=spec.INK, length=2)
    if bounds is spec.BOUNDS:
        bar.axhline(spec.CHANCE, color=spec.INK, linewidth=2.5)
    bar.set_title(name, fontsize=9.5, color=spec.INK, loc="left")
