"""What a page needs to show figures by itself: the library, the figures, and the two templates between which it switches."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from validation.addresses import without_addresses
from validation.plots.theme import template

if TYPE_CHECKING:
    from plotly.graph_objects import Figure


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


def library() -> str:
    """The source of plotly.js, of the version to which the figures belong, without addresses and with `CONFIG` set."""
    from plotly.offline import get_plotlyjs

    return f"{without_addresses(str(get_plotlyjs()))}\nPlotly.setPlotConfig({json.dumps(CONFIG)});\n"


def figure_json(figure: Figure) -> str:
    """`figure` as JSON without its template, which a page has once for all of them."""
    from plotly.graph_objects import Figure
    from plotly.io import to_json

    bare = Figure(figure)
    bare.layout.template = None
    return str(to_json(bare, validate=False))


def template_json(dark: bool) -> str:
    """The template that makes any of the figures light or `dark`, as JSON."""
    from plotly.io.json import to_json_plotly

    return str(to_json_plotly(template(dark).to_plotly_json()))
