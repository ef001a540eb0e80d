"""A hypothesis fitted: all tolerances, and the effects with them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import log

import numpy as np

from geometry.arrays import Array
from validation.diagnosing.bench import Bench, Hypothesis
from validation.diagnosing.menu import is_resonator
from validation.effects.catalogue import FAMILIES
from validation.effects.family import OPENED
from validation.engine.evaluation import Fit
from validation.engine.fit import child, fit, nearby
from validation.engine.parameter import FITTED
from validation.engine.problem import Problem
from validation.ladders.judging import sized_by
from validation.models.model import Added
from validation.prediction.applied import name

SPARSE, PART = 3, 0.25
"""A rough fit takes every so many lines of the others, and begins at such a part of the size, too."""

SAME = 0.05
"""[nats] that a fit which ended by itself may cost more than where its trial stopped: the last step is taken unseen."""

OUT = 2.0
"""Standard deviations from no effect at which an effect is one."""

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
    """`at` with the effect `added` as well, fitted from afar and on few lines: for effects that bend the model.

    A straight line overrates what bends it, so that the way begins at its size and at a part of that.
    """
    problem = bench.problem((*at.effects, added)).sparser(SPARSE)
    start = _start(bench, added)
    begins = [start] if is_resonator(added.named) or not start else [start, {name: PART * x for name, x in start.items()}]
    return min((child(problem, FITTED, at.fit, begin, from_afar=True) for begin in begins), key=lambda fit: fit.cost)


def polished(bench: Bench, at: Hypothesis, begin: Fit) -> Hypothesis:
    """`at` fitted again from where another fit ended, where that is cheaper."""
    found = nearby(at.problem, FITTED, begin.by_name)
    return at if found.cost >= at.fit.cost else settled(bench, replace(at, fit=found))


def finished(bench: Bench, at: Hypothesis) -> Hypothesis:
    """`at`, whose fit may be a trial, fitted to the end."""
    found = nearby(at.problem, FITTED, at.fit.by_name)
    return settled(bench, replace(at, fit=found)) if found.cost <= at.fit.cost + SAME else at


def stands_out(of: Hypothesis) -> bool:
    """Whether the newest effect is more than none: what is fitted of it lies off the size of no effect."""
    added = of.effects[-1]
    sizes = () if added.fixed or is_resonator(added.named) else added.named.fitted_sizes
    known = {one.name: (x, sd) for one, x, sd in zip(of.fit.parameters, of.fit.offsets, _spread(of.fit), strict=True)}
    found = [known[which] for size in sizes if (which := name(added.named, size.key)) in known]
    return not found or any(abs(x) > OUT * sd > 0 for x, sd in found)


def _spread(fit: Fit) -> Array:
    return np.asarray(np.sqrt(np.maximum(np.diag(fit.covariance), 0.0)))


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


def instead(bench: Bench, at: Hypothesis, rest: Hypothesis, added: Added) -> Hypothesis:
    """`rest` with the effect `added` as well, from where `at` ended with another in its place."""
    effects = (*rest.effects, added)
    problem = bench.problem(effects)
    same = {one.name for one in at.fit.parameters if (new := problem.by_name.get(one.name)) and new.kind == one.kind}
    start = {which: x for which, x in _in(problem, at.fit).items() if which in same} | _start(bench, added)
    return settled(bench, Hypothesis(effects=effects, fit=child(problem, FITTED, rest.fit, start), problem=problem))


def _start(bench: Bench, added: Added) -> dict[str, float]:
    """An effect with an equation begins at its size; the fit knows where a tolerance stands already."""
    if FAMILIES[added.named.family].stage == OPENED or added.fixed:
        return {}
    keys = [size.key for size in added.named.fitted_sizes]
    parameters = {one.name: one for one in bench.problem((added,)).parameters}
    return {which: parameters[which].start for key in keys if (which := name(added.named, key)) in parameters}


def settled(bench: Bench, of: Hypothesis) -> Hypothesis:
    """`of` with its effects at the sizes that the fit found, from which logarithms then count."""
    effects = tuple(sized_by(one, of.fit) for one in of.effects)
    problem = bench.problem(effects)
    return Hypothesis(effects=effects, fit=_counted_from(problem, of.fit), problem=problem)


def _counted_from(problem: Problem, fit: Fit) -> Fit:
    """`fit` with its logarithms counted from the sizes that the models of `problem` have."""
    parameters = tuple(problem.by_name[one.name] for one in fit.parameters)
    return replace(fit, parameters=parameters, offsets=np.array(list(_in(problem, fit).values())))


def _in(problem: Problem, fit: Fit) -> dict[str, float]:
    """Offsets of `fit` of what `problem` has, its logarithms counted from there."""
    found = {}
    for old, x in zip(fit.parameters, fit.offsets, strict=True):
        if (new := problem.by_name.get(old.name)) is not None:
            found[old.name] = float(x) + (log(old.nominal / new.nominal) if new.logarithmic else 0.0)
    return found
