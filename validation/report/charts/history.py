"""Pictures of a ladder of models: the errors falling from rung to rung, and identified inertia on its way to the reference."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import log10
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from geometry.frames import Array
from identification.quality import sizes
from validation.history.history import Body, Errors, HistoryPosition, Version
from validation.reference.statement import COG, QUANTITIES, inertia_of
from validation.report.charts.interactive import LEGEND_ROOM, TITLE_ROOM, decades, dressed, escaped, legend_above
from validation.report.charts.spec import COLOURS as PALETTE
from validation.report.charts.spec import FAINT, INK, PAPER
from validation.report.charts.static import DPI, Axes, finish, grid_lines, new_figure, require_format

if TYPE_CHECKING:
    from plotly.graph_objects import Figure


NOMINAL, PLAIN, HELD_OUT, CHI2, PRICE = "#9aa0a6", "#2456c4", "#d9541e", "#1f8a4c", "#8e6fc0"
ASIDE = "#c9ced6"
"""Of what branched off."""

REFERENCE = "#c8283c"
LARGEST = 30
"""Letters of a name below the axis, before it is cut."""


@dataclass(frozen=True, kw_only=True)
class DrawnRung:
    """One rung.

    Attributes
    ----------
    number, parent : of the rungs; None for the first
    title : what was added
    depth : rungs between it and the first
    here : whether the way from the first rung to the current one leads over it
    errors : by name, NaN where there is none
    gain : evidence over the parent [nats]; None where it is not known
    """

    number: int
    parent: int | None
    title: str
    depth: int
    here: bool
    errors: Mapping[str, float]
    gain: float | None


PERCENT = {"nominal": NOMINAL, "plain": PLAIN, "held out": HELD_OUT}
NAMED = ("held out", "sum z² over what is due")
"""The errors at which branches have their names."""

BELOW = ("plain", "sum z² over what is due")
"""Those whose figures stand below and to the left of their points, out of the way of the others'."""

LINE = 10.5
"""[points] between two labels, one above the other."""

FITTED = {"chi² per deg. of freedom": CHI2, "sum z² over what is due": PRICE}
"""The errors of the upper and of the lower panel, and their colours."""


def draw_fall(title: str, rungs: Sequence[DrawnRung], path: Path, note: str = "", about: str = "") -> None:
    """Write how the four errors fall along the way to the current rung; branches are thin.

    Raises
    ------
    BadInput : the ending of `path` is unknown.
    """
    require_format(path)
    deepest = max(one.depth for one in rungs)
    figure = new_figure(max(11.0, 5.5 + 1.5 * deepest), 9.4)
    grid = figure.add_gridspec(2, 1, height_ratios=(1.7, 1), hspace=0.1, left=0.085, right=0.78, top=0.9, bottom=0.18)
    upper = figure.add_subplot(grid[0])
    lower = figure.add_subplot(grid[1], sharex=upper)
    for axes, shown in ((upper, PERCENT), (lower, FITTED)):
        for name, colour in shown.items():
            _way(axes, rungs, name, colour)
        _dress(axes)
    upper.set_ylabel("error of the judged channels [%]", fontsize=10)
    lower.set_ylabel("all tolerances fitted", fontsize=10)
    lower.axhline(1.0, color=FAINT, linewidth=0.9, linestyle=(0, (5, 3)), zorder=1)
    upper.tick_params(labelbottom=False)
    _gains(upper, rungs)
    _names(lower, rungs, deepest)
    for axes, shown in ((upper, PERCENT), (lower, FITTED)):
        _labels(axes, rungs, shown)
    finish(figure, title, note, path, about)


def _way(axes: Axes, rungs: Sequence[DrawnRung], name: str, colour: str) -> None:
    """One error: the way to the current rung strong, what branches off faint."""
    by_number = {one.number: one for one in rungs}
    for one in rungs:
        parent = None if one.parent is None else by_number[one.parent]
        if parent is not None and not one.here and np.isfinite([one.errors[name], parent.errors[name]]).all():
            axes.plot([parent.depth, one.depth], [parent.errors[name], one.errors[name]], color=ASIDE, linewidth=1.1, zorder=2)
        if not one.here and np.isfinite(one.errors[name]):
            axes.plot(one.depth, one.errors[name], marker="o", markersize=5, color=PAPER, markeredgecolor=colour, zorder=3)
    way = [one for one in rungs if one.here and np.isfinite(one.errors[name])]
    look: dict[str, Any] = {"color": colour, "marker": "o", "markersize": 7, "linewidth": 2.2, "markeredgecolor": PAPER}
    axes.plot([one.depth for one in way], [one.errors[name] for one in way], label=name, zorder=4, **look)


def _labels(axes: Axes, rungs: Sequence[DrawnRung], shown: Mapping[str, str]) -> None:
    """Figures of the way beside their points, names of branches to the right of theirs, none upon another."""
    for depth in sorted({one.depth for one in rungs}):
        there = [one for one in rungs if one.depth == depth]
        found = [label for name, colour in shown.items() for label in _of_one(axes, there, name, colour, shown)]
        for align, beside in (("left", 7.0), ("right", -6.0)):
            _write(axes, depth, [one for one in found if one.align == align], beside)


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
            yield _Label(text=f"{value:.3g}", value=value, height=height, colour=colour, **place)
            continue
        upon = any(abs(height - way) < LINE / 1.5 for way in on_way)
        if name in NAMED or (name in FITTED and not upon):
            place = {"align": "right", "apart": -2 * LINE - height + on_way[0]} if upon else {"align": "left", "apart": 0.0}
            yield _Label(text=f"{one.number}  {_cut(one.title)}", value=value, height=height, colour=FAINT, **place)


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


def _dress(axes: Axes) -> None:
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    axes.set_yscale("log")
    low, high = axes.get_ylim()
    axes.set_ylim(low * (low / high) ** 0.17, high * (high / low) ** 0.1)  # room for figures and names
    axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.yaxis.set_minor_formatter(NullFormatter())
    grid_lines(axes)
    axes.legend(fontsize=9.5, loc="upper left", bbox_to_anchor=(1.01, 1.0), borderaxespad=0.0, frameon=False)


def _gains(axes: Axes, rungs: Sequence[DrawnRung]) -> None:
    """Evidence gained on the way, above the panel, between a rung and the one before."""
    place = axes.get_xaxis_transform()
    for one in rungs:
        if one.here and one.parent is not None and one.gain is not None and np.isfinite(one.gain):
            axes.text(one.depth - 0.5, 1.015, f"{one.gain:+.0f} nats", transform=place, ha="center", fontsize=9, color=INK)


def _names(axes: Axes, rungs: Sequence[DrawnRung], deepest: int) -> None:
    way = [one for one in rungs if one.here]
    names = [f"{one.number}  {_cut(one.title)}" for one in way]
    axes.set_xticks([one.depth for one in way], names, rotation=18, ha="right", rotation_mode="anchor")
    axes.tick_params(axis="x", labelsize=9.5)
    axes.set_xlim(-0.4, max(deepest, 1) + 0.8)


def _cut(text: str) -> str:
    return text if len(text) <= LARGEST else f"{text[: LARGEST - 2]} …"


@dataclass(frozen=True, eq=False, kw_only=True)
class DrawnQuantity:
    """One of ten quantities along the rungs.

    Attributes
    ----------
    label, unit : of the values
    identified, half_width, reference : (r,) at every rung; half of the 95 % interval
    """

    label: str
    unit: str
    identified: Array
    half_width: Array
    reference: Array


def draw_inertia(title: str, names: Sequence[str], quantities: Sequence[DrawnQuantity], path: Path, note: str = "") -> None:
    """Write identified inertia with its 95 % intervals beside the reference, quantity by quantity, over the rungs `names`.

    Raises
    ------
    BadInput : the ending of `path` is unknown.
    """
    require_format(path)
    figure = new_figure(16.0, 8.6)
    grid = figure.add_gridspec(2, 5, hspace=0.24, wspace=0.36, left=0.055, right=0.985, top=0.85, bottom=0.19)
    for k, one in enumerate(quantities):
        axes = figure.add_subplot(grid[k // 5, k % 5])
        _quantity(axes, one)
        axes.set_title(f"{one.label} [{one.unit}]", fontsize=11, loc="left", color=INK)
        last = k >= len(quantities) - 5
        axes.set_xticks(range(len(names)), [_cut(name) for name in names] if last else [""] * len(names))
        if last:
            axes.tick_params(axis="x", rotation=28, labelsize=8.5)
            for label in axes.get_xticklabels():
                label.set(ha="right", rotation_mode="anchor")
        if k == 0:
            place: dict[str, Any] = {"loc": "upper right", "bbox_to_anchor": (0.985, 1.0 - 0.25 / 8.6), "ncols": 2}
            figure.legend(*axes.get_legend_handles_labels(), fontsize=10, frameon=False, **place)
    finish(figure, title, note, path)


def _quantity(axes: Axes, one: DrawnQuantity) -> None:
    at = np.arange(len(one.identified))
    axes.plot(
        at, one.reference, color=REFERENCE, linewidth=1.6, marker="_", markersize=16, label="reference: the model", zorder=2
    )
    look: dict[str, Any] = {"color": PLAIN, "marker": "o", "markersize": 6, "capsize": 4, "linewidth": 1.4, "elinewidth": 1.4}
    axes.errorbar(at, one.identified, one.half_width, label="identified, 95 % interval", zorder=3, **look)
    axes.set_xlim(-0.4, len(at) - 0.6)
    axes.ticklabel_format(axis="y", useOffset=False)
    grid_lines(axes)


# The pictures of a ladder: where they go and what is on them.


NAN = float("nan")


def draw(at: HistoryPosition, folder: Path) -> list[Path]:
    """Write the falling errors, and for every article the way of its inertia, into `folder`; the files.

    Raises
    ------
    OSError : they cannot be written.
    """
    found: list[Path] = []
    name, way = at.path.stem, _ladder_way(at)
    if any(one.errors for one in at.ladder.rungs):
        found.append(folder / f"{name}-ladder.png")
        note = "Strong: the way to the rung on which the model stands. Thin: branches. Above: evidence that a rung gained."
        draw_fall(f"{at.path.name}: errors from rung to rung", _drawn(at), found[-1], note)
    for article in dict.fromkeys(body.article for one in way for body in one.bodies):
        seen = [(one, body) for one in way for body in one.bodies if body.article == article]
        found.append(folder / f"{name}-ladder-{article.replace('+', '-')}.png")
        _inertia(at, article, seen, found[-1])
    return found


def _ladder_way(at: HistoryPosition) -> tuple[Version, ...]:
    return () if at.below is None else at.ladder.path(at.below.number)


def _drawn(at: HistoryPosition) -> list[DrawnRung]:
    way = {one.number for one in _ladder_way(at)}
    return [
        DrawnRung(
            number=one.number,
            parent=one.parent,
            title=one.title,
            depth=len(at.ladder.path(one.number)) - 1,
            here=one.number in way,
            errors=_errors(one.errors),
            gain=one.gain,
        )
        for one in at.ladder.rungs
    ]


def _errors(errors: Errors | None) -> dict[str, float]:
    if errors is None:
        return dict.fromkeys((*PERCENT, *FITTED), NAN)
    held_out = NAN if errors.held_out is None else errors.held_out
    figures = (errors.nominal, errors.plain, held_out, errors.chi2_per_dof, errors.z2_over_due)
    seen = (one if one > 0 else NAN for one in figures)  # an error of nothing but noise is 0 and has no place on these axes
    return dict(zip((*PERCENT, *FITTED), seen, strict=True))


def _inertia(at: HistoryPosition, article: str, seen: Sequence[tuple[Version, Body]], path: Path) -> None:
    values, half, reference = (
        np.array([getattr(body, name) for _, body in seen]) for name in ("values", "half_width", "reference")
    )
    quantities = [
        DrawnQuantity(
            label=one.label,
            unit=one.unit,
            identified=one.per_si * values[:, k],
            half_width=one.per_si * half[:, k],
            reference=one.per_si * reference[:, k],
        )
        for k, one in enumerate(QUANTITIES)
    ]
    note = (
        "CoG from the article's own origin; moments and products about the CoG. "
        "The reference is the model with the effects of each rung."
    )
    draw_inertia(f"{article}: identified inertia", [f"{one.number}  {one.title}" for one, _ in seen], quantities, path, note)


# Ten identified values with their 95 % intervals, each beside its reference.


PANELS = (
    ("mass and moments about the CoG [%]", (0, 4, 5, 6)),
    ("CoG [mm]", (1, 2, 3)),
    ("products about the CoG [% of √(Θii Θjj)]", (7, 8, 9)),
)
"""What shares a unit, by index in `QUANTITIES`."""

COLOURS = (PALETTE["measured"][1], PALETTE["predicted"][1], PALETTE["further"][1], "#9a6fd0", PALETTE["aside"][1])


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


# The errors of a model falling from rung to rung.


Error = tuple[str, str, Callable[[Errors], float | None]]
"""Name, colour, and the figure."""

UPPER: tuple[Error, ...] = (
    ("nominal", PALETTE["aside"][1], lambda of: of.nominal),
    ("plain, fitted data", PALETTE["predicted"][1], lambda of: of.plain),
    ("plain, held out", PALETTE["measured"][1], lambda of: of.held_out),
)
LOWER: tuple[Error, ...] = (
    ("χ² per degree of freedom", "#1f9d61", lambda of: of.chi2_per_dof),
    ("z² of the tolerances over what is due", "#9a6fd0", lambda of: of.z2_over_due),
)

LONGEST = 28
"""Letters of a name below the axis before it is cut."""


def falling_errors(at: HistoryPosition, *, dark: bool = False) -> Figure:
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
    names = [f"{one.number}  {escaped(_ladder_cut(one.title))}" for one in way]
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


def way_to(at: HistoryPosition) -> tuple[Version, ...]:
    """From the first rung to the one on which the model stands, or from which it was edited."""
    return () if at.below is None else at.ladder.path(at.below.number)


def _line(
    figure: Figure,
    row: int,
    name: str,
    colour: str,
    tell: Callable[[Errors], float | None],
    rungs: Sequence[Version],
    depth: Callable[[Version], int],
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


def _beside(value: float, rung: Version, group: Sequence[Error]) -> str:
    """Where a figure stands: of the greatest above its point, of the least below, of what is between to the right."""
    known = [one for _, _, tell in group if rung.errors is not None and (one := tell(rung.errors)) is not None]
    return "top center" if value >= max(known) else "bottom center" if value <= min(known) else "middle right"


def _range(at: HistoryPosition, group: Sequence[Error]) -> dict[str, Any]:
    """Of the axis, with room for figures above and below."""
    told = [tell(one.errors) for one in at.ladder.rungs if one.errors is not None for _, _, tell in group]
    sizes = [one for one in told if one is not None and one > 0] or [1.0]
    low, high = log10(min(sizes)), log10(max(sizes))
    room = 0.22 * max(high - low, 0.4)
    return decades(low - room, high + room)


def _ladder_cut(text: str) -> str:
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 1]}…"
