"""Reference tables as CSV: one line for each quantity and column, full precision, units in a column of their own.

Units are written in ASCII (kg m^2): a spreadsheet that is not told that a file is UTF-8 shows another sign for the raised 2.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Sequence

from validation.output import plain_unit
from validation.reference_table import ReferenceTable, row
from validation.statement import QUANTITIES

HEADER = (
    "article",
    "quantity",
    "unit",
    "column",
    "value",
    "tolerance",
    "reference_column",
    "reference",
    "deviation",
    "deviation_percent",
    "deviation_in_tolerances",
    "within",
)


def render(tables: Sequence[ReferenceTable]) -> str:
    """All `tables` as one CSV text with a header; what is not stated is empty."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(HEADER)
    for table in tables:
        writer.writerows(_lines(table))
    return text.getvalue()


def _lines(table: ReferenceTable) -> Iterator[tuple[object, ...]]:
    for k, quantity in enumerate(QUANTITIES):
        for column in table.columns:
            stated = table.stated(column, k)
            if stated is None:
                continue
            value = _printed(stated.value, quantity.per_si, stated.decimals)
            tolerance = "" if stated.tolerance is None else f"{stated.tolerance * quantity.per_si:.6g}"
            yield (
                table.article,
                quantity.key,
                plain_unit(quantity.unit),
                column,
                value,
                tolerance,
                *_held(table, column, k),
            )


def _held(table: ReferenceTable, column: str, k: int) -> tuple[object, ...]:
    one = row(table, column, k)
    if one is None:
        return ("",) * 6
    sizes = (one.reference, one.deviation, one.deviation_percent, one.deviation_in_tolerances)
    shown = ("" if size is None else f"{size:.9g}" for size in sizes)
    return (table.reference_columns[k], *shown, "yes" if one.within else "no")


def _printed(value: float, per_si: float, decimals: int | None) -> str:
    return f"{value * per_si:.12g}" if decimals is None else f"{value * per_si:.{decimals}f}"
