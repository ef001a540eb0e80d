"""Charts of report and workbench, drawn with plotly: what `spec` says, light and dark.

Whatever differs between the two stands in the template alone: a page that switches exchanges the template and keeps the figure.
"""

import json
import re
from collections.abc import Sequence
from functools import cache
from itertools import pairwise
from math import ceil, floor, log10
from typing import Any, NamedTuple

import numpy as np

from geometry.dynamic_mass import ComplexArray
from geometry.frames import Array
from validation.report.charts import spec
from validation.report.charts.figure import Figure, Values, as_json

SURFACE = {False: "#ffffff", True: "#171b22"}
"""Behind a figure, by whether it is dark."""

GRID = {False: "#e3e7ed", True: "#303846"}
AXIS = {False: "#7b8494", True: "#8b95a6"}

FONT = "system-ui, -apple-system, 'Segoe UI', 'DejaVu Sans', Arial, sans-serif"

TITLE_ROOM, LEGEND_ROOM = 46, 32
"""[pixels] above the panels, and what a legend there adds."""


@cache
def template(dark: bool) -> Values:
    """What makes a figure light or `dark`."""
    ink, grid, axis = "#e4e8ef" if dark else spec.INK, GRID[dark], AXIS[dark]
    of_axis = {
        "gridcolor": grid,
        "zerolinecolor": axis,
        "linecolor": axis,
        "tickcolor": axis,
        "showline": True,
        "ticks": "outside",
        "zeroline": False,
    }
    layout = {
        "paper_bgcolor": SURFACE[dark],
        "plot_bgcolor": SURFACE[dark],
        "font": {"family": FONT, "size": 13, "color": ink},
        "title": {"font": {"size": 15, "color": ink}, "x": 0, "xref": "container", "xanchor": "left", "pad": {"l": 12}},
        "xaxis": of_axis,
        "yaxis": of_axis,
        "legend": {"font": {"color": ink}, "bgcolor": "rgba(0,0,0,0)"},
        "hoverlabel": {"bgcolor": SURFACE[dark], "bordercolor": axis, "font": {"color": ink, "family": FONT}},
        "shapedefaults": {"line": {"color": ink, "width": 1}},
        "annotationdefaults": {"font": {"color": ink}},
        "modebar": {"bgcolor": "rgba(0,0,0,0)", "color": axis, "activecolor": ink},
    }
    # Steps of equal width, one a level
    colours = (*spec.PALE[dark], *spec.STRONG[dark])
    count = len(colours)
    sigmas = [[edge / count, colour] for k, colour in enumerate(colours) for edge in (k, k + 1)]
    heatmap = {"type": "heatmap", "colorscale": sigmas, "colorbar": {"outlinecolor": axis, "tickcolor": axis}}
    return {"layout": layout, "data": {"heatmap": [heatmap]}}


def dressed(figure: Figure, title: str, height: int, dark: bool, **layout: Any) -> Figure:
    """`figure` with its template, a title above it and room for its modebar; it takes the width that it is given.

    Parameters
    ----------
    height : [pixels]
    """
    margin = {"l": 70, "r": 16, "t": TITLE_ROOM, "b": 48} | layout.pop("margin", {})
    named = {"text": escaped(title), "y": 1, "yref": "container", "yanchor": "top", "pad": {"t": 12, "l": 12}}
    figure.update(height=height, margin=margin, autosize=True, title=named, **layout)
    figure.layout["template"] = template(dark)
    return figure


def legend_above(panel: float = 0.0) -> dict[str, Any]:
    """A legend between the title and the panels, `panel` [share of them] higher where they have titles of their own."""
    return {"orientation": "h", "x": 0, "y": 1.01 + panel, "yanchor": "bottom", "xanchor": "left"}


def decades(low: float, high: float, wide: float = 2.6) -> dict[str, Any]:
    """Range and ticks of a logarithmic axis between two powers of ten: round numbers, written out, however short the axis is, and
    powers of ten alone from `wide` decades on."""
    a, b = 10.0**low, 10.0**high
    if high - low > 0.7:
        steps = (1, 2, 5) if high - low < wide else (1,)
        every = [step * 10.0**power for power in range(floor(low) - 1, ceil(high) + 1) for step in steps]
    else:
        rough = (b - a) / 5
        unit = 10.0 ** floor(log10(rough))
        step = next(each * unit for each in (1, 2, 2.5, 5, 10) if each * unit >= rough)
        every = [step * k for k in range(floor(a / step), ceil(b / step) + 1)]
    ticks = [tick for tick in every if a <= tick * (1 + 1e-9) and tick <= b * (1 + 1e-9)]
    return {"type": "log", "range": [low, high], "tickvals": ticks, "ticktext": [f"{tick:.6g}" for tick in ticks]}


def escaped(text: str) -> str:
    """`text` as plotly shows it to the letter: it reads a little HTML, and names come from files."""
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")


# One entry of a matrix over frequency, and curves likewise.


DEEPEST = 1e5
"""Of the largest magnitude: what is smaller is off the page."""

NOTHING = 1e-4
"""Of the largest magnitude: a curve that is smaller throughout is next to nothing."""

LEAST = -170.0
"""[°] at which a phase begins; the page shows 20 more on either side of it."""

WIDE = 2.0
"""Standard deviations (those of the maps) by which the band is wider than the prediction on both sides.

They are those of a complex difference, so that no single share of magnitudes is due in the band: of noise that is alike in all
directions 98 % of the differences are smaller, and more of the magnitudes.
"""


def add_entry(figure: Figure, panel: spec.EntryPanel, row: int, column: int, *, legend: bool = True, last: bool = True) -> None:
    """Add magnitude in the panel at `row` and `column`, phase in that below; `last` names the frequency axis."""
    f, values = panel.curves[0].frequency, [one.values for one in panel.curves]
    bands = [np.abs(one.values) + WIDE * one.expected for one in panel.curves if one.expected is not None]
    low, high = magnitude_range([values[0], *bands, *values[1:]])
    for one in panel.curves:
        if one.expected is None:
            continue
        # Where noise and tolerances that were not fitted let expect what is measured
        size = np.abs(one.values)
        edge = {
            "type": "scatter",
            "mode": "lines",
            "line": {"width": 0},
            "hoverinfo": "skip",
            "legendgroup": "expected",
            **_lines(f),
        }
        fill = {"fill": "tonexty", "fillcolor": "rgba(59,125,221,0.18)", "name": f"expected, ± {WIDE:g} σ"}
        bottom = _short(np.maximum(size - WIDE * one.expected, 10**low))
        edge |= {"legendgroup": "expected"}
        above = {"y": _short(size + WIDE * one.expected), "showlegend": legend}
        figure.add({**edge, "y": bottom, "showlegend": False}, {**edge, **above, **fill}, row=row, column=column)
    others = 0
    for one in panel.curves:
        look: dict[str, Any] = {"mode": "lines", "line": {"color": spec.COLOURS[one.role][1], "width": 2}}
        if one.dots:
            look = {"mode": "markers", "marker": {"color": spec.COLOURS[one.role][1], "size": 4.5}}
        elif one.expected is None:
            look["line"]["dash"] = ("dash", "dot")[others // 2 % 2]
            others += 1
        said = {"type": "scatter", "name": escaped(one.name), "legendgroup": escaped(one.name), **look, **_lines(f)}
        above = {"y": _short(np.abs(one.values)), "hovertemplate": f"%{{y:.4g}} {panel.unit}", "showlegend": legend}
        # None where the magnitude is below the page, since the angle of next to nothing means nothing
        angle = _short(np.where(np.abs(one.values) >= 10**low, phase(one.values), np.nan))
        below = {"y": angle, "hovertemplate": "%{y:.1f}°", "showlegend": False}
        figure.add({**said, **above}, row=row, column=column)
        figure.add({**said, **below}, row=row + 1, column=column)
    if panel.modes:
        of_modes: dict[str, Any] = {"name": "modes of the model", "legendgroup": "modes", "showlegend": legend}
        figure.add(modes(panel.modes, 10 ** (high - 0.04 * (high - low)), 10, **of_modes), row=row, column=column)
    ends = [float(f[0]), float(f[-1])]
    named = {"title": {"text": "frequency [Hz]"}} if last else {}
    figure.across(range=ends, showticklabels=False, row=row, column=column)
    figure.across(range=ends, **named, row=row + 1, column=column)
    figure.up(title={"text": f"|H| [{panel.unit}]"}, **decades(low, high), row=row, column=column)
    phases = {"range": [-190, 190], "tickvals": [-180, 0, 180]}
    figure.up(title={"text": "phase [°]"}, **phases, row=row + 1, column=column)


def magnitude_range(curves: Sequence[ComplexArray | Array]) -> tuple[float, float]:
    """Powers of ten between which the magnitudes of `curves` are shown.

    A curve that symmetry makes next to nothing does not count, and what falls below `DEEPEST` of the largest is off the page.
    """
    largest = max((float(np.nanmax(np.abs(one))) for one in curves), default=0.0)
    sizes = np.abs(np.concatenate([one for one in curves if np.nanmax(np.abs(one)) >= NOTHING * largest]))
    sizes = sizes[np.isfinite(sizes) & (sizes > 0)]
    if not sizes.size:
        return -1.0, 1.0
    top = float(sizes.max())
    bottom = max(float(sizes.min()), top / DEEPEST)
    return float(np.log10(bottom)) - 0.08, float(np.log10(top)) + 0.12


def phase(H: ComplexArray) -> Array:
    """[°] from -170 to 190: what is negative, give or take its noise, does not jump from one end of the page to the other."""
    angle = np.degrees(np.angle(H))
    return np.asarray(np.where(angle < LEAST, angle + 360.0, angle))


def _lines(f: Array) -> dict[str, Any]:
    """Frequencies as a first one and a step where they are even, which is shorter."""
    steps = np.diff(f)
    if len(f) > 2 and np.allclose(steps, steps[0], rtol=1e-6):
        return {"x0": float(f[0]), "dx": float((f[-1] - f[0]) / (len(f) - 1))}
    return {"x": f}


def _short(values: Array) -> Any:
    """Single precision: six digits are more than a figure shows."""
    return np.asarray(values, dtype=np.float32)


def condition(lines: spec.SpectralLines, title: str, dark: bool) -> Figure:
    """Scaled condition number of the base motions of all runs over frequency, its limit, and the lines that were left out."""
    look = {
        "type": "scatter",
        "line": {"color": spec.COLOURS[spec.PREDICTED][1], "width": 1.8},
        "hovertemplate": "%{x:.2f} Hz: %{y:.3g}<extra></extra>",
    }
    figure = Figure({"x": lines.frequency, "y": lines.condition, "mode": "lines", "name": "condition number", **look})
    if lines.left_out.any():
        out = {"mode": "markers", "marker": {"color": spec.COLOURS[spec.ASIDE][1], "size": 5}, "name": "left out"}
        figure.add({"type": "scatter", "x": lines.frequency[lines.left_out], "y": lines.condition[lines.left_out], **out})
    figure.rule(y=lines.limit, dash="dash", color=spec.COLOURS["limit"][1])
    place: dict[str, Any] = {"x": 1, "xref": "paper", "xanchor": "right", "yanchor": "bottom"}
    figure.note(y=float(np.log10(lines.limit)), text=f"limit {lines.limit:g}: worse lines are left out", **place)
    top = float(np.log10(3 * max(float(lines.condition.max()), lines.limit)))
    figure.up(title={"text": "condition number [1]"}, **decades(0.0, top))
    figure.across(title={"text": "frequency [Hz]"})
    return dressed(figure, title, 310, dark, showlegend=False)


BODIES = tuple(spec.COLOURS[role][1] for role in (spec.MEASURED, spec.PREDICTED, spec.FURTHER, "prior penalty", spec.ASIDE))
SYMBOLS = ("circle", "diamond", "square", "triangle-up", "x")
"""Of bodies in turn."""


def intervals(chart: spec.IntervalChart, dark: bool) -> Figure:
    """Distances from the reference with their intervals, a panel for what shares a unit."""
    widths = [len(own) for own in chart.groups.values()]
    figure = Figure(columns=len(widths), widths=widths, horizontal=0.07, titles=list(chart.groups))
    for number, one in enumerate(chart.bodies):
        shift = 0.0 if len(chart.bodies) == 1 else 0.5 * (number / (len(chart.bodies) - 1) - 0.5)
        colour = BODIES[number % len(BODIES)]
        for column, own in enumerate(map(list, chart.groups.values()), start=1):
            points = {
                "type": "scatter",
                "x": [at + shift for at in range(len(own))],
                "y": one.deviation[own],
                "error_y": {"type": "data", "array": one.reach[own], "thickness": 1.8, "width": 5, "color": colour},
                "mode": "markers",
                "marker": {"color": colour, "size": 9, "symbol": SYMBOLS[number % len(SYMBOLS)]},
                "name": escaped(one.name),
                "legendgroup": escaped(one.name),
                "showlegend": column == 1,
                "text": [
                    f"{chart.quantities[k][0]}: {one.values[k]:.6g} ± {one.half_width[k]:.2g} {chart.quantities[k][1]}, "
                    f"reference {one.reference[k]:.6g}"
                    for k in own
                ],
                "hovertemplate": "%{text}<extra></extra>",
            }
            figure.add(points, column=column)
    for column, own in enumerate(map(list, chart.groups.values()), start=1):
        ticks = {"tickvals": list(range(len(own))), "ticktext": [chart.quantities[k][0].split(" ", 1)[1] for k in own]}
        figure.across(**ticks, range=[-0.6, len(own) - 0.4], showgrid=False, row=1, column=column)
    figure.up(zeroline=True, zerolinewidth=1.6, nticks=7)
    figure.up(title={"text": "identified less reference"}, row=1, column=1)
    for title in figure.layout["annotations"]:
        title["font"] = {"size": 12}
    margin = {"t": TITLE_ROOM + LEGEND_ROOM + 26, "b": 36}
    return dressed(figure, chart.title, 390, dark, legend=legend_above(0.09), margin=margin)


# What a page needs to show figures by itself: the library, the figures, and the two templates between which it switches.


BUTTONS = (("toImage",), ("zoom2d", "pan2d"), ("zoomIn2d", "zoomOut2d", "resetScale2d"))
"""All buttons above a figure, in groups. Only these are shown, whatever plotly.js adds: version 4 added one that opened
a window of its makers and posted the figure there."""

CONFIG: dict[str, Any] = {
    "modeBarButtons": BUTTONS,
    "displaylogo": False,
    "showSendToCloud": False,
    "plotlyServerURL": "",
    "topojsonURL": "about:blank#",  # where it would look for maps of the world; it takes no empty one
}
"""What every figure of report and workbench is drawn with; a page adds its own sizes, and none of these."""


# Scripts of others without the addresses that they hold. A policy of content stops what a page loads, posts or connects to. It
# does not stop a window that a click opens, and plotly.js has offered one that took the figure, with its data, to its makers. So
# no script is shipped with an address that could be gone to.


NAMESPACES = "www.w3.org/"
"""Of XML: names that look like addresses, by which a browser knows SVG from HTML; nothing goes there."""

ADDRESS = re.compile(rf"(?:https?|wss?|ftp)://(?!{re.escape(NAMESPACES)})(?=[\w$\[{{])")
"""Where an address begins, a host behind it, be it written out, put together (``${host}``) or a pattern (``{s}.tile``)."""

NOWHERE = "about:blank#"
"""A valid address, as scripts expect one, of an empty page."""


def without_addresses(script: str) -> str:
    """`script` with every foreign address leading to an empty page; what it said stays legible, as in a notice of copyright."""
    return ADDRESS.sub(NOWHERE, script)


def library() -> str:
    """The source of plotly.js, of the version to which the figures belong, without addresses and with `CONFIG` set."""
    from plotly.offline import get_plotlyjs

    return f"{without_addresses(str(get_plotlyjs()))}\nPlotly.setPlotConfig({json.dumps(CONFIG)});\n"


def template_json(dark: bool) -> str:
    """The template that makes any of the figures light or `dark`, as JSON."""
    return as_json(template(dark))


# As many lines as a figure has pixels for, the worst of those that share one.


MOST = 280
"""Columns of a map."""


class Thinned(NamedTuple):
    """Lines in columns.

    Attributes
    ----------
    middle : (m,) [Hz] of each column
    values : (m, ...) the greatest of each column; NaN where all of it is
    at : (m, ...) [Hz] of the line that has it
    """

    middle: Array
    values: Array
    at: Array


def worst(frequency: Array, values: Array, most: int = MOST) -> Thinned:
    """`frequency` (n,) [Hz] and `values` (n, ...) in at most `most` columns; a value that is NaN hides no other."""
    n = len(frequency)
    edges = np.arange(n + 1) if n <= most else np.unique(np.linspace(0, n, most + 1).astype(int))
    known = np.where(np.isnan(values), -np.inf, values)
    lines = np.array([a + np.argmax(known[a:b], axis=0) for a, b in pairwise(edges)])
    middle = np.array([frequency[(a + b - 1) // 2] for a, b in pairwise(edges)])
    return Thinned(middle, np.take_along_axis(values, lines, axis=0), frequency[lines])


TICKS = (-1000, -100, -10, -5, 0, 5, 10, 30, 100, 300, 1000, 3000, 10_000, 100_000, 1_000_000)
"""Of an axis of evidence [nats]."""

LETTER, NARROW = 6.5, 430.0
"""[px] of a letter of an axis, and of the axis of causes where it is narrowest, on paper. By definition."""


def bars(one: spec.Bars, chart: spec.BarChart, **more: Any) -> Values:
    """The trace of `one`, its words at the ends of the bars."""
    colours = spec.COLOURS[one.roles][1] if isinstance(one.roles, str) else [spec.COLOURS[role][1] for role in one.roles]
    look = {"marker": {"color": colours}, "text": one.words, "textposition": "outside", "cliponaxis": False}
    rows = [chart.on_page.get(row, row) for row in one.rows]
    return {"type": "bar", "orientation": "h", "x": one.values, "y": rows, **look, **more}


def evidence(chart: spec.BarChart, dark: bool) -> Figure:
    """A bar a cause, its words behind it, and a mark at what is asked for; a click tells the row as `y`."""
    (panel,) = chart.panels
    figure = Figure()
    for one in panel.bars:
        told = [(escaped(about), escaped(words)) for about, words in zip(one.about, one.words, strict=True)]
        bar = {
            "type": "bar",
            "name": one.name,
            "orientation": "h",
            "x": spec.signed_log(np.array(one.values)),
            "y": [escaped(row) for row in one.rows],
            "marker": {"color": spec.COLOURS[one.name][1]},
            "customdata": told,
            "hovertemplate": "%{y}: %{customdata[0]}<br>%{customdata[1]}<extra></extra>",
        }
        figure.add(bar)
    rows = [escaped(row) for row in panel.rows]
    found = {row: told for one in panel.bars for row, told in zip(one.rows, zip(one.values, one.words, strict=True), strict=True)}
    reach = spec.signed_log(np.array([found[row][0] for row in panel.rows] or [0.0]))
    low, high = min(0.0, 1.15 * float(reach.min())), max(1.35 * spec.LINEAR_NATS, float(reach.max()))
    behind = [escaped(found[row][1]).replace("   ", "<br>") for row in panel.rows]
    longest = max((len(line) for one in behind for line in one.split("<br>")), default=0)
    whole = (high - low) / (1 - min(longest * LETTER / NARROW, 0.65))
    shown = list[tuple[float, int]]()  # as far as bars reach, none on its neighbour
    for tick, at in zip(TICKS, spec.signed_log(np.array(TICKS, dtype=float)).tolist(), strict=True):
        if low <= at <= high and (not shown or at - shown[-1][0] > len(f" {tick:,} ") * LETTER / NARROW * whole):
            shown.append((at, tick))
    ticks: Values = {"tickvals": [at for at, _ in shown], "ticktext": [f"{tick:,}".replace(",", " ") for _, tick in shown]}
    figure.across(range=[low, low + whole], zeroline=True, title={"text": panel.label}, tickangle=0, **ticks)
    figure.up(categoryorder="array", categoryarray=rows, range=[len(rows) - 0.5, -0.5], showgrid=False, automargin=True)
    asked = {
        "type": "scatter",
        "x": spec.signed_log(np.array(panel.asked)),
        "y": rows,
        "customdata": panel.asked,
        "mode": "markers",
        "marker": {"symbol": "line-ns", "size": 24, "line": {"width": 2.5, "color": spec.COLOURS[spec.MEASURED][1]}},
        "name": "asked for",
        "hovertemplate": "%{customdata:g} nats are asked for<extra></extra>",
    }
    words = {  # of a cause that the data speak against they stand behind the axis
        "type": "scatter",
        "x": np.maximum(reach[: len(rows)], 0.0),
        "y": rows,
        "text": [f"  {one.replace('<br>', '<br>  ')}" for one in behind],
        "mode": "text",
        "textposition": "middle right",
        "cliponaxis": False,
        "showlegend": False,
        "hoverinfo": "skip",
    }
    figure.add(asked, words)
    further = 19 * max(0, ceil((len(panel.bars) + 1) / 2) - 1)  # [px] lines of a legend that has two names a line on paper
    margin, height = {"t": TITLE_ROOM + LEGEND_ROOM + further}, 160 + further + 42 * len(rows)
    return dressed(figure, chart.title, height, dark, legend=legend_above(), barmode="overlay", margin=margin)


def levels(sigma: Array) -> Array:
    """Of each cell the place in the scale of colours, from 0 in steps of 1; NaN where it has none."""
    found = np.searchsorted(np.array(spec.BOUNDS), np.nan_to_num(sigma), side="right") - 1.0
    return np.where(np.isnan(sigma), np.nan, found)


def heat_map(one: spec.HeatMap, dark: bool) -> Figure:
    """A map of sigmas.

    A click tells the middle of its column as `x`, the name of its row as `y`, and as `customdata` the worst of the lines
    that share the cell: [σ, its frequency in Hz].
    """
    thin = worst(one.frequency, one.values)
    rows = [escaped(row) for row in one.rows]
    bar = {
        "title": {"text": "σ"},
        "tickvals": [k - 0.5 for k in range(len(spec.BOUNDS))],
        "ticktext": [f"{bound:g}" for bound in spec.BOUNDS],
        "thickness": 14,
        "len": 1.0,
        "outlinewidth": 1,
    }
    of_modes = one.along == "mode"
    where = "mode %{customdata[1]:.0f}" if of_modes else "%{customdata[1]:.2f} Hz"
    heat = {
        "type": "heatmap",
        "x": np.asarray(thin.middle, dtype=np.float32),
        "y": rows,
        "z": np.asarray(levels(thin.values).T, dtype=np.float32),
        "customdata": np.stack([thin.values.T, thin.at.T], axis=2).astype(np.float32),
        "zmin": -0.5,
        "zmax": len(spec.BOUNDS) - 0.5,
        "hoverongaps": False,
        "hovertemplate": f"%{{y}}<br>{where}: %{{customdata[0]:.1f}} σ<extra></extra>",
        "colorbar": bar,
    }
    figure = Figure(heat)
    if one.shown_modes:  # above the rows, on an axis of their own: a category without cells is more than a heat map bears
        figure.add(modes(one.shown_modes, 1.0, 9, yaxis="y2", showlegend=False))
        figure.update(yaxis2={"overlaying": "y", "range": [0, 1], "visible": False, "fixedrange": True})
    for rule in one.rules:
        figure.rule(y=rule - 0.5, width=1)
    axis: Values = {
        "type": "category",
        "categoryorder": "array",
        "categoryarray": rows,
        "range": [len(rows) - 0.5, -0.5],
        "ticks": "",
    }
    figure.up(showgrid=False, tickmode="array", tickvals=rows, tickfont={"size": 11}, **axis)
    figure.across(title={"text": one.along}, showgrid=False, **({"dtick": 1} if of_modes else {}))
    look = {"margin": {"l": 118, "r": 10}, "uirevision": escaped(one.title)}
    return dressed(figure, one.title, 130 + max(15 * len(rows), 210), dark, **look)  # of few rows, room for the scale beside them


def modes(shown: Sequence[tuple[str, float]], height: float, size: int, **more: Any) -> Values:
    """Triangles at the eigenfrequencies."""
    return {
        "type": "scatter",
        "x": [frequency for _, frequency in shown],
        "y": [height] * len(shown),
        "text": [escaped(name) for name, _ in shown],
        "mode": "markers",
        "marker": {"symbol": "triangle-down", "size": size, "color": spec.COLOURS[spec.ASIDE][1]},
        "cliponaxis": False,
        "hovertemplate": "%{text}, %{x:.2f} Hz<extra></extra>",
        **more,
    }
