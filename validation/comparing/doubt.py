"""What is not known at a plain fit: every tolerance of the measurement, and how the fit answered to it.

A gain that is off by its tolerance moves the inertia of the FMD that a plain fit identifies, and so what that fit leaves
over. To first order the fit answers to an offset s of a tolerance by

    d theta = -N_ff^-1 N_fs ds

with N the second derivatives of its cost, so that one standard deviation of every tolerance moves a whole vector of offsets.
What the fitted parameters keep of their own uncertainty is a further doubt, its square root a vector for each of them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from identification.self_calibration.solve import inverse
from validation.engine.cost import cost_of
from validation.engine.evaluation import Fit
from validation.engine.fit import PLAIN_FLOOR
from validation.engine.parameter import STRUCTURAL
from validation.engine.problem import Problem
from validation.engine.refit import solved
from validation.engine.roots import root


@dataclass(frozen=True, eq=False, kw_only=True)
class Doubt:
    """Independent unknowns, each with a standard deviation of 1, and the offsets that they move.

    Attributes
    ----------
    tolerances : (q,) by name, standard deviation of each tolerance that was not fitted
    fitted : (p,) names of the parameters that were and could move
    answer : (p, q) what one standard deviation of every tolerance does to them
    own : (p, p) what is left unknown of them when all tolerances are known
    of_modes : names of those tolerances that are not of the measurement but of modes, of whatever configuration
    """

    tolerances: dict[str, float]
    fitted: tuple[str, ...] = ()
    answer: Array
    own: Array
    of_modes: frozenset[str] = frozenset()


def nothing_fitted(problem: Problem) -> Doubt:
    """Of a model as it stands."""
    loose = _loose(problem, ())
    return Doubt(tolerances=loose, answer=np.zeros((0, len(loose))), own=np.zeros((0, 0)), of_modes=_of_modes(problem))


def doubt(problem: Problem, plain: Fit) -> Doubt:
    """At the plain fit of `problem`, on its lines."""
    loose = _loose(problem, [one.name for one in plain.parameters])
    free = solved(problem, plain, PLAIN_FLOOR).cost.free
    others = [one for one in problem.parameters if one.name in loose]
    held = {name: x for name, x in plain.by_name.items() if name not in {one.name for one in free}}
    cost = cost_of(problem, (*free, *others), PLAIN_FLOOR, held)
    N = cost.total(cost.at(plain.by_name))[0].matrix
    p = len(free)
    own = inverse(N[:p, :p]) if p else np.zeros((0, 0))
    return Doubt(
        tolerances=loose,
        fitted=tuple(one.name for one in free),
        answer=-own @ N[:p, p:] * np.array(list(loose.values())),
        own=root(own) if p else own,
        of_modes=_of_modes(problem),
    )


def _of_modes(problem: Problem) -> frozenset[str]:
    return frozenset(one.name for one in problem.parameters if one.kind == STRUCTURAL)


def _loose(problem: Problem, fitted: list[str] | tuple[str, ...]) -> dict[str, float]:
    return {one.name: one.tolerance for one in problem.parameters if one.name not in fitted and 0 < one.tolerance < np.inf}
