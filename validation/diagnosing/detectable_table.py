"""The smallest sizes that would have been named, for people: by side of the catalogue and family, in units of a laboratory."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from validation.diagnosing.diagnosis import Detectable
from validation.diagnosing.practical import said
from validation.effects.catalogue import FAMILIES
from validation.tables.grid import Grid, aligned

SPREAD = 1.05
"""Factor between the least and the greatest of a family within which one figure says it."""


@dataclass(frozen=True, kw_only=True)
class Row:
    """A family, or what its targets have in common.

    Attributes
    ----------
    side : of the catalogue: "structure", "force side" and so on
    family : its name
    least, greatest : over its targets, SI
    unit : SI
    text : both in a practical unit: "12 mm", "1.5 % to 2.2 %"
    best, worst : targets of these, with what they belong to ("21 Hz"); empty where there is none
    count : targets
    """

    side: str
    family: str
    least: float
    greatest: float
    unit: str
    text: str
    best: str
    worst: str
    count: int


def rows(of: Sequence[Detectable]) -> tuple[Row, ...]:
    """`of` by family, in the order of the catalogue; a family that says its sizes in several units has a row for each."""
    return tuple(_rows(of))


def grid(of: Sequence[Detectable]) -> Grid:
    """`rows` as a table, each side of the catalogue under its heading."""
    lines: list[tuple[str, str, str]] = []
    side = ""
    for one in rows(of):
        lines += [(one.side, "", "")] if one.side != side else []
        lines.append((f"  {one.family}", one.text, _where(one)))
        side = one.side
    first, size, where = zip(*lines, strict=True)
    return Grid(
        header=("would have been named", "from", "at"), lines=tuple(zip(first, aligned(size), where, strict=True)), words=True
    )


def _rows(of: Sequence[Detectable]) -> Iterator[Row]:
    for name, family in FAMILIES.items():
        own = [one for one in of if one.id.partition(":")[0] == name]
        for unit in dict.fromkeys(one.unit for one in own):
            yield _row(family.side, name, unit, sorted((one for one in own if one.unit == unit), key=lambda one: one.size))


def _row(side: str, family: str, unit: str, of: Sequence[Detectable]) -> Row:
    least, greatest = of[0], of[-1]
    low, high = said(least.size, unit), said(greatest.size, unit)
    together = greatest.size <= SPREAD * least.size or low == high
    return Row(
        side=side,
        family=family,
        least=least.size,
        greatest=greatest.size,
        unit=unit,
        text=low if together else f"{low} to {high}",
        best=_target(least),
        worst="" if together else _target(greatest),
        count=len(of),
    )


def _target(of: Detectable) -> str:
    return ", ".join(part for part in (of.id.partition(":")[2], of.at and f"at {of.at}") if part)


def _where(of: Row) -> str:
    if of.count == 1:
        return of.best
    if not of.worst:
        return f"all {of.count} alike"
    return f"{of.best} to {of.worst}, {of.count} in all"
