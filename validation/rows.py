"""`Row`: one quantity with its tolerance beside its reference, and what becomes of a list of them.

`weigh`, `cog`, `pendulum` and `validate` all answer with rows. The deviation is relative to the reference, as in the paper's
Tables 1 and 2 (there the finite-element value). The verdict compares the deviation with both tolerances in quadrature; what
states no tolerance counts as exact, so a row without any is within only where the values coincide. A row without a reference
has nothing that contradicts it and is within.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from validation.output import plain_unit

if TYPE_CHECKING:
    from rich.table import Table
    from rich.text import Text

NONE = "–"

SMALL, LARGE = 1e-6, 1e7
"""Outside of these a figure has an exponent: its zeros would have to be counted."""

FIGURES = ("value\n± tolerance", "reference", "deviation", "in tol.", "within")
"""Headings of the columns that hold figures."""

MIN_WORDS = 11
"""Columns below which words are not squeezed: room for "CoG [kg m²]"."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Row:
    """One line of a table of results.

    Attributes
    ----------
    quantity : what it is, in the field's words, with the point it refers to
    value : in `unit`
    tolerance : in `unit`, of `value`; None where none is stated
    unit : as printed, for example "kg m²"
    reference : in `unit`; None where nothing is known to hold the value against
    reference_tolerance : in `unit`; None where none is stated
    dominated_by : name of the input that contributes most to `tolerance`; empty where nothing is propagated
    """

    quantity: str
    value: float
    tolerance: float | None
    unit: str
    reference: float | None = None
    reference_tolerance: float | None = None
    dominated_by: str = ""

    @property
    def deviation(self) -> float | None:
        """Value minus reference, in `unit`."""
        return None if self.reference is None else self.value - self.reference

    @property
    def deviation_percent(self) -> float | None:
        """Deviation in per cent of the reference; None without a reference or where the reference is zero."""
        return None if not self.reference or self.deviation is None else 100 * self.deviation / abs(self.reference)

    @property
    def combined_tolerance(self) -> float:
        """Both tolerances in quadrature, in `unit`."""
        return math.hypot(self.tolerance or 0.0, self.reference_tolerance or 0.0)

    @property
    def deviation_in_tolerances(self) -> float | None:
        """Deviation in units of the combined tolerance; None without a reference or without any tolerance."""
        return None if self.deviation is None or self.combined_tolerance == 0 else self.deviation / self.combined_tolerance

    @property
    def within(self) -> bool:
        """Whether value and reference agree within the combined tolerance."""
        return self.deviation is None or abs(self.deviation) <= self.combined_tolerance


def rows_json(rows: Iterable[Row]) -> list[dict[str, Any]]:
    """`rows` as the output contract has them; more keys than the contract's eight may follow them.

    `within` is true as well where nothing contradicts because nothing is known: `compared` tells the two apart.
    """
    return [
        {
            "quantity": row.quantity,
            "value": row.value,
            "tolerance": row.tolerance,
            "unit": plain_unit(row.unit),
            "reference": row.reference,
            "deviation_percent": row.deviation_percent,
            "within": row.within,
            "dominated_by": row.dominated_by,
            "reference_tolerance": row.reference_tolerance,
            "deviation_in_tolerances": row.deviation_in_tolerances,
            "compared": row.reference is not None,
        }
        for row in rows
    ]


def rows_table(rows: Iterable[Row], title: str = "") -> Table:
    """`rows` as a table to print; a value is rounded to the second significant digit of its tolerance.

    It fits 80 columns: figures are never broken or cut, only words wrap.
    """
    from rich import box
    from rich.table import Table
    from rich.text import Text

    table = Table(
        title=headline(title) if title else None, title_justify="left", box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0), pad_edge=False
    )
    listed = list(rows)
    figures = list(zip(*(_cells(row)[1:-1] for row in listed), strict=True)) or [()] * len(FIGURES)
    table.add_column("quantity", min_width=MIN_WORDS)
    for heading, column in zip(FIGURES, figures, strict=True):
        add_figures(table, heading, column)
    table.add_column("dominated by", min_width=MIN_WORDS)
    for row in listed:
        table.add_row(*(Text(cell) for cell in _cells(row)), style=None if row.within else "bold red")
    return table


def add_figures(table: Table, heading: str, cells: Iterable[str]) -> None:
    """Add a column to `table` that is never narrower than its `heading` and its `cells`, which are never broken."""
    width = max(map(len, (*heading.splitlines(), *cells)))
    table.add_column(heading, justify="right", no_wrap=True, min_width=width)


def headline(title: str) -> Text:
    """`title` as it stands over a table: its first line bold, what follows ("constructed, not measured") to be seen as well."""
    from rich.text import Text

    first, *rest = title.splitlines()
    return Text("\n").join([Text(first, style="bold not italic"), *(Text(line, style="yellow not italic") for line in rest)])


def rounded(value: float | None, tolerance: float | None) -> str:
    """`value` with the digits that `tolerance` leaves it: two of the tolerance's, or six significant ones without any."""
    if value is None:
        return NONE
    if not tolerance:
        return f"{value:.6g}"
    decimals = 1 - math.floor(math.log10(tolerance))
    if SMALL <= max(abs(value), tolerance) < LARGE:
        return f"{round(value, decimals) + 0.0:.{max(decimals, 0)}f}"
    return f"{value:.{max(math.floor(math.log10(abs(value))) + decimals, 0)}e}" if value else "0"


def _cells(row: Row) -> tuple[str, ...]:
    percent, many = row.deviation_percent, row.deviation_in_tolerances
    own = rounded(row.value, row.tolerance)
    return (
        f"{row.quantity} [{row.unit}]",
        f"{own} ± {rounded(row.tolerance, row.tolerance)}" if row.tolerance else own,
        rounded(row.reference, row.reference_tolerance),
        NONE if percent is None else f"{percent:+.2f} %",
        NONE if many is None else f"{many:+.2f}",
        NONE if row.reference is None else ("yes" if row.within else "no"),
        row.dominated_by or NONE,
    )
