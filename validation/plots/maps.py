"""Where a model fails, in sigmas over frequency: channels and loads of a run, or the 36 pairs of axes. A cell can be clicked.

A click tells the middle of its column as `x`, the name of its row as `y` (one of `labels` or of `PAIRS`), and as `customdata` the
worst of the lines that share the cell: [σ, its frequency in Hz].
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from geometry.arrays import Array
from validation.comparing.maps import Map
from validation.comparing.modes import NamedMode
from validation.comparing.pairs import Pairs
from validation.comparing.words import SENSED, run
from validation.plots.overlay import SIGNS
from validation.plots.theme import ASIDE, BOUNDS, dressed, escaped
from validation.plots.thinning import worst

if TYPE_CHECKING:
    from plotly.graph_objects import Figure

PAIRS = tuple(f"{load}{motion}" for load in SIGNS for motion in SIGNS)
"""Rows of a map of pairs: load, then base motion; entry 6 i + j of the 6 x 6."""

ROW, ROOM = 15, 130
"""Height of a row and of what is not rows [pixels]."""


def labels(of: Map) -> tuple[str, ...]:
    """Names of the rows of `of`, as its figure says them: channels by name, loads in words."""
    return tuple(SENSED.get(name, name) for name in of.rows)


def channel_map(of: Map, run_index: int | None = None, *, modes: Sequence[NamedMode] = (), dark: bool = False) -> Figure:
    """Channels and loads of one run over frequency; the worst of all runs where `run_index` is None.

    Cells of a row that nothing checks stay empty.
    """
    sigma = np.where(np.isfinite(of.expected), of.sigma, np.nan)
    chosen = np.fmax.reduce(sigma, axis=0) if run_index is None else sigma[run_index]
    where = "the worst of all runs" if run_index is None else run(of.runs[run_index], of.axes[run_index])
    title = f"{of.data_set}, {where}: channels and loads"
    return _map(title, of.frequency, chosen, labels(of), _rules(of), modes, dark)


def pair_map(pairs: Pairs, *, modes: Sequence[NamedMode] = (), dark: bool = False) -> Figure:
    """Predicted beside measured dynamic mass about F: load and base motion over frequency."""
    title = f"{pairs.campaign}: dynamic mass, load and base motion"
    sigma = pairs.sigma.reshape(len(pairs.frequency), 36)
    return _map(title, pairs.frequency, sigma, PAIRS, (6, 12, 18, 24, 30), modes, dark)


def levels(sigma: Array) -> Array:
    """Of each cell the place in the scale of colours, from 0 in steps of 1; NaN where it has none."""
    found = np.searchsorted(np.array(BOUNDS), np.nan_to_num(sigma), side="right") - 1.0
    return np.where(np.isnan(sigma), np.nan, found)


def _map(
    title: str,
    frequency: Array,
    sigma: Array,
    rows: Sequence[str],
    rules: Sequence[int],
    modes: Sequence[NamedMode],
    dark: bool,
) -> Figure:
    """`sigma` (n, m) over `frequency` (n,) and `rows`."""
    from plotly import graph_objects as go

    thin = worst(frequency, sigma)
    shown = [escaped(row) for row in rows]
    heat = go.Heatmap(
        x=np.asarray(thin.middle, dtype=np.float32),
        y=shown,
        z=np.asarray(levels(thin.values).T, dtype=np.float32),
        customdata=np.stack([thin.values.T, thin.at.T], axis=2).astype(np.float32),
        zmin=-0.5,
        zmax=len(BOUNDS) - 0.5,
        hoverongaps=False,
        hovertemplate="%{y}<br>%{customdata[1]:.2f} Hz: %{customdata[0]:.1f} σ<extra></extra>",
        colorbar=_bar(),
    )
    figure = go.Figure(heat)
    inside = [one for one in modes if frequency[0] <= one.frequency <= frequency[-1]]
    if inside:  # above the rows, on an axis of their own: a category without cells is more than a heat map bears
        figure.add_trace(_marks(go, inside))
        figure.update_layout(yaxis2={"overlaying": "y", "range": [0, 1], "visible": False, "fixedrange": True})
    for rule in rules:
        figure.add_hline(rule - 0.5, line={"width": 1})
    axis = {"type": "category", "categoryorder": "array", "categoryarray": shown, "range": [len(shown) - 0.5, -0.5], "ticks": ""}
    figure.update_layout(yaxis={"showgrid": False, "tickmode": "array", "tickvals": shown, "tickfont": {"size": 11}, **axis})
    figure.update_xaxes(title_text="frequency [Hz]", showgrid=False)
    height = ROOM + ROW * len(shown)
    return dressed(figure, title, height, dark, margin={"l": 118, "r": 10}, uirevision=escaped(title))


def _bar() -> dict[str, Any]:
    at = [k - 0.5 for k in range(len(BOUNDS))]
    return {
        "title": {"text": "σ"},
        "tickvals": at,
        "ticktext": [f"{bound:g}" for bound in BOUNDS],
        "thickness": 14,
        "len": 1.0,
        "outlinewidth": 1,
    }


def _marks(go: Any, modes: Sequence[NamedMode]) -> Any:
    return go.Scatter(
        x=[one.frequency for one in modes],
        y=[1.0] * len(modes),
        yaxis="y2",
        cliponaxis=False,
        text=[escaped(one.name) for one in modes],
        mode="markers",
        marker={"symbol": "triangle-down", "size": 9, "color": ASIDE},
        showlegend=False,
        hovertemplate="%{text}, %{x:.2f} Hz<extra></extra>",
    )


def _rules(of: Map) -> tuple[int, ...]:
    """Between the channels and the loads."""
    return (of.channels,) if of.channels < len(of.rows) else ()
