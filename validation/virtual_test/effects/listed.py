"""`massline simulate --list-effects`: what can be planted, with targets, units and limits."""

from __future__ import annotations

from validation.effects.catalogue import FAMILIES
from validation.effects.family import Family, Size
from validation.rows import NONE
from validation.tables.grid import Grid
from validation.virtual_test.effects.planting import plant_of

NOTE = "Write --effect ID=VALUE as in the first column, in SI. It may be repeated, with other targets as well."


def page_of_effects() -> str:
    """All of it as text."""
    from validation.tables.text import page

    return page("Effects that a virtual test can plant", (grid(),), (NOTE,))


def grid() -> Grid:
    """One line a family."""
    lines = tuple(
        (family.example.split(", or ")[0], _targets(family), "\n".join(_sizes(family)) or NONE, family.what)
        for family in FAMILIES.values()
        if plant_of(family) is not None
    )
    return Grid(header=("for example", "acts on", "from to", "what"), lines=lines, words=True)


def _targets(family: Family) -> str:
    words = [*family.targets]
    if family.optional:
        words[-1] = f"[{words[-1]}]"
    return ", ".join(words) or NONE


def _sizes(family: Family) -> list[str]:
    every = dict.fromkeys((*family.sizes, *(size for sizes in family.varying.values() for size in sizes)))
    return [_size(size) for size in every]


def _size(size: Size) -> str:
    unit = "" if size.unit == "1" else f" {size.unit}"
    limits = f"{size.low:g} or {size.high:g}" if size.whole else f"{size.low:.3g} to {size.high:.3g}{unit}"
    return f"{size.key}: {limits}" if size.key else limits
