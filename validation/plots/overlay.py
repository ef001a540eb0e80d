"""Measured and predicted dynamic mass over frequency: magnitude above phase, any of the 36 entries."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray
from validation.comparing.modes import NamedMode
from validation.comparing.pairs import Pairs
from validation.plots.theme import (
    ASIDE,
    FURTHER,
    LEGEND_ROOM,
    MEASURED,
    PREDICTED,
    THRESHOLD,
    TITLE_ROOM,
    decades,
    dressed,
    escaped,
    legend_above,
)

if TYPE_CHECKING:
    from plotly.graph_objects import Figure

SIGNS = ("x", "y", "z", "α", "β", "γ")
"""Of loads and of base motions."""

LOADS = ("force along x", "force along y", "force along z", "moment about x", "moment about y", "moment about z")
MOTIONS = tuple(f"{kind} {axis}" for kind in ("acceleration along", "angular acceleration about") for axis in "xyz")

UNITS = ("kg", "kg m", "kg m²")
"""By how many of load and motion are about an axis."""

DEEPEST = 1e5
"""Of the largest magnitude; what is smaller is off the page."""

WIDE = 2.0
"""Standard deviations of the band about the prediction."""

NONE: Mapping[str, ComplexArray] = MappingProxyType({})


def entry(load: int, motion: int) -> str:
    """ "H xβ": the name of an entry."""
    return f"H {SIGNS[load]}{SIGNS[motion]}"


def unit(load: int, motion: int) -> str:
    """Of an entry."""
    return UNITS[(load > 2) + (motion > 2)]


def overlay(
    pairs: Pairs,
    load: int,
    motion: int,
    *,
    modes: Sequence[NamedMode] = (),
    further: Mapping[str, ComplexArray] = NONE,
    marked: float | None = None,
    dark: bool = False,
) -> Figure:
    """One entry of the blocked dynamic mass about F: measured as dots, predicted as a line, what is expected as a band.

    Parameters
    ----------
    pairs : both, of one campaign
    load, motion : 0 to 5 in the order of `geometry.dynamic_mass.MOTIONS`
    modes : of the model, marked above
    further : by name, more predictions (n, 6, 6) on the lines of `pairs`: with an effect, or before it was added
    marked : [Hz] where a line is drawn
    """
    from plotly import graph_objects as go
    from plotly.subplots import make_subplots

    figure = make_subplots(rows=2, cols=1, shared_xaxes=True, row_heights=[0.68, 0.32], vertical_spacing=0.04)
    f, measured, predicted = pairs.frequency, pairs.measured[:, load, motion], pairs.predicted[:, load, motion]
    others = {name: matrix[:, load, motion] for name, matrix in further.items()}
    low, high = magnitude_range([measured, predicted, *others.values()])
    figure.add_traces(_band(go, f, predicted, pairs.expected[:, load, motion], 10**low), rows=1, cols=1)
    named = [("measured, Eqs. 9 to 11", measured, {"mode": "markers", "marker": {"color": MEASURED, "size": 5}})]
    named += [("predicted", predicted, {"mode": "lines", "line": {"color": PREDICTED, "width": 2}})]
    named += [(name, H, _further(k)) for k, (name, H) in enumerate(others.items())]
    for name, H, look in named:
        said = {"name": escaped(name), "legendgroup": name, **look, **_lines(f)}
        figure.add_trace(go.Scatter(y=_short(np.abs(H)), hovertemplate=f"%{{y:.4g}} {unit(load, motion)}", **said), 1, 1)
        phase = go.Scatter(y=_short(np.degrees(np.angle(H))), hovertemplate="%{y:.1f}°", showlegend=False, **said)
        figure.add_trace(phase, 2, 1)
    if inside := [one for one in modes if f[0] <= one.frequency <= f[-1]]:
        figure.add_trace(_modes(go, inside, 10**high), 1, 1)
    figure.update_xaxes(range=[float(f[0]), float(f[-1])])
    figure.update_xaxes(title_text="frequency [Hz]", row=2, col=1)
    figure.update_yaxes(title_text=f"|H| [{unit(load, motion)}]", **decades(low, high), row=1, col=1)
    figure.update_yaxes(title_text="phase [°]", range=[-190, 190], tickvals=[-180, -90, 0, 90, 180], row=2, col=1)
    if marked is not None:
        figure.add_vline(marked, line={"color": THRESHOLD, "width": 1.5, "dash": "dash"})
    title = f"{entry(load, motion)} of {pairs.campaign}: {LOADS[load]} by {MOTIONS[motion]}"
    held = f"{pairs.campaign} {load} {motion}"
    return dressed(
        figure,
        title,
        470,
        dark,
        legend=legend_above(),
        hovermode="x unified",
        uirevision=held,
        margin={"t": TITLE_ROOM + LEGEND_ROOM},
    )


def magnitude_range(curves: Sequence[ComplexArray]) -> tuple[float, float]:
    """Powers of ten between which the magnitudes of `curves` are shown, the smallest not below `DEEPEST` of the largest."""
    sizes = np.abs(np.concatenate(curves))
    sizes = sizes[np.isfinite(sizes) & (sizes > 0)]
    if not sizes.size:
        return -1.0, 1.0
    top = float(sizes.max())
    bottom = max(float(sizes.min()), top / DEEPEST)
    return float(np.log10(bottom)) - 0.08, float(np.log10(top)) + 0.12


def _band(go: Any, f: Array, H: ComplexArray, expected: Array, bottom: float) -> list[Any]:
    """Where noise and tolerances that were not fitted let expect what is measured."""
    size = np.abs(H)
    look = {"mode": "lines", "line": {"width": 0}, "hoverinfo": "skip", **_lines(f)}
    low = go.Scatter(y=_short(np.maximum(size - WIDE * expected, bottom)), showlegend=False, legendgroup="expected", **look)
    name = "expected, 95 %"
    fill = {"fill": "tonexty", "fillcolor": "rgba(59,125,221,0.18)", "name": name, "legendgroup": "expected"}
    return [low, go.Scatter(y=_short(size + WIDE * expected), **fill, **look)]


def _further(k: int) -> dict[str, Any]:
    return {"mode": "lines", "line": {"color": (FURTHER, ASIDE)[k % 2], "width": 2, "dash": ("dash", "dot")[k // 2 % 2]}}


def _modes(go: Any, modes: Sequence[NamedMode], height: float) -> Any:
    return go.Scatter(
        x=[one.frequency for one in modes],
        y=[height] * len(modes),
        text=[escaped(one.name) for one in modes],
        mode="markers",
        marker={"symbol": "triangle-down", "size": 10, "color": ASIDE},
        cliponaxis=False,
        name="modes of the model",
        hovertemplate="%{text}, %{x:.2f} Hz<extra></extra>",
    )


def _lines(f: Array) -> dict[str, Any]:
    """Frequencies as a first one and a step where they are even, which is shorter."""
    steps = np.diff(f)
    if len(f) > 2 and np.allclose(steps, steps[0], rtol=1e-6):
        return {"x0": float(f[0]), "dx": float((f[-1] - f[0]) / (len(f) - 1))}
    return {"x": f}


def _short(values: Array) -> Any:
    """Single precision: six digits are more than a figure shows."""
    return np.asarray(values, dtype=np.float32)
