"""`massline simulate --list-effects`: what can be planted, with targets, units and limits."""

from __future__ import annotations

from validation.effects import described
from validation.effects.catalogue import FAMILIES
from validation.effects.family import Family
from validation.rows import NONE
from validation.tables.grid import Grid

NOTES = (
    "Write --effect ID=VALUE as in the first column, in SI. It may be repeated, with other targets as well.",
    "`massline effects ID` says more about one.",
)


def page_of_effects() -> str:
    """All of it as text."""
    from validation.tables.text import page

    return page("Effects that a virtual test can plant", (grid(),), NOTES)


def grid() -> Grid:
    """One line a family."""
    lines = tuple(
        (described.examples(family)[0], described.targets(family), _limits(family), family.what)
        for family in FAMILIES.values()
        if family.plant is not None
    )
    return Grid(header=("for example", "acts on", "from to", "what"), lines=lines, words=True)


def _limits(family: Family) -> str:
    return "\n".join(map(described.limits, described.sizes(family))) or NONE
