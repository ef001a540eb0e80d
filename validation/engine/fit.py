"""The fits: from far away to the minimum of misfit and of what is known beforehand, and the guard that makes children comparable.

The model-error floor is annealed: at 20 % the likelihood is so coarse that its minimum is found from afar, at 0.15 % it is sharp.
Tolerances of the measurement, hundreds of them and stiff, are released when the few that matter are near. Every stage is
Levenberg-Marquardt with the priors as part of it (`identification.self_calibration.solve`).

A fit that begins nowhere converges or is refused: an unconverged baseline makes any further parameter look decisive. A fit that
begins at a parent's solution keeps that where it finds nothing better, and so never costs more. "What bit" of the catalogue.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from math import inf

import numpy as np

from geometry.errors import CheckFailed
from identification.self_calibration.solve import inverse
from validation.engine.cost import Cost, cost_of
from validation.engine.descent import WORTH, End, Progress, annealed, direct, ended
from validation.engine.evaluation import Fit
from validation.engine.evidence import log_evidence
from validation.engine.parameter import SENSOR, TOLERANCES, Parameter
from validation.engine.prediction import Offsets
from validation.engine.problem import Problem

FLOOR = 0.0015
"""Model-error floor relative to the level of a channel at which fits are compared."""

TRIAL = 20
"""Evaluations after which a trial stops, and begins once more if it still gained: most are of effects that are not there."""

FEW = 3
"""Times that a way of a child begins again: it has others, one of which ends lower where this one creeps along a valley."""

PLAIN_FLOOR = 0.01
"""The same where tolerances of the measurement are not fitted: what gains, delays and angles within them make of a prediction."""


def fit(
    problem: Problem,
    kinds: Sequence[str],
    *,
    start: Fit | Offsets | None = None,
    floor: float | None = None,
    progress: Progress | None = None,
) -> Fit:
    """The parameters of `kinds` that fit best, knowledge beforehand counted; others stand where the model has them.

    Where the tolerances of the measurement are not among `kinds`, declared parameters stay `within` their bounds. Effects always
    stay within what their family allows.

    Parameters
    ----------
    start : offsets at which to begin; or the fit of a parent, in whose place this one never costs more: what the parent does not
        have begins at the size at which there is no effect (offset 0) and, once more, at its own start
    floor : model-error floor; `FLOOR`, and `PLAIN_FLOOR` where tolerances of the measurement are not fitted
    progress : told the share of the work that is done, 0 to 1

    Raises
    ------
    CheckFailed : without a parent, when the iteration does not end by itself or the model breaks down where it begins; says why.
    """
    tell = progress or (lambda share: None)
    cost = cost_of(problem, problem.free(kinds), floor_of(kinds) if floor is None else floor, plain=SENSOR not in kinds)
    end = _child(cost, start, tell) if isinstance(start, Fit) else _baseline(cost, start or {}, tell)
    tell(1.0)
    return fitted(end)


def child(
    problem: Problem, kinds: Sequence[str], parent: Fit, start: Offsets, *, from_afar: bool = False, floor: float | None = None
) -> Fit:
    """The fit of `problem`, which has more parameters than that of its `parent`, by a single way; it never costs more.

    Parameters
    ----------
    start : offsets at which the way begins; what is not named begins where the parent ended, or where it has no effect
    from_afar : whether the floor is annealed on the way, instead of straight down
    """
    cost = cost_of(problem, problem.free(kinds), floor_of(kinds) if floor is None else floor, plain=SENSOR not in kinds)
    null = parents_point(cost.free, parent)
    try:
        end = _trial(cost, {**null, **start}, from_afar=from_afar)
    except CheckFailed:
        return fitted(ended(cost, null, converged=False))
    return fitted(end if end.whole.cost <= parent.cost else min(end, ended(cost, null, converged=False), key=_whole))


def _trial(cost: Cost, begin: Offsets, *, from_afar: bool) -> End:
    if from_afar:
        return annealed(cost, begin, lambda share: None, most=TRIAL)
    return direct(cost, begin, lambda share: None, most=TRIAL, again=1)


def nearby(problem: Problem, kinds: Sequence[str], start: Offsets, progress: Progress | None = None) -> Fit:
    """The fit to which the way leads straight down from `start`, as far as it ends.

    Raises
    ------
    CheckFailed : the model breaks down where it begins.
    """
    cost = cost_of(problem, problem.free(kinds), floor_of(kinds), plain=SENSOR not in kinds)
    return fitted(direct(cost, start, progress or (lambda share: None)))


def unfitted(problem: Problem, kinds: Sequence[str], offsets: Offsets) -> Fit:
    """The parameters of `kinds` as they stand at `offsets`, with what the data say there; nothing was fitted, nor converged."""
    return fitted(
        ended(cost_of(problem, problem.free(kinds), floor_of(kinds), plain=SENSOR not in kinds), offsets, converged=False)
    )


def _whole(end: End) -> float:
    return end.whole.cost


def floor_of(kinds: Sequence[str]) -> float:
    """The model-error floor of a fit of parameters of `kinds`."""
    return FLOOR if SENSOR in kinds else PLAIN_FLOOR


def _baseline(cost: Cost, start: Offsets, tell: Progress) -> End:
    end = _cheaper(annealed(cost, start, tell), start, tell)
    if not end.converged:
        raise _refused(end)
    return end


def _child(cost: Cost, parent: Fit, tell: Progress) -> End:
    """The cheapest of the parent's point, the way straight from there, and the way annealed from the child's start.

    Where none of them ends by itself, also of the way annealed from the model as it was given.
    """
    null = parents_point(cost.free, parent)
    ends = [ended(cost, null, converged=False)]
    begins = {one.name: parent.by_name.get(one.name, one.start) for one in cost.free}
    for way, begin in ((direct, null), (annealed, begins)):
        try:
            ends.append(_cheaper(way(cost, begin, tell, again=FEW), begin, tell))
        except CheckFailed:
            continue
    if not _best(ends).converged:  # what the parent was driven to for want of the effect may be a valley without an end
        with suppress(CheckFailed):
            ends.append(_cheaper(annealed(cost, {}, tell), {}, tell))
    return _best(ends)


def _best(ends: Sequence[End]) -> End:
    """The cheapest; it is as good as any other that ended by itself and costs as much."""
    best = min(ends, key=lambda end: end.whole.cost)
    return replace(best, converged=any(one.converged and one.whole.cost < best.whole.cost + WORTH for one in ends))


def _cheaper(end: End, start: Offsets, tell: Progress) -> End:
    """`end`, or where it stands at bounds what is cheaper: the way from `start` without them, brought back within them."""
    if not (end.cost.plain and any(one.within < inf for one in end.cost.held)):
        return end
    cost = end.cost.holding({})
    try:
        free = annealed(replace(cost, free=tuple(map(_unbounded, cost.free))), start, tell)
        other = direct(cost, free.offsets, tell)
    except CheckFailed:
        return end
    return min(end, other, key=lambda one: one.whole.cost)


def _unbounded(one: Parameter) -> Parameter:
    return replace(one, within=inf)


def parents_point(free: Sequence[Parameter], parent: Fit) -> dict[str, float]:
    """Offsets of `free` at which a child is its parent: what is new stands where it has no effect."""
    known = parent.by_name
    return {one.name: known.get(one.name, one.start if one.logarithmic else 0.0) for one in free}


def _refused(end: End) -> CheckFailed:
    step = -inverse(end.whole.matrix) @ end.whole.gradient
    sd = np.sqrt(np.diag(inverse(end.whole.matrix)))
    worst = sorted(zip(end.cost.names, step / sd, strict=True), key=lambda one: -abs(one[1]))[:3]
    named = ", ".join(f"{name} ({away:+.1f})" for name, away in worst)
    return CheckFailed(
        f"the fit of {len(end.x)} parameters did not converge: its next step is still many standard deviations in {named}; "
        "start from a nearer model, or declare more of it as unknown",
        steps=dict(worst),
        chi2=end.chi2,
        degrees_of_freedom=_degrees(end),
    )


def fitted(end: End) -> Fit:
    """An end as a result."""
    everything = (*end.cost.free, *end.cost.held)
    order = [one for one in end.cost.problem.parameters if one.name in {each.name for each in everything}]
    offsets = end.offsets
    tolerances = [one for one in everything if one.kind in TOLERANCES and np.isfinite(one.tolerance)]
    covariance = np.zeros((len(order), len(order)))
    place = {one.name: k for k, one in enumerate(order)}
    at = np.array([place[name] for name in end.cost.names], dtype=np.int64)
    covariance[np.ix_(at, at)] = inverse(end.whole.matrix) if len(at) else 0.0
    return Fit(
        parameters=tuple(order),
        offsets=np.array([offsets[one.name] for one in order]),
        covariance=covariance,
        cost=end.whole.cost,
        chi2=end.chi2,
        degrees_of_freedom=_degrees(end),
        tolerance_z2=sum((offsets[one.name] / one.tolerance) ** 2 for one in tolerances),
        tolerances=len(tolerances),
        log_evidence=log_evidence(end.cost, end.x, end.whole),
        converged=end.converged,
    )


def _degrees(end: End) -> int:
    return end.cost.size(end.x) - sum(not np.isfinite(one.tolerance) for one in end.cost.free)
