"""From a rig and a base motion to the response, by exudyn."""

from __future__ import annotations

from functools import partial

import numpy as np

from fem.base_excitation import ring_down
from fem.base_excitation.base_motion import BaseMotion
from fem.base_excitation.response import Response
from fem.base_excitation.rig import Rig
from fem.base_excitation.rig_check import require_usable
from fem.flexible_body.driven_base.assembly import Assembled, assembled
from fem.flexible_body.driven_base.drive import Drive, Progress, targets
from fem.flexible_body.driven_base.integration import integrate
from fem.flexible_body.driven_base.scene import Number, Scene, recorded
from fem.flexible_body.driven_base.solver import Solver, described, simulation
from fem.flexible_body.driven_base.steps import residual, subdivision
from fem.flexible_body.running import failed, finite, running
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
            return _response(built, rig, motion, described(solver, rate, steps))
    raise stopped


def _response(built: Assembled, rig: Rig, motion: BaseMotion, settings: dict[str, object]) -> Response:
    n, warning = len(motion.acceleration), ring_down.warning(rig, motion)
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
        settings=settings,
        warnings=(warning,) if warning else (),
    )


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
