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
from scipy.linalg import solve_triangular

from geometry.arrays import Array
from validation.diagnosing.bench import Hypothesis
from validation.effects.worth import ALIKE
from validation.engine.cost import cost_of
from validation.engine.fit import FLOOR
from validation.engine.parameter import EFFECT, FITTED
from validation.engine.prediction import Fact, Prediction
from validation.engine.problem import Problem
from validation.ladders.aliases import names_of
from validation.models.model import Added
from validation.prediction.facts import ArticleFact
from validation.prediction.series import SeriesPrediction

SHARE = 1e-3
"""Of the square of what an effect does that another one must leave to it."""


def alike(best: Hypothesis, others: Sequence[Hypothesis]) -> tuple[str, ...]:
    """Ids of what explains the data about as well as `best`, its own first; of several effects those that not all have."""
    near = [one for one in others if best.fit.log_evidence - one.fit.log_evidence < ALIKE]
    ranked = (best, *sorted(near, key=lambda one: -one.fit.log_evidence))
    common = set.intersection(*({one.named.id for one in each.effects} for each in (best, *others))) if others else set()
    return tuple(dict.fromkeys(one.named.id for each in ranked for one in each.effects if one.named.id not in common))


def aliases(best: Hypothesis, effect: Added, candidates: Sequence[Added], *, limit: float = SHARE) -> dict[str, float]:
    """Ids of those of `candidates` that could stand for `effect` of the hypothesis `best` where its fit ended, with their share.

    Those that act nowhere on the data are left out, and so are those that `best` has, and those with a larger share than `limit`.
    """
    known = {one.named.id for one in best.effects}
    asked = [one for one in candidates if one.named.id not in known]
    problem = opened(best.problem, asked)
    own = {one.name: one.tolerance for one in best.problem.free(FITTED)}
    free = [one for one in problem.parameters if one.name in own or one.kind == EFFECT]
    cost = cost_of(problem, free, FLOOR)
    x = cost.at(best.fit.by_name)
    _, rows = cost.knowledge(x)
    facts = rows[len(rows) - len(problem.facts) :]
    matrix, prior = cost.data(x).matrix + facts.T @ facts, np.array([own.get(one.name, np.inf) for one in free]) ** -2.0
    place = {one.name: k for k, one in enumerate(free)}
    (b, *_) = (place[name] for name in names_of(problem, effect.named))
    found = {}
    for one in asked:
        c = [place[name] for name in names_of(problem, one.named) if name in place]
        o = [place[name] for name in own if place[name] not in (b, *c)]
        if c and matrix[c[0], c[0]] > 0:
            found[one.named.id] = share(matrix, prior, b, c, o)
    return {id: size for id, size in sorted(found.items(), key=lambda pair: pair[1]) if size <= limit}


def share(matrix: Array, prior: Array, b: int, c: Sequence[int], o: Sequence[int]) -> float:
    """Share of the square of what parameter `b` does that parameters `c` cannot do once `o` have taken what they may.

    Parameters
    ----------
    matrix : (p, p) Fisher matrix of the data
    prior : (p,) one over the square of what is known of each beforehand, which counts for `o`
    """
    bc = [b, *c]
    root = np.linalg.cholesky(matrix[np.ix_(o, o)] + np.diag(prior[o]))
    through = solve_triangular(root, matrix[np.ix_(o, bc)], lower=True, check_finite=False)
    S = matrix[np.ix_(bc, bc)] - through.T @ through
    scale = np.sqrt(np.maximum(np.diag(S), np.finfo(np.float64).tiny))
    S = S / np.outer(scale, scale)
    return float(np.clip(1 - S[0, 1:] @ np.linalg.pinv(S[1:, 1:], rcond=1e-10, hermitian=True) @ S[1:, 0], 0.0, 1.0))


def opened(problem: Problem, candidates: Sequence[Added]) -> Problem:
    """`problem` with `candidates` on top of the effects of its models."""
    made: list[Prediction] = []
    for one in problem.predictions:
        made.append(one.with_effects((*one.effects, *candidates)) if isinstance(one, SeriesPrediction) else one)
    facts: list[Fact] = []
    for fact in problem.facts:
        has = (*fact.of.effects, *fact.effects) if isinstance(fact, ArticleFact) else ()
        facts.append(fact.with_effects((*has, *candidates)) if isinstance(fact, ArticleFact) else fact)
    return replace(problem, predictions=tuple(made), facts=tuple(facts))
