"""All candidates at once, in closed form: what evidence each would bring and of what size, as far as a straight line goes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from validation.diagnosing import dictionary, swinging
from validation.diagnosing.bench import Bench, Hypothesis
from validation.diagnosing.menu import is_resonator
from validation.diagnosing.screened import Screened
from validation.effects.catalogue import FAMILIES
from validation.effects.family import PERIOD_STAGE, Size
from validation.engine.parameter import Parameter
from validation.engine.screening import Told, in_the_fit, screened
from validation.models.model import Added
from validation.prediction import applied

SWITCHED = 1.0
"""Offset of a switch: from on to off."""


def screen(bench: Bench, at: Hypothesis, menu: Sequence[Added]) -> tuple[Screened, ...]:
    """The candidates of `menu` on top of the hypothesis `at`, the most promising first."""
    known = {one.named.id for one in at.effects}
    left = [one for one in menu if one.named.id not in known]
    tolerances = in_the_fit(at.fit)
    inside = [one for one in left if one.named.id in tolerances]
    resonators = [one for one in left if is_resonator(one.named)]
    of_periods = [one for one in left if FAMILIES[one.named.family].stage == PERIOD_STAGE]
    new = [one for one in left if one not in inside and one not in resonators and one not in of_periods]
    found = [_of_tolerance(one, tolerances[one.named.id], at) for one in inside]
    found += _of_new(bench, at, new) if new else []
    found += dictionary.looked_up(bench, at, resonators) if resonators else []
    found += _of_periods(bench, at, of_periods) if of_periods else []
    return tuple(sorted(found, key=lambda one: -one.evidence))


def _of_periods(bench: Bench, at: Hypothesis, menu: Sequence[Added]) -> list[Screened]:
    """Of effects on a period no straight line tells, and no smallest size by one."""
    return [
        Screened(
            added=added,
            evidence=found.evidence,
            told=Told(name=added.named.id, estimate=found.value, information=0.0),
            plausible=added.named.sizes[0].plausible,
        )
        for added, found in swinging.told(bench, at, menu)
    ]


def _of_tolerance(added: Added, told: Told, at: Hypothesis) -> Screened:
    (size,) = added.named.sizes
    one = next(one for one in at.fit.parameters if one.name == told.name)
    return _sized(added, size, one, told)


def _of_new(bench: Bench, at: Hypothesis, menu: Sequence[Added]) -> list[Screened]:
    free = [replace(one, fixed=False) for one in menu]
    problem = bench.problem((*at.effects, *free))
    sized = {one.named.id: applied.name(one.named, _first(one).key) for one in free if one.named.sizes}
    of = screened(problem, at.fit, [which for which in sized.values() if which in problem.by_name], by_line=False)
    told = of.told()
    there = [(one, which) for one in menu if (which := sized.get(one.named.id, "")) in told]
    return [_sized(one, _first(one), problem.by_name[which], told[which]) for one, which in there]


def _first(added: Added) -> Size:
    """The size by which an effect of several is screened: the first that is fitted."""
    return (*added.named.fitted_sizes, added.named.sizes[0])[0]


def _sized(added: Added, size: Size, one: Parameter, told: Told) -> Screened:
    """`added` at the size that `told` says, within what its family allows."""
    low, high = applied.bounds(one, size)
    if size.whole:
        offset = SWITCHED if one.nominal == 0 else -SWITCHED
        return Screened(added=_at(added, size, one.value(offset)), evidence=_at_size(told, offset), told=told, plausible=SWITCHED)
    offset = float(np.clip(told.estimate, low, high))
    evidence = told.evidence(size.plausible) if low < told.estimate < high else _at_size(told, offset)
    return Screened(
        added=_at(added, size, one.value(offset)), evidence=evidence, told=told, plausible=size.plausible, parameter=one
    )


def _at_size(told: Told, offset: float) -> float:
    """[nats] of an effect that can only be `offset`: a switch, or the bound of what its family allows; 0 where that is none."""
    return told.information * (told.estimate * offset - 0.5 * offset**2)


def _at(added: Added, size: Size, value: float) -> Added:
    values = {**added.named.values, size.key: min(max(value, size.low), size.high)}
    return replace(added, named=replace(added.named, values=values))
