"""A hypothesis fitted: all tolerances, and the effects with them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import log

import numpy as np

from validation.diagnosing.bench import Bench, Hypothesis
from validation.effects.catalogue import FAMILIES
from validation.effects.family import OPENED
from validation.engine.evaluation import Fit
from validation.engine.fit import child, fit
from validation.engine.parameter import EFFECT, FITTED
from validation.engine.problem import Problem
from validation.models.model import Added
from validation.prediction.applied import name

SPARSE = 3
"""A rough fit takes every so many lines of the others."""

Progress = Callable[[float], None]


def baseline(bench: Bench, progress: Progress | None = None) -> Hypothesis:
    """The model as it is.

    Raises
    ------
    CheckFailed : its fit does not converge; an unconverged baseline makes any effect look decisive.
    """
    problem = bench.problem()
    return Hypothesis(effects=(), fit=fit(problem, FITTED, progress=progress), problem=problem)


def roughly(bench: Bench, at: Hypothesis, added: Added) -> Fit:
    """`at` with the effect `added` as well, fitted from afar and on few lines: for effects that bend the model."""
    problem = bench.problem((*at.effects, added)).sparser(SPARSE)
    return child(problem, FITTED, at.fit, _start(bench, added), from_afar=True)


def refitted(bench: Bench, at: Hypothesis, added: Added, *, begin: Fit | None = None) -> Hypothesis:
    """`at` with the effect `added` as well, all sizes free; it never costs more.

    Parameters
    ----------
    begin : a rough fit of the same, where the way begins; by default it is straight down from `at`
    """
    effects = (*at.effects, added)
    problem = bench.problem(effects)
    start = _start(bench, added) if begin is None else begin.by_name
    found = child(problem, FITTED, at.fit, start)
    return settled(bench, Hypothesis(effects=effects, fit=found, problem=problem))


def _start(bench: Bench, added: Added) -> dict[str, float]:
    """An effect with an equation begins at its size; the fit knows where a tolerance stands already."""
    if FAMILIES[added.named.family].stage == OPENED or added.fixed:
        return {}
    keys = [size.key for size in added.named.sizes if size.plausible > 0]
    parameters = {one.name: one for one in bench.problem((added,)).parameters}
    return {which: parameters[which].start for key in keys if (which := name(added.named, key)) in parameters}


def settled(bench: Bench, of: Hypothesis) -> Hypothesis:
    """`of` with its effects at the sizes that the fit found, from which logarithms then count."""
    effects = tuple(_sized(one, of.fit) for one in of.effects)
    problem = bench.problem(effects)
    return Hypothesis(effects=effects, fit=_counted_from(problem, of.fit), problem=problem)


def _counted_from(problem: Problem, fit: Fit) -> Fit:
    """`fit` with its logarithms counted from the sizes that the models of `problem` have."""
    parameters = tuple(problem.by_name[one.name] for one in fit.parameters)
    pairs = zip(fit.parameters, parameters, fit.offsets, strict=True)
    offsets = np.array([x + log(old.nominal / new.nominal) if new.logarithmic else x for old, new, x in pairs])
    return replace(fit, parameters=parameters, offsets=offsets)


def _sized(added: Added, fit: Fit) -> Added:
    if added.fixed:
        return added
    values, deviation = dict(added.named.values), {}
    spread = np.sqrt(np.maximum(np.diag(fit.covariance), 0.0))
    found = {one.name: (one, float(x), float(sd)) for one, x, sd in zip(fit.parameters, fit.offsets, spread, strict=True)}
    for size in added.named.sizes:
        one, x, sd = found.get(name(added.named, size.key), (None, 0.0, 0.0))
        if one is not None and one.kind == EFFECT:
            values[size.key] = min(max(one.value(x), size.low), size.high)
            deviation[size.key] = abs(one.slope(x)) * sd
    return replace(added, named=replace(added.named, values=values), deviation=deviation)
