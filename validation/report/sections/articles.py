"""The articles, rendered, and their reference tables: three routes beside print, weighing and pendulum."""

from __future__ import annotations

from collections.abc import Sequence

from geometry.routes import ROUTES
from validation.reference_table import IDENTIFIED, ReferenceTable, row, verdict
from validation.report.figures import Figures
from validation.report.markup import Safe, tag
from validation.report.nouns import ArticlePart, Report
from validation.report.sections.parts import notes, picture, section
from validation.report.tables import NOTHING, Cell, Column, Number, number, table, toleranced
from validation.rows import Row
from validation.statement import QUANTITIES, Statement
from validation.tables.grid import notes as table_notes
from validation.tables.grid import values


def html(report: Report, figures: Figures) -> Safe:
    """The section; empty where no article is known by itself."""
    if not report.articles:
        return Safe("")
    return section("articles", "Articles and their reference", *(_article(one) for one in report.articles))


def _article(one: ArticlePart) -> Safe:
    tables = (_values(one.table), _deviations(one.table), notes(table_notes(one.table))) if one.table is not None else ()
    return tag("div", tag("h3", one.name), picture(one.picture), *tables, notes(one.missing), class_="part")


def _values(of: ReferenceTable) -> Safe:
    """What every column says, each with its tolerance in a column of its own where it states one."""
    printed = values(of)
    texts = {name: [line[k].strip() for line in printed.lines] for k, name in enumerate(of.columns, start=1)}
    stated = {name: [_stated(of, name, k, texts[name][k]) for k in range(len(QUANTITIES))] for name in of.columns}
    wide = {name for name, cells in stated.items() if any(tolerance is not NOTHING for _, tolerance in cells)}
    columns = [Column(head="quantity", words=True), Column(head="unit", words=True)]
    for name, said in of.columns.items():
        columns += [Column(head=_head(name, said)), *([Column(head=f"± {_head(name, said)}")] if name in wide else [])]
    rows = [
        [quantity.label, quantity.unit, *(cell for name in of.columns for cell in stated[name][k][: 1 + (name in wide)])]
        for k, quantity in enumerate(QUANTITIES)
    ]
    return table(f"{of.article}: mass, CoG and inertia", columns, rows)


def _head(column: str, said: Statement) -> str:
    """Of a column; what somebody printed as identified is not what was identified here."""
    return f"{said.name}, in print" if column == IDENTIFIED else said.name


def _stated(of: ReferenceTable, name: str, k: int, text: str) -> tuple[Cell, Cell]:
    """Value and tolerance, with the digits of the printed table; of a measurement with those that its tolerance leaves it."""
    stated, per_si = of.stated(name, k), QUANTITIES[k].per_si
    if stated is None:
        return NOTHING, NOTHING
    value, tolerance = stated.value * per_si, (stated.tolerance or 0.0) * per_si
    if name in ROUTES:
        return Number(value=value, text=text), NOTHING
    if stated.decimals is None:
        return toleranced(value, tolerance), toleranced(tolerance, tolerance) if tolerance else NOTHING
    own, apart, spread = text.partition(" ± ")
    return Number(value=value, text=own), Number(value=tolerance, text=spread) if apart else NOTHING


def _deviations(of: ReferenceTable) -> Safe:
    """How far the columns lie from the reference: per cent, of the CoG and where the reference is zero in its own unit."""
    every = range(len(QUANTITIES))
    groups = {"routes": [name for name in of.columns if name in ROUTES]}
    groups |= {_head(name, said): [name] for name, said in of.columns.items() if name not in ROUTES}
    compared = {name: [_farthest(of, own, k) for k in every] for name, own in groups.items()}
    compared = {name: found for name, found in compared.items() if any(found)}
    columns = [Column(head="deviation", words=True), Column(head="unit", words=True)]
    columns += [column for name in compared for column in (Column(head=name), Column(head="in tol."))]
    rows = [
        [
            QUANTITIES[k].label,
            _unit(of, k),
            *(cell for found in compared.values() for cell in _deviation(found[k])),
            verdict(of, k),
        ]
        for k in every
    ]
    head = f"{of.article}: deviation from the reference and verdict"
    return table(head, [*columns, Column(head="verdict", words=True)], rows) if compared else Safe("")


def _farthest(of: ReferenceTable, names: Sequence[str], k: int) -> Row | None:
    """Of the columns `names` that which deviates most; None where none is compared."""
    compared = [one for name in names if (one := row(of, name, k)) is not None]
    return max(compared, key=lambda one: abs(one.deviation or 0.0), default=None)


def _in_own_unit(of: ReferenceTable, k: int) -> bool:
    against = of.reference_columns[k]
    known = None if against is None else of.stated(against, k)
    return 1 <= k <= 3 or known is None or known.value == 0


def _unit(of: ReferenceTable, k: int) -> str:
    return QUANTITIES[k].unit if _in_own_unit(of, k) else "%"


def _deviation(one: Row | None) -> tuple[Cell, Cell]:
    if one is None:
        return NOTHING, NOTHING
    own = one.unit == "mm" or one.deviation_percent is None
    shown = number(one.deviation if own else one.deviation_percent, "+.3g")
    return shown, number(one.deviation_in_tolerances, "+.2f")
