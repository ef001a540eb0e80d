"""The run itself: it ends well, is stopped, or fails with the time, the step and the last state."""

from __future__ import annotations

from typing import Any

import numpy as np

from fem.flexible_body.driven_base.drive import Drive
from fem.flexible_body.driven_base.scene import Scene
from fem.flexible_body.running import exudyn_version
from geometry.errors import CheckFailed


def integrate(scene: Scene, settings: Any, drive: Drive) -> BaseException | None:
    """Run `scene` to the end of `settings`, its table moved by `drive`; what stopped it from within `drive`, if anything did.

    Raises
    ------
    CheckFailed : exudyn gave up.
    """
    scene.system.SetPreStepUserFunction(drive)
    said = "the solver gave up"
    try:
        done = scene.system.SolveDynamic(settings)
    except Exception as error:
        done, said = False, str(error)
    if not done and drive.stopped is None:
        raise _astray(scene, drive, said)
    return drive.stopped


def _astray(scene: Scene, drive: Drive, said: str) -> CheckFailed:
    q, rate = (np.array(values) for values in _state(scene))
    worst = int(np.argmax(np.abs(q)))
    return CheckFailed(f"{exudyn_version()} {said} {drive.step} {q[worst]} {rate[worst]}")


def _state(scene: Scene) -> tuple[Any, Any]:
    data = scene.system.systemData
    return data.GetODE2Coordinates(), data.GetODE2Coordinates_t()
