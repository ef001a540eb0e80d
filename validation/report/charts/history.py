"""Pictures of a ladder of models: the errors falling from rung to rung, and identified inertia on its way to the reference."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import log10
from pathlib import Path
from typing import Any

import numpy as np

from geometry.frames import Array
from identification.quality import sizes
from validation.history.history import Body, HistoryPosition, Version
from validation.output import significant
from validation.reference.statement import COG, QUANTITIES, inertia_of
from validation.report.charts import interactive, static
from validation.report.charts.figure import Figure
from validation.report.charts.interactive import LEGEND_ROOM, TITLE_ROOM, decades, dressed, escaped, legend_above
from validation.report.charts.spec import ASIDE, COLOURS, FAINT, FURTHER, INK, PAPER, PREDICTED, IntervalChart, Intervals
from validation.report.charts.static import DPI, Axes, cut, finish, grid_lines, new_figure

BRANCH = "#c9ced6"
"""Of what branched off, in print."""

LONGEST = 28
"""Letters of a name below the axis of a page, before it is cut."""


@dataclass(frozen=True, kw_only=True)
class DrawnRung:
    """One rung of a ladder, as both the file and the page show it.

    Attributes
    ----------
    number, parent : of the rungs; None for the first
    title : what was added
    depth : rungs between it and the first
    here : whether the way from the first rung to the current one leads over it
    errors : by name, NaN where there is none; one that is 0 stands below all others, which have a logarithmic axis
    zeros : names of those that are
    gain : evidence over the parent [nats]; None where it is not known
    """

    number: int
    parent: int | None
    title: str
    depth: int
    here: bool
    errors: Mapping[str, float]
    gain: float | None
    zeros: frozenset[str] = frozenset()

    def said(self, name: str, digits: int) -> str:
        """An error in words."""
        return "0" if name in self.zeros else significant(self.errors[name], digits)


PERCENT = {"nominal": ASIDE, "plain": PREDICTED, "held out": "held out"}
FITTED = {"chi² per deg. of freedom": FURTHER, "sum z² over what is due": "prior penalty"}
"""The errors of the upper and of the lower panel, and their roles."""

ON_PAGE = {
    "plain": "plain, fitted data",
    "held out": "plain, only for checking",
    "chi² per deg. of freedom": "χ² per degree of freedom",
    "sum z² over what is due": "z² of the tolerances over what is due",
}
"""What a page says in other words than a file."""

NAMED = ("held out", "sum z² over what is due")
"""The errors at which branches have their names."""

BELOW = ("plain", "sum z² over what is due")
"""Those whose figures stand below and to the left of their points, out of the way of the others'."""

LINE = 10.5
"""[points] between two labels, one above the other."""


def draw_fall(title: str, rungs: Sequence[DrawnRung], path: Path, note: str = "") -> None:
    """Write how the four errors fall along the way to the current rung; branches are thin.

    Raises
    ------
    BadInput : the ending of `path` is unknown.
    """
    deepest = max(one.depth for one in rungs)
    figure = new_figure(max(11.0, 5.5 + 1.5 * deepest), 9.4)
    grid = figure.add_gridspec(2, 1, height_ratios=(1.7, 1), hspace=0.1, left=0.085, right=0.78, top=0.9, bottom=0.18)
    upper = figure.add_subplot(grid[0])
    lower = figure.add_subplot(grid[1], sharex=upper)
    for axes, shown in ((upper, PERCENT), (lower, FITTED)):
        for name, role in shown.items():
            _way(axes, rungs, name, COLOURS[role][0])
        from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

        axes.set_yscale("log")
        low, high = axes.get_ylim()
        axes.set_ylim(low * (low / high) ** 0.17, high * (high / low) ** 0.1)  # room for figures and names
        axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axes.yaxis.set_minor_formatter(NullFormatter())
        grid_lines(axes)
        axes.legend(fontsize=9.5, loc="upper left", bbox_to_anchor=(1.01, 1.0), borderaxespad=0.0, frameon=False)
    upper.set_ylabel("error of the judged channels [%]", fontsize=10)
    lower.set_ylabel("all tolerances fitted", fontsize=10)
    lower.axhline(1.0, color=FAINT, linewidth=0.9, linestyle=(0, (5, 3)), zorder=1)
    upper.tick_params(labelbottom=False)
    for one in rungs:
        if one.here and one.parent is not None and one.gain is not None and np.isfinite(one.gain):
            above: dict[str, Any] = {"transform": upper.get_xaxis_transform(), "ha": "center", "fontsize": 9, "color": INK}
            upper.text(one.depth - 0.5, 1.015, f"{one.gain:+.0f} nats", **above)
    way = [one for one in rungs if one.here]
    names = [f"{one.number}  {cut(one.title)}" for one in way]
    lower.set_xticks([one.depth for one in way], names, rotation=18, ha="right", rotation_mode="anchor")
    lower.tick_params(axis="x", labelsize=9.5)
    lower.set_xlim(-0.4, max(deepest, 1) + 0.8)
    for axes, shown in ((upper, PERCENT), (lower, FITTED)):
        # Figures of the way beside their points, names of branches to the right of theirs, none upon another
        for depth in sorted({one.depth for one in rungs}):
            there = [one for one in rungs if one.depth == depth]
            found = [label for name, role in shown.items() for label in _of_one(axes, there, name, COLOURS[role][0], shown)]
            for align, beside in (("left", 7.0), ("right", -6.0)):
                _write(axes, depth, [one for one in found if one.align == align], beside)
    finish(figure, title, note, path)


def _way(axes: Axes, rungs: Sequence[DrawnRung], name: str, colour: str) -> None:
    """One error: the way to the current rung strong, what branches off faint."""
    by_number = {one.number: one for one in rungs}
    for one in rungs:
        parent = None if one.parent is None else by_number[one.parent]
        if parent is not None and not one.here and np.isfinite([one.errors[name], parent.errors[name]]).all():
            axes.plot([parent.depth, one.depth], [parent.errors[name], one.errors[name]], color=BRANCH, linewidth=1.1, zorder=2)
        if not one.here and np.isfinite(one.errors[name]):
            axes.plot(one.depth, one.errors[name], marker="o", markersize=5, color=PAPER, markeredgecolor=colour, zorder=3)
    way = [one for one in rungs if one.here and np.isfinite(one.errors[name])]
    look: dict[str, Any] = {"color": colour, "marker": "o", "markersize": 7, "linewidth": 2.2, "markeredgecolor": PAPER}
    axes.plot([one.depth for one in way], [one.errors[name] for one in way], label=name, zorder=4, **look)


@dataclass(frozen=True, kw_only=True)
class _Label:
    """A text at the point at `value`, `apart` from its `height` [points]; aligned "left" it stands to the right of it."""

    text: str
    value: float
    height: float
    apart: float
    align: str
    colour: str


def _of_one(axes: Axes, rungs: Sequence[DrawnRung], name: str, colour: str, shown: Iterable[str]) -> Iterator[_Label]:
    """Labels of one error at one depth, where no line of the way runs through them.

    A figure stands below its point where another's is close above, a branch upon the way is named below it.
    """

    def height_of(one: DrawnRung, error: str) -> float:
        return float(axes.transData.transform((one.depth, one.errors[error]))[1]) * 72 / DPI

    told = [one for one in rungs if np.isfinite(one.errors[name])]
    heights = [height_of(one, name) for one in told]
    beside = [(one, each) for one in rungs if one.here for each in shown if each != name]
    others = [height_of(one, each) for one, each in beside if np.isfinite(one.errors[each])]
    on_way = [height for one, height in zip(told, heights, strict=True) if one.here]
    for one, height in zip(told, heights, strict=True):
        value = one.errors[name]
        if one.here:
            below = name in BELOW or any(0 <= other - height < 2 * LINE for other in others)
            place: dict[str, Any] = {"align": "right", "apart": -LINE} if below else {"align": "left", "apart": LINE}
            yield _Label(text=one.said(name, 3), value=value, height=height, colour=colour, **place)
            continue
        upon = any(abs(height - way) < LINE / 1.5 for way in on_way)
        if name in NAMED or (name in FITTED and not upon):
            place = {"align": "right", "apart": -2 * LINE - height + on_way[0]} if upon else {"align": "left", "apart": 0.0}
            yield _Label(text=f"{one.number}  {cut(one.title)}", value=value, height=height, colour=FAINT, **place)


def _write(axes: Axes, depth: int, labels: Sequence[_Label], beside: float) -> None:
    """Labels beside their points, in the order of these, farther apart where they would meet."""
    from matplotlib.patheffects import withStroke

    upwards = sorted(labels, key=lambda one: one.height + min(one.apart, 0.0))
    placed = spread([one.height + one.apart for one in upwards], LINE)
    for one, place in zip(upwards, placed, strict=True):
        look = _SMALL | {"color": one.colour, "ha": one.align, "va": "center", "zorder": 6}
        text = axes.annotate(one.text, (depth, one.value), xytext=(beside, place - one.height), **look)
        text.set_path_effects([withStroke(linewidth=2, foreground=PAPER)])


def spread(heights: Sequence[float], gap: float) -> Array:
    """`heights` (n,) moved apart, so that each is at least `gap` above the one before, by the least squares of the moves.

    Less their rank times `gap` they then rise only: adjacent violators are pooled (Ayer et al., Annals of Mathematical
    Statistics 26, 1955).
    """
    pools: list[list[float]] = []
    for rank, height in enumerate(heights):
        pools.append([height - rank * gap])
        while len(pools) > 1 and np.mean(pools[-2]) > np.mean(pools[-1]):
            pools[-2:] = [pools[-2] + pools[-1]]
    means = [float(np.mean(pool)) for pool in pools for _ in pool]
    return np.asarray(means + gap * np.arange(len(means)), dtype=np.float64)


_SMALL: dict[str, Any] = {"textcoords": "offset points", "fontsize": 8.5}


def intervals_of(bodies: Mapping[str, Body], title: str, note: str = "") -> IntervalChart:
    """Ten identified values of `bodies` with their 95 % intervals, each beside its own reference.

    Parameters
    ----------
    bodies : by name - plain and self-calibrated, or rungs of a ladder
    """
    per_si = np.array([one.per_si for one in QUANTITIES])
    found = []
    for name, body in bodies.items():
        size = sizes(inertia_of(body.reference))
        size[COG] = 0.1
        one = Intervals(
            name=name,
            values=per_si * body.values,
            half_width=per_si * body.half_width,
            reference=per_si * body.reference,
            deviation=body.shown,
            reach=100 * body.half_width / size,  # in the units in which `Body.shown` tells distances
        )
        found.append(one)
    quantities = tuple((one.label, one.unit) for one in QUANTITIES)
    return IntervalChart(title=title, note=note, quantities=quantities, groups=PANELS, bodies=tuple(found))


PANELS = {"mass and moments [%]": (0, 4, 5, 6), "CoG [mm]": (1, 2, 3), "products [% of √(Θii Θjj)]": (7, 8, 9)}
"""What shares a unit, by number in `QUANTITIES`."""


def identified_inertia(bodies: Mapping[str, Body], title: str = "", *, dark: bool = False) -> Figure:
    """Distance of ten identified values from their reference, with 95 % intervals."""
    chart = intervals_of(bodies, title or "Identified inertia beside its reference, 95 % intervals")
    return interactive.intervals(chart, dark)


def way_to(at: HistoryPosition) -> tuple[Version, ...]:
    """From the first rung to the one on which the model stands, or from which it was edited."""
    return () if at.below is None else at.ladder.path(at.below.number)


def draw(at: HistoryPosition, folder: Path) -> list[Path]:
    """Write the falling errors, and for every article the way of its inertia, into `folder`; the files.

    Raises
    ------
    OSError : they cannot be written.
    """
    found: list[Path] = []
    name, way = at.path.stem, way_to(at)
    if any(one.errors for one in at.ladder.rungs):
        found.append(folder / f"{name}-ladder.png")
        note = "Strong: the way to the rung on which the model stands. Thin: branches. Above: evidence that a rung gained."
        note += " 0: what noise makes." if any(one.zeros for one in _rungs(at)) else ""
        draw_fall(f"{at.path.name}: errors from rung to rung", _rungs(at), found[-1], note)
    note = (
        "CoG from the article's own origin; moments and products about the CoG. "
        "The reference is the model with the effects of each rung."
    )
    for article in dict.fromkeys(body.article for one in way for body in one.bodies):
        bodies = {f"{one.number}  {one.title}": body for one in way for body in one.bodies if body.article == article}
        found.append(folder / f"{name}-ladder-{article.replace('+', '-')}.png")
        static.draw_intervals(intervals_of(bodies, f"{article}: identified inertia", note), found[-1])
    return found


ZERO = 0.4
"""Share of the least percentage at which one of 0, of nothing but noise, is drawn."""


def _rungs(at: HistoryPosition) -> list[DrawnRung]:
    """What both the picture and the figure show."""
    way = {one.number for one in way_to(at)}
    judged = {one.number: one.errors for one in at.ladder.rungs if one.errors is not None}
    percents = [size for of in judged.values() for size in (of.nominal, of.plain, of.held_out) if size]
    found = []
    for one in at.ladder.rungs:
        of = judged.get(one.number)
        told = (None,) * 5 if of is None else (of.nominal, of.plain, of.held_out, of.chi2_per_dof, of.z2_over_due)
        sizes = dict(zip((*PERCENT, *FITTED), told, strict=True))
        zeros = frozenset(name for name in PERCENT if sizes[name] == 0 and percents)
        errors = {name: ZERO * min(percents) if name in zeros else size or np.nan for name, size in sizes.items()}
        place: dict[str, Any] = {"depth": len(at.ladder.path(one.number)) - 1, "here": one.number in way, "zeros": zeros}
        found.append(DrawnRung(number=one.number, parent=one.parent, title=one.title, errors=errors, gain=one.gain, **place))
    return found


# The errors of a model falling from rung to rung, on a page.


def falling_errors(at: HistoryPosition, *, dark: bool = False) -> Figure:
    """The way from the first rung to that on which the model stands; branches as open circles at their depth.

    A click tells the number of the rung as `customdata`.
    """
    rungs = _rungs(at)
    figure = Figure(rows=2, heights=(0.62, 0.38), vertical=0.06, shared=True)
    way = sorted((one for one in rungs if one.here), key=lambda one: one.depth)
    for row, (group, title) in enumerate(((PERCENT, "error [%]"), (FITTED, "all fitted [1]")), start=1):
        for name in group:
            _line(figure, row, name, way, group)
            _line(figure, row, name, [one for one in rungs if not one.here], group, aside=True)
        known = [one.errors[name] for one in rungs for name in group if np.isfinite(one.errors[name])] or [1.0]
        low, high = log10(min(known)), log10(max(known))
        room = 0.22 * max(high - low, 0.4)  # for figures above and below
        wide = (2.6, 1.5)[row - 1]  # the lower one is half as high
        figure.up(title={"text": title}, **decades(low - room, high + room, wide), row=row, column=1)
    names = [f"{one.number}  {escaped(cut(one.title, LONGEST, '…'))}" for one in way]
    deepest = max((one.depth for one in rungs), default=0)
    figure.across(tickvals=list(range(len(names))), ticktext=names, range=[-0.35, max(deepest, 1) + 0.35])
    figure.rule(y=1.0, dash="dash", width=1, row=2, column=1)
    for k, one in enumerate(way[1:], start=1):
        if one.gain is not None:
            said = f"{one.gain:+.0f} nats"
            figure.note(x=k - 0.5, y=1, yref="paper", yanchor="bottom", text=said, font={"size": 11})
    margin = {"t": TITLE_ROOM + LEGEND_ROOM + 24, "b": 40}
    return dressed(figure, "Errors from rung to rung", 500, dark, legend=legend_above(0.05), margin=margin)


def _line(
    figure: Figure, row: int, error: str, rungs: Sequence[DrawnRung], group: Mapping[str, str], *, aside: bool = False
) -> None:
    """One error on some rungs; none where it is not known."""
    seen = [(one, one.errors[error]) for one in rungs if np.isfinite(one.errors[error])]
    if not seen:
        return
    places = []  # of figures: of the greatest above its point, of the least below, of what is between to the right
    for one, value in seen:
        known = [one.errors[name] for name in group if np.isfinite(one.errors[name])]
        places.append("top center" if value >= max(known) else "bottom center" if value <= min(known) else "middle right")
    name, colour = ON_PAGE.get(error, error), COLOURS[group[error]][1]
    symbol = {"symbol": "circle-open", "size": 8} if aside else {"symbol": "circle", "size": 9}
    points = {
        "type": "scatter",
        "x": [one.depth for one, _ in seen],
        "y": [value for _, value in seen],
        "customdata": [one.number for one, _ in seen],
        "text": [one.said(error, 3) for one, _ in seen],
        "hovertext": [escaped(f"rung {one.number}, {one.title}: {one.said(error, 4)}") for one, _ in seen],
        "hovertemplate": f"{name}<br>%{{hovertext}}<extra></extra>",
        "mode": "markers" if aside else "lines+markers+text",
        "textposition": places,
        "cliponaxis": False,
        "name": name,
        "legendgroup": name,
        "showlegend": not aside,
        "marker": {"color": colour, **symbol},
        "line": {"color": colour, "width": 2.2},
    }
    figure.add(points, row=row)
