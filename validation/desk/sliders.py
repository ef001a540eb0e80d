"""Every effect of the catalogue that reaches these data, and the sliders that move it.

What is looked for by a diagnosis is its own list (`validation.diagnosing.menu`); mistakes, noise, and what depends on the level
or on how spectra are made come beside it here: everything that changes what is read, or how surely.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import product
from types import MappingProxyType

from validation.desk.table import Table, Tested
from validation.diagnosing import figures
from validation.effects.catalogue import FAMILIES
from validation.effects.described import examples
from validation.effects.family import OPENED, PERIOD_STAGE, Family, Size
from validation.effects.identifiers import Named, parse
from validation.effects.reach import acts
from validation.ladders.candidate import FIRST_GUESS
from validation.models.model import Added
from validation.prediction import swung

NONE: Mapping[str, float] = MappingProxyType({})

FAR = 5.0
"""Plausible faults from no effect to the end of a slider."""

WIDE, NARROW = 100.0, 10.0
"""Factors below and above where a size is likely, that is known to a factor; of a frequency."""

WORDS = {"m": "mass", "f": "frequency", "zeta": "damping ratio", "z": "height", "mass": "mass of what slips"}
"""Of sizes that do not stand alone, by key."""


@dataclass(frozen=True, kw_only=True)
class Slider:
    """One size of an effect.

    Attributes
    ----------
    key : as in ``key:number``; empty for the one that stands alone
    label : what it is, in words
    unit : SI; "1" for a ratio
    low, high : ends of the slider, SI, within what the catalogue allows
    start : where it begins: no effect where that is a size, else a size that is likely
    null : the size at which there is no effect; None where the slider does not reach one
    logarithmic : whether equal steps are equal factors; then `low` is above zero
    whole : a switch between `low` and `high`
    shown_unit, per_si : in which it reads best on the whole slider, and how many of it are one SI unit
    """

    key: str
    label: str
    unit: str
    low: float
    high: float
    start: float
    null: float | None
    logarithmic: bool
    whole: bool
    shown_unit: str
    per_si: float


@dataclass(frozen=True, eq=False, kw_only=True)
class Effect:
    """An effect that can be tried.

    Attributes
    ----------
    id : ``family:target``
    family, side : of the catalogue; sides are its headings
    what : in a few words
    sliders : none of a mistake that is there or not
    campaigns : names of those that it reaches; none of one that moves the period of a swing alone
    in_model : whether the model has it already; its sliders begin at its size
    """

    id: str
    family: str
    side: str
    what: str
    sliders: tuple[Slider, ...]
    campaigns: tuple[str, ...]
    in_model: bool

    def written(self, sizes: Mapping[str, float] = NONE) -> str:
        """The effect at `sizes` by key, as `validation.desk.whatif.what_if` takes it; where none are said at its start."""
        values = {one.key: sizes.get(one.key, one.start) for one in self.sliders}
        return str(Named(family=self.family, targets=tuple(self.id.split(":")[1:]), values=values))


def reaching(of: Table) -> tuple[Effect, ...]:
    """All that act on these data, in the order of the catalogue; those of the model are among them."""
    every = [named for family in FAMILIES.values() for named in _everywhere(of, family)]
    asked = tuple(Added(named=one) for one in every if FAMILIES[one.family].stage == OPENED)
    opened = [{each.name for each in one.prediction.with_effects(asked).parameters} for one in of.tested]
    found = []
    for named in every:
        there = tuple(one.name for one, names in zip(of.tested, opened, strict=True) if _reaches(named, one, names))
        if there or any(fact.swing is not None and swung.acts(named, fact.swing) for fact in of.facts):
            found.append(_effect(of, named, there))
    return tuple(found)


def _everywhere(of: Table, family: Family) -> Iterator[Named]:
    """The family at each of its targets here, at its start; a pair of channels once."""
    for targets in product(*(of.words.legal(kind) or () for kind in family.targets)):
        alike = len(set(family.targets)) < len(family.targets)
        if not alike or targets == tuple(sorted(set(targets))):
            known = next((one.named for one in of.model.effects if one.named.id == ":".join((family.name, *targets))), None)
            typical = parse(examples(family)[0]).values
            values = {size.key: _start(size, typical.get(size.key)) for size in family.sizes_at(targets)}
            yield known or Named(family=family.name, targets=targets, values=values)


def _reaches(named: Named, one: Tested, opened: Collection[str]) -> bool:
    family, there = FAMILIES[named.family], one.prediction.tested.carried.standing.there
    if family.stage == PERIOD_STAGE or (family.stage == OPENED and named.id not in opened):
        return False
    return acts(named, replace(there, channels=one.prediction.measured.channels))


def _effect(of: Table, named: Named, there: tuple[str, ...]) -> Effect:
    family = FAMILIES[named.family]
    typical = parse(examples(family)[0]).values
    return Effect(
        id=named.id,
        family=family.name,
        side=family.side,
        what=family.what,
        sliders=tuple(_slider(family, size, named.values[size.key], typical.get(size.key)) for size in named.sizes),
        campaigns=there,
        in_model=any(one.named.id == named.id for one in of.model.effects),
    )


def _start(size: Size, typical: float | None) -> float:
    """No effect, where that is a size; else the least of the slider, or of a resonator one that is likely."""
    if size.low <= size.null <= size.high and not (size.logarithmic and size.null <= 0):
        return size.null if size.default is None or size.whole else size.default
    if size.key or size.null > size.high:
        return _centre(size, typical)
    return ends(size, typical)[0]


def _centre(size: Size, typical: float | None) -> float:
    return size.default or typical or FIRST_GUESS.get(size.key, 1.0)


def _slider(family: Family, size: Size, start: float, typical: float | None) -> Slider:
    low, high, logarithmic = ends(size, typical)
    shown = figures.scale(size.unit, high / 20, ratio=figures.is_ratio(family.name, size.key))
    return Slider(
        key=size.key,
        label=WORDS.get(size.key, family.what),
        unit=size.unit,
        low=min(low, start),
        high=max(high, start),
        start=start,
        null=size.null if min(low, start) <= size.null <= max(high, start) else None,
        logarithmic=logarithmic,
        whole=size.whole,
        shown_unit=shown.unit,
        per_si=shown.per_si,
    )


def ends(size: Size, typical: float | None) -> tuple[float, float, bool]:
    """Ends of a slider, SI, and whether it is one of factors; `typical` is a size that is likely, if one is known."""
    if size.whole:
        return size.low, size.high, False
    if size.low > 0:
        middle = size.null if size.low <= size.null <= size.high else _centre(size, typical)
        reach = NARROW if size.key == "f" else WIDE
        return max(size.low, middle / reach), min(size.high, middle * reach), True
    reach = FAR * (size.plausible or _centre(size, typical))
    return max(size.low, size.null - reach), min(size.high, size.null + reach), False
