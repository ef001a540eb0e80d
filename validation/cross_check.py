"""A result against its reference, row by row, and what to say about the whole.

*Within* means that a value differs from its reference by no more than the tolerance of the result and that of the reference, in
quadrature. A value that the result does not state, or that has no reference, is not judged but named.
"""

from __future__ import annotations

from dataclasses import dataclass

from geometry.consistency import judge
from validation.reference_table import held_against, in_tolerances
from validation.rows import Row
from validation.statement import QUANTITIES, Statement


@dataclass(frozen=True, eq=False, kw_only=True)
class CrossCheck:
    """What came of it.

    Attributes
    ----------
    rows : one for each value that both state
    not_stated : labels of the values that the result does not state
    not_known : labels of the values that it states and the reference does not
    physical : whether a body can have the stated parameters; None when too few are stated to tell
    physics : that verdict in words
    """

    rows: tuple[Row, ...]
    not_stated: tuple[str, ...]
    not_known: tuple[str, ...]
    physical: bool | None
    physics: str

    @property
    def outside(self) -> tuple[Row, ...]:
        """The rows that lie outside."""
        return tuple(row for row in self.rows if not row.within)

    @property
    def passed(self) -> bool:
        """Every row within, at least one of them, and no law of physics broken."""
        return bool(self.rows) and not self.outside and self.physical is not False


def cross_check(result: Statement, reference: Statement) -> CrossCheck:
    """Hold `result` against `reference`, both in one frame."""
    triples = list(zip(QUANTITIES, result.values, reference.values, strict=True))
    physical, physics = _physics(result)
    return CrossCheck(
        rows=tuple(
            held_against(q, said, known, ("result", f"reference ({reference.name})"))
            for q, said, known in triples
            if said is not None and known is not None
        ),
        not_stated=tuple(q.label for q, said, _ in triples if said is None),
        not_known=tuple(q.label for q, said, known in triples if said is not None and known is None),
        physical=physical,
        physics=physics,
    )


def summary(check: CrossCheck, against: str) -> str:
    """The verdict in a sentence."""
    if not check.rows:
        return f"nothing could be compared with {against}"
    if not check.outside:
        held = f"all {len(check.rows)} stated values agree with {against} within the combined tolerance"
    else:
        held = f"outside the combined tolerance of {against}: {', '.join(_named(row) for row in check.outside)}"
    return held if check.physical is not False else f"{held}; and {check.physics}"


def _named(row: Row) -> str:
    percent, many = row.deviation_percent, row.deviation_in_tolerances
    size = f"{row.deviation:+.3g} {row.unit}" if percent is None else f"{percent:+.2f} %"
    return f"{row.quantity} ({size}{in_tolerances(many, ', ')})"


def _physics(result: Statement) -> tuple[bool | None, str]:
    """The judgement on all ten values; on fewer only what no products could mend, for they leave the diagonal as it is."""
    if None in result.values[:7] or result.values[0] is None or result.values[0].value == 0:
        return None, "too few values are stated to judge whether a body can have them"
    verdict = judge(result.inertia, rounding=1e-9)
    if not verdict.physical:
        return False, f"no body has these parameters: {verdict.text}"
    if not result.complete:
        return None, "nothing speaks against a body with these parameters; without the products it cannot be proven"
    return True, f"a body can have these parameters: {verdict.text}"
