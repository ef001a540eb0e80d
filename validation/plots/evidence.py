"""Ranked causes as bars of evidence, each with its size and interval."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from geometry.arrays import Array
from validation.diagnosing import words
from validation.diagnosing.diagnosis import Cause, Diagnosis
from validation.diagnosing.drawn import tried
from validation.effects.worth import worth
from validation.plots.theme import LEGEND_ROOM, MEASURED, TITLE_ROOM, dressed, escaped, legend_above

if TYPE_CHECKING:
    from plotly.graph_objects import Figure

ACCEPTED, ALIKE, LESS, TOO_MUCH_LEFT = STANDINGS = ("accepted", "cannot be told from it", "explains less", "leaves too much")
COLOURS = dict(zip(STANDINGS, ("#3b7ddd", "#e0952b", "#97a1b0", "#c2476b"), strict=True))

LINEAR = 10.0
"""[nats] below which the axis is linear, and logarithmic beyond."""

TICKS = (-1000, -100, -10, -5, 0, 5, 10, 30, 100, 300, 1000, 3000, 10_000, 100_000, 1_000_000)


def evidence(found: Diagnosis, *, dark: bool = False) -> Figure:
    """What was tried, the best on top: a bar a cause in nats, coloured by where it stands, its size behind it.

    A click tells the id of the cause as `y`.
    """
    from plotly import graph_objects as go

    causes = tried(found)
    figure = go.Figure()
    for standing in STANDINGS:
        own = [one for one in causes if standing_of(found, one) == standing]
        if own:
            figure.add_trace(_bars(go, standing, own))
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
    asked = [worth(one.named.family) for one in causes]
    return go.Scatter(
        x=place(np.array(asked)),
        y=[escaped(one.id) for one in causes],
        customdata=asked,
        mode="markers",
        marker={"symbol": "line-ns", "size": 24, "line": {"width": 2.5, "color": MEASURED}},
        name="asked for",
        hovertemplate="%{customdata:g} nats are asked for<extra></extra>",
    )


def standing_of(found: Diagnosis, one: Cause) -> str:
    """Of `STANDINGS`."""
    if one.id in {cause.id for cause in found.accepted}:
        return ACCEPTED
    if one.id in found.equivalence_class:
        return ALIKE
    return LESS if one.null else TOO_MUCH_LEFT


def _bars(go: Any, standing: str, causes: Sequence[Cause]) -> Any:
    return go.Bar(
        name=standing,
        orientation="h",
        x=place(np.array([one.evidence for one in causes])),
        y=[escaped(one.id) for one in causes],
        marker={"color": COLOURS[standing]},
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
    return escaped(f"{one.evidence:+.1f} nats   " + "; ".join(words.sized(one, size) for size in one.sizes[:1]))
