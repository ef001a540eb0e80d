"""The public face of the joint estimator."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from geometry.arrays import Array
from identification.evidence import Evidence, Settings
from identification.identified import Identified
from identification.self_calibration import further_poles, pruning
from identification.self_calibration.assembly import Assembly, assembled
from identification.self_calibration.problem import normals, total
from identification.self_calibration.result import identified
from identification.self_calibration.solve import CLOSE, MOST, Solution, minimise

_DEFAULT = Settings()

ANNEALED = (0.02, 0.005)
"""Model-error floors that come before the one asked for: a coarse likelihood is found from farther."""

FURTHER = 1
"""Poles that are added at most where the joint fit shows lines that do not fit."""

FURTHER_STEPS = 40
"""Evaluations after which a further pole that has not settled is given up."""


def calibrated(
    evidence: Evidence, settings: Settings = _DEFAULT, *, progress: Callable[[float], None] | None = None
) -> Identified:
    """The article's ten parameters about F with every tolerance of the measurement chain estimated beside them.

    Without a tare and without a known FMD the result includes the FMD, and a warning says so.

    Parameters
    ----------
    progress : told the share of the work that is done, 0 to 1

    Raises
    ------
    BadInput : tare and article of different `hardware` without `settings.any_hardware`; a channel table that differs.
    """
    problem = assembled(evidence, settings)
    prune = settings.modes is None
    problem, x = _annealed(problem, settings, prune=prune)
    solution = _minimum(problem, settings.floor, x, progress=progress)
    if prune:
        problem, solution = _completed(*_plainer(problem, solution, settings), settings)
    return identified(problem, solution, settings)


def _annealed(problem: Assembly, settings: Settings, *, prune: bool = False) -> tuple[Assembly, Array]:
    """Down through the annealed floors: the problem, plainer where poles do not pay any longer, and where they led."""
    x = problem.layout.start
    for floor in [one for one in ANNEALED if one > settings.floor]:
        coarse = _minimum(problem, floor, x, close=0.3, most=8)
        at_last = _linearised(problem, settings.floor, coarse) if prune else coarse
        shorter = pruning.pruned(problem, at_last, _size(problem, settings.floor), below=problem.band[1]) if prune else None
        problem, x = shorter or (problem, coarse.x)
    return problem, x


def _linearised(problem: Assembly, floor: float, coarse: Solution) -> Solution:
    """The normal equations at the place of a `coarse` solution with the weights of another `floor`."""
    return _minimum(problem, floor, coarse.x, most=0)


def _plainer(problem: Assembly, solution: Solution, settings: Settings) -> tuple[Assembly, Solution]:
    """The fit without poles that do not pay at the floor asked for."""
    shorter = pruning.pruned(problem, solution, _size(problem, settings.floor))
    if shorter is None or pruning.modes(shorter[0]) == pruning.modes(problem):
        return problem, solution
    return shorter[0], _minimum(shorter[0], settings.floor, shorter[1])


def _completed(problem: Assembly, solution: Solution, settings: Settings) -> tuple[Assembly, Solution]:
    """The fit with a few further poles where lines do not fit and poles pay."""
    for _ in range(FURTHER):
        line, misfit = further_poles.worst(problem, solution.x, settings.floor)
        longer = further_poles.with_one_more(problem, solution.x, line) if misfit > further_poles.MISFIT else None
        if longer is None:
            break
        more = _minimum(longer[0], settings.floor, longer[1], most=FURTHER_STEPS)
        price = (len(longer[0].layout) - len(problem.layout)) * np.log(_size(problem, settings.floor)) / 2
        if not more.converged or solution.normal.cost - more.normal.cost < price:
            break
        problem, solution = longer[0], more
    return problem, solution


def _size(problem: Assembly, floor: float) -> int:
    return sum(part.observed.size for part in problem.parts(floor))


def fitted(problem: Assembly, settings: Settings, *, progress: Callable[[float], None] | None = None) -> Solution:
    """The joint minimum, down through the annealed floors."""
    return _minimum(problem, settings.floor, _annealed(problem, settings)[1], progress=progress)


def _minimum(
    problem: Assembly,
    floor: float,
    start: Array,
    *,
    close: float = CLOSE,
    most: int = MOST,
    progress: Callable[[float], None] | None = None,
) -> Solution:
    parts = problem.parts(floor)
    return minimise(
        lambda x: total(normals(parts, problem.layout, x)),
        start,
        problem.knowledge,
        close=close,
        most=most,
        size=sum(part.observed.size for part in parts),
        progress=progress,
    )
