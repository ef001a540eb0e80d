"""A reference table as JSON: the output contract of `massline reference`."""

from __future__ import annotations

from typing import Any

from geometry.routes import ROUTES
from validation.reference_table import IDENTIFIED, MEASURED, PUBLISHED, ReferenceTable, rows, verdict
from validation.rows import rows_json
from validation.statement import QUANTITIES, Stated, Statement


def render(table: ReferenceTable) -> dict[str, Any]:
    """One article of the contract; published, measured and identified are null where nothing is stated."""
    return {
        "routes": {route: statement_json(table.columns[route]) for route in ROUTES if route in table.columns},
        **{c: statement_json(table.columns[c]) if c in table.columns else None for c in (PUBLISHED, MEASURED, IDENTIFIED)},
        "agree": table.agree,
        "agreement": table.agreement,
        "chord_m": table.chord,
        "changes": dict(table.changes),
        "rows": [
            {**line, "column": column, "reference_column": table.reference_columns[k]}
            for k in range(len(QUANTITIES))
            for column, one in rows(table, k)
            for line in rows_json([one])
        ],
        "verdict": {q.key: verdict(table, k) for k, q in enumerate(QUANTITIES)},
        "note": table.note,
        "warnings": list(table.warnings),
        "footnotes": list(table.footnotes),
    }


def statement_json(said: Statement) -> dict[str, Any]:
    """INERTIA of the contract with null for what is not stated, and the tolerances in the same shape."""
    return {
        **_shaped([_value(s) for s in said.values]),
        "about": "cog",
        "name": said.name,
        "source": said.source,
        "tolerance": {**_shaped([_tolerance(s) for s in said.values]), "note": said.tolerance_note},
    }


def _value(stated: Stated | None) -> float | None:
    return None if stated is None else stated.value


def _tolerance(stated: Stated | None) -> float | None:
    return None if stated is None else stated.tolerance


def _shaped(ten: list[float | None]) -> dict[str, Any]:
    shown = [None if v is None else _unrounded(v * q.per_si) for v, q in zip(ten, QUANTITIES, strict=True)]
    return {"mass_kg": shown[0], "cog_mm": shown[1:4], "moi_cog_kgm2": shown[4:7], "poi_cog_kgm2": shown[7:]}


def _unrounded(value: float) -> float:
    """Fifteen digits: what a printed 603.3 mm is, after its way through metres."""
    return float(f"{value:.15g}")
