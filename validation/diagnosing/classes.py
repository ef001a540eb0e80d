"""Explanations that these data cannot tell apart: those of nearly the same evidence, and those that do the same to every channel.

Evidence is compared between hypotheses that were fitted. What was not may still be an alias: the columns of J of one effect, once
the tolerances have taken what they may of it, lie along those of the other. With the Fisher matrix N, what is known beforehand in
it, and tolerances o projected off,

    S = N_xx - N_xo N_oo^-1 N_ox ,      share = 1 - S_bc S_cc^+ S_cb / S_bb

is what only the first effect b can explain of what it does, whatever the sizes c of the other.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from validation.diagnosing.bench import Hypothesis
from validation.engine.cost import cost_of
from validation.engine.fit import FLOOR
from validation.engine.parameter import EFFECT, FITTED
from validation.engine.problem import Problem
from validation.ladders.aliases import names_of
from validation.models.model import Added

WITHIN = 5.0
"""Nats below which no explanation is better than another."""

SHARE = 1e-3
"""Of the square of what an effect does that another one must leave to it."""


def alike(best: Hypothesis, others: Sequence[Hypothesis]) -> tuple[str, ...]:
    """Ids of what explains the data about as well as `best`, its own first; of several effects those that not all have."""
    near = [one for one in others if best.fit.log_evidence - one.fit.log_evidence < WITHIN]
    ranked = (best, *sorted(near, key=lambda one: -one.fit.log_evidence))
    common = set.intersection(*({one.named.id for one in each.effects} for each in (best, *others))) if others else set()
    return tuple(dict.fromkeys(one.named.id for each in ranked for one in each.effects if one.named.id not in common))


def aliases(best: Hypothesis, effect: Added, candidates: Sequence[Added]) -> tuple[str, ...]:
    """Ids of those of `candidates` that could stand for `effect` of the hypothesis `best`, at the point where its fit ended."""
    problem = _with(best.problem, [one for one in candidates if one.named.id not in {each.named.id for each in best.effects}])
    cost = cost_of(problem, problem.free(FITTED), FLOOR)
    x = cost.at(best.fit.by_name)
    whole, _, _ = cost.total(x)
    ...
