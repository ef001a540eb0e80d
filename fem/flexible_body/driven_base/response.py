"""From a rig and a base motion to the response, by exudyn."""

from __future__ import annotations

import numpy as np

from fem.base_excitation.base_motion import BaseMotion
from fem.base_excitation.response import Response
from fem.base_excitation.rig import Rig
from fem.base_excitation.rig_check import require_usable
from fem.flexible_body.driven_base.assembly import Assembled, assembled
from fem.flexible_body.driven_base.drive import Drive, Progress, targets
from fem.flexible_body.driven_base.integration import integrate
from fem.flexible_body.driven_base.scene import recorded
from fem.flexible_body.driven_base.solver import Solver, described, simulation
from fem.flexible_body.driven_base.steps import residual, subdivision
from fem.flexible_body.running import finite, running
from geometry.arrays import Array

TASK = "integrate the rig on its driven base"


def respond(
    rig: Rig,
    motion: BaseMotion,
    *,
    solver: Solver = Solver(),  # noqa: B008 - frozen
    progress: Progress | None = None,
    keep_coordinates: bool = False,
) -> Response:
    """What `rig` does while the table follows `motion`, integrated by exudyn.

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
        built = assembled(exudyn, rig, velocity=velocity)
        steering = Drive(built.scene, built.axes, targets(motion, steps, velocity=velocity), rate * steps, progress)
        samples = len(motion.acceleration)
        settings = simulation(exudyn, solver, rate=rate, samples=samples, subdivision=steps, residual=allowed)
        stopped = integrate(built.scene, settings, steering)
        if stopped is None:
            return _response(built, rig, motion, described(solver, rate, steps), keep_coordinates)
    raise stopped


def _response(built: Assembled, rig: Rig, motion: BaseMotion, settings: dict[str, object], keep_coordinates: bool) -> Response:
    scene = built.scene
    acceleration = finite(recorded(scene, built.article), TASK)
    cells: Array = np.zeros((len(acceleration), 0, 3))
    if built.cells:
        cells = recorded(scene, built.cells).reshape(len(acceleration), -1, 3)
    return Response(
        sampling_rate=motion.sampling_rate,
        table=recorded(scene, built.table),
        cover=recorded(scene, built.cover),
        load=-recorded(scene, built.loads),
        cells=cells,
        places={name: acceleration @ shape.T for name, shape in rig.article.places.items()},
        coordinates=recorded(scene, built.coordinates) if keep_coordinates else np.zeros((0, 0)),
        reference_point=motion.reference_point,
        settings=settings,
    )
