"""Modes of every set-up, and their shapes."""

from __future__ import annotations

import numpy as np

from geometry.arrays import Array
from validation.comparing.maps import Map
from validation.comparing.modes import NamedMode
from validation.report.figures import Figures
from validation.report.markup import Safe, joined, tag
from validation.report.nouns import Report
from validation.report.sections.parts import notes, picture, section
from validation.report.tables import NOTHING, Cell, Column, Number, number, table

SMALL = 1e-6
"""Share of the largest along an axis below which an effective mass is 0."""

FEWEST, MOST = 6, 20
"""Modes of a table: those within twice the band, but so many at least and at most."""

AXES = ("x", "y", "z", "α", "β", "γ")

NOTE = (
    "Base held, about F, as the plain fit has them with the effects of the model. Effective mass along and about every axis. "
    "The last modes of a model stand for the static answer of all others and are left out here."
)


def html(report: Report, figures: Figures) -> Safe:
    """The section; empty where nothing has modes."""
    found = report.comparison
    tables = [_table(of, modes) for of, modes in zip(found.maps, found.modes, strict=True) if modes]
    shapes = [tag("div", tag("h3", f"Shapes of {one.name}"), picture(one.shapes)) for one in report.articles if one.shapes]
    if not tables:
        return Safe("")
    return section("modes", "Modes", *tables, notes([NOTE]), *shapes)


def _table(of: Map, modes: tuple[NamedMode, ...]) -> Safe:
    columns = [Column(head="mode", words=True), Column(head="frequency", unit="Hz"), Column(head="damping ratio", unit="%")]
    columns += [Column(head=f"m eff {axis}", unit="kg" if k < 3 else "kg m²") for k, axis in enumerate(AXES)]
    largest = np.max([one.effective_mass or (0.0,) * 6 for one in modes], axis=0)
    rows = [_row(one, SMALL * largest) for one in shown(modes, float(of.frequency[-1]))]
    return joined(table(f"Modes of {of.configuration} ({of.data_set})", columns, rows))


def shown(modes: tuple[NamedMode, ...], top: float) -> tuple[NamedMode, ...]:
    """The modes that a page tells of data up to `top` [Hz]."""
    near = sum(one.frequency <= 2 * top for one in modes)
    return modes[: min(max(near, FEWEST), MOST)]


def _row(one: NamedMode, nothing: Array) -> list[Cell]:
    """A mode; what is below `nothing` along an axis is rounding."""
    masses = [_mass(mass, least) for mass, least in zip(one.effective_mass, nothing, strict=True)] if one.effective_mass else []
    none: list[Cell] = [NOTHING] * len(AXES)
    return [one.name, number(one.frequency, ".3f"), number(100 * one.damping_ratio, ".3g"), *(masses or none)]


def _mass(mass: float, least: float) -> Cell:
    return number(mass, ".3g") if mass > least else Number(value=mass, text="0")
