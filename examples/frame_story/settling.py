"""Fits that have ended: a fit that stopped on its way begins again where it stopped."""

from __future__ import annotations

from geometry.errors import CheckFailed
from validation.engine.evaluate import evaluate
from validation.engine.evaluation import Evaluation
from validation.engine.problem import Problem

RESTARTS, WORTH = 4, 1.0
"""How often a fit that has not converged begins again, and what that must gain [nats] to go on."""


def settled(problem: Problem, parent: Evaluation | None) -> Evaluation:
    """The evaluation of a model whose fits have ended by themselves, or would not gain `WORTH` by beginning again.

    Modulus and clamps are nearly one number: a fit that begins at the modulus of its parent may stop in the valley between them,
    which costs it evidence that is not its model's fault. It then begins again where it stopped.

    Raises
    ------
    CheckFailed : they still gain after `RESTARTS`.
    """
    found = evaluate(problem, parent=parent)
    for _ in range(RESTARTS):
        if found.plain_fit.converged and found.fitted.converged:
            return found
        before, found = found, evaluate(problem, parent=found)
        if gained(before, found) < WORTH:
            return found
    raise CheckFailed(f"a fit of {problem.predictions[0].measured.name} still gains after {RESTARTS} new beginnings")


def gained(before: Evaluation, after: Evaluation) -> float:
    """What the better of the two fits has gained [nats]."""
    return max(before.plain_fit.cost - after.plain_fit.cost, before.fitted.cost - after.fitted.cost)
