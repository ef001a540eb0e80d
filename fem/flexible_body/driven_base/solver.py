"""`Solver`: how exudyn integrates, and what it says about it afterwards.

Both methods are of second order in the step. The table's acceleration follows from its prescribed displacement (generalised-alpha
with constraints of index 3; Arnold & Brüls, Multibody System Dynamics 18, 2007, doi:10.1007/s11044-007-9084-0) or from its
prescribed velocity (Newmark's trapezoidal rule, index 2).
"""

from __future__ import annotations

import sys
from dataclasses import asdict, dataclass
from typing import Any, Literal

import numpy as np

from fem.base_excitation.base_motion import BaseMotion
from fem.base_excitation.rig import Rig
from fem.flexible_body.driven_base import friction as bristles
from fem.flexible_body.driven_base.struts import position_of
from fem.flexible_body.running import exudyn_version
from geometry.errors import BadInput

EPS = 2.0**-52

ROUNDINGS = 8
"""Roundings of a place that add up in a spring's force."""


@dataclass(frozen=True, kw_only=True)
class Solver:
    """Settings of exudyn's time integration.

    Attributes
    ----------
    method : "generalised-alpha", which prescribes displacements, or "newmark", which prescribes velocities
    spectral_radius : of generalised-alpha at infinite frequency, above 0 and below 1: how much of what is far too fast for the
        step survives one step
    subdivision : steps a sample of the base motion, at least 1
    tolerance : by which the acceleration of a joint may be off when Newton's iteration ends, relative to the table's largest

    Raises
    ------
    BadInput : a value out of its bounds.
    """

    method: Literal["generalised-alpha", "newmark"] = "generalised-alpha"
    spectral_radius: float = 0.9
    subdivision: int = 1
    tolerance: float = 1e-6

    def __post_init__(self) -> None:
        if self.method not in ("generalised-alpha", "newmark"):
            raise _bad("method", f"it must be generalised-alpha or newmark, found {self.method!r}", "Name one of them")
        if not 0 < self.spectral_radius <= 1:
            raise _bad("spectral_radius", f"it must lie above 0 and up to 1, found {self.spectral_radius:g}", "Take 0.9")
        if self.subdivision < 1 or self.subdivision != int(self.subdivision):
            problem = f"it must be a whole number from 1, found {self.subdivision:g}"
            raise _bad("subdivision", problem, "Take 1, or 2 for half the step")
        if not 0 < self.tolerance < 1:
            raise _bad("tolerance", f"it must lie between 0 and 1, found {self.tolerance:g}", "Take 1e-6")

    @property
    def prescribes_velocity(self) -> bool:
        """Whether the table's velocity is prescribed (index 2) and not its displacement (index 3)."""
        return self.method == "newmark"


def residual(solver: Solver, motion: BaseMotion, rig: Rig) -> float:
    """What Newton's iteration may leave, a length [m] in joints and a force [N] elsewhere.

    In a joint of index 3 a length left over becomes an acceleration when it is divided by the square of the step, and is held to
    the tolerance. Springs between places set a floor: their force knows a place no better than a number of this size is rounded.
    """
    step = 1 / (motion.sampling_rate * solver.subdivision)
    peak = float(np.abs(motion.acceleration).max(initial=0.0))
    mass = float(rig.article.reduced.mass[0, 0]) + (0.0 if rig.cover is None else rig.cover.mass)
    travel = float(np.abs(motion.displacement).max(initial=0.0))
    rounding = ROUNDINGS * EPS * (stiffest(rig, travel) + mass * peak)
    return max(solver.tolerance * peak * step**2, rounding, sys.float_info.min)


def simulation(exudyn: Any, solver: Solver, *, rate: float, steps: int, allowed: float) -> Any:
    """Exudyn's settings for `steps` steps that are recorded `rate` times a second; `allowed` is the residual that may stay."""
    settings = exudyn.SimulationSettings()
    time, alpha = settings.timeIntegration, settings.timeIntegration.generalizedAlpha
    time.numberOfSteps, time.endTime = steps, steps / (rate * solver.subdivision)
    time.adaptiveStep = False  # a step cut short would not meet the samples of the motion
    time.newton.relativeTolerance, time.newton.absoluteTolerance = EPS, allowed
    time.newton.useModifiedNewton = True
    alpha.spectralRadius = solver.spectral_radius
    alpha.useIndex2Constraints = alpha.useNewmark = solver.prescribes_velocity
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = 1 / rate
    return settings


def stiffest(rig: Rig, travel: float) -> float:
    """[N] the largest stiffness between two places, times the numbers that tell them apart: how far they lie from F, or travel [m]."""
    springs = [(cell.stiffness.max(), np.linalg.norm(cell.position)) for cell in rig.cells]
    for strut in rig.struts:
        at = rig.seat + position_of(rig.article.places[strut.place])
        springs.append((strut.stiffness.max(), np.linalg.norm(at)))
    if rig.flange is not None and rig.flange.compliance.any():
        springs.append((1 / rig.flange.compliance[rig.flange.compliance > 0].min(), np.linalg.norm(rig.seat)))
    springs += [(friction.mass * bristles.STIFFNESS, travel) for friction in rig.frictions]
    return float(max((k * length for k, length in springs), default=0.0))


def described(solver: Solver, rate: float) -> dict[str, object]:
    """What a result says about how it was found; JSON values."""
    return {"program": "exudyn", "version": exudyn_version(), "step": 1 / (rate * solver.subdivision), **asdict(solver)}


def _bad(field: str, problem: str, remedy: str) -> BadInput:
    return BadInput(source="solver", field=field, problem=problem, remedy=remedy)
