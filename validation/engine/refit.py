"""The plain fit without what a fold holds out: a short way from the solution with all data.

Normal equations of runs add, so that those without a run are known at once, and their quadratic model has its minimum in closed
form. Where that lies too far away for a quadratic model, the fit goes on from there with the data that are left.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from geometry.arrays import Array
from geometry.errors import CheckFailed
from identification.self_calibration.elimination import Normal
from identification.self_calibration.solve import excess
from validation.engine import hold_out, likelihood
from validation.engine.cost import Cost, cost_of
from validation.engine.descent import BREAKDOWNS, at_bounds, direct
from validation.engine.evaluation import Fit
from validation.engine.hold_out import Fold
from validation.engine.problem import Problem

NEAR = 3.0
"""Standard deviations, as far as the data fit, to which the quadratic model is taken at its word."""

FEW = 8
"""Evaluations that a fold may take beyond that."""

SHORTER = 8
"""Times that a step is halved at which the model breaks down."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Solved:
    """A plain fit with what its folds need.

    Attributes
    ----------
    cost : of all data in the parameters that stand at no bound
    x : (p,) of these
    by_run : normal equations by data set and run there
    """

    cost: Cost
    x: Array
    by_run: dict[tuple[str, str], Normal]


def solved(problem: Problem, plain: Fit, floor: float) -> Solved:
    """`plain`, the plain fit of `problem` at `floor`, ready for folds."""
    cost = at_bounds(cost_of(problem, plain.parameters, floor, plain=True), plain.by_name)
    x = cost.at(plain.by_name)
    return Solved(cost=cost, x=x, by_run=cost.by_run(x))


def refitted(at: Solved, fold: Fold, *, quick: bool = False) -> dict[str, float]:
    """Offsets of all parameters that fit best without what `fold` holds out, declared ones within their bounds.

    Where it must be `quick` the quadratic model is taken at its word wherever it leads.
    """
    rest = replace(at.cost, problem=hold_out.without(at.cost.problem, fold), observed=())
    left = _left(at, rest, fold)
    away, rows = rest.knowledge(at.x)
    gradient, matrix = left.gradient + rows.T @ away, left.matrix + rows.T @ rows
    step = _standing(rest, at.x, _bounded_step(rest, at.x, gradient, matrix))
    offsets = rest.offsets(at.x + step)
    if quick or float(step @ matrix @ step) < (NEAR * excess(left, rest.size(at.x))) ** 2:
        return offsets
    return _further(rest, offsets)


def _left(at: Solved, rest: Cost, fold: Fold) -> Normal:
    if fold.blocks:
        return rest.data(at.x)
    kept = [one for (data_set, run), one in at.by_run.items() if run not in fold.runs.get(data_set, ())]
    return likelihood.total(kept, len(at.x))


def _bounded_step(cost: Cost, x: Array, gradient: Array, matrix: Array) -> Array:
    """(p,) to the minimum of the quadratic model; what would leave its bounds stops at them, and the others make up for it."""
    low, high = cost.bounds
    step, moving = np.zeros(len(x)), np.ones(len(x), dtype=bool)
    for _ in range(len(x) + 1):
        force = gradient[moving] + matrix[np.ix_(moving, ~moving)] @ step[~moving]
        step[moving] = -_solve(matrix[np.ix_(moving, moving)], force)
        there = np.clip(x + step, low, high)
        beyond = moving & (there != x + step)
        if not beyond.any():
            break
        step[beyond] = there[beyond] - x[beyond]
        moving &= ~beyond
    return step


def _standing(cost: Cost, x: Array, step: Array) -> Array:
    """`step`, or its longest half from which the model does not break down: no body has every ten parameters.

    That is no matter of frequency: one line of every data set tells it.
    """
    for _ in range(SHORTER):
        try:
            cost.size(x + step)
        except BREAKDOWNS:
            step = step / 2
        else:
            return step
    return np.zeros_like(step)


def _solve(matrix: Array, force: Array) -> Array:
    scale = 1 / np.sqrt(np.maximum(np.diag(matrix), np.finfo(np.float64).tiny))
    return np.asarray(scale * np.linalg.solve(scale[:, None] * matrix * scale, scale * force))


def _further(rest: Cost, offsets: dict[str, float]) -> dict[str, float]:
    """From `offsets` with the data that are left; these themselves where the model breaks down there."""

    def nobody(share: float) -> None:
        """Folds tell their number, not their share."""

    try:
        return direct(rest.holding({}), offsets, nobody, most=FEW, again=0).offsets
    except CheckFailed:
        return offsets
