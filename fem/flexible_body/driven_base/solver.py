"""`Solver`: how exudyn integrates, and what it says about it afterwards.

- "fox-goodwin": Newmark's method with beta = 1/12, gamma = 1/2 (Hughes, The Finite Element Method, 1987, section 9.1), the
  table's velocity prescribed. Frequencies are right to the fourth order of the step and the table's acceleration to the second,
  so that a lightly damped resonance comes out like everything else. It is stable only while omega h < sqrt(6) for all that can
  swing, which decides on the number of steps a sample (`fem.flexible_body.driven_base.steps`).
- "newmark": the trapezoidal rule, beta = 1/4, always stable. Frequencies come out too low by (omega h)² / 12, which a mode of
  damping ratio zeta shows as an error of (omega h)² / (12 zeta) in its answer.
- "generalised-alpha": the table's displacement is prescribed (constraints of index 3; Arnold & Brüls, Multibody System Dynamics
  18, 2007, doi:10.1007/s11044-007-9084-0). Frequencies as "newmark"; what is far too fast for the step dies out. With a spectral
  radius of 1 nothing dies out and the load is lost in an oscillation from step to step.

Measured against the exact recursion at 8192 Hz, one blade swept from 4 to 32 Hz along x and about z, greatest error of load in
units of the greatest load: 1.4e-5 and 7e-5, 1.1e-3 and 6.5e-3, 1.2e-3 and 6.5e-3. All fall with the square of the step; with a
radius of 1 the last one is 7e-2, and more than 1 at half the step.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any, Literal, get_args

import numpy as np

from fem.flexible_body.running import exudyn_version
from geometry.errors import BadInput

Method = Literal["fox-goodwin", "newmark", "generalised-alpha"]

BETA = {"fox-goodwin": 1 / 12, "newmark": 1 / 4}
"""Newmark's beta of the methods that prescribe velocities."""

STABLE = {"fox-goodwin": float(np.sqrt(6.0))}
"""The largest omega h that a method bears, of those that do not bear any."""

EARLY = 1e-9
"""Share of a sample by which exudyn's instants of recording run ahead, so that no rounding of its clock skips one."""


@dataclass(frozen=True, kw_only=True)
class Solver:
    """Settings of exudyn's time integration.

    Attributes
    ----------
    method : see above
    spectral_radius : of generalised-alpha at infinite frequency, above 0 and up to 1: how much of what is far too fast for the
        step survives one step
    subdivision : steps a sample of the base motion, at least 1; None for as many as the method needs to be stable
    tolerance : by which the acceleration of a joint may be off when Newton's iteration ends, relative to the table's largest

    Raises
    ------
    BadInput : a value out of its bounds.
    """

    method: Method = "fox-goodwin"
    spectral_radius: float = 0.9
    subdivision: int | None = None
    tolerance: float = 1e-6

    def __post_init__(self) -> None:
        methods = get_args(Method)
        if self.method not in methods:
            raise _bad("method", f"it must be one of {', '.join(methods)}, found {self.method!r}", "Name one of them")
        if not 0 < self.spectral_radius <= 1:
            raise _bad("spectral_radius", f"it must lie above 0 and up to 1, found {self.spectral_radius:g}", "Take 0.9")
        if self.subdivision is not None and not (self.subdivision >= 1 and self.subdivision == int(self.subdivision)):
            problem = f"it must be a whole number from 1, found {self.subdivision:g}"
            raise _bad("subdivision", problem, "Take 1, or 2 for half the step")
        if not 0 < self.tolerance < 1:
            raise _bad("tolerance", f"it must lie between 0 and 1, found {self.tolerance:g}", "Take 1e-6")

    @property
    def prescribes_velocity(self) -> bool:
        """Whether the table's velocity is prescribed (constraints of index 2) and not its displacement (index 3)."""
        return self.method in BETA


def simulation(exudyn: Any, solver: Solver, *, rate: float, samples: int, subdivision: int, residual: float) -> Any:
    """Exudyn's settings for `samples` samples at `rate` [Hz], the first at time 0, and `subdivision` steps from one to the next.

    `residual` is what Newton's iteration may leave.
    """
    settings = exudyn.SimulationSettings()
    time, alpha = settings.timeIntegration, settings.timeIntegration.generalizedAlpha
    time.numberOfSteps, time.endTime = (samples - 1) * subdivision, (samples - 1) / rate
    time.adaptiveStep = False  # a step cut short would not meet the samples of the motion
    time.newton.relativeTolerance, time.newton.absoluteTolerance = np.finfo(float).eps, residual
    time.newton.useModifiedNewton = True
    alpha.spectralRadius = solver.spectral_radius
    alpha.useIndex2Constraints = alpha.useNewmark = solver.prescribes_velocity
    alpha.newmarkBeta, alpha.newmarkGamma = BETA.get(solver.method, 1 / 4), 1 / 2
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = (1 - EARLY) / rate
    return settings


def described(solver: Solver, rate: float, subdivision: int) -> dict[str, object]:
    """What a result says about how it was found; JSON values."""
    step = 1 / (rate * subdivision)
    return {
        "route": "exudyn",
        "exudyn": exudyn_version(),
        **asdict(solver),
        "subdivision": subdivision,
        "step_s": step,
        "sampling_rate_hz": rate,
    }


def _bad(field: str, problem: str, remedy: str) -> BadInput:
    return BadInput(source="solver", field=field, problem=problem, remedy=remedy)
