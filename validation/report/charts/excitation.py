"""A driven run drawn: what table, loads and cells do over time, and beside it their amplitudes over frequency.

Rows share their time and their frequency axis. What the rigid body would do is drawn into every load, and the resonances that
were passed are marked in both columns, so that one sees which mode swells which load, when, and how far it rings on. The last row
tells the two apart: in a spectrogram the drive is a line that rises and what rings stays level, and the load of the whole record
over the acceleration is the dynamic mass that the run has to show.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from geometry.frames import Array
from validation.report.charts.spec import COLOURS, CURVES, FAINT, INK, PAPER
from validation.report.charts.static import Axes, finish, grid_lines, new_figure

COLUMNS, FEWER = 1400, 300
"""Pieces of the time axis, in each of which a signal is drawn from its lowest to its highest value: one signal, several."""

LINES = CURVES[:4]
"""Of the signals in one panel, first to fourth."""

WIDTHS = (3.0, 2.2, 1.5, 0.8)
"""Of these: where they coincide, all of them are seen."""

SHADES = (PAPER, "#cfdcf2", "#6f93dc", "#2456c4", "#14296b", INK)
"""Of a spectrogram, from nothing to the largest."""

LIMIT = COLOURS["limit"][0]
REFERENCE = (0, (5, 3))
ROOM = 0.045
"""Of the width of a panel, between two figures above it."""

HEIGHT = 2.75
"""Inches of one row."""

DECADES = 4
"""Most decades of an amplitude that are shown."""

FEW = 1000.0
"""From the lowest to the highest amplitude of a panel: below it, twos and fives have their figures too, or there could be two."""

DEEP = 60.0
"""Decibels from the darkest to the white of a spectrogram."""


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
class PanelRow:
    """A panel over time and its neighbour over frequency.

    Attributes
    ----------
    title : what is shown
    unit : of the signals over time
    unit_of_amplitude : over frequency
    signals : one, or several that are told apart by their colours
    rigid : amplitude of the rigid body's answer over time (n,) and frequency (m,); None where there is none, or over time none
    limit : a value with its name, drawn as a line over time; None without one
    logarithmic : whether amplitudes are; from zero otherwise
    """

    title: str
    unit: str
    unit_of_amplitude: str
    signals: tuple[Signal, ...]
    rigid: tuple[Array | None, Array] | None = None
    limit: tuple[str, float] | None = None
    logarithmic: bool = True


@dataclass(frozen=True, eq=False, kw_only=True)
class Spectra:
    """The last row: one load in time and frequency, and over the acceleration of the table.

    Attributes
    ----------
    load : its name
    time, frequency : (t,) [s], (f,) [Hz] of the spectrogram
    decibel : (f, t) of its amplitude, 0 the largest
    lines : (m,) [Hz]
    quotient : (m,) amplitude of the load over that of the acceleration, of the whole record
    cut : whether the record ends while the article still rings
    rigid : the same of the rigid body
    unit : of these
    """

    load: str
    time: Array
    frequency: Array
    decibel: Array
    lines: Array
    quotient: Array
    cut: bool
    rigid: float
    unit: str


@dataclass(frozen=True, eq=False, kw_only=True)
class Sheet:
    """A whole picture.

    Attributes
    ----------
    title, note : above and below
    time : (n,) [s]
    frequency : (m,) [Hz]
    along : what the frequency axis is
    marks : time [s] (NaN where there is no one moment) and frequency [Hz] of every resonance
    driven : [s] end of the drive
    """

    title: str
    note: str
    time: Array
    frequency: Array
    along: str
    rows: tuple[PanelRow, ...]
    spectra: Spectra
    marks: tuple[tuple[float, float], ...]
    driven: float


def draw_sheet(sheet: Sheet, path: Path, about: str = "") -> None:
    """Write `sheet` as a picture. A PNG carries the words `about` as its comment.

    Raises
    ------
    BadInput : the ending of `path` is unknown.
    """
    count = len(sheet.rows) + 1
    height = 1.65 + HEIGHT * count
    figure = new_figure(15.0, height)
    room = {"left": 0.058, "right": 0.985, "top": 1 - 1.0 / height, "bottom": 0.95 / height}
    grid = figure.add_gridspec(count, 2, hspace=0.3, wspace=0.13, **room)
    panels: list[list[Axes]] = []
    for k in range(count):
        panels.append([figure.add_subplot(grid[k, c], sharex=panels[0][c] if panels else None) for c in (0, 1)])
    for row, (left, right) in zip(sheet.rows, panels, strict=False):
        _over_time(left, sheet, row)
        alone = len(row.signals) == 1
        for signal, colour, width in zip(row.signals, LINES, WIDTHS, strict=False):
            right.plot(sheet.frequency, signal.amplitude, color=colour, linewidth=1.4 if alone else width, label=signal.name)
        if row.rigid is not None:
            right.plot(sheet.frequency, row.rigid[1], color=INK, linewidth=1.1, linestyle=REFERENCE, label="rigid body, M a")
        right.set_xlim(sheet.frequency[0], sheet.frequency[-1])
        if row.logarithmic:
            _few_decades(right, np.concatenate([signal.amplitude for signal in row.signals]))
        else:
            right.set_ylim(0, 1.25 * max(float(signal.amplitude.max()) for signal in row.signals))
        right.set_ylabel(f"[{row.unit_of_amplitude}]", fontsize=9.5)
        if not alone or row.rigid is not None:
            right.legend(fontsize=8.5, loc="best", framealpha=0.85, ncols=2 if len(row.signals) > 2 else 1)
        left.set_title(row.title, fontsize=11, loc="left", color=INK, pad=16 if left is panels[0][0] else 6)
    _last_row(panels[-1], sheet)
    for k, pair in enumerate(panels):
        for column, axes in enumerate(pair):
            grid_lines(axes)
            axes.tick_params(labelbottom=k == count - 1)
            low, high = axes.get_xlim()
            text: dict[str, Any] = {"transform": axes.get_xaxis_transform(), "ha": "center", "fontsize": 8, "color": FAINT}
            previous = -np.inf
            for at, frequency in sorted((mark[column], mark[1]) for mark in sheet.marks if low <= mark[column] <= high):
                axes.axvline(at, color=FAINT, linewidth=0.8, alpha=0.55, zorder=0.5)
                if k == 0 and at - previous > ROOM * (high - low):
                    axes.text(at, 1.02, f"{frequency:.1f}", **text)
                    previous = at
    finish(figure, sheet.title, sheet.note, path, about)


def _over_time(axes: Axes, sheet: Sheet, row: PanelRow) -> None:
    alone = len(row.signals) == 1
    middle, low, high = _pieces(sheet.time, [signal.values for signal in row.signals], COLUMNS if alone else FEWER)
    for colour, width, lowest, highest in zip(LINES, WIDTHS, low, high, strict=False):
        if alone:
            axes.fill_between(middle, lowest, highest, color=colour, linewidth=0.4, alpha=0.9)
        else:
            axes.plot(middle, highest, color=colour, linewidth=width)
            axes.plot(middle, lowest, color=colour, linewidth=width)
    if row.rigid is not None and row.rigid[0] is not None:
        at, _, rigid = _pieces(sheet.time, [row.rigid[0]], COLUMNS)
        for sign in (-1, 1):
            axes.plot(at, sign * rigid[0], color=INK, linewidth=1.1, linestyle=REFERENCE)
    if row.limit is not None:
        axes.axhline(row.limit[1], color=LIMIT, linewidth=1.2)
        beside: dict[str, Any] = {"transform": axes.get_yaxis_transform(), "ha": "right", "va": "bottom", "color": LIMIT}
        axes.text(0.995, row.limit[1], row.limit[0], fontsize=8.5, **beside)
    axes.axvline(sheet.driven, color=FAINT, linewidth=0.8, linestyle=(0, (1, 2)))
    axes.set_xlim(sheet.time[0], sheet.time[-1])
    axes.set_ylabel(f"[{row.unit}]", fontsize=9.5)


def _last_row(pair: Sequence[Axes], sheet: Sheet) -> None:
    from matplotlib.colors import LinearSegmentedColormap

    found, (left, right) = sheet.spectra, pair
    shades = LinearSegmentedColormap.from_list("shades", SHADES)
    left.pcolormesh(
        found.time, found.frequency, found.decibel, cmap=shades, vmin=-DEEP, vmax=0, shading="nearest", rasterized=True
    )
    left.set_title(f"{found.load} in time and frequency, {DEEP:g} dB from white to dark", fontsize=11, loc="left", color=INK)
    left.set_ylabel("[Hz]", fontsize=9.5)
    left.set_xlabel("time [s]", fontsize=9.5)
    said = ", cut while it rings" if found.cut else ""
    right.plot(found.lines, found.quotient, color=LINES[0], linewidth=1.4, label=f"{found.load}, whole record{said}")
    right.axhline(found.rigid, color=INK, linewidth=1.1, linestyle=REFERENCE, label="rigid body")
    _few_decades(right, found.quotient)
    right.set_title(f"{found.load} over the acceleration of the table", fontsize=11, loc="left", color=INK)
    right.set_ylabel(f"[{found.unit}]", fontsize=9.5)
    right.set_xlabel(sheet.along, fontsize=9.5)
    right.legend(fontsize=8.5, loc="best", framealpha=0.85)


def _few_decades(axes: Axes, amplitude: Array) -> None:
    """At least one decade, so that what is flat looks flat, and at most `DECADES`."""
    top = float(amplitude.max())
    if top <= 0:
        return
    from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter

    axes.set_yscale("log")
    axes.yaxis.set_minor_formatter(NullFormatter())
    low, high = axes.get_ylim()
    low = max(low, top * 10.0**-DECADES)
    if high < 10 * low:
        middle = np.sqrt(low * high)
        low, high = middle / 10**0.5, middle * 10**0.5
    axes.set_ylim(low, high)
    if high < FEW * low:
        axes.yaxis.set_minor_locator(LogLocator(subs=(2, 5)))
        for formatted in (axes.yaxis.set_major_formatter, axes.yaxis.set_minor_formatter):
            formatted(StrMethodFormatter("{x:g}"))
        axes.tick_params(axis="y", which="minor", labelsize=8.5, labelcolor=INK)


def _pieces(time: Array, signals: Sequence[Array], most: int) -> tuple[Array, Array, Array]:
    """Middles (k,) of at most `most` pieces of the time axis, lowest and highest value of every signal in each, (s, k)."""
    count = min(most, len(time))
    edges = np.unique(np.linspace(0, len(time), count + 1).astype(int))
    stacked = np.array(signals)
    low, high = (kind.reduceat(stacked, edges[:-1], axis=1) for kind in (np.minimum, np.maximum))
    return time[(edges[:-1] + edges[1:] - 1) // 2], low, high
