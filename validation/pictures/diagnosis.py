"""Pictures of a diagnosis: how surely each effect explains the data, and the errors before and after what was found."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from validation.pictures.curves import Axes, finish, grid_lines, new_figure
from validation.pictures.files import require_format
from validation.pictures.palette import FAINT, INK, PAPER

ACCEPTED, ALIKE, LESS, TOO_MUCH_LEFT = STANDINGS = ("accepted", "cannot be told from it", "explains less", "leaves too much")

COLOURS: Mapping[str, str] = MappingProxyType(dict(zip(STANDINGS, ("#2456c4", "#f39b2c", "#b4bcc8", "#b8415f"), strict=True)))
"""By where a cause stands; dark, middle and light, so that they differ without colours, too."""

BEFORE, AFTER = "#b4bcc8", "#2456c4"

LINEAR = 10.0
"""[nats] below which the axis of evidence is linear, and logarithmic beyond."""

LONGEST = 34
"""Letters of an id before it is cut."""


@dataclass(frozen=True, kw_only=True)
class DrawnCause:
    """One bar.

    Attributes
    ----------
    name : id
    size : with its interval, in words
    evidence : [nats]
    standing : of `STANDINGS`
    """

    name: str
    size: str
    evidence: float
    standing: str


@dataclass(frozen=True, kw_only=True)
class DrawnPair:
    """One error before and after.

    Attributes
    ----------
    name : of the error
    before, after : its size; None where nothing was found that could change it
    unit : behind the figures
    """

    name: str
    before: float
    after: float | None
    unit: str = ""


def draw_evidence(title: str, causes: Sequence[DrawnCause], path: Path, note: str = "", threshold: float | None = None) -> None:
    """Write one bar a cause, the best on top, with its size behind it.

    Parameters
    ----------
    threshold : [nats] from which an effect is accepted; None where it is not known

    Raises
    ------
    BadInput : the ending of `path` is unknown.
    """
    require_format(path)
    height = 2.5 + 0.46 * len(causes)
    figure = new_figure(13.5, height)
    axes = figure.add_axes((0.235, 0.98 / height, 0.45, 1 - 2.15 / height))
    places = np.arange(len(causes))
    axes.set_xscale("symlog", linthresh=LINEAR)
    axes.barh(places, [one.evidence for one in causes], color=[COLOURS[one.standing] for one in causes], height=0.64)
    axes.set_ylim(len(causes) - 0.4, -0.6)
    axes.set_xlim(min(0.0, *(1.3 * one.evidence for one in causes)), max(2 * LINEAR, *(1.6 * one.evidence for one in causes)))
    for place, one in zip(places, causes, strict=True):
        words = f"{one.evidence:+.1f} nats   {one.size}"
        axes.text(1.02, place, words, transform=axes.get_yaxis_transform(), va="center", fontsize=10, color=INK, parse_math=False)
    axes.axvline(0.0, color=FAINT, linewidth=0.8)
    if threshold is not None:
        axes.axvline(threshold, color=INK, linewidth=1.6, linestyle=(0, (5, 3)))
    axes.set_xlabel("evidence [nats], logarithmic beyond 10", fontsize=9.5, color=INK)
    grid_lines(axes)
    axes.set_yticks(places, [_short(one.name) for one in causes], parse_math=False)
    axes.tick_params(axis="y", labelsize=10.5)
    axes.xaxis.set_major_formatter("{x:g}")
    axes.grid(visible=False, axis="y")
    _legend(figure, [one for one in STANDINGS if any(cause.standing == one for cause in causes)], height, threshold)
    finish(figure, title, note, path)


def draw_before_after(title: str, percents: Sequence[DrawnPair], prices: Sequence[DrawnPair], path: Path, note: str = "") -> None:
    """Write pairs of bars: `percents` of the measured forces above, ratios to what is due where nothing is wrong below.

    Raises
    ------
    BadInput : the ending of `path` is unknown.
    """
    require_format(path)
    height = 2.9 + 0.62 * (len(percents) + len(prices))
    figure = new_figure(12.0, height)
    grid = figure.add_gridspec(
        2,
        1,
        height_ratios=(len(percents), len(prices)),
        hspace=0.5,
        left=0.19,
        right=0.95,
        top=1 - 1.15 / height,
        bottom=0.95 / height,
    )
    upper, lower = figure.add_subplot(grid[0]), figure.add_subplot(grid[1])
    _pairs(upper, percents, "per cent of the measured forces")
    _pairs(lower, prices, "times what is due where nothing is wrong, logarithmic", log=True)
    lower.axvline(1.0, color=INK, linewidth=1.6, linestyle=(0, (5, 3)))
    _before_after(figure, height, both=any(one.after is not None for one in percents))
    finish(figure, title, note, path)


def _pairs(axes: Axes, pairs: Sequence[DrawnPair], label: str, *, log: bool = False) -> None:
    both = any(one.after is not None for one in pairs)
    bars = [(k - 0.19 * both, one.before, BEFORE, one.unit) for k, one in enumerate(pairs)]
    bars += [(k + 0.19, one.after, AFTER, one.unit) for k, one in enumerate(pairs) if one.after is not None]
    places, sizes, colours, units = zip(*bars, strict=True)
    axes.barh(places, sizes, color=colours, height=0.36 if both else 0.5)
    if log:
        axes.set_xscale("log")
        axes.set_xlim(0.5 * min(0.2, *(size for size in sizes if size > 0)), 2.5 * max(2.0, *sizes))
        axes.xaxis.set_major_formatter("{x:g}")
        axes.xaxis.set_minor_formatter("")
    else:
        axes.set_xlim(0, 1.14 * max(1e-9, *sizes))
    for place, size, unit in zip(places, sizes, units, strict=True):
        where = {"textcoords": "offset points", "va": "center", "fontsize": 9.5, "color": INK, "zorder": 5}
        behind = {"facecolor": PAPER, "edgecolor": "none", "pad": 1.0}
        axes.annotate(f"{size:.3g}{unit}", (size, place), (6, 0), bbox=behind, **where)
    axes.set_xlabel(label, fontsize=9.5, color=INK)
    grid_lines(axes)
    axes.set_yticks(np.arange(len(pairs)), [one.name for one in pairs], parse_math=False)
    axes.tick_params(axis="y", labelsize=10.5)
    axes.invert_yaxis()
    axes.grid(visible=False, axis="y")


def _legend(figure: Any, standings: Sequence[str], height: float, threshold: float | None) -> None:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles: list[Any] = [Patch(color=COLOURS[word], label=word) for word in standings]
    if threshold is not None:
        handles.append(Line2D([], [], color=INK, linewidth=1.6, linestyle=(0, (5, 3)), label="asked for"))
    _place(figure, handles, height)


def _before_after(figure: Any, height: float, *, both: bool) -> None:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    line = Line2D([], [], color=INK, linewidth=1.6, linestyle=(0, (5, 3)), label="due, nothing wrong")
    patches = [Patch(color=BEFORE, label="before"), Patch(color=AFTER, label="with what was found")]
    _place(figure, [*(patches if both else ()), line], height)


def _place(figure: Any, handles: Sequence[Any], height: float) -> None:
    """Below the title."""
    at = (0.4 / figure.get_figwidth(), 1 - 0.62 / height)
    figure.legend(handles=handles, loc="upper left", bbox_to_anchor=at, ncols=5, fontsize=9.5, frameon=False)


def _short(name: str) -> str:
    return name if len(name) <= LONGEST else f"{name[: LONGEST - 1]}…"
