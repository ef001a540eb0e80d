"""Colours and lettering of all figures, light and dark.

Whatever differs between the two stands in the template alone: a page that switches exchanges the template and keeps the figure.
Curves take middle tones that are read on white, on the dark surface and in print.
"""

from __future__ import annotations

from math import ceil, floor, log10
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from plotly.graph_objects import Figure as Figure
    from plotly.graph_objects.layout import Template

MEASURED, PREDICTED, FURTHER, ASIDE = "#d9661f", "#3b7ddd", "#1f9d61", "#8791a1"
"""What was measured, what the model says, what it would say otherwise, and what stands back."""

THRESHOLD = "#c2334d"
"""Of limits."""

SURFACE = {False: "#ffffff", True: "#171b22"}
"""Behind a figure, by whether it is dark."""

INK = {False: "#1d2330", True: "#e4e8ef"}
GRID = {False: "#e3e7ed", True: "#303846"}
AXIS = {False: "#7b8494", True: "#8b95a6"}

FONT = "system-ui, -apple-system, 'Segoe UI', 'DejaVu Sans', Arial, sans-serif"

TITLE_ROOM, LEGEND_ROOM = 46, 32
"""[pixels] above the panels, and what a legend there adds."""


def template(dark: bool) -> Template:
    """What makes a figure light or `dark`."""
    from plotly import graph_objects as go

    ink, grid, axis = INK[dark], GRID[dark], AXIS[dark]
    of_axis = {
        "gridcolor": grid,
        "zerolinecolor": axis,
        "linecolor": axis,
        "tickcolor": axis,
        "showline": True,
        "ticks": "outside",
        "zeroline": False,
    }
    made = go.layout.Template(
        layout={
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
    )
    made.data.heatmap = [go.Heatmap(colorscale=_sigmas(dark), colorbar={"outlinecolor": axis, "tickcolor": axis})]
    return made


BOUNDS = (0.0, 1.0, 2.0, 3.0, 4.0, 6.0, 10.0, 20.0, 50.0, 100.0)
"""Sigmas at which the colour of a map changes; beyond 4 it is no chance."""

PALE = {False: ("#ffffff", "#f3f5f8", "#e3e9f0", "#ccd8e4"), True: ("#171b22", "#1d232d", "#262f3c", "#33404f")}
STRONG = {
    False: ("#f7d13d", "#f39b2c", "#dd6a3c", "#b8415f", "#7b2a76", "#3d1559"),
    True: ("#6b3d86", "#9c3f7f", "#c9525f", "#e67a3f", "#f6ad3c", "#fbe77a"),
}
"""Below and above the threshold: on paper darker where worse, on a dark page lighter where worse."""


def _sigmas(dark: bool) -> list[list[Any]]:
    """Steps of equal width, one a level."""
    colours = (*PALE[dark], *STRONG[dark])
    count = len(colours)
    return [[edge / count, colour] for k, colour in enumerate(colours) for edge in (k, k + 1)]


def dressed(figure: Figure, title: str, height: int, dark: bool, **layout: Any) -> Figure:
    """`figure` with its template, a title above it and room for its modebar; it takes the width that it is given.

    Parameters
    ----------
    height : [pixels]
    """
    margin = {"l": 70, "r": 16, "t": TITLE_ROOM, "b": 48} | layout.pop("margin", {})
    figure.update_layout(template=template(dark), height=height, margin=margin, autosize=True, **layout)
    figure.update_layout(title={"text": escaped(title), "y": 1, "yref": "container", "yanchor": "top", "pad": {"t": 12, "l": 12}})
    return figure


def legend_above(panel: float = 0.0) -> dict[str, Any]:
    """A legend between the title and the panels, `panel` [share of them] higher where they have titles of their own."""
    return {"orientation": "h", "x": 0, "y": 1.01 + panel, "yanchor": "bottom", "xanchor": "left"}


def decades(low: float, high: float) -> dict[str, Any]:
    """Range and ticks of a logarithmic axis between two powers of ten: round numbers, written out, however short the axis is."""
    a, b = 10.0**low, 10.0**high
    if high - low > 0.7:
        steps = (1, 2, 5) if high - low < 2.6 else (1,)
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
