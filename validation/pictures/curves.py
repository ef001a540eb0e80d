"""Dynamic masses drawn as structural-dynamics engineers read them: magnitude (logarithmic) above phase, over frequency.

The rigid body's line is drawn in, since the way a curve leaves it is the whole story, and every resonance is marked.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray, DynamicMass
from validation.pictures.files import ABOUT, require_format, save
from validation.pictures.palette import FAINT, INK, PAPER

LABELS = ("x", "y", "z", "α", "β", "γ")
DPI = 110
CURVES = ("#2456c4", "#d9541e", "#1f8a4c")
"""Of the models in a panel, first to third."""

AXES = ("#c8283c", "#1f8a4c", "#2456c4")
"""Of x, y, z and of α, β, γ where they share a panel."""

MEASURED, LEFT_OUT = "#f28a1c", "#c3c8d0"
"""Of lines that were measured, and of those among them that are not used."""

WIDTHS = (2.8, 1.9, 1.1)
"""Of these: where curves coincide, all of them are seen."""

NOTHING = 1e-6
"""An entry smaller than this share of its block's largest is nothing: symmetry makes it zero, rounding or a mesh almost."""

SHOWS = 1e-3
"""Share of the rigid body that a mode must carry along an axis to be marked there."""

ROOM_FOR_A_FIGURE = 0.075
"""Of the width of a panel."""

TITLE_ABOVE_FIGURES = 13
"""Points between a panel and its title, so that the figures of `_mark` stand below it."""

FEW = 3
"""Names that a legend inside a panel has at most."""

DEEPEST = 1e5
"""Of the largest magnitude in a panel of a chosen entry; what is smaller is off the page."""

DASHES = ("-", "--", ":")

Axes = Any
Figure = Any
"""Matplotlib's; the library is imported inside the functions."""


class Resonances(Protocol):
    """What is marked: modes of a model, or elastic terms that were identified."""

    @property
    def frequency(self) -> Array:
        """(m,) [Hz]."""

    @property
    def effective_mass(self) -> Array:
        """(m, 6) [kg], [kg m²] along every axis."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Curve:
    """A dynamic mass to be drawn.

    Attributes
    ----------
    name : of the model or the article
    mass : on the lines to be drawn
    rigid : (6, 6) mass matrix of the rigid body about the same point
    modes : eigenfrequencies, and how much each shows on an axis
    dots : colour of a measured dynamic mass, drawn line by line; empty for a model
    """

    name: str
    mass: DynamicMass
    rigid: Array
    modes: Resonances
    dots: str = ""


def diagonal(title: str, curves: Sequence[Curve], path: Path, note: str = "") -> None:
    """Write a picture of the six diagonal entries of `curves`, each magnitude over phase.

    Raises
    ------
    BadInput : the ending of `path` is unknown.
    """
    require_format(path)
    figure = new_figure(15.0, 10.2)
    grid = figure.add_gridspec(5, 3, height_ratios=(3, 1.15, 0.42, 3, 1.15), hspace=0.09, wspace=0.2, **_ROOM)
    for i in range(6):
        top, column = 3 * (i // 3), i % 3
        upper = figure.add_subplot(grid[top, column])
        lower = figure.add_subplot(grid[top + 1, column], sharex=upper)
        _entry(upper, lower, curves, i, i)
        upper.set_title(f"$H_{{{LABELS[i]}{LABELS[i]}}}$", fontsize=12, loc="left", pad=TITLE_ABOVE_FIGURES)
        _mark(upper, curves[0], (i,))
        upper.set_ylabel(f"|H| [{unit(i, i)}]", fontsize=9.5)
        lower.set_ylabel("phase [°]", fontsize=9.5)
        if i >= 3:
            lower.set_xlabel("frequency [Hz]", fontsize=9.5)
        if i == 0:
            _legend(figure, upper, 8.5)
    finish(figure, title, note, path)


def full(title: str, curves: Sequence[Curve], path: Path, note: str = "") -> None:
    """Write a picture of all 36 entries of `curves`, magnitude over phase; rows are loads, columns base motions.

    Raises
    ------
    BadInput : the ending of `path` is unknown.
    """
    require_format(path)
    figure = new_figure(20.0, 19.0)
    outer = figure.add_gridspec(6, 6, hspace=0.22, wspace=0.3, left=0.05, right=0.985, top=0.935, bottom=0.05)
    for i in range(6):
        for j in range(6):
            inner = outer[i, j].subgridspec(2, 1, height_ratios=(2.6, 1), hspace=0.07)
            upper = figure.add_subplot(inner[0])
            lower = figure.add_subplot(inner[1], sharex=upper)
            _entry(upper, lower, curves, i, j)
            label = f"$H_{{{LABELS[i]}{LABELS[j]}}}$ [{unit(i, j)}]"
            upper.set_title(label, fontsize=9.5, loc="left", pad=2.5)
            for axes in (upper, lower):
                axes.tick_params(labelsize=7)
            if i == 5:
                lower.set_xlabel("frequency [Hz]", fontsize=8.5)
            if (i, j) == (0, 0):
                _legend(figure, upper, 7)
    finish(figure, title, note, path)


def chosen(title: str, panels: Sequence[tuple[str, int, int, Sequence[Curve]]], path: Path, note: str = "") -> None:
    """Write a picture of single entries of H, at most six, each magnitude over phase.

    Parameters
    ----------
    panels : words for the article, row, column, and the curves of that entry

    Raises
    ------
    BadInput : the ending of `path` is unknown.
    """
    require_format(path)
    figure = new_figure(15.0, 10.2 if len(panels) > 3 else 6.0)
    ratios = (3, 1.15, 0.55, 3, 1.15) if len(panels) > 3 else (3, 1.15)
    grid = figure.add_gridspec(len(ratios), 3, height_ratios=ratios, hspace=0.09, wspace=0.3, **_ROOM | {"left": 0.07})
    for k, (words, i, j, curves) in enumerate(panels):
        top = 3 * (k // 3)
        upper = figure.add_subplot(grid[top, k % 3])
        lower = figure.add_subplot(grid[top + 1, k % 3], sharex=upper)
        shown = [curve for curve in curves if not _vanishes(curve.mass.matrix, i, j)] or list(curves)
        _entry(upper, lower, shown, i, j)
        nothing = ", ".join(curve.name for curve in curves if curve not in shown)
        if nothing:
            upper.text(0.02, 0.04, f"{nothing}: nothing", transform=upper.transAxes, fontsize=9, color=FAINT)
        upper.set_title(f"$H_{{{LABELS[i]}{LABELS[j]}}}$", fontsize=12, loc="left", pad=TITLE_ABOVE_FIGURES)
        upper.set_title(words, fontsize=9.5, loc="right", color=FAINT, pad=TITLE_ABOVE_FIGURES, parse_math=False)
        _mark(upper, curves[0], (i, j))
        low, high = upper.get_ylim()
        upper.set_ylim(max(low, high / DEEPEST), high)
        upper.set_ylabel(f"|H| [{unit(i, j)}]", fontsize=9.5)
        lower.set_ylabel("phase [°]", fontsize=9.5)
        lower.set_xlabel("frequency [Hz]", fontsize=9.5)
    _names(figure, [curve for *_, curves in panels for curve in curves])
    finish(figure, title, note, path)


def _names(figure: Figure, curves: Sequence[Curve]) -> None:
    """A legend beside the title, of all curves of a page whether a panel has room for them or not."""
    from matplotlib.lines import Line2D

    handles: dict[str, Any] = {}
    lines = iter(zip(CURVES, DASHES, strict=True))
    for curve in curves:
        if curve.name not in handles:
            colour, dash = (curve.dots, "none") if curve.dots else next(lines)
            marker = "o" if curve.dots else None
            look: dict[str, Any] = {"color": colour, "linestyle": dash, "marker": marker}
            handles[curve.name] = Line2D([], [], **look, markersize=5, label=curve.name)
    _, height = figure.get_size_inches()
    place: dict[str, Any] = {"loc": "upper right", "bbox_to_anchor": (0.985, 1 - 0.25 / height)}
    figure.legend(handles=list(handles.values()), ncols=len(handles), fontsize=10, frameon=False, **place)


def side_by_side(title: str, articles: Sequence[Curve], path: Path, note: str = "", about: str = "") -> None:
    """Write a picture with one column an article: diagonal of the translations [kg] and of the rotations [kg m²] over frequency.

    A PNG carries the words `about`, which `validation.pictures.said_about` reads again.

    Raises
    ------
    BadInput : the ending of `path` is unknown.
    """
    require_format(path)
    figure = new_figure(4.6 * len(articles) + 1.0, 9.6)
    grid = figure.add_gridspec(5, len(articles), height_ratios=(3, 1.15, 0.3, 3, 1.15), hspace=0.09, wspace=0.07, **_ROOM)
    rows: dict[int, list[Axes]] = {0: [], 3: []}
    for column, curve in enumerate(articles):
        for top, entries in ((0, (0, 1, 2)), (3, (3, 4, 5))):
            upper = figure.add_subplot(grid[top, column], sharey=rows[top][0] if rows[top] else None)
            lower = figure.add_subplot(grid[top + 1, column], sharex=upper)
            rows[top].append(upper)
            for colour, width, i in zip(AXES, WIDTHS, entries, strict=True):
                _line(upper, lower, curve, i, i, colour, DASHES[0], LABELS[i], width)
                upper.axhline(curve.rigid[i, i], color=colour, linewidth=0.9, linestyle=(0, (5, 3)), alpha=0.6)
            _dress(upper, lower, curve.mass.frequency)
            upper.tick_params(labelleft=column == 0)
            lower.tick_params(labelleft=column == 0)
            _mark(upper, curve, entries)
            if top == 0:
                upper.set_title(curve.name, fontsize=13, weight="bold", color=INK, pad=14)
            if column == 0:
                upper.set_ylabel(f"|H| [{unit(entries[0], entries[0])}]", fontsize=10)
                lower.set_ylabel("phase [°]", fontsize=10)
                upper.legend(fontsize=9, loc="upper right", ncols=3, framealpha=0.85, handlelength=1.4)
            if top == 3:
                lower.set_xlabel("frequency [Hz]", fontsize=10)
    for row in rows.values():
        _at_least_a_decade(row[0])
    finish(figure, title, note, path, about)


def unit(row: int, column: int) -> str:
    """Unit of an entry of H."""
    return ("kg", "kg m", "kg m²")[(row >= 3) + (column >= 3)]


_ROOM = {"left": 0.06, "right": 0.985, "top": 0.895, "bottom": 0.085}


def _entry(upper: Axes, lower: Axes, curves: Sequence[Curve], i: int, j: int) -> None:
    """One entry of H of every curve, with the rigid body's line of the first."""
    rigid = abs(curves[0].rigid[i, j])
    if all(_vanishes(curve.mass.matrix, i, j) for curve in curves):
        for axes in (upper, lower):
            axes.set(xticks=[], yticks=[])
            for side in axes.spines.values():
                side.set_color("#d9dde3")
        upper.text(0.5, 0.4, "below 1e-6 of its block", transform=upper.transAxes, ha="center", color=FAINT, fontsize=9)
        return
    lines, measured = iter(zip(CURVES, DASHES, strict=True)), any(curve.dots for curve in curves)
    for curve in curves:
        if curve.dots:
            _dots(upper, lower, curve, i, j)
        else:
            colour, dash = next(lines)
            _line(upper, lower, curve, i, j, colour, dash, curve.name, above=measured)
    if rigid > NOTHING * np.abs(curves[0].rigid).max():
        upper.axhline(rigid, color=INK, linewidth=1.0, linestyle=(0, (5, 3)), label="rigid body", zorder=1)
    _dress(upper, lower, np.concatenate([curve.mass.frequency for curve in curves]))
    _at_least_a_decade(upper)


def _legend(figure: Figure, upper: Axes, size: float) -> None:
    """In the panel where it is small, else beside the title: a large one hides what it explains."""
    handles, labels = upper.get_legend_handles_labels()
    if len(labels) <= FEW:
        upper.legend(fontsize=size, loc="best", framealpha=0.85)
        return
    _, height = figure.get_size_inches()
    place: dict[str, Any] = {"loc": "upper right", "bbox_to_anchor": (0.985, 1 - 0.25 / height), "ncols": len(labels)}
    figure.legend(handles, labels, fontsize=10, frameon=False, markerscale=2, handlelength=1.6, **place)


def _vanishes(H: ComplexArray, i: int, j: int) -> bool:
    rows, columns = (slice(0, 3) if k < 3 else slice(3, 6) for k in (i, j))
    return bool(np.abs(H[:, i, j]).max() <= NOTHING * np.abs(H[:, rows, columns]).max())


def _line(
    upper: Axes,
    lower: Axes,
    curve: Curve,
    i: int,
    j: int,
    colour: str,
    dash: str,
    label: str,
    width: float = 1.3,
    *,
    above: bool = False,
) -> None:
    """A curve; `above` dots it has a rim, so that both are seen where they agree."""
    from matplotlib.patheffects import Normal, withStroke

    f, H = curve.mass.frequency, curve.mass.matrix[:, i, j]
    look: dict[str, Any] = {"color": colour, "linestyle": dash, "linewidth": width, "zorder": 3 if above else 2}
    if above:
        look["path_effects"] = [withStroke(linewidth=width + 1.0, foreground=INK), Normal()]
    upper.semilogy(f, np.abs(H), label=label, **look)
    lower.plot(f, _phase(H), **look)


def _dots(upper: Axes, lower: Axes, curve: Curve, i: int, j: int) -> None:
    f, H = curve.mass.frequency, curve.mass.matrix[:, i, j]
    look: dict[str, Any] = {"color": curve.dots, "linestyle": "none", "marker": "o", "markersize": 4.2, "markeredgewidth": 0}
    upper.semilogy(f, np.abs(H), label=curve.name, **look)
    lower.plot(f, np.degrees(np.angle(H)), **look)


def _phase(H: ComplexArray) -> Array:
    """Phase [°], -180 to 180, broken where it jumps from one end to the other: a line there would be no phase."""
    phase = np.degrees(np.angle(H))
    jumps = np.flatnonzero(np.abs(np.diff(phase)) > 270)
    phase[jumps] = np.nan
    return np.asarray(phase)


def _dress(upper: Axes, lower: Axes, f: Array) -> None:
    from matplotlib.ticker import MaxNLocator

    upper.set_xlim(f.min(), f.max())
    lower.set_ylim(-195, 195)
    lower.set_yticks([-180, -90, 0, 90, 180])
    lower.xaxis.set_major_locator(MaxNLocator(7, steps=[1, 2, 4, 5, 10]))
    upper.tick_params(labelbottom=False)
    for axes in (upper, lower):
        grid_lines(axes)
    upper.grid(visible=True, which="minor", axis="y", color="#f0f2f5", linewidth=0.5)


def grid_lines(axes: Axes) -> None:
    """Faint lines behind the curves, small figures beside them."""
    axes.grid(visible=True, which="major", color="#e3e6ec", linewidth=0.7)
    axes.tick_params(labelsize=8.5, colors=INK)
    axes.set_axisbelow(True)


def _at_least_a_decade(upper: Axes) -> None:
    """What is flat is to look flat."""
    low, high = upper.get_ylim()
    if high < 10 * low:
        middle = np.sqrt(low * high)
        upper.set_ylim(middle / 10, middle * 10)


def _mark(upper: Axes, curve: Curve, entries: Sequence[int]) -> None:
    """Ticks on the upper edge at the eigenfrequencies that a diagonal entry of `entries` shows, with figures where they fit."""
    low, high = upper.get_xlim()
    whole = np.diag(curve.rigid)[list(entries)]
    shows = np.any(curve.modes.effective_mass[:, list(entries)] > SHOWS * whole, axis=1)
    last = -np.inf
    for f in curve.modes.frequency[shows & (curve.modes.frequency > low) & (curve.modes.frequency < high)]:
        upper.axvline(f, ymin=0.965, color=FAINT, linewidth=1.0)
        if f - last > ROOM_FOR_A_FIGURE * (high - low):
            upper.text(f, 1.012, f"{f:.1f}", transform=upper.get_xaxis_transform(), ha="center", fontsize=7.2, color=FAINT)
            last = f


def new_figure(width: float, height: float) -> Figure:
    """An empty page of so many inches."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure as Page

    figure = Page(figsize=(width, height), dpi=DPI, facecolor=PAPER)
    FigureCanvasAgg(figure)
    return figure


def finish(figure: Figure, title: str, note: str, path: Path, about: str = "") -> None:
    """Write title and note onto `figure`, and `figure` to `path`; a PNG carries the words `about`."""
    width, height = figure.get_size_inches()
    figure.text(0.4 / width, 1 - 0.3 / height, title, fontsize=17, weight="bold", color=INK, va="top", parse_math=False)
    figure.text(0.4 / width, 0.14 / height, note, fontsize=9.5, color=FAINT, va="bottom", parse_math=False)
    more = {"metadata": {ABOUT: about}} if about else {}
    save(path, lambda temporary: figure.savefig(temporary, dpi=DPI, **more))
