"""A second way to an effect: not from where tolerances have paid for it already, but from where they are declared.

A blade's tip that is 100 g too heavy moves its frequencies by forty of their tolerances, and tolerances do pay that. From
there no step leads to the mass: each needs a frequency that goes home at the same time. So the sizes of the effect are looked at
one by one with every tolerance at home, from a small part of what is plausible to several times that, and the fit begins at
the one that comes nearest.
"""

from __future__ import annotations

from dataclasses import replace
from math import inf

import numpy as np

from geometry.arrays import Array
from validation.diagnosing.bench import Bench, Hypothesis
from validation.diagnosing.menu import is_resonator
from validation.diagnosing.refitting import SPARSE, settled
from validation.effects.catalogue import FAMILIES
from validation.effects.family import PERIOD_STAGE
from validation.engine.cost import Cost, cost_of
from validation.engine.descent import BREAKDOWNS
from validation.engine.evaluation import Fit
from validation.engine.fit import child
from validation.engine.parameter import EFFECT, FITTED, Parameter
from validation.engine.prediction import Offsets
from validation.engine.problem import Problem
from validation.models.model import Added
from validation.prediction.applied import name

OCTAVES = np.arange(-6.0, 4.0, 0.5)
"""Powers of two of what is plausible, at which a size is looked at."""

ROUGH = 0.2
"""Model-error floor of these looks: so coarse that resonances which a tolerance still has to move do not decide."""


def can_be(added: Added) -> bool:
    """Whether there is such a way: an effect of one size that is fitted, and not of a pendulum, whose period follows a line."""
    swings = FAMILIES[added.named.family].stage == PERIOD_STAGE
    return not (added.fixed or swings or is_resonator(added.named)) and len(added.named.fitted_sizes) == 1


def afresh(bench: Bench, at: Hypothesis, added: Added) -> Hypothesis:
    """`at` with the effect `added` as well, tolerances from where they are declared; it never costs more than `at`."""
    effects = (*at.effects, added)
    problem = bench.problem(effects)
    (which,) = (name(added.named, size.key) for size in added.named.fitted_sizes)
    home = _home(problem, at.fit)
    begin = home | {which: _nearest(problem.sparser(SPARSE), home, which)}
    return settled(bench, Hypothesis(effects=effects, fit=child(problem, FITTED, at.fit, begin, from_afar=True), problem=problem))


def rested(bench: Bench, at: Hypothesis) -> Hypothesis:
    """`at`, tolerances from where they are declared; it never costs more.

    A tolerance that paid for an effect may stay behind in a valley of its own when that is found: a mode that takes part with the
    wrong sign comes home by no small step.
    """
    return settled(bench, replace(at, fit=child(at.problem, FITTED, at.fit, _home(at.problem, at.fit), from_afar=True)))


def _home(problem: Problem, fit: Fit) -> dict[str, float]:
    """Offsets of tolerances that are declared, and of the effects of `fit` that were found."""
    found = {one.name: fit.by_name[one.name] for one in fit.parameters if one.kind == EFFECT}
    return {one.name: one.start for one in problem.parameters} | found


def _nearest(problem: Problem, home: Offsets, which: str) -> float:
    """The size of the effect `which` that comes nearest to the data, everything else at `home`."""
    cost = cost_of(problem, [problem.by_name[which]], ROUGH, home)
    return min(map(float, sizes(problem.by_name[which])), key=lambda size: _cost(cost, size))


def _cost(cost: Cost, size: float) -> float:
    try:
        return cost.total(np.array([size]))[0].cost
    except BREAKDOWNS:
        return inf


def sizes(of: Parameter) -> Array:
    """Offsets of `of` at which an effect is looked at, (n,), none outside its bounds."""
    steps = of.tolerance * np.exp2(OCTAVES)
    both = np.concatenate([-steps[::-1], steps])
    return both[(both > of.low) & (both < of.high)]
