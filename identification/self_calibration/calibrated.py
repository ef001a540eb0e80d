"""The public face of the joint estimator."""

from __future__ import annotations

from collections.abc import Callable

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

BEYOND = 3
"""Poles beyond the band up to which one more is tried: the residual mass leaves of those there what rises with omega⁴."""

LET_IN = 16.0
"""What such a pole must take out of chi², twice its eight parameters (Akaike 1974): there are poles beyond for certain."""

FURTHER_STEPS = 20
"""Evaluations after which a further pole that does not pay yet is given up."""


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
    tell = progress or (lambda share: None)
    problem = assembled(evidence, settings)
    tell(0.3)
    searched = settings.modes is None
    problem, x = _annealed(problem, settings, prune=searched)
    solution = _minimum(problem, settings.floor, x, progress=lambda share: tell(0.3 + 0.5 * share))
    if searched:
        problem, solution = _plainer(*_completed(problem, solution, settings), settings)
    found = identified(problem, solution, settings)
    tell(1.0)
    return found


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
    """The fit without poles in the band that do not pay at the floor asked for; those beyond it were let in by what they took."""
    shorter = pruning.pruned(problem, solution, _size(problem, settings.floor), below=problem.band[1])
    if shorter is None or pruning.modes(shorter[0]) == pruning.modes(problem):
        return problem, solution
    return shorter[0], _minimum(shorter[0], settings.floor, shorter[1])


def _completed(problem: Assembly, solution: Solution, settings: Settings) -> tuple[Assembly, Solution]:
    """The fit with a few further poles where they pay: beyond the band, and where lines do not fit."""
    for _ in range(BEYOND - pruning.beyond(problem, solution.x) if pruning.modes(problem) else 0):
        more = _paid(further_poles.with_one_beyond(problem, solution.x), solution, settings, LET_IN)
        if more is None:
            break
        problem, solution = more
    for _ in range(FURTHER):
        line, misfit = further_poles.worst(problem, solution.x, settings.floor)
        longer = further_poles.with_one_more(problem, solution.x, line) if misfit > further_poles.MISFIT else None
        price = pruning.price(_size(problem, settings.floor))
        problem, solution = _paid(longer, solution, settings, price) or (problem, solution)
    return problem, solution


def _paid(
    longer: tuple[Assembly, Array] | None, solution: Solution, settings: Settings, price: float
) -> tuple[Assembly, Solution] | None:
    """The minimum with one pole more; None where it takes less than `price` out of chi²."""
    if longer is None:
        return None
    more = _minimum(longer[0], settings.floor, longer[1], most=FURTHER_STEPS)
    if 2 * (solution.normal.cost - more.normal.cost) < price:
        return None
    return longer[0], more if more.converged else _minimum(longer[0], settings.floor, more.x)


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
        asked=problem.layout.at("article"),
        most=most,
        size=sum(part.observed.size for part in parts),
        progress=progress,
    )
