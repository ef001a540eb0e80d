"""The errors of a model falling from rung to rung."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import log10
from typing import TYPE_CHECKING, Any

from validation.ladders.climbing import Standing
from validation.ladders.nouns import Errors, Rung
from validation.plots.theme import ASIDE, LEGEND_ROOM, MEASURED, PREDICTED, TITLE_ROOM, decades, dressed, escaped, legend_above

if TYPE_CHECKING:
    from plotly.graph_objects import Figure

Error = tuple[str, str, Callable[[Errors], float | None]]
"""Name, colour, and the figure."""

UPPER: tuple[Error, ...] = (
    ("nominal", ASIDE, lambda of: of.nominal),
    ("plain, fitted data", PREDICTED, lambda of: of.plain),
    ("plain, held out", MEASURED, lambda of: of.held_out),
)
LOWER: tuple[Error, ...] = (
    ("χ² per degree of freedom", "#1f9d61", lambda of: of.chi2_per_dof),
    ("z² of the tolerances over what is due", "#9a6fd0", lambda of: of.z2_over_due),
)

LONGEST = 28
"""Letters of a name below the axis before it is cut."""


def falling_errors(at: Standing, *, dark: bool = False) -> Figure:
    """The way from the first rung to that on which the model stands; branches as open circles at their depth.

    A click tells the number of the rung as `customdata`.
    """
    from plotly.subplots import make_subplots

    figure = make_subplots(rows=2, cols=1, shared_xaxes=True, row_heights=[0.62, 0.38], vertical_spacing=0.06)
    way = way_to(at)
    aside = [one for one in at.ladder.rungs if one not in way]
    for row, group in ((1, UPPER), (2, LOWER)):
        for name, colour, tell in group:
            _line(figure, row, name, colour, tell, way, lambda one: way.index(one))
            _line(figure, row, name, colour, tell, aside, lambda one: len(at.ladder.path(one.number)) - 1, aside=True)
    names = [f"{one.number}  {escaped(_cut(one.title))}" for one in way]
    depth = max((len(at.ladder.path(one.number)) for one in at.ladder.rungs), default=1)
    figure.update_xaxes(tickvals=list(range(len(names))), ticktext=names, range=[-0.35, max(depth - 1, 1) + 0.35])
    for row, (group, title) in enumerate(((UPPER, "error [%]"), (LOWER, "all fitted [1]")), start=1):
        figure.update_yaxes(title_text=title, **_range(at, group), row=row, col=1)
    figure.add_hline(1.0, line={"dash": "dash", "width": 1}, row=2, col=1)
    for k, one in enumerate(way[1:], start=1):
        if one.gain is not None:
            said = f"{one.gain:+.0f} nats"
            figure.add_annotation(x=k - 0.5, y=1, yref="paper", yanchor="bottom", text=said, showarrow=False, font={"size": 11})
    return dressed(
        figure,
        "Errors from rung to rung",
        500,
        dark,
        legend=legend_above(0.05),
        margin={"t": TITLE_ROOM + LEGEND_ROOM + 24, "b": 40},
    )


def way_to(at: Standing) -> tuple[Rung, ...]:
    """From the first rung to the one on which the model stands, or from which it was edited."""
    return () if at.below is None else at.ladder.path(at.below.number)


def _line(
    figure: Figure,
    row: int,
    name: str,
    colour: str,
    tell: Callable[[Errors], float | None],
    rungs: Sequence[Rung],
    depth: Callable[[Rung], int],
    *,
    aside: bool = False,
) -> None:
    """One error on some rungs; none where it is not known."""
    from plotly import graph_objects as go

    seen = [(depth(one), value, one) for one in rungs if one.errors is not None and (value := tell(one.errors))]
    if not seen:
        return
    group = UPPER if row == 1 else LOWER
    places = [_beside(value, one, group) for _, value, one in seen]
    symbol = {"symbol": "circle-open", "size": 8} if aside else {"symbol": "circle", "size": 9}
    figure.add_trace(
        go.Scatter(
            x=[at for at, _, _ in seen],
            y=[value for _, value, _ in seen],
            customdata=[one.number for _, _, one in seen],
            text=[f"{value:.3g}" for _, value, _ in seen],
            hovertext=[escaped(f"rung {one.number}, {one.title}: {value:.4g}") for _, value, one in seen],
            hovertemplate=f"{name}<br>%{{hovertext}}<extra></extra>",
            mode="markers" if aside else "lines+markers+text",
            textposition=places,
            cliponaxis=False,
            name=name,
            legendgroup=name,
            showlegend=not aside,
            marker={"color": colour, **symbol},
            line={"color": colour, "width": 2.2},
        ),
        row,
        1,
    )


def _beside(value: float, rung: Rung, group: Sequence[Error]) -> str:
    """Where a figure stands: of the greatest above its point, of the least below, of what is between to the right."""
    known = [one for _, _, tell in group if rung.errors is not None and (one := tell(rung.errors)) is not None]
    return "top center" if value >= max(known) else "bottom center" if value <= min(known) else "middle right"


def _range(at: Standing, group: Sequence[Error]) -> dict[str, Any]:
    """Of the axis, with room for figures above and below."""
    told = [tell(one.errors) for one in at.ladder.rungs if one.errors is not None for _, _, tell in group]
    sizes = [one for one in told if one is not None and one > 0] or [1.0]
    low, high = log10(min(sizes)), log10(max(sizes))
    room = 0.22 * max(high - low, 0.4)
    return decades(low - room, high + room)


def _cut(text: str) -> str:
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 1]}…"
