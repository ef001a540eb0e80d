"""A driven run drawn: what table, loads and cells do over time, and beside it their amplitudes over frequency.

Rows share their time and their frequency axis. What the rigid body would do is drawn into every load, and the resonances that
were passed are marked in both columns, so that one sees which mode swells which load, when, and how far it rings on.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from geometry.arrays import Array
from validation.pictures.curves import CURVES, Axes, finish, grid_lines, new_figure
from validation.pictures.files import require_format
from validation.pictures.palette import FAINT, INK

COLUMNS = 1400
"""Pieces of the time axis, in each of which a signal is drawn from its lowest to its highest value."""

LINES = (*CURVES, "#8e6fc0")
"""Of the signals in one panel, first to fourth."""

REFERENCE = (0, (5, 3))
ROOM = 0.045
"""Of the width of a panel, between two figures above it."""

HEIGHT = 2.75
"""Inches of one row."""

DECADES = 5
"""Most decades of an amplitude that are shown."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Signal:
    """One signal of a panel.

    Attributes
    ----------
    name : in the legend
    values : (n,) over time
    amplitude : (m,) over frequency
    """

    name: str
    values: Array
    amplitude: Array


@dataclass(frozen=True, eq=False, kw_only=True)
class Row:
    """A panel over time and its neighbour over frequency.

    Attributes
    ----------
    title : what is shown
    unit : of the signals over time
    unit_of_amplitude : over frequency
    signals : one, or several that are told apart by their colours
    rigid : amplitude of the rigid body's answer over time (n,) and frequency (m,); None where there is none, or over time none
    limit : a value with its name, drawn as a line over time; None without one
    """

    title: str
    unit: str
    unit_of_amplitude: str
    signals: tuple[Signal, ...]
    rigid: tuple[Array | None, Array] | None = None
    limit: tuple[str, float] | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class Sheet:
    """A whole picture.

    Attributes
    ----------
    title, note : above and below
    time : (n,) [s]
    frequency : (m,) [Hz]
    along : what the frequency axis is
    logarithmic : whether amplitudes over frequency are
    marks : time [s] (NaN where there is no one moment) and frequency [Hz] of every resonance
    driven : [s] end of the drive
    """

    title: str
    note: str
    time: Array
    frequency: Array
    along: str
    rows: tuple[Row, ...]
    marks: tuple[tuple[float, float], ...]
    driven: float


def draw_sheet(sheet: Sheet, path: Path) -> None:
    """Write `sheet` as a picture.

    Raises
    ------
    BadInput : the ending of `path` is unknown.
    """
    require_format(path)
    height = 1.65 + HEIGHT * len(sheet.rows)
    figure = new_figure(15.0, height)
    grid = figure.add_gridspec(
        len(sheet.rows), 2, hspace=0.3, wspace=0.13, left=0.058, right=0.985, top=1 - 1.0 / height, bottom=0.95 / height
    )
    first: list[Axes] = [None, None]
    for k, row in enumerate(sheet.rows):
        axes = [figure.add_subplot(grid[k, column], sharex=first[column]) for column in (0, 1)]
        first = first if k else axes
        _over_time(axes[0], sheet, row)
        _over_frequency(axes[1], sheet, row)
        for column, one in enumerate(axes):
            marks = [mark[column] for mark in sheet.marks]
            _dress(one, marks, [mark[1] for mark in sheet.marks], last=k == len(sheet.rows) - 1, figures=k == 0)
            one.set_title(row.title if column == 0 else "", fontsize=11, loc="left", color=INK, pad=16 if k == 0 else 6)
    axes[0].set_xlabel("time [s]", fontsize=9.5)
    axes[1].set_xlabel(sheet.along, fontsize=9.5)
    finish(figure, sheet.title, sheet.note, path)


def _over_time(axes: Axes, sheet: Sheet, row: Row) -> None:
    middle, low, high = _pieces(sheet.time, [signal.values for signal in row.signals])
    alone = len(row.signals) == 1
    for signal, colour, lowest, highest in zip(row.signals, LINES, low, high, strict=False):
        if alone:
            axes.fill_between(middle, lowest, highest, color=colour, linewidth=0.4, alpha=0.9)
        else:
            axes.plot(middle, highest, color=colour, linewidth=1.0, label=signal.name)
            axes.plot(middle, lowest, color=colour, linewidth=1.0)
    if row.rigid is not None and row.rigid[0] is not None:
        at, _, rigid = _pieces(sheet.time, [row.rigid[0]])
        for sign in (-1, 1):
            axes.plot(at, sign * rigid[0], color=INK, linewidth=1.1, linestyle=REFERENCE)
    if row.limit is not None:
        axes.axhline(row.limit[1], color="#c8283c", linewidth=1.2)
        axes.text(0.995, row.limit[1], row.limit[0], transform=axes.get_yaxis_transform(), ha="right", va="bottom", fontsize=8.5, color="#c8283c")
    axes.axvline(sheet.driven, color=FAINT, linewidth=0.8, linestyle=(0, (1, 2)))
    axes.set_xlim(sheet.time[0], sheet.time[-1])
    axes.set_ylabel(f"[{row.unit}]", fontsize=9.5)


def _over_frequency(axes: Axes, sheet: Sheet, row: Row) -> None:
    for signal, colour in zip(row.signals, LINES, strict=False):
        axes.semilogy(sheet.frequency, signal.amplitude, color=colour, linewidth=1.4, label=signal.name)
    if row.rigid is not None:
        axes.semilogy(sheet.frequency, row.rigid[1], color=INK, linewidth=1.1, linestyle=REFERENCE, label="rigid body, M a")
    axes.set_xlim(sheet.frequency[0], sheet.frequency[-1])
    _few_decades(axes, np.concatenate([signal.amplitude for signal in row.signals]))
    axes.set_ylabel(f"[{row.unit_of_amplitude}]", fontsize=9.5)
    if len(row.signals) > 1 or row.rigid is not None:
        axes.legend(fontsize=8.5, loc="best", framealpha=0.85, ncols=2 if len(row.signals) > 2 else 1)


def _few_decades(axes: Axes, amplitude: Array) -> None:
    """At least one decade, so that what is flat looks flat, and at most `DECADES`."""
    low, high = axes.get_ylim()
    top = float(amplitude.max())
    if top <= 0:
        return
    low = max(low, top * 10.0**-DECADES)
    if high < 10 * low:
        middle = np.sqrt(low * high)
        low, high = middle / 10**0.5, middle * 10**0.5
    axes.set_ylim(low, high)


def _pieces(time: Array, signals: Sequence[Array]) -> tuple[Array, Array, Array]:
    """Middles (k,) of at most `COLUMNS` pieces of the time axis, lowest and highest value of every signal in each, (s, k)."""
    count = min(COLUMNS, len(time))
    edges = np.unique(np.linspace(0, len(time), count + 1).astype(int))
    stacked = np.array(signals)
    low, high = (kind.reduceat(stacked, edges[:-1], axis=1) for kind in (np.minimum, np.maximum))
    return time[(edges[:-1] + edges[1:] - 1) // 2], low, high


def _dress(axes: Axes, marks: Sequence[float], labels: Sequence[float], *, last: bool, figures: bool) -> None:
    grid_lines(axes)
    axes.tick_params(labelbottom=last)
    low, high = axes.get_xlim()
    previous = -np.inf
    for at, frequency in sorted(zip(marks, labels, strict=True)):
        if not low <= at <= high:
            continue
        axes.axvline(at, color=FAINT, linewidth=0.8, alpha=0.55, zorder=0.5)
        if figures and at - previous > ROOM * (high - low):
            text: dict[str, Any] = {"transform": axes.get_xaxis_transform(), "ha": "center", "fontsize": 8, "color": FAINT}
            axes.text(at, 1.02, f"{frequency:.1f}", **text)
            previous = at

