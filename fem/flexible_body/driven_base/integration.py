"""The run itself: it ends well, is stopped, or fails with the time, the step and the last state."""

from __future__ import annotations

from typing import Any

import numpy as np

from fem.flexible_body.driven_base.drive import Drive
from fem.flexible_body.driven_base.scene import Scene
from fem.flexible_body.interruption import integrated
from fem.flexible_body.running import exudyn_version
from geometry.errors import CheckFailed


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
        raise _astray(scene, drive, said)
    return drive.stopped


def _astray(scene: Scene, drive: Drive, said: str) -> CheckFailed:
    data = scene.system.systemData
    q, rates = (np.asarray(values, dtype=np.float64) for values in (data.GetODE2Coordinates(), data.GetODE2Coordinates_t()))
    worst = int(np.argmax(np.where(np.isfinite(q), np.abs(q), np.inf)))
    time, name = drive.step / drive.rate, _coordinate(scene, worst)
    return CheckFailed(
        f"exudyn {exudyn_version()} lost the rig at {time:.6g} s, in step {drive.step} of {drive.steps}: {said}. "
        f"The largest of its last state is {name}, at {q[worst]:.4g} and changing by {rates[worst]:.4g} a second. "
        "Take more steps a sample, and look for a damping or stiffness that feeds energy in.",
        time=time,
        step=drive.step,
        coordinate=name,
        value=float(q[worst]),
        rate=float(rates[worst]),
    )


def _coordinate(scene: Scene, number: int) -> str:
    """Name of one of exudyn's coordinates of second order."""
    starts = {scene.system.GetNodeODE2Index(node): node for node in range(scene.system.systemData.NumberOfNodes())}
    first = max(start for start in starts if 0 <= start <= number)
    node = starts[first]
    return f"coordinate {number - first + 1} of the {scene.names.get(node) or scene.system.GetNode(node)['name']}"
