"""The four errors as bars: of a comparison, and before and after what was found is added."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from validation.comparing.comparison import Comparison
from validation.comparing.verdicts import DOUBTFUL, FAILED, GOOD, expected_z2, misfit
from validation.engine.evaluation import Evaluation, Share
from validation.plots.theme import ASIDE, LEGEND_ROOM, PREDICTED, TITLE_ROOM, dressed, legend_above

if TYPE_CHECKING:
    from plotly.graph_objects import Figure

SHARES: tuple[tuple[str, Callable[[Evaluation], Share | None]], ...] = (
    ("nominal", lambda of: of.nominal),
    ("plain", lambda of: of.plain),
    ("plain, held out", lambda of: of.held_out),
    ("a configuration never seen", lambda of: of.held_out_configurations),
)

VERDICTS = {"": ASIDE, GOOD: PREDICTED, DOUBTFUL: "#e0952b", FAILED: "#c2476b"}


def four_errors(found: Comparison, *, dark: bool = False) -> Figure:
    """Nominal, plain and held-out error in per cent, coloured by their verdicts, and what tolerances let expect as a line."""
    from plotly import graph_objects as go

    verdicts = dict(zip(("nominal", "plain", "fitted", "plain, held out"), (one.verdict for one in found.errors), strict=True))
    seen = [(name, share.percent) for name, tell in SHARES if (share := tell(found.evaluation)) is not None]
    names, sizes = [name for name, _ in seen], [size for _, size in seen]
    colours = [VERDICTS[verdicts.get(name, "")] for name in names]
    bars = go.Bar(
        orientation="h",
        x=sizes,
        y=names,
        marker={"color": colours},
        text=[f"{size:.3g} %" for size in sizes],
        textposition="outside",
        cliponaxis=False,
        hovertemplate="%{y}: %{text}<extra></extra>",
    )
    figure = go.Figure(bars)
    figure.update_yaxes(autorange="reversed", showgrid=False, automargin=True)
    figure.update_xaxes(title_text="per cent of the measured forces", range=[0, 1.18 * max(1e-9, *sizes)])
    expected = found.explained.measurement
    note = {"text": f"expected: {expected:.2g} %", "yanchor": "bottom", "y": 1, "xanchor": "left"}
    figure.add_vline(expected, line={"dash": "dash", "width": 1.5}, annotation=note)
    return dressed(figure, "The errors of the model", 130 + 42 * len(names), dark, margin={"t": 66})


def before_and_after(before: Evaluation, after: Evaluation | None, *, dark: bool = False) -> Figure:
    """The errors in per cent, and chi² and the price of the tolerances over what is due, before and after an effect is added."""
    from plotly import graph_objects as go
    from plotly.subplots import make_subplots

    titles = ("per cent of the measured forces", "over what is due, nothing wrong")
    figure = make_subplots(rows=1, cols=2, column_widths=[0.6, 0.4], horizontal_spacing=0.17, subplot_titles=titles)
    for name, of, colour in (("before", before, ASIDE), ("with what was found", after, PREDICTED)):
        if of is None:
            continue
        shares = [(label, share.percent) for label, tell in SHARES if (share := tell(of)) is not None]
        prices = [("χ² per dof", misfit(of.fitted)), ("z² of tolerances", price(of))]
        for column, told in ((1, shares), (2, prices)):
            labels, sizes = zip(*told, strict=True)
            unit = " %" if column == 1 else ""
            bars = go.Bar(
                name=name,
                orientation="h",
                x=sizes,
                y=labels,
                marker={"color": colour},
                text=[f"{size:.3g}{unit}" for size in sizes],
                textposition="outside",
                cliponaxis=False,
                legendgroup=name,
                showlegend=column == 1,
                hovertemplate=f"%{{y}}, {name}: %{{text}}<extra></extra>",
            )
            figure.add_trace(bars, 1, column)
    figure.update_yaxes(autorange="reversed", showgrid=False, automargin=True)
    _room(figure)
    figure.add_vline(1.0, line={"dash": "dash", "width": 1.5}, row=1, col=2)
    legend = legend_above(0.1) | {"traceorder": "normal"}
    return dressed(
        figure, "Errors before and after", 350, dark, legend=legend, margin={"t": TITLE_ROOM + LEGEND_ROOM + 26, "b": 40}
    )


def price(of: Evaluation) -> float:
    """Sum of z² of the tolerances over what is due where nothing is wrong."""
    return of.fitted.tolerance_z2 / max(expected_z2(of.fitted), 1.0)


def _room(figure: Figure) -> None:
    """For the figures behind the bars."""
    for column in (1, 2):
        own = [one for one in figure.data if one.xaxis == ("x" if column == 1 else "x2")]
        most = max((max(one.x) for one in own), default=1.0)
        figure.update_xaxes(range=[0, 1.3 * max(most, 1e-9 if column == 1 else 1.5)], row=1, col=column)
