"""`massline effects`: the catalogue as a table, or one family on a page of its own."""

from __future__ import annotations

from collections.abc import Sequence

from geometry.errors import BadInput
from geometry.keys import nearest
from validation.effects import described
from validation.effects.catalogue import FAMILIES, SOURCES
from validation.effects.family import SIDES, Family
from validation.tables.grid import Grid

NOTE = "`massline effects ID` says more about one: what it means, its equation, what it is mistaken for, what would confirm it."


def chosen(names: Sequence[str]) -> tuple[tuple[Family, str], ...]:
    """The families that ``family`` or ``family:target`` name, each with its target; all of them where none is named.

    Raises
    ------
    BadInput : no such family, with the nearest; a target that it does not have.
    """
    from validation.effects.identifiers import parse

    if not names:
        return tuple((family, "") for family in FAMILIES.values())
    found = []
    for name in names:
        family, _, target = name.partition("=")[0].partition(":")
        if family not in FAMILIES:
            remedy = f"{nearest(family, FAMILIES)}`massline effects` lists all of them"
            raise BadInput(source="massline effects", field=name, problem=f"no effect is called {family!r}", remedy=remedy)
        known = FAMILIES[family]
        if target:
            value = described.examples(known)[0].partition("=")[2]
            parse(f"{family}:{target}={value}" if value else f"{family}:{target}", source="massline effects")
        found.append((known, target))
    return tuple(found)


def table() -> str:
    """All families as text, side by side of the laboratory."""
    from validation.tables.text import page

    sides = [side for side in SIDES if any(family.side == side for family in FAMILIES.values())]
    return "\n".join(page(side.capitalize(), (_grid(side),), (NOTE,) if side == sides[-1] else ()) for side in sides)


def whole(family: Family, target: str = "") -> str:
    """One family as text, at `target` where one is named."""
    from validation.tables.text import page

    lines = (
        ("means", described.sentence(family, target)),
        ("acts on", described.targets(family)),
        ("unit", described.unit(family)),
        ("size", "\n".join(map(described.limits, described.sizes(family))) or "there or not"),
        ("tolerance", described.tolerance(family)),
        ("plausible", described.plausible(family)),
        ("does", described.DOES[family.stage]),
        ("equation", family.equation),
        ("mistaken for", ", ".join(family.mistaken_for)),
        ("confirmed by", family.confirmed_by),
        ("reference", family.reference),
        ("written", "\n".join(described.examples(family))),
        ("from", SOURCES.get(family.name, "massline")),
    )
    grid = Grid(header=("", family.what), lines=lines, words=True)
    return page(described.identifier(family), (grid,))


def _grid(side: str) -> Grid:
    lines = tuple(
        (
            described.identifier(family),
            described.tolerance(family),
            described.plausible(family),
            family.what,
        )
        for family in FAMILIES.values()
        if family.side == side
    )
    return Grid(header=("effect", "tolerance", "plausible", "what"), lines=lines, words=True)
