"""A reference table laid out as strings: two grids, the values and their deviations, and the notes below them.

No digit that was printed is lost, none is invented: a published value keeps its own decimals, a route is shown with one more than
the published value, or with six significant digits of the largest entry of its kind. The decimal points of a column line up.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from geometry.routes import ROUTES
from validation.reference_table import IDENTIFIED, MEASURED, PUBLISHED, ReferenceTable, row, verdict
from validation.rows import LARGE, NONE, Row
from validation.statement import COG, MASS, QUANTITIES, TENSOR, Quantity, Stated

SIGNIFICANT = 6

MANY_DECIMALS = 12
"""Decimals of `SIGNIFICANT` digits whose largest is too small to be written without an exponent."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Grid:
    """Header and lines of strings; the first column reads from the left, the last too when `words`, all else from the right."""

    header: tuple[str, ...]
    lines: tuple[tuple[str, ...], ...]
    words: bool = False


def values(table: ReferenceTable) -> Grid:
    """What every column says, with its tolerance where it has one that is more than rounding."""
    names = tuple(table.columns)
    body = [tuple(_value(table, column, k) for k in range(len(QUANTITIES))) for column in names]
    lines = tuple(zip(*((_labels(), *(aligned(column) for column in body))), strict=True))
    return Grid(header=("", *(table.columns[column].name for column in names)), lines=lines)


def grids(table: ReferenceTable) -> tuple[Grid, ...]:
    """The values and, where anything can be compared, their deviations."""
    return (values(table), deviations(table)) if _compared(table) else (values(table),)


def _compared(table: ReferenceTable) -> bool:
    """Whether any column has another to be held against."""
    return any(row(table, column, k) for column in table.columns for k in range(len(QUANTITIES)))


def deviations(table: ReferenceTable) -> Grid:
    """How far the columns lie from the reference, in per cent (CoG also in mm) and in combined tolerances, and the verdict.

    The routes share one column, which shows the one that lies farthest off.
    """
    all_k = range(len(QUANTITIES))
    routes = {"routes": [c for c in table.columns if c in ROUTES]}
    groups = routes | {said.name: [c] for c, said in table.columns.items() if c not in ROUTES}
    farthest = {name: [_farthest(table, columns, k) for k in all_k] for name, columns in groups.items()}
    compared = {name: rows for name, rows in farthest.items() if any(rows)}
    body = [
        cells
        for rows in compared.values()
        for cells in zip(*(_deviation(table, one, k) for k, one in enumerate(rows)), strict=True)
    ]
    verdicts = tuple(verdict(table, k) for k in all_k)
    header = [text for name in compared for text in (name, "tol.")]
    lines = tuple(zip(*((_labels(), *(aligned(cells) for cells in body), verdicts)), strict=True))
    return Grid(header=("deviation", *header, "verdict"), lines=lines, words=True)


def _farthest(table: ReferenceTable, columns: list[str], k: int) -> Row | None:
    """Of the rows of `columns` the one that deviates most; None where none is compared."""
    compared = [one for column in columns if (one := row(table, column, k)) is not None]
    return max(compared, key=lambda one: abs(one.deviation or 0.0), default=None)


def notes(table: ReferenceTable) -> tuple[str, ...]:
    """What must be known to read the table."""
    against = {PUBLISHED: "the published value", MEASURED: "the measured value"}
    kinds = dict.fromkeys(against.get(c, f"route {c}") for c in table.reference_columns if c is not None)
    deviation = (
        f"Deviations are from {' or, where none is printed, '.join(kinds)}; of the routes, the farthest is shown. "
        "tol.: in combined tolerances, beyond 1 is outside."
    )
    tolerances = tuple(
        f"Tolerance of {said.name}: {said.tolerance_note}."
        for column, said in table.columns.items()
        if column in (PUBLISHED, MEASURED, IDENTIFIED) and said.tolerance_note
    )
    return (
        *((table.note,) if table.note else ()),
        *((f"Routes: {table.agreement}.",) if table.agreement else ()),
        *((deviation,) if _compared(table) else ()),
        *tolerances,
        *table.footnotes,
    )


def _labels() -> tuple[str, ...]:
    return tuple(f"{q.label} [{q.unit}]" for q in QUANTITIES)


def _value(table: ReferenceTable, column: str, k: int) -> str:
    stated = table.stated(column, k)
    if stated is None:
        return NONE
    per_si = QUANTITIES[k].per_si
    printed = stated.decimals is not None
    decimals = stated.decimals if stated.decimals is not None else _decimals(table, k)
    text = number(stated.value * per_si, decimals)
    return f"{text} ± {_tolerance(stated, per_si, decimals)}" if printed and not _is_rounding(stated, per_si) else text


def _decimals(table: ReferenceTable, k: int) -> int:
    """Decimals of a value that nobody printed."""
    kind = next(span for span in (slice(MASS, 1), COG, TENSOR) if span.start <= k < span.stop)
    largest = max(
        (abs(stated.value) * q.per_si for c in table.columns for stated, q in _kind(table, c, kind) if stated is not None),
        default=0,
    )
    significant = SIGNIFICANT - 1 - math.floor(math.log10(largest)) if largest else SIGNIFICANT - 1
    published = [stated.decimals for stated, _ in _kind(table, PUBLISHED, kind) if stated and stated.decimals is not None]
    return max(significant, *(d + 1 for d in published), 0)


def _kind(table: ReferenceTable, column: str, kind: slice) -> list[tuple[Stated | None, Quantity]]:
    return [(table.stated(column, k), QUANTITIES[k]) for k in range(kind.start, kind.stop)]


def _is_rounding(stated: Stated, per_si: float) -> bool:
    """Whether the tolerance is half a unit of the last printed digit, which the digits say already."""
    if stated.tolerance is None or stated.decimals is None:
        return True
    return math.isclose(stated.tolerance * per_si, 0.5 * 10.0**-stated.decimals, rel_tol=1e-6)


def _tolerance(stated: Stated, per_si: float, decimals: int) -> str:
    """Two significant digits at the least, rounded up never away."""
    size = (stated.tolerance or 0.0) * per_si
    return number(size, max(decimals, 1 - math.floor(math.log10(size)) if size else 0))


def _deviation(table: ReferenceTable, one: Row | None, k: int) -> tuple[str, str]:
    if one is None or one.deviation is None:
        return NONE, NONE
    percent, many = one.deviation_percent, one.deviation_in_tolerances
    is_length = COG.start <= k < COG.stop
    own = f"{number(one.deviation, 2 if is_length else _decimals(table, k))} {one.unit}"
    relative = None if percent is None else f"{number(percent, 2)} %"
    size = relative if relative and not is_length else f"{own} ({relative})" if relative else own
    return size, NONE if many is None else _many(many)


def _many(many: float) -> str:
    """A deviation in tolerances; beyond a thousand the figure says nothing more."""
    return number(many, 1) if abs(many) < 1000 else f"{'-' if many < 0 else ''}>999"


def number(value: float, decimals: int) -> str:
    """`value` with `decimals`, or six significant digits and an exponent beyond `LARGE`; zero has no sign."""
    if abs(value) >= LARGE or decimals >= MANY_DECIMALS:
        return f"{value:.{SIGNIFICANT - 1}e}" if abs(value) >= 0.5 * 10.0**-decimals else "0"
    text = f"{value:.{decimals}f}"
    return text.lstrip("-") if float(text) == 0 else text


def aligned(cells: tuple[str, ...]) -> tuple[str, ...]:
    """`cells` padded so that their decimal points stand below each other."""
    parts = [at_point(cell) for cell in cells]
    left, right = (max((len(part[side]) for part in parts), default=0) for side in (0, 1))
    return tuple(f"{a:>{left}}{b:<{right}}" for a, b in parts)


def at_point(cell: str) -> tuple[str, str]:
    """`cell` before and from its first decimal point, or before its first space."""
    first = cell.split(" ")[0]
    whole = first.partition(".")[0]
    return whole, cell[len(whole) :]
