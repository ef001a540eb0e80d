"""Ten identified values with their 95 % intervals, each beside its reference."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from geometry.arrays import Array
from identification.quality import sizes
from validation.ladders.nouns import Body
from validation.plots.theme import ASIDE, FURTHER, LEGEND_ROOM, MEASURED, PREDICTED, TITLE_ROOM, dressed, escaped, legend_above
from validation.statement import COG, QUANTITIES, inertia_of

if TYPE_CHECKING:
    from plotly.graph_objects import Figure

PANELS = (
    ("mass and moments about the CoG [%]", (0, 4, 5, 6)),
    ("CoG [mm]", (1, 2, 3)),
    ("products about the CoG [% of √(Θii Θjj)]", (7, 8, 9)),
)
"""What shares a unit, by index in `QUANTITIES`."""

COLOURS = (MEASURED, PREDICTED, FURTHER, "#9a6fd0", ASIDE)


def identified_inertia(bodies: Mapping[str, Body], title: str = "", *, dark: bool = False) -> Figure:
    """Distance of ten identified values from their reference, with 95 % intervals.

    Parameters
    ----------
    bodies : by name - plain and self-calibrated, or rungs of a ladder; each beside its own reference
    """
    from plotly import graph_objects as go
    from plotly.subplots import make_subplots

    widths, names = [len(own) for _, own in PANELS], [name for name, _ in PANELS]
    figure = make_subplots(rows=1, cols=3, column_widths=widths, horizontal_spacing=0.07, subplot_titles=names)
    for number, (name, body) in enumerate(bodies.items()):
        for column, (_, own) in enumerate(PANELS, start=1):
            figure.add_trace(_points(go, name, body, own, _shift(number, len(bodies)), number, legend=column == 1), 1, column)
    for column, (_, own) in enumerate(PANELS, start=1):
        ticks = [QUANTITIES[k].label.split(" ", 1)[1] for k in own]
        figure.update_xaxes(
            tickvals=list(range(len(own))), ticktext=ticks, range=[-0.6, len(own) - 0.4], showgrid=False, row=1, col=column
        )
    figure.update_yaxes(zeroline=True, zerolinewidth=1.6, nticks=7)
    figure.update_yaxes(title_text="identified less reference", row=1, col=1)
    figure.update_annotations(font={"size": 12})
    said = title or "Identified inertia beside its reference, 95 % intervals"
    return dressed(figure, said, 390, dark, legend=legend_above(0.09), margin={"t": TITLE_ROOM + LEGEND_ROOM + 26, "b": 36})


def shown_half_width(body: Body) -> Array:
    """(10,) half of each 95 % interval in the units in which `Body.shown` tells distances."""
    size = sizes(inertia_of(body.reference))
    size[COG] = 0.1
    return np.asarray(100 * body.half_width / size)


def _points(go: Any, name: str, body: Body, own: tuple[int, ...], shift: float, number: int, *, legend: bool) -> Any:
    distance, half = body.shown, shown_half_width(body)
    chosen = list(own)
    told = [
        f"{QUANTITIES[k].label}: {body.values[k] * QUANTITIES[k].per_si:.6g} ± {body.half_width[k] * QUANTITIES[k].per_si:.2g} "
        f"{QUANTITIES[k].unit}, reference {body.reference[k] * QUANTITIES[k].per_si:.6g}"
        for k in chosen
    ]
    colour = COLOURS[number % len(COLOURS)]
    return go.Scatter(
        x=[at + shift for at in range(len(chosen))],
        y=distance[chosen],
        error_y={"type": "data", "array": half[chosen], "thickness": 1.8, "width": 5, "color": colour},
        mode="markers",
        marker={"color": colour, "size": 9, "symbol": ("circle", "diamond", "square", "triangle-up", "x")[number % 5]},
        name=escaped(name),
        legendgroup=escaped(name),
        showlegend=legend,
        text=told,
        hovertemplate="%{text}<extra></extra>",
    )


def _shift(number: int, count: int) -> float:
    """Beside each other where there are several."""
    return 0.0 if count == 1 else 0.5 * (number / (count - 1) - 0.5)
