"""Pictures of a ladder of models: the errors falling from rung to rung, and identified inertia on its way to the reference."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from geometry.arrays import Array
from validation.pictures.curves import DPI, Axes, finish, grid_lines, new_figure
from validation.pictures.files import require_format
from validation.pictures.palette import FAINT, INK, PAPER

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
