"""The way down: stages of an annealed floor, all of them within the bounds of the parameters, and where it ended."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from geometry.arrays import Array
from geometry.errors import CheckFailed
from identification.self_calibration.elimination import Normal
from identification.self_calibration.solve import CLOSE, MOST, Solution, minimise
from validation.engine.cost import Cost
from validation.engine.parameter import SENSOR, STRUCTURAL
from validation.engine.prediction import Offsets

COARSE = (0.2, 0.06)
"""Floors of the stages before tolerances of the measurement are released."""

FINE = (0.02, 0.006, 0.003)
"""Floors of the stages after that, before the last."""

ROUGHLY = 1.0
"""Standard deviations that the last step of a stage may be which is not the last."""

STEPS = 6
"""Evaluations that such a stage may take."""

SPARSE = 3
"""Such a stage takes every third line, where that leaves enough: its minimum need not be sharp."""

AGAIN, WORTH = 6, 1.0
"""How often a way down that did not end by itself begins again where it stopped, and what that must gain [nats] to go on."""

ROUNDING = 1e-9
"""Standard deviations from a bound that are none."""

BREAKDOWNS = (np.linalg.LinAlgError, ValueError, FloatingPointError)
"""What a prediction raises where its model breaks down."""

Progress = Callable[[float], None]


@dataclass(frozen=True, eq=False, kw_only=True)
class End:
    """Where a way ended.

    Attributes
    ----------
    cost : that was made small, with what is held at a bound
    x : (p,) of its free parameters
    whole, data : normal equations there, with knowledge beforehand and without
    chi2 : of data and facts
    converged : whether the iteration ended by itself
    """

    cost: Cost
    x: Array
    whole: Normal
    data: Normal
    chi2: float
    converged: bool

    @property
    def offsets(self) -> dict[str, float]:
        """Of all parameters of the problem."""
        return self.cost.offsets(self.x)


def ended(cost: Cost, offsets: Offsets, *, converged: bool, data: Normal | None = None) -> End:
    """The point `offsets` as an end; `data` are the normal equations there, where they are known."""
    x = cost.at(offsets)
    whole, data, chi2 = cost.total(x, data)
    return End(cost=cost, x=x, whole=whole, data=data, chi2=chi2, converged=converged)


def annealed(cost: Cost, offsets: Offsets, progress: Progress, *, most: int = MOST, again: int = AGAIN) -> End:
    """From `offsets` through floors that fall to that of `cost`; tolerances of the measurement are released half-way.

    At the last floor it takes at most `most` evaluations before it begins again, at most `again` times, see `direct`.

    Raises
    ------
    CheckFailed : the model breaks down where it begins.
    """
    found, sparse = dict(offsets), cost.problem.sparser(SPARSE)
    stages = [(floor, False) for floor in COARSE if floor > cost.floor] + [(floor, True) for floor in FINE if floor > cost.floor]
    for done, (floor, everything) in enumerate(stages):
        moving = tuple(one for one in cost.free if everything or one.kind not in (SENSOR, STRUCTURAL))
        stage = replace(cost, problem=sparse, observed=(), free=moving, floor=floor, base={**cost.base, **found})
        found |= stage.offsets(_solved(stage, found, close=ROUGHLY, most=STEPS).seen)
        progress((done + 1) / (len(stages) + 2))
    return direct(cost, found, progress, most=most, again=again)


def direct(cost: Cost, offsets: Offsets, progress: Progress, *, most: int = MOST, again: int = AGAIN) -> End:
    """From `offsets` straight down, and once more from where that ended while it does not end by itself but still gains.

    A whole beginning that gains next to nothing ends it, too. How far the quadratic model would still like to go is not asked:
    where the data do not fit, its second derivatives lack what the misfit adds, it points along a valley for ever, or past a
    bound of what a model declares.

    Parameters
    ----------
    most : evaluations before it begins again
    again : times that it may

    Raises
    ------
    CheckFailed : the model breaks down where it begins.
    """
    solution = _solved(cost, offsets, close=CLOSE, most=most)
    converged = solution.converged
    for _ in range(again):
        if converged:
            break
        before, solution = solution, _solved(cost, cost.offsets(solution.seen), close=CLOSE, most=most)
        gained = before.normal.cost - solution.normal.cost
        idle = gained < WORTH
        converged = solution.converged or (idle and solution.evaluations >= most)
        if idle:
            break
    progress(0.95)
    seen = standing(cost, cost.offsets(solution.seen), converged=converged, data=solution.data)
    if np.array_equal(solution.x, solution.seen):
        return seen
    try:
        last = standing(cost, cost.offsets(solution.x), converged=converged)
    except BREAKDOWNS:  # the last step was taken unseen
        return seen
    return min(last, seen, key=lambda end: end.whole.cost)  # nor need it go down where the valley bends


def standing(cost: Cost, offsets: Offsets, *, converged: bool, data: Normal | None = None) -> End:
    """The point `offsets` as an end, what stands at a bound there held.

    Parameters
    ----------
    data : normal equations of the data there in all free parameters of `cost`, where they are known
    """
    left = at_bounds(cost, offsets)
    free = np.array([one.name in left.names for one in cost.free], dtype=bool)
    return ended(left, offsets, converged=converged, data=None if data is None else _of(data, free))


def at_bounds(cost: Cost, offsets: Offsets) -> Cost:
    """`cost` with what stands at a bound at `offsets` held there."""
    low, high = cost.bounds
    x = cost.at(offsets)
    near = ROUNDING * np.array([one.tolerance if np.isfinite(one.tolerance) else 1.0 for one in cost.free])
    at = np.where(x <= low + near, low, np.where(x >= high - near, high, np.nan))
    held = {name: float(bound) for name, bound in zip(cost.names, at, strict=True) if np.isfinite(bound)}
    return cost.holding({**{one.name: cost.base[one.name] for one in cost.held}, **held})


def _of(data: Normal, free: NDArray[np.bool_]) -> Normal:
    """`data` in the parameters that are `free` (p,), the others held."""
    return Normal(cost=data.cost, gradient=data.gradient[free], matrix=data.matrix[np.ix_(free, free)])


def _solved(cost: Cost, offsets: Offsets, *, close: float, most: int) -> Solution:
    start = np.clip(cost.at(offsets), *cost.bounds)
    if not len(start):
        return _nothing_to_do(cost, start)
    try:
        return minimise(cost.data, start, cost.knowledge, close=close, most=most, size=cost.size(start), bounds=cost.bounds)
    except BREAKDOWNS as error:
        raise CheckFailed(f"the model breaks down where its fit begins: {error}") from error


def _nothing_to_do(cost: Cost, x: Array) -> Solution:
    whole, data, _ = cost.total(x)
    return Solution(x=x, seen=x, normal=whole, data=data, converged=True, decrement=0.0, evaluations=1)
