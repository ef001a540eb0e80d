"""What a plain fit frees, following an effect: the FMD's inertia and what else is declared, at every size that is tried.

Where the comparison ended, the FMD has taken up what it could of a fault. An effect that is put into the model beside that counts
twice: the right one would seem to make things worse. So the parameters of the plain fit go with it: by one step of Gauss and
Newton from where they stood last while a slider is dragged, to the minimum when it is released.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from validation.engine.cost import cost_of
from validation.engine.descent import BREAKDOWNS
from validation.engine.fit import PLAIN_FLOOR, nearby
from validation.engine.parameter import PLAIN
from validation.engine.prediction import Fact, Offsets
from validation.engine.problem import Problem
from validation.prediction.series import SeriesPrediction

STEP = 4
"""While dragging, of the lines of fits every so many."""

STEPS = 3
"""Where every run is predicted by itself, and a fit would take as many times as long as there are runs."""


class Dragged:
    """An effect that is dragged: its predictions with it free, what fits see of them, and where their parameters stood last."""

    def __init__(self, predictions: tuple[SeriesPrediction, ...], problem: Problem, offsets: Offsets) -> None:
        self.predictions, self.problem, self.offsets = predictions, problem.sparser(STEP), dict(offsets)

    def follow(self, moved: Mapping[str, float]) -> None:
        """One step towards the plain fit with the effect at the offsets `moved`; none where the model breaks down there."""
        self.offsets = {**self.offsets, **stepped(self.problem, self.offsets, moved)}


def seen_by_fits(known: Problem, predictions: Sequence[SeriesPrediction], facts: Sequence[Fact]) -> Problem:
    """`predictions` on the runs and lines of `known`, and its facts of those that are given by name."""
    by_name = {one.measured.name: one for one in predictions}
    some = tuple(by_name[one.measured.name].on(one.measured.runs) for one in known.predictions)
    kept = {one.name for one in known.facts}
    return Problem(some, tuple(one for one in facts if one.name in kept), lines=known.lines)


def stepped(problem: Problem, offsets: Offsets, moved: Mapping[str, float]) -> dict[str, float]:
    """Offsets of what a plain fit frees one step further, within their bounds, the parameters `moved` standing where they are."""
    free = tuple(one for one in problem.free(PLAIN) if one.name not in moved)
    others = {name: value for name, value in offsets.items() if name not in {one.name for one in free}}
    cost = cost_of(problem, free, PLAIN_FLOOR, {**others, **moved}, plain=True)
    low, high = cost.bounds
    x = np.clip(cost.at(offsets), low, high)
    try:
        whole = cost.total(x)[0]
        there = np.clip(x - np.linalg.solve(whole.matrix, whole.gradient), low, high)
    except BREAKDOWNS:
        return {}
    return dict(zip(cost.names, map(float, there), strict=True))


def settled(problem: Problem, offsets: Offsets) -> dict[str, float]:
    """Offsets of the plain fit of `problem`, from nearby.

    Raises
    ------
    CheckFailed : the model breaks down where it begins.
    """
    return nearby(problem, PLAIN, offsets).by_name


def several_steps(problem: Problem, offsets: Offsets) -> dict[str, float]:
    """The same by a few steps on some of the lines."""
    sparse, there = problem.sparser(STEP), dict(offsets)
    for _ in range(STEPS):
        there |= stepped(sparse, there, {})
    return there
