"""Dynamic masses drawn as structural-dynamics engineers read them: magnitude (logarithmic) above phase, over frequency.

The rigid body's line is drawn in, since the way a curve leaves it is the whole story, and every resonance is marked.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain, count
from pathlib import Path
from typing import Any

import numpy as np

from geometry.dynamic_mass import SIGNS, ComplexArray, DynamicMass
from geometry.frames import Array
from validation.report.charts import static
from validation.report.charts.spec import COLOURS, CURVES, FAINT, Curve, EntryPanel

# Colours: one a material, the same in every picture; red, green and blue belong to the principal axes 1, 2 and 3.


MATERIALS = {
    "steel": "#54708a",
    "aluminium": "#9fc3d6",
    "silicone": "#f28a1c",
    "cast-carbon-steel": "#4b5563",
    "brass": "#c9a227",
    "oak": "#a0703c",
    "titanium": "#8d80a8",
    "cfrp": "#33373d",
}
OTHERS = ("#7fa36b", "#b5838d", "#5f9ea0", "#b8a04a", "#8f8fc4", "#a86f4f")
"""Materials without a colour of their own take these in turn, in alphabetical order."""
ELLIPSOID = "#8e6fc0"
UNCOUNTED = "#9aa0a6"


def colours(materials: Iterable[str]) -> dict[str, str]:
    """A colour for each of `materials`, alphabetical."""
    names = sorted(set(materials))
    strangers = [name for name in names if name not in MATERIALS]
    return {name: MATERIALS.get(name) or OTHERS[strangers.index(name) % len(OTHERS)] for name in names}


AXES = ("#c8283c", "#1f8a4c", "#2456c4")
"""Of x, y, z and of α, β, γ where they share a panel."""

WIDTHS = (2.8, 1.9, 1.1)
"""Of these: where curves coincide, all of them are seen."""

NOTHING = 1e-6
"""An entry smaller than this share of its block's largest is nothing: symmetry makes it zero, rounding or a mesh almost."""

SHOWS = 1e-3
"""Share of the rigid body that a mode must carry along an axis to be marked there."""

ROOM_FOR_A_FIGURE = 0.075
"""Of the width of a panel."""

TITLE_ABOVE_FIGURES = 13
"""Points between a panel and its title, so that the figures of `mark` stand below it."""

FEW = 3
"""Names that a legend inside a panel has at most."""

DEEPEST = 1e5
"""Of the largest magnitude in a panel of a chosen entry; what is smaller is off the page."""


@dataclass(frozen=True, eq=False, kw_only=True)
class DynamicMassCurve:
    """A dynamic mass to be drawn.

    Attributes
    ----------
    name : of the model or the article
    mass : on the lines to be drawn
    rigid : (6, 6) mass matrix of the rigid body about the same point
    marked : (m,) [Hz] eigenfrequencies of its modes, or of elastic terms that were identified
    effective_mass : (m, 6) [kg], [kg m²] what each of them carries along every axis
    dots : role of a measured dynamic mass, drawn line by line; empty for a model
    """

    name: str
    mass: DynamicMass
    rigid: Array
    marked: Array
    effective_mass: Array
    dots: str = ""

    def entry(self, i: int, j: int) -> Curve:
        """The curve of one entry."""
        values = self.mass.matrix[:, i, j]
        return Curve(name=self.name, frequency=self.mass.frequency, values=values, role=self.dots, dots=bool(self.dots))


def entry_of(curves: Sequence[DynamicMassCurve], i: int, j: int) -> EntryPanel:
    """One entry of H of every curve, with the rigid body's line of the first; none where all of them vanish."""
    rigid = abs(curves[0].rigid[i, j])
    return EntryPanel(
        unit=unit(i, j),
        curves=() if all(_vanishes(one.mass.matrix, i, j) for one in curves) else tuple(one.entry(i, j) for one in curves),
        rigid=float(rigid) if rigid > NOTHING * np.abs(curves[0].rigid).max() else None,
    )


def diagonal(title: str, curves: Sequence[DynamicMassCurve], path: Path, note: str = "") -> None:
    """Write a picture of the six diagonal entries of `curves`, each magnitude over phase.

    Raises
    ------
    BadInput : the ending of `path` is unknown.
    """
    figure = static.new_figure(15.0, 10.2)
    grid = figure.add_gridspec(5, 3, height_ratios=(3, 1.15, 0.42, 3, 1.15), hspace=0.09, wspace=0.2, **_ROOM)
    for i in range(6):
        top, column = 3 * (i // 3), i % 3
        upper = figure.add_subplot(grid[top, column])
        lower = figure.add_subplot(grid[top + 1, column], sharex=upper)
        static.draw_entry(upper, lower, entry_of(curves, i, i))
        upper.set_title(f"$H_{{{SIGNS[i]}{SIGNS[i]}}}$", fontsize=12, loc="left", pad=TITLE_ABOVE_FIGURES)
        mark(upper, curves[0], (i,))
        upper.set_ylabel(f"|H| [{unit(i, i)}]", fontsize=9.5)
        lower.set_ylabel("phase [°]", fontsize=9.5)
        if i >= 3:
            lower.set_xlabel("frequency [Hz]", fontsize=9.5)
        if i == 0:
            _legend(figure, upper, 8.5)
    static.finish(figure, title, note, path)


def full(title: str, curves: Sequence[DynamicMassCurve], path: Path, note: str = "") -> None:
    """Write a picture of all 36 entries of `curves`, magnitude over phase; rows are loads, columns base motions.

    Raises
    ------
    BadInput : the ending of `path` is unknown.
    """
    figure = static.new_figure(20.0, 19.0)
    outer = figure.add_gridspec(6, 6, hspace=0.22, wspace=0.3, left=0.05, right=0.985, top=0.935, bottom=0.05)
    for i in range(6):
        for j in range(6):
            inner = outer[i, j].subgridspec(2, 1, height_ratios=(2.6, 1), hspace=0.07)
            upper = figure.add_subplot(inner[0])
            lower = figure.add_subplot(inner[1], sharex=upper)
            static.draw_entry(upper, lower, entry_of(curves, i, j))
            label = f"$H_{{{SIGNS[i]}{SIGNS[j]}}}$ [{unit(i, j)}]"
            upper.set_title(label, fontsize=9.5, loc="left", pad=2.5)
            for axes in (upper, lower):
                axes.tick_params(labelsize=7)
            if i == 5:
                lower.set_xlabel("frequency [Hz]", fontsize=8.5)
            if (i, j) == (0, 0):
                _legend(figure, upper, 7)
    static.finish(figure, title, note, path)


def chosen(title: str, panels: Sequence[tuple[str, int, int, Sequence[DynamicMassCurve]]], path: Path, note: str = "") -> None:
    """Write a picture of single entries of H, at most six, each magnitude over phase.

    Parameters
    ----------
    panels : words for the article, row, column, and the curves of that entry

    Raises
    ------
    BadInput : the ending of `path` is unknown.
    """
    figure = static.new_figure(15.0, 10.2 if len(panels) > 3 else 6.0)
    ratios = (3, 1.15, 0.55, 3, 1.15) if len(panels) > 3 else (3, 1.15)
    grid = figure.add_gridspec(len(ratios), 3, height_ratios=ratios, hspace=0.09, wspace=0.3, **_ROOM | {"left": 0.07})
    for k, (words, i, j, curves) in enumerate(panels):
        top = 3 * (k // 3)
        upper = figure.add_subplot(grid[top, k % 3])
        lower = figure.add_subplot(grid[top + 1, k % 3], sharex=upper)
        shown = [curve for curve in curves if not _vanishes(curve.mass.matrix, i, j)] or list(curves)
        static.draw_entry(upper, lower, entry_of(shown, i, j))
        nothing = ", ".join(curve.name for curve in curves if curve not in shown)
        if nothing:
            upper.text(0.02, 0.04, f"{nothing}: nothing", transform=upper.transAxes, fontsize=9, color=FAINT)
        upper.set_title(f"$H_{{{SIGNS[i]}{SIGNS[j]}}}$", fontsize=12, loc="left", pad=TITLE_ABOVE_FIGURES)
        upper.set_title(words, fontsize=9.5, loc="right", color=FAINT, pad=TITLE_ABOVE_FIGURES, parse_math=False)
        mark(upper, curves[0], (i, j))
        low, high = upper.get_ylim()
        upper.set_ylim(max(low, high / DEEPEST), high)
        upper.set_ylabel(f"|H| [{unit(i, j)}]", fontsize=9.5)
        lower.set_ylabel("phase [°]", fontsize=9.5)
        lower.set_xlabel("frequency [Hz]", fontsize=9.5)
    _names(figure, [curve for *_, curves in panels for curve in curves])
    static.finish(figure, title, note, path)


def _names(figure: static.Figure, curves: Sequence[DynamicMassCurve]) -> None:
    """A legend beside the title, of all curves of a page whether a panel has room for them or not."""
    from matplotlib.lines import Line2D

    handles: dict[str, Any] = {}
    lines = iter(zip(CURVES, static.DASHES, strict=False))
    for curve in curves:
        if curve.name not in handles:
            colour, dash = (COLOURS[curve.dots][0], "none") if curve.dots else next(lines)
            marker = "o" if curve.dots else None
            look: dict[str, Any] = {"color": colour, "linestyle": dash, "marker": marker}
            handles[curve.name] = Line2D([], [], **look, markersize=5, label=curve.name)
    _, height = figure.get_size_inches()
    place: dict[str, Any] = {"loc": "upper right", "bbox_to_anchor": (0.985, 1 - 0.25 / height)}
    figure.legend(handles=list(handles.values()), ncols=len(handles), fontsize=10, frameon=False, **place)


def unit(row: int, column: int) -> str:
    """Unit of an entry of H."""
    return ("kg", "kg m", "kg m²")[(row >= 3) + (column >= 3)]


_ROOM = {"left": 0.06, "right": 0.985, "top": 0.895, "bottom": 0.085}


def _legend(figure: static.Figure, upper: static.Axes, size: float) -> None:
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


def mark(upper: static.Axes, curve: DynamicMassCurve, entries: Sequence[int]) -> None:
    """Ticks on the upper edge at the eigenfrequencies that a diagonal entry of `entries` shows, with figures where they fit."""
    low, high = upper.get_xlim()
    whole = np.diag(curve.rigid)[list(entries)]
    shows = np.any(curve.effective_mass[:, list(entries)] > SHOWS * whole, axis=1)
    last = -np.inf
    for f in curve.marked[shows & (curve.marked > low) & (curve.marked < high)]:
        upper.axvline(f, ymin=0.965, color=FAINT, linewidth=1.0)
        if f - last > ROOM_FOR_A_FIGURE * (high - low):
            upper.text(f, 1.012, f"{f:.1f}", transform=upper.get_xaxis_transform(), ha="center", fontsize=7.2, color=FAINT)
            last = f


# Labels that do not cover one another: each takes the first free place around its anchor.


STEPS = (1.0, 1.8, 2.8, 4.0, 6.0, 9.0)
"""Distances that are tried first, in units of the label's own; then ever farther ones, `FARTHER` apart."""

FARTHER = 2.0

TURNS = np.radians([0, 25, -25, 50, -50, 80, -80, 120, -120, 160, -160])
"""Directions that are tried, from the wished one."""

Box = tuple[Array, tuple[float, float]]
"""Middle (2,), and width and height [pixel]."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Label:
    """A text with the place it belongs to.

    Attributes
    ----------
    text : what is written; may hold mathematics between dollar signs
    anchor : (2,) [pixel], what it names, from the upper left corner
    wish : (2,), the direction in which it would like to stand, of any length
    extent : width and height of the text [pixel]
    gap : least distance between anchor and the text's middle [pixel]
    """

    text: str
    anchor: Array
    wish: Array
    extent: tuple[float, float]
    gap: float
    colour: str

    def candidates(self, rounds: Iterable[int]) -> Iterator[Array]:
        """Places around the anchor, the nearest first; after `STEPS` come as many farther ones as `rounds` has."""
        length = float(np.linalg.norm(self.wish))
        wish = self.wish / length if length > 0 else np.array([1.0, 0.0])
        for step in chain(STEPS, (STEPS[-1] + FARTHER * k for k in rounds)):
            for c, s in zip(np.cos(TURNS), np.sin(TURNS), strict=True):
                direction = np.array([c * wish[0] - s * wish[1], s * wish[0] + c * wish[1]])
                reach = self.gap * step + np.abs(direction) @ np.array(self.extent) / 2
                yield np.asarray(self.anchor + reach * direction)


def arranged(labels: Sequence[Label], taken: Iterable[Box] = (), room: Box | None = None) -> list[Array]:
    """The middle (2,) [pixel] of every label.

    No two labels cover one another and none covers what is `taken`. A label lies within `room` as long as that has a free place
    for it in one of the directions tried; None is a page without end.
    """
    boxes = list(taken)
    places = []
    for label in labels:
        # The first candidate that covers nothing: within `room`, or else outside of it, where there is always one
        extent, inside = np.array(label.extent), []
        if room is not None:
            nearby = label.candidates(range(1, 2 + int(sum(room[1]) / (FARTHER * label.gap))))
            inside = [one for one in nearby if np.all(np.abs(one - room[0]) <= (np.array(room[1]) - extent) / 2)]
        place = next(
            one
            for one in chain(inside, label.candidates(count(1)))
            if not any(np.all(np.abs(one - middle) < (extent + np.array(size)) / 2) for middle, size in boxes)
        )
        boxes.append((place, label.extent))
        places.append(place)
    return places
