"""A run of a rig that is not linear - a cell that lifts off, a loose part that slips - integrated by exudyn, whole.

It costs twenty times and more what the recursion does. The sensors read the same signals with the same rows. The tilt of the
cover plate, which counts only where one half of gravity is off, is taken to be that of the table: cells let the two differ
by microradians.
"""

from __future__ import annotations

import numpy as np

from fem.base_excitation.base_motion import BaseMotion
from fem.base_excitation.response import Response
from geometry.arrays import Array
from validation.virtual_test.laboratory import Laboratory
from validation.virtual_test.plan import Plan
from validation.virtual_test.runs import DrivenRun, cross_motion


def respond(plan: Plan, lab: Laboratory, run: DrivenRun, rate: float) -> tuple[Response, Array]:
    """What the rig of `lab` does in `run` at `rate` [Hz], and what all sensors read of it, (n, c).

    Raises
    ------
    BadInput : a rig that cannot be built, or whose ringing never ends.
    CheckFailed : the integration failed.
    """
    from fem.base_excitation import ring_down
    from fem.flexible_body import driven_base

    at_rest = _motion(plan, run, rate, 0.0)
    length = ring_down.needed(lab.rig, at_rest, plan.ringing)
    motion = _motion(plan, run, rate, length - at_rest.driven + plan.quiet)
    response = driven_base.respond(lab.rig, motion)
    return response, _read(lab, response, motion)


def _motion(plan: Plan, run: DrivenRun, rate: float, rest: float) -> BaseMotion:
    found: BaseMotion = run.pattern.motion(rate, ring_down=rest, cross=cross_motion(plan, run.name))  # type: ignore[attr-defined]
    return found


def _read(lab: Laboratory, response: Response, motion: BaseMotion) -> Array:
    tilt = motion.displacement[:, 3:5]
    signals = [response.table, response.cover, response.cells.reshape(len(response.table), -1), tilt, tilt]
    return np.asarray(np.hstack(signals) @ lab.sensors.rows.T)
