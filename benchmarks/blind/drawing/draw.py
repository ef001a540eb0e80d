"""`draw`: a seed becomes cases. The first cases of a kind are the same however many are asked for.

Every laboratory of a draw is used twice: with nothing missing, as a null, and with the effects of one other case. So what a
faulty series leaves can be held against what the same laboratory leaves without the fault, noise and all.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import islice

import numpy as np

from benchmarks.blind.drawing import foreign, limits
from benchmarks.blind.drawing.case import (
    FOREIGN,
    KINDS,
    LEFT_OUT,
    NULL,
    PAIR,
    SERIES,
    SINGLE,
    WHOLE_SERIES,
    Case,
    Planted,
)
from benchmarks.blind.drawing.choices import CHOICES, DAMPING, FREQUENCIES, Choice, without
from geometry.dynamic_mass import MOTIONS
from validation.effects.catalogue import FAMILIES
from validation.virtual_test.layout import stream

MULTIPLES = (5.0, 15.0, 2.0)
"""Sizes over the detection limit, in the order in which they are drawn."""

COUNTS: Mapping[str, int] = {NULL: 216, SINGLE: 1000, PAIR: 20, LEFT_OUT: 24, FOREIGN: 27}
"""Cases of a draw by kind; of singles as many as there are."""

WHOLE = 6
"""Every so many laboratories the series has four blades, too."""


def draw(seed: int, kinds: Sequence[str] = KINDS, most: int | None = None) -> tuple[Case, ...]:
    """The cases of `seed`.

    Parameters
    ----------
    kinds : of `KINDS`, those that are wanted
    most : of every kind; None for all
    """
    nulls = [_null(seed, number) for number in range(COUNTS[NULL])]
    free: dict[tuple[str, ...], list[Case]] = {
        series: [one for one in nulls if one.articles == series] for series in (SERIES, WHOLE_SERIES)
    }
    found = {NULL: nulls}
    for kind, made in ((SINGLE, _singles), (PAIR, _pairs), (LEFT_OUT, _left_out), (FOREIGN, _foreign)):
        found[kind] = [_in(free, kind, number, one) for number, one in enumerate(islice(made(seed), COUNTS[kind]))]
    return tuple(one for kind in KINDS if kind in kinds for one in found[kind][:most])


def _null(seed: int, number: int) -> Case:
    name = _name(NULL, number)
    generator = stream(seed, "laboratory", f"{number}")
    articles = WHOLE_SERIES if number % WHOLE == WHOLE - 1 else SERIES
    held = generator.permutation(len(MOTIONS))
    return Case(
        name=name,
        kind=NULL,
        laboratory=int(generator.integers(1, 2**31)),
        articles=articles,
        hold_out=tuple(f"{article}/{MOTIONS[held[k]]}" for k, article in enumerate(articles)),
        null=name,
    )


def _name(kind: str, number: int) -> str:
    return f"{kind}-{number:03d}"


def _in(free: Mapping[tuple[str, ...], list[Case]], kind: str, number: int, made: Case) -> Case:
    """`made` in the next laboratory whose series it needs."""
    null = free[made.articles].pop(0)
    return replace(made, name=_name(kind, number), laboratory=null.laboratory, hold_out=null.hold_out, null=null.name)


def _singles(seed: int) -> Iterator[Case]:
    for k, multiple in enumerate(MULTIPLES):
        for number in stream(seed, SINGLE, "order", f"{k}").permutation(len(CHOICES)):
            choice = CHOICES[int(number)]
            if (k == 0 or not choice.words) and (one := _planted(choice, multiple, stream(seed, SINGLE, f"{number} {k}"))):
                yield _case(SINGLE, choice.articles, one)


def _pairs(seed: int) -> Iterator[Case]:
    """Effects of different kinds, both well above their limits."""
    plain = [one for one in CHOICES if not one.words and all(5 * limits.limit(id) <= one.largest for id in one.ids)]
    for number in range(COUNTS[PAIR]):
        generator = stream(seed, PAIR, f"{number}")
        first, second = _different(plain, generator)
        both = [_well_above(one, generator) for one in (first, second)]
        yield _case(PAIR, max(first.articles, second.articles, key=len), *both)


def _well_above(choice: Choice, generator: np.random.Generator) -> Planted:
    """`choice` at five or fifteen times its limit; at five where fifteen would be no physics of a test."""
    found = _planted(choice, float(generator.choice([5.0, 15.0])), generator)
    while found is None:
        found = _planted(choice, 5.0, generator)
    return found


def _different(choices: Sequence[Choice], generator: np.random.Generator) -> tuple[Choice, Choice]:
    """Two of `choices` that are not of one kind."""
    while True:
        first, second = (choices[int(k)] for k in generator.choice(len(choices), 2, replace=False))
        if second.family not in without(first.family):
            return first, second


def _left_out(seed: int) -> Iterator[Case]:
    sized = [one for one in CHOICES if not one.words]
    for number, k in enumerate(stream(seed, LEFT_OUT, "order").permutation(len(sized))):
        choice, generator = sized[int(k)], stream(seed, LEFT_OUT, f"{k}")
        multiple = 15.0 if number % 2 else 5.0
        one = _planted(choice, multiple, generator) or _smallest(choice, generator)
        yield replace(_case(LEFT_OUT, choice.articles, one), leave_out=without(choice.family))


def _foreign(seed: int) -> Iterator[Case]:
    """All of them in turn, each anew as often as the draw is long."""
    for number in range(COUNTS[FOREIGN]):
        name = tuple(foreign.FOREIGN)[number % len(foreign.FOREIGN)]
        what, generator = foreign.FOREIGN[name], stream(seed, FOREIGN, f"{number}")
        size = float(np.exp(generator.uniform(np.log(what.low), np.log(what.high))))
        id = ":".join((foreign.PREFIX + name, *([str(generator.choice(what.channels))] if what.channels else [])))
        yield replace(_case(FOREIGN, SERIES, Planted(text=f"{id}={size:.4g}")), leave_out=what.without)


def _case(kind: str, articles: tuple[str, ...], *planted: Planted) -> Case:
    return Case(name="", kind=kind, laboratory=0, articles=articles, planted=planted)


def _planted(choice: Choice, multiple: float, generator: np.random.Generator) -> Planted | None:
    """`choice` at a place, `multiple` times its limit; None where that would be no physics of a test."""
    id = choice.ids[int(generator.integers(len(choice.ids)))]
    if choice.words:
        value = str(generator.choice(choice.words))
        return Planted(text=f"{id}={value}" if value else id)
    size = multiple * limits.limit(id)
    if size > choice.largest:
        return None
    sign = -1.0 if choice.signed and size <= choice.least and generator.random() < 0.5 else 1.0
    return Planted(text=f"{id}={_written(choice, sign * size, generator)}", multiple=multiple, told=size / limits.told(id))


def _smallest(choice: Choice, generator: np.random.Generator) -> Planted:
    """`choice` at the largest size that is still one."""
    least = min(limits.limit(id) for id in choice.ids)
    found = _planted(choice, float(np.floor(choice.largest / least)), generator)
    while found is None:
        found = _planted(choice, 2.0, generator)
    return found


def _written(choice: Choice, size: float, generator: np.random.Generator) -> str:
    if choice.family not in FREQUENCIES:
        null = next((one.null for one in FAMILIES[choice.family].sizes), 0.0)
        return f"{null + size:.5g}"
    low, high = FREQUENCIES[choice.family]
    f, zeta = (float(np.exp(generator.uniform(*np.log(limits_)))) for limits_ in ((low, high), DAMPING))
    return f"m:{size:.5g},f:{f:.4g},zeta:{zeta:.3g}"
