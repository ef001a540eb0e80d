"""Condition number of Eqs. 9 to 11, line by line."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from validation.identifying.findings import Lines
from validation.plots.theme import ASIDE, PREDICTED, THRESHOLD, decades, dressed

if TYPE_CHECKING:
    from plotly.graph_objects import Figure


def condition(lines: Lines, name: str = "", *, dark: bool = False) -> Figure:
    """Scaled condition number of the base motions of all runs over frequency, its limit, and the lines that were left out.

    Parameters
    ----------
    name : of the campaign
    """
    from plotly import graph_objects as go

    kept = np.asarray(lines.kept) > 0
    said = f"condition number{' of ' + name if name else ''}"
    look = {"line": {"color": PREDICTED, "width": 1.8}, "hovertemplate": "%{x:.2f} Hz: %{y:.3g}<extra></extra>"}
    figure = go.Figure(go.Scatter(x=lines.frequency, y=lines.condition, mode="lines", name="condition number", **look))
    if not kept.all():
        out = {"mode": "markers", "marker": {"color": ASIDE, "size": 5}, "name": "left out"}
        figure.add_trace(go.Scatter(x=lines.frequency[~kept], y=lines.condition[~kept], **out))
    figure.add_hline(lines.limit, line={"dash": "dash", "color": THRESHOLD})
    note = {
        "text": f"limit {lines.limit:g}: worse lines are left out",
        "xanchor": "right",
        "yanchor": "bottom",
        "showarrow": False,
    }
    figure.add_annotation(x=1, xref="paper", y=float(np.log10(lines.limit)), **note)
    top = float(np.log10(3 * max(float(lines.condition.max()), lines.limit)))
    figure.update_yaxes(title_text="condition number [1]", **decades(0.0, top))
    figure.update_xaxes(title_text="frequency [Hz]")
    return dressed(figure, f"Eqs. 9 to 11: {said}", 310, dark, showlegend=False)
