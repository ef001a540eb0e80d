"""The public face of the joint estimator."""

from __future__ import annotations

from collections.abc import Callable

from geometry.arrays import Array
from identification.evidence import Evidence, Settings
from identification.identified import Identified
from identification.self_calibration.assembly import Assembly, assembled
from identification.self_calibration.likelihood import Normal
from identification.self_calibration.problem import normals, total
from identification.self_calibration.result import identified
from identification.self_calibration.solve import Solution, minimise

_DEFAULT = Settings()

ANNEALED = (0.02, 0.005)
"""Model-error floors that come before the one asked for: a coarse likelihood is found from farther."""


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
    return identified(problem, fitted(problem, settings, progress=progress), settings)


def fitted(problem: Assembly, settings: Settings, *, progress: Callable[[float], None] | None = None) -> Solution:
    """The joint minimum, down through the annealed floors."""
    x = problem.layout.start
    for floor in [one for one in ANNEALED if one > settings.floor]:
        x = minimise(_data(problem, floor), x, problem.knowledge, close=0.3, most=8).x
    return minimise(_data(problem, settings.floor), x, problem.knowledge, progress=progress)


def _data(problem: Assembly, floor: float) -> Callable[[Array], Normal]:
    parts = problem.parts(floor)
    return lambda x: total(normals(parts, problem.layout, x))
