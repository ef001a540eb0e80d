"""`massline simulate --list-effects`: what can be planted, with targets, units and limits."""

from __future__ import annotations

from validation.effects.families import FAMILIES, Family, Size
from validation.rows import NONE
from validation.tables.grid import Grid
from validation.virtual_test.effects.planting import PLANTS


def page_of_effects() -> str:
    """All of it as text."""
    from validation.tables.text import page

    return page("Effects that a virtual test can plant", (grid(),), ("Write --effect ID=VALUE, as in the last column. SI.",))


def grid() -> Grid:
    """One line a family."""
    lines = tuple(
        (name, family.what, _targets(family), "\n".join(_sizes(family)) or NONE, family.example)
        for name, family in FAMILIES.items()
        if name in PLANTS
    )
    return Grid(header=("family", "what", "acts on", "size", "for example"), lines=lines, words=True)


def _targets(family: Family) -> str:
    words = [*family.targets]
    if family.optional:
        words[-1] = f"[{words[-1]}]"
    return ", ".join(words) or NONE


def _sizes(family: Family) -> list[str]:
    every = dict.fromkeys((*family.sizes, *(size for sizes in family.varying.values() for size in sizes)))
    return [_size(size) for size in every]


def _size(size: Size) -> str:
    limits = f"{size.low:g} or {size.high:g}" if size.whole else f"{size.low:.3g} to {size.high:.3g} {size.unit.replace('1', '')}"
    return f"{size.key}: {limits}".strip() if size.key else limits.strip()
