"""From a rig and a base motion to the response, by exudyn."""

from __future__ import annotations

import sys
from dataclasses import asdict, dataclass, replace
from functools import partial
from math import ceil, pi
from typing import Any, Literal, get_args

import numpy as np

from fem.base_excitation import response
from fem.base_excitation.patterns import BaseMotion
from fem.base_excitation.response import Response, require_fine
from fem.base_excitation.rig import LATERAL, TABLE, Rig, matrices, require_usable
from fem.exudyn import driven_rig
from fem.exudyn.driven_rig import Drive, Number, Progress, Scene, assembled, position_of, recorded, targets
from fem.exudyn.run import exudyn_version, failed, finite, integrated, running
from geometry.errors import BadInput, CheckFailed
from geometry.frames import Array

# The run itself: it ends well, is stopped, or fails with the time, the step and the last state.


def integrate(scene: Scene, settings: Any, drive: Drive) -> BaseException | None:
    """Run `scene` to the end of `settings`, its table moved by `drive`; what stopped it from within `drive`, if anything did.

    Raises
    ------
    CheckFailed : exudyn gave up.
    KeyboardInterrupt : Ctrl-C, once exudyn has stopped.
    """
    said = "the solver gave up"
    try:
        done = integrated(scene.system, settings, drive)
    except Exception as error:
        done, said = False, str(error)
    if not done and drive.stopped is None:
        data = scene.system.systemData
        q, rates = (np.asarray(values, dtype=np.float64) for values in (data.GetODE2Coordinates(), data.GetODE2Coordinates_t()))
        worst = int(np.argmax(np.where(np.isfinite(q), np.abs(q), np.inf)))
        # Name of one of exudyn's coordinates of second order
        starts = {scene.system.GetNodeODE2Index(node): node for node in range(scene.system.systemData.NumberOfNodes())}
        first = max(start for start in starts if 0 <= start <= worst)
        node = starts[first]
        coordinate = f"coordinate {worst - first + 1} of the {scene.names.get(node) or scene.system.GetNode(node)['name']}"
        time, name = drive.step / drive.rate, coordinate
        raise CheckFailed(
            f"exudyn {exudyn_version()} lost the rig at {time:.6g} s, in step {drive.step} of {drive.steps}: {said}. "
            f"The largest of its last state is {name}, at {q[worst]:.4g} and changing by {rates[worst]:.4g} a second. "
            "Take more steps a sample, and look for a damping or stiffness that feeds energy in.",
            time=time,
            step=drive.step,
            coordinate=name,
            value=float(q[worst]),
            rate=float(rates[worst]),
        )
    return drive.stopped


# `Solver`: how exudyn integrates, and what it says about it afterwards.
#
# - "fox-goodwin": Newmark's method with beta = 1/12, gamma = 1/2 (Hughes, The Finite Element Method, 1987, section 9.1), the
#   table's velocity prescribed. Frequencies are right to the fourth order of the step and the table's acceleration to the
#   second, so that a lightly damped resonance comes out like everything else. It is stable only while omega h < sqrt(6) for all
#   that can swing, which decides on the number of steps a sample.
# - "newmark": the trapezoidal rule, beta = 1/4, always stable. Frequencies come out too low by (omega h)² / 12, which a mode of
#   damping ratio zeta shows as an error of (omega h)² / (12 zeta) in its answer.
# - "generalised-alpha": the table's displacement is prescribed (constraints of index 3; Arnold & Brüls, Multibody System
#   Dynamics 18, 2007, doi:10.1007/s11044-007-9084-0). Frequencies as "newmark"; what is far too fast for the step dies out. With
#   a spectral radius of 1 nothing dies out and the load is lost in an oscillation from step to step.
#
# Measured against the exact recursion at 8192 Hz, one blade swept from 4 to 32 Hz along x and about z, greatest error of load in
# units of the greatest load: 1.4e-5 and 7e-5, 1.1e-3 and 6.5e-3, 1.2e-3 and 6.5e-3. All fall with the square of the step; with a
# radius of 1 the last one is 7e-2, and more than 1 at half the step.


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


# How long a step may be, and how well the equations of one can be solved.
#
# A step must be short enough for the modes of the article that are kept as such: `fem.base_excitation.response.require_fine` says
# how many a period of the highest of them. Coordinates that carry static answers, load cells and joints may swing far faster;
# they need not be followed, but a method that is not always stable must bear them.


MARGIN = 0.9
"""Share of the stability limit that is used."""

MOST = 32
"""Steps a sample beyond which another method is the better advice."""

EPS = sys.float_info.epsilon

ROUNDINGS = 8
"""Roundings of a place that add up in a spring's force."""

RESONANT = 1e4
"""Times the load of a rigid article that the forces within one may be when it resonates, and their roundings with them."""


def subdivision(rig: Rig, rate: float, solver: Solver) -> int:
    """Steps a sample, of a base motion at `rate` [Hz].

    Raises
    ------
    BadInput : too coarse for a kept mode, or for the solver's method to be stable; the message names what is needed.
    """
    frequency = highest(rig)
    limit = STABLE.get(solver.method)
    least = 1 if limit is None else max(1, ceil(2 * pi * frequency / (MARGIN * limit * rate)))
    steps = least if solver.subdivision is None else solver.subdivision
    if steps < least or least > MOST:
        found = f"found {steps}" if steps < least else f"more than {MOST} of them"
        raise BadInput(
            source="solver",
            field="subdivision",
            problem=f"{highest(rig):.4g} Hz, the rig's highest frequency, needs {least} steps a sample, {found}",
            remedy="Leave it out, soften the stiffest joint, or use generalised-alpha",
        )
    require_fine(rig.article, rate * steps)
    return steps


def highest(rig: Rig) -> float:
    """[Hz] the highest frequency of all that stands on the held table, gaps closed and loose parts sticking; 0 when rigid."""
    from scipy.linalg import eigvalsh

    cells = tuple(replace(cell, preload=None) for cell in rig.cells)
    structure = matrices(replace(rig, frictions=(), cells=cells))
    M, K = structure.mass, structure.stiffness
    for friction in rig.frictions:
        # One coordinate more: how far the part moves along its axis on the article's base
        size, base = len(M), structure.article[:3]
        rows = np.zeros((3, size + 1))
        rows[:, : base.shape[1]] = base
        rows[LATERAL.index(friction.axis), size] = 1.0
        M, K = (np.pad(matrix, (0, 1)) for matrix in (M, K))
        K[size, size] = friction.mass * driven_rig.STIFFNESS
        M = M + friction.mass * rows.T @ rows
    free = slice(TABLE, None)
    return float(np.sqrt(eigvalsh(K[free, free], M[free, free]).max(initial=0.0)) / (2 * pi))


def residual(rig: Rig, motion: BaseMotion, step: float, solver: Solver) -> float:
    """What Newton's iteration may leave: a length [m] or a velocity [m/s] in joints and a force [N] elsewhere.

    In a joint, what is left over becomes an acceleration when it is divided by the step or its square, and is held to the
    tolerance. Springs between places set a floor: their force knows a place no better than a number of this size is rounded.
    """
    peak, travel = (float(np.abs(values).max(initial=0.0)) for values in (motion.acceleration, motion.displacement))
    mass = float(np.abs(rig.article.reduced.mass[:TABLE, :TABLE]).max()) + (0.0 if rig.cover is None else rig.cover.mass)
    # [N] the largest stiffness between two places, times how far they lie from F, or how far they travel [m] together
    springs = [cell.stiffness.max() * np.linalg.norm(cell.position) for cell in rig.cells]
    for strut in rig.struts:
        at = rig.seat + position_of(rig.article.places[strut.place])
        springs.append(strut.stiffness.max() * np.linalg.norm(at))
    if rig.flange is not None and rig.flange.compliance.any():
        springs.append(np.linalg.norm(rig.seat) / rig.flange.compliance[rig.flange.compliance > 0].min())
    springs += [friction.mass * driven_rig.STIFFNESS * travel for friction in rig.frictions]
    rounding = EPS * (ROUNDINGS * float(max(springs, default=0.0)) + RESONANT * mass * peak)
    return max(solver.tolerance * peak * step ** (1 if solver.prescribes_velocity else 2), rounding, sys.float_info.min)


TASK = "integrate the rig on its driven base"


def respond(
    rig: Rig,
    motion: BaseMotion,
    *,
    solver: Solver = Solver(),
    progress: Progress | None = None,
    keep_coordinates: bool = False,
) -> Response:
    """What `rig` does while the table follows `motion`, integrated by exudyn.

    Everything is told in the laboratory's axes. Table, cover plate and cells move as far as they move, so the forces of the cells
    turn with the cover plate; the article itself is linear, and knows small rotations only.

    Parameters
    ----------
    solver : method, step and tolerance; see `Solver`
    progress : called with the share done; what it raises, KeyboardInterrupt for one, ends the run and leaves as it is
    keep_coordinates : with those of the article: its base's six, then its own, in the laboratory

    Raises
    ------
    BadInput : a rig, motion or solver that cannot be used.
    CheckFailed : the integration failed or went astray; with the time, the step and the last state.
    """
    require_usable(rig)
    rate = motion.sampling_rate
    steps = subdivision(rig, rate, solver)
    velocity = solver.prescribes_velocity
    allowed = residual(rig, motion, 1 / (rate * steps), solver)
    with running(TASK) as exudyn:
        built = assembled(exudyn, rig, velocity=velocity, keep_coordinates=keep_coordinates)
        steering = Drive(built.scene, built.axes, targets(motion, steps, velocity=velocity), rate * steps, progress)
        samples = len(motion.acceleration)
        settings = simulation(exudyn, solver, rate=rate, samples=samples, subdivision=steps, residual=allowed)
        stopped = integrate(built.scene, settings, steering)
        if stopped is None:
            words = described(solver, rate, steps)
            n, warning = len(motion.acceleration), response.warning(rig, motion)
            read = partial(_read, built.scene, n)
            acceleration = read(built.article)
            return Response(
                sampling_rate=motion.sampling_rate,
                table=read(built.table),
                cover=read(built.cover),
                load=-read(built.loads),
                cells=read(built.cells).reshape(n, -1, 3),
                places={name: acceleration @ shape.T for name, shape in rig.article.places.items()},
                coordinates=read(built.coordinates),
                slipping=tuple(bristles.share_slipping for bristles in built.bristles),
                reference_point=motion.reference_point,
                settings=words,
                warnings=(warning,) if warning else (),
            )
    raise stopped


def _read(scene: Scene, samples: int, sensors: tuple[Number, ...]) -> Array:
    """(samples, k) what `sensors` recorded, side by side.

    Raises
    ------
    CheckFailed : something is not finite, or another number of samples.
    """
    found = finite(recorded(scene, sensors), TASK) if sensors else np.zeros((samples, 0))
    if len(found) != samples:
        raise failed(TASK, f"it recorded {len(found)} samples of {samples}")
    return found
