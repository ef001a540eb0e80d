"""Modes of every set-up, and their shapes."""

from __future__ import annotations

from validation.comparing.maps import Map
from validation.comparing.modes import NamedMode
from validation.report.figures import Figures
from validation.report.markup import Safe, joined, tag
from validation.report.nouns import Report
from validation.report.sections.parts import notes, picture, section
from validation.report.tables import Cell, Column, number, table

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
    rows = [_row(one) for one in shown(modes, float(of.frequency[-1]))]
    return joined(table(f"Modes of {of.configuration} ({of.data_set})", columns, rows))


def shown(modes: tuple[NamedMode, ...], top: float) -> tuple[NamedMode, ...]:
    """The modes that a page tells of data up to `top` [Hz]."""
    near = sum(one.frequency <= 2 * top for one in modes)
    return modes[: min(max(near, FEWEST), MOST)]


def _row(one: NamedMode) -> list[Cell]:
    masses = one.effective_mass or (None,) * 6
    return [
        one.name,
        number(one.frequency, ".3f"),
        number(100 * one.damping_ratio, ".3g"),
        *(number(mass, ".3g") for mass in masses),
    ]
