"""The way down: stages of an annealed floor, bounds of declared parameters, and where it ended."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from geometry.arrays import Array
from geometry.errors import CheckFailed
from identification.self_calibration.elimination import Normal
from identification.self_calibration.solve import CLOSE, MOST, Solution, inverse, minimise
from validation.engine.cost import Cost
from validation.engine.parameter import DECLARED, SENSOR, STRUCTURAL
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


def ended(cost: Cost, offsets: Offsets, *, converged: bool) -> End:
    """The point `offsets` as an end."""
    x = cost.at(offsets)
    whole, data, chi2 = cost.total(x)
    return End(cost=cost, x=x, whole=whole, data=data, chi2=chi2, converged=converged)


def annealed(cost: Cost, offsets: Offsets, progress: Progress) -> End:
    """From `offsets` through floors that fall to that of `cost`; tolerances of the measurement are released half-way.

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
    return direct(cost, found, progress)


def direct(cost: Cost, offsets: Offsets, progress: Progress, *, most: int = MOST) -> End:
    """From `offsets` straight down.

    Raises
    ------
    CheckFailed : the model breaks down where it begins.
    """
    solution = _solved(cost, offsets, close=CLOSE, most=most)
    progress(0.95)
    try:
        return ended(cost, cost.offsets(solution.x), converged=solution.converged)
    except BREAKDOWNS:  # the last step was taken unseen
        return ended(cost, cost.offsets(solution.seen), converged=solution.converged)


def _solved(cost: Cost, offsets: Offsets, *, close: float, most: int) -> Solution:
    start = cost.at(offsets)
    if not len(start):
        return _nothing_to_do(cost, start)
    try:
        return minimise(cost.data, start, cost.knowledge, close=close, most=most, size=cost.size(start))
    except BREAKDOWNS as error:
        raise CheckFailed(f"the model breaks down where its fit begins: {error}") from error


def _nothing_to_do(cost: Cost, x: Array) -> Solution:
    whole, data, _ = cost.total(x)
    return Solution(x=x, seen=x, normal=whole, data=data, converged=True, decrement=0.0, evaluations=1)


def within(end: End, progress: Progress, *, most: int = MOST) -> End:
    """`end` with declared parameters inside their bounds: those beyond stand at theirs, and the others are fitted again.

    One that would rather come back is let go (an active set), no more often than there are bounds.
    """
    declared = [one for one in (*end.cost.free, *end.cost.held) if one.kind == DECLARED and np.isfinite(one.within)]
    for _ in range(2 * len(declared)):
        held = {one.name: end.cost.base[one.name] for one in end.cost.held}
        beyond = {
            one.name: float(np.clip(end.offsets[one.name], -one.within, one.within))
            for one in declared
            if abs(end.offsets[one.name]) > one.within * (1 + 1e-12)
        }
        back = () if beyond else _inwards(end, held)
        if not beyond and not back:
            break
        cost = end.cost.holding({**{name: at for name, at in held.items() if name not in back}, **beyond})
        end = direct(cost, {**end.offsets, **beyond}, progress, most=most)
    return end


def _inwards(end: End, held: Offsets) -> Sequence[str]:
    """Those `held` at a bound whose cost falls when they leave it inwards."""
    if not held:
        return ()
    everything = end.cost.holding({})
    whole, _, _ = everything.total(everything.at(end.offsets))
    slope = dict(zip(everything.names, whole.gradient * np.sqrt(np.diag(inverse(whole.matrix))), strict=True))
    return tuple(name for name, at in held.items() if slope[name] * np.sign(at) > CLOSE)
