"""Bars: the four errors of a comparison, a diagnosis with its causes and the errors before and after, explanations of numbers."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from validation.compare.compare import Comparison
from validation.diagnose import diagnosis
from validation.diagnose.diagnosis import Cause, Diagnosis
from validation.effects.effect import evidence_threshold
from validation.estimation.problem import Evaluation, Share
from validation.estimation.verdicts import MISFIT, absurd, expected_z2, misfit
from validation.output import nats
from validation.report.charts import interactive, spec, static
from validation.report.charts.figure import Figure

SHARES: tuple[tuple[str, Callable[[Evaluation], Share | None]], ...] = (
    ("nominal", lambda of: of.nominal),
    ("plain", lambda of: of.plain),
    ("plain, held out", lambda of: of.held_out),
    ("a configuration never seen", lambda of: of.held_out_configurations),
)
PER_CENT = "per cent of what was measured"
"""Forces of a base test, answers or modes of a structure's."""

CHI2 = "chi² per degree of freedom"


def errors_of(found: Comparison, *, never_seen: bool = False) -> spec.BarChart:
    """Nominal, plain and held-out error in per cent, with what is expected of them; chi² and z² over what is due.

    Parameters
    ----------
    never_seen : with the error of a configuration never seen, which is not judged
    """
    verdicts = dict(zip(("nominal", "plain", "fitted", "plain, held out"), (one.verdict for one in found.errors), strict=True))
    names, sizes = _shares(found.evaluation)
    names = names if never_seen else names[:3]
    rows = tuple("held out, plain" if name == "plain, held out" else name for name in names)
    percents = spec.Bars(
        name="errors",
        rows=rows,
        values=sizes[: len(rows)],
        words=tuple(f"{size:.3g} %" for size in sizes[: len(rows)]),
        roles=tuple(verdicts.get(name, spec.NOT_JUDGED) for name in names),
    )
    fit = found.evaluation.fitted
    ratios = (misfit(fit), prior_penalty(found.evaluation))
    prices = spec.Bars(
        name="fitted",
        rows=(CHI2, "z² of the tolerances"),
        values=ratios,
        words=tuple(f"{ratio:.3g}" for ratio in ratios),
        roles=tuple("failed" if wrong else "good" for wrong in (misfit(fit) > MISFIT, absurd(fit))),
    )
    due = "times what is expected where nothing is wrong"
    return spec.BarChart(
        title=f"{found.title}: the four errors",
        note=f"Fitted: {found.errors[2].text}.",
        panels=(
            spec.BarPanel(label=PER_CENT, rows=rows, bars=(percents,), limit=found.explained.measurement, least=1.0),
            spec.BarPanel(label=due, rows=prices.rows, bars=(prices,), limit=1.0, least=1.0),
        ),
        legend={verdict: verdict or "not judged" for verdict in spec.VERDICTS},
        limit="expected, nothing wrong",
        on_page={"held out, plain": "only for checking"},
    )


def _shares(of: Evaluation) -> tuple[tuple[str, ...], tuple[float, ...]]:
    """Names and per cent of the errors that are known."""
    found = [(name, share.percent) for name, tell in SHARES if (share := tell(of)) is not None]
    names, sizes = zip(*found, strict=True)
    return names, sizes


def prior_penalty(of: Evaluation) -> float:
    """Sum of z² of the tolerances over what is due where nothing is wrong."""
    return of.fitted.tolerance_z2 / max(expected_z2(of.fitted), 1.0)


def draw_errors(chart: spec.BarChart, path: Path) -> None:
    """Write the errors and, below them, chi² and z².

    Raises
    ------
    BadInput : the ending of `path` is unknown.
    """
    room = {"left": 0.19, "right": 0.975, "top": 0.85, "bottom": 0.14, "hspace": 0.55}
    legend = {"loc": "upper right", "bbox_to_anchor": (0.985, 0.914)}
    static.draw_bars(chart, path, size=(12.0, 6.4), room=room, legend=legend, thickness=0.62, further=1.12, lettering=8.5)


def four_errors(found: Comparison) -> Figure:
    """The errors alone, coloured by their verdicts, and what is expected as a line."""
    chart = errors_of(found, never_seen=True)
    panel, _ = chart.panels
    (one,) = panel.bars
    figure = Figure(interactive.bars(one, chart, hovertemplate="%{y}: %{text}<extra></extra>"))
    figure.up(autorange="reversed", showgrid=False, automargin=True)
    figure.across(title={"text": panel.label}, range=[0, 1.18 * max(1e-9, *one.values)])
    figure.rule(x=panel.limit, dash="dash", width=1.5)
    place: dict[str, Any] = {"x": panel.limit, "xref": "x", "xanchor": "left", "y": 1, "yref": "y domain", "yanchor": "bottom"}
    figure.note(text=f"expected: {panel.limit:.2g} %", **place)
    return interactive.dressed(figure, "The errors of the model", 130 + 42 * len(one.rows), False, margin={"t": 66})


def changes_of(
    before: Evaluation, after: Evaluation | None, title: str = "Errors before and after", note: str = ""
) -> spec.BarChart:
    """The errors, and chi² and the prior penalty over what is due, before and after an effect is added."""
    percents, prices = [], []
    for name, of in ((spec.BEFORE, before), (spec.AFTER, after)):
        if of is None:
            continue
        names, sizes = _shares(of)
        words = tuple(f"{size:.3g} %" for size in sizes)
        percents.append(spec.Bars(name=name, rows=names, values=sizes, words=words, roles=name))
        ratios = (misfit(of.fitted), prior_penalty(of))
        words = tuple(f"{ratio:.3g}" for ratio in ratios)
        prices.append(spec.Bars(name=name, rows=(CHI2, "sum z² of the tolerances"), values=ratios, words=words, roles=name))
    due = "times what is due where nothing is wrong, logarithmic"
    return spec.BarChart(
        title=title,
        note=note,
        panels=(
            spec.BarPanel(label=PER_CENT, rows=percents[0].rows, bars=tuple(percents)),
            spec.BarPanel(label=due, rows=prices[0].rows, bars=tuple(prices), scale=spec.LOG, limit=1.0),
        ),
        legend={} if after is None else {spec.BEFORE: spec.BEFORE, spec.AFTER: spec.AFTER},
        limit="due, nothing wrong",
        on_page={
            "plain, held out": "only for checking",
            CHI2: "χ² per dof",
            "sum z² of the tolerances": "z² of tolerances",
            due: "over what is due, nothing wrong",
        },
    )


def before_and_after(before: Evaluation, after: Evaluation | None) -> Figure:
    """The same side by side, on axes that begin at nothing."""
    chart = changes_of(before, after)
    titles = [chart.on_page.get(one.label, one.label) for one in chart.panels]
    figure = Figure(columns=2, widths=(0.6, 0.4), horizontal=0.17, titles=titles)
    for pair in zip(*(panel.bars for panel in chart.panels), strict=True):
        for column, one in enumerate(pair, start=1):
            told = {"name": one.name, "legendgroup": one.name, "showlegend": column == 1}
            hover = f"%{{y}}, {one.name}: %{{text}}<extra></extra>"
            figure.add(interactive.bars(one, chart, hovertemplate=hover, **told), column=column)
    figure.up(autorange="reversed", showgrid=False, automargin=True)
    for column, (panel, least) in enumerate(zip(chart.panels, (1e-9, 1.5), strict=True), start=1):
        most = max(value for one in panel.bars for value in one.values)
        figure.across(range=[0, 1.3 * max(most, least)], row=1, column=column)
    figure.rule(x=1.0, dash="dash", width=1, row=1, column=2)
    legend = interactive.legend_above(0.17) | {"traceorder": "normal"}
    margin = {"t": interactive.TITLE_ROOM + interactive.LEGEND_ROOM + 26, "b": 40}
    return interactive.dressed(figure, chart.title, 350, False, legend=legend, margin=margin)


MOST = 10
"""Causes that are drawn."""

LEAST = 0.05
"""[nats] below which evidence is printed as none. By definition."""


def tried(found: Diagnosis) -> tuple[Cause, ...]:
    """What is drawn: what was accepted and what data speak for, each once, the best first."""
    known = {one.id for one in found.accepted}
    every = sorted({one.id: one for one in (*found.ranking, *found.accepted)}.values(), key=lambda one: -one.evidence)
    return tuple(one for one in every if one.id in known or one.evidence >= LEAST)[:MOST]


def standing_of(found: Diagnosis, one: Cause) -> str:
    """Of `STANDINGS`."""
    if one.id in {cause.id for cause in found.accepted}:
        return spec.ACCEPTED
    if one.id in found.equivalence_class:
        return spec.ALIKE
    return spec.LESS if one.null else spec.TOO_MUCH_LEFT


def causes_of(found: Diagnosis, title: str = "", note: str = "", threshold: float | None = None) -> spec.BarChart:
    """What was tried, the best on top: a bar a cause, by where it stands, its evidence and its size behind it.

    Parameters
    ----------
    threshold : [nats] from which an effect is accepted; None where it is not known
    """
    causes = tried(found)
    by_standing = {word: [one for one in causes if standing_of(found, one) == word] for word in spec.STANDINGS}
    bars = [
        spec.Bars(
            name=standing,
            rows=tuple(one.id for one in own),
            values=tuple(one.evidence for one in own),
            words=tuple(
                f"{nats(one.evidence)} nats   " + "; ".join(diagnosis.sized(one, size) for size in one.sizes[:1]) for one in own
            ),
            roles=standing,
            about=tuple(one.named.what for one in own),
        )
        for standing, own in by_standing.items()
        if own
    ]
    panel = spec.BarPanel(
        label="evidence [nats], logarithmic beyond 10",
        rows=tuple(one.id for one in causes),
        bars=tuple(bars),
        scale=spec.EVIDENCE,
        limit=threshold,
        asked=tuple(evidence_threshold(one.named.family) for one in causes),
    )
    legend = {one.name: one.name for one in bars}
    return spec.BarChart(title=title, note=note, panels=(panel,), legend=legend, limit="" if threshold is None else "asked for")


def evidence(found: Diagnosis, *, dark: bool = False) -> Figure:
    """The same on a page; a click tells the id of the cause as `y`."""
    return interactive.evidence(causes_of(found, "Evidence of each cause, with its size and 90 % interval"), dark)
