"""`ReferenceTable`: what the routes, print, balance, pendulum and identification say about one article, side by side.

Ten quantities by columns. Every column but one is held against the *reference* of its quantity: the published value (for Clumod
that of the FE model) where one is printed, as in the paper's Tables 1 and 2; the exact route where none is. A deviation is given
in per cent of the reference, in its own unit where the reference is zero, and in units of the combined tolerance (both in
quadrature). A quantity's verdict names the columns that lie outside.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from geometry.agreement import rounding
from geometry.arrays import Array
from geometry.frames import Pose
from geometry.inertia import Inertia
from validation.rows import Row
from validation.statement import QUANTITIES, Quantity, Stated, Statement, about_cog, jacobian, seen_from

PUBLISHED, MEASURED, IDENTIFIED = "published", "measured", "identified"


@dataclass(frozen=True, eq=False, kw_only=True)
class ReferenceTable:
    """One article's table.

    Attributes
    ----------
    article : its name
    note : what its geometry rests on
    columns : statements by column, the routes first; all in one frame
    agree : whether the routes agree
    agreement : that verdict in a sentence
    chord : largest chord error of the mesh route [m]; 0 where a mesh is taken as it is
    changes : the user's own dimensions that the routes rest on, by key, in the unit of the dimension file
    footnotes : what must be known to read it
    warnings : what was noticed on the way, in words; each is among the footnotes too
    """

    article: str
    columns: Mapping[str, Statement]
    note: str = ""
    agree: bool = True
    agreement: str = ""
    chord: float = 0.0
    changes: Mapping[str, float] = field(default_factory=dict)
    footnotes: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()

    @property
    def reference_columns(self) -> tuple[str | None, ...]:
        """For each of the ten quantities the column that it is held against; None where nobody states it."""
        order = (PUBLISHED, *self.columns)
        return tuple(next((c for c in order if self.stated(c, k) is not None), None) for k in range(len(QUANTITIES)))

    def stated(self, column: str, k: int) -> Stated | None:
        """What `column` says about quantity `k`."""
        return self.columns[column].values[k] if column in self.columns else None


def row(table: ReferenceTable, column: str, k: int) -> Row | None:
    """Quantity `k` of `column` beside its reference, in printed units; None where either is not stated or both are the same."""
    against = table.reference_columns[k]
    said = table.stated(column, k)
    if said is None or against is None or against == column:
        return None
    known = table.stated(against, k)
    return None if known is None else held_against(QUANTITIES[k], said, known, (table.columns[column].name, against))


def held_against(quantity: Quantity, said: Stated, known: Stated | None, names: tuple[str, str]) -> Row:
    """One stated value beside a known one, in printed units; `names` of the two say which tolerance dominates."""
    result = _shown(said.tolerance, quantity)
    limit = None if known is None else _shown(known.tolerance, quantity)
    return Row(
        quantity=quantity.label,
        value=said.value * quantity.per_si,
        tolerance=result,
        unit=quantity.unit,
        reference=None if known is None else known.value * quantity.per_si,
        reference_tolerance=limit,
        dominated_by=names[0] if (result or 0.0) >= (limit or 0.0) else names[1],
    )


def rows(table: ReferenceTable, k: int) -> Iterator[tuple[str, Row]]:
    """Every column that is held against the reference of quantity `k`."""
    for column in table.columns:
        if (one := row(table, column, k)) is not None:
            yield column, one


def verdict(table: ReferenceTable, k: int) -> str:
    """Quantity `k` in words."""
    held = list(rows(table, k))
    if not held:
        return "nothing to compare"
    outside = [f"{column} outside{_by(one)}" for column, one in held if not one.within]
    return "; ".join(outside) if outside else "all within"


def route_statement(name: str, inertia: Inertia, error: Array | None = None) -> Statement:
    """A route's `inertia` with what it may be off by: rounding, and `error` (10,) of its parameters about the origin, Eq. 4.

    A CoG coordinate or product that does not rise above rounding is zero: it is the symmetry of the body that it fails to show.
    """
    least = _spread(inertia, rounding(inertia))
    tolerance = least if error is None else np.hypot(least, _spread(inertia, error))
    values = about_cog(inertia)
    return Statement(
        name=name,
        values=tuple(
            Stated(value=0.0 if abs(v) <= zero else float(v), tolerance=float(t))
            for v, zero, t in zip(values, least, tolerance, strict=True)
        ),
        source=f"route {name}",
        tolerance_note="rounding" if error is None else "rounding and tessellation",
    )


def _spread(inertia: Inertia, error: Array) -> Array:
    """What `error` (10,) of the parameters about the origin, Eq. 4, makes of the values about the CoG, (10,)."""
    J = jacobian(lambda parameters: about_cog(Inertia(parameters=parameters)), inertia.about(np.zeros(3)).parameters)
    return np.asarray(np.sqrt(J**2 @ error**2))


def seen(table: ReferenceTable, frame: Pose) -> ReferenceTable:
    """`table` from the user's own `frame`, whose pose is given in the article's frame."""
    return replace(table, columns={column: seen_from(said, frame) for column, said in table.columns.items()})


def _shown(tolerance: float | None, quantity: Quantity) -> float | None:
    return None if tolerance is None else tolerance * quantity.per_si


def _by(one: Row) -> str:
    words = in_tolerances(one.deviation_in_tolerances)
    return f" ({words})" if words else ""


def in_tolerances(many: float | None, before: str = "") -> str:
    """A deviation in tolerances as words after `before`; empty without any."""
    if many is None:
        return ""
    return f"{before}{abs(many):.1f} tolerances" if abs(many) < 1000 else f"{before}over 999 tolerances"
