"""What a page needs to show figures by itself: the library, the figures, and the two templates between which it switches."""

from __future__ import annotations

from typing import TYPE_CHECKING

from validation.plots.theme import template

if TYPE_CHECKING:
    from plotly.graph_objects import Figure


def library() -> str:
    """The source of plotly.js, of the version to which the figures belong."""
    from plotly.offline import get_plotlyjs

    return str(get_plotlyjs())


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
