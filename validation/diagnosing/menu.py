"""The candidates: every effect of the catalogue that could act on these data, at the size at which it does nothing.

A resonator has no such size in its logarithm: it stands at next to nothing, at a frequency that `dictionary` moves.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import product

from geometry.errors import BadInput
from geometry.keys import nearest
from validation.diagnosing.bench import Bench
from validation.diagnosing.swinging import of_swings
from validation.effects.catalogue import FAMILIES
from validation.effects.family import (
    ACCELERATIONS,
    BODY_STAGE,
    CHANNEL_STAGE,
    FORCES,
    OPENED,
    STRUCTURE,
    STRUCTURE_STAGE,
    Family,
    Size,
)
from validation.effects.identifiers import Named
from validation.effects.reach import There, acts
from validation.effects.targets import Vocabulary
from validation.models.model import Added
from validation.models.pairing import vocabulary

SIDES = (STRUCTURE, FORCES, ACCELERATIONS)
"""What one level of a linear test shows; mistakes and what depends on the level are tested before."""

SHOWN = (STRUCTURE_STAGE, BODY_STAGE, CHANNEL_STAGE, OPENED)

RESONATOR = ("m", "f", "zeta")
"""Keys of the sizes of a resonator."""

TINY = 1e-6
"""[kg] of a resonator that does next to nothing."""

TINY_AT = {"m": TINY, "f": 1000.0, "zeta": 0.02}


def candidates(bench: Bench, *, only: Sequence[str] = (), leave_out: Sequence[str] = ()) -> tuple[Added, ...]:
    """What could be missing from the model of `bench`.

    Parameters
    ----------
    only : families or ids that are looked for; all where nothing is said
    leave_out : families or ids that are not

    Raises
    ------
    BadInput : one of `only` is no effect that could act on these data and be told by them.
    """
    found = tuple(one for one in _all(bench) if not _is_any(one.named, leave_out))
    for wanted in only:
        if not any(_is(one.named, wanted) for one in found):
            known = dict.fromkeys(name for one in found for name in (one.named.family, one.named.id))
            problem = "is no effect that could act on these data and be told by them"
            remedy = f"{nearest(wanted, known)}`massline effects` lists the catalogue"
            raise BadInput(source="--candidate", field=wanted, problem=problem, remedy=remedy)
    return tuple(one for one in found if not only or _is_any(one.named, only))


def looked_for(named: Named, only: Sequence[str], leave_out: Sequence[str]) -> bool:
    """Whether an effect is one of `only` (families or ids; all where nothing is said), and none of `leave_out`."""
    return (not only or _is_any(named, only)) and not _is_any(named, leave_out)


def _is_any(named: Named, names: Sequence[str]) -> bool:
    return any(_is(named, name) for name in names)


def _is(named: Named, name: str) -> bool:
    return named.family == name or named.id == name or named.id.startswith(f"{name}:")


def is_resonator(named: Named) -> bool:
    """Whether its frequency must be looked for."""
    return tuple(size.key for size in named.sizes) == RESONATOR


def _all(bench: Bench) -> Iterator[Added]:
    there, words = tuple(_there(bench)), vocabulary(bench.model, bench.campaigns)
    known = {one.named.id for one in bench.model.effects}
    families = [one for one in FAMILIES.values() if one.side in SIDES and one.stage in SHOWN]
    every = [named for family in families for named in _everywhere(family, words) if named.id not in known]
    found = [Added(named=one, fixed=_is_switch(one)) for one in every if any(acts(one, place) for place in there)]
    opened = _opened(bench, found)
    yield from (one for one in found if _has_equation(one) or one.named.id in opened)
    yield from (one for one in of_swings(bench) if one.named.id not in known)


def _there(bench: Bench) -> Iterator[There]:
    for one in bench.made:
        there = one.tested.carried.standing.there
        yield There(article=there.article, parts=there.parts, places=there.places, channels=one.measured.channels)


def _everywhere(family: Family, words: Vocabulary) -> Iterator[Named]:
    for targets in product(*(words.legal(kind) or () for kind in family.targets)):
        yield _at_nothing(family, targets)


def _has_equation(added: Added) -> bool:
    return FAMILIES[added.named.family].stage != OPENED


def _opened(bench: Bench, found: Sequence[Added]) -> set[str]:
    """Parameters that effects without an equation would open; a chain makes them when they are asked for."""
    asking = tuple(replace(one, fixed=False) for one in found if not _has_equation(one))
    return {one.name for made in bench.made for one in made.with_effects((*bench.model.effects, *asking)).parameters}


def _at_nothing(family: Family, targets: tuple[str, ...]) -> Named:
    sizes = family.sizes_at(targets)
    if tuple(size.key for size in sizes) == RESONATOR:
        return Named(family=family.name, targets=targets, values=TINY_AT)
    return Named(family=family.name, targets=targets, values={size.key: _nothing(size) for size in sizes})


def _nothing(size: Size) -> float:
    return size.null if size.plausible > 0 or size.default is None else size.default


def _is_switch(named: Named) -> bool:
    return bool(named.sizes) and all(size.whole for size in named.sizes)
