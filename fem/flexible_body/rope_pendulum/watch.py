"""The run watched step by step: told on, stopped from outside, or failed with the time, the step and the last state.

Before every step exudyn calls back. What is raised there is kept and raised again once exudyn has stopped: exudyn itself would
make an error of its own of it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fem.flexible_body.interruption import integrated
from fem.flexible_body.running import failed
from geometry.errors import CheckFailed

Progress = Callable[[float], None]
"""Called with the share done, 0 to 1; what it raises ends the run."""

TOLD = 200
"""Times in a run that progress is told."""


class Watch:
    """One run of `steps` steps of `step` [s]; knows how far it has come."""

    def __init__(self, *, steps: int, step: float, progress: Progress | None) -> None:
        self.steps = steps
        self.step = step
        self.progress = progress
        self.now = 0
        self.stopped: BaseException | None = None

    def run(self, system: Any, settings: Any, task: str) -> None:
        """Integrate `system`.

        Raises
        ------
        CheckFailed : exudyn gave up; with the time [s], the step and the last coordinates.
        BaseException : what stopped the run from within `progress`, or KeyboardInterrupt by Ctrl-C.
        """
        said = "the solver gave up"
        try:
            done = integrated(system, settings, self)
        except Exception as error:  # exudyn raises errors of several kinds
            done, said = False, " ".join(str(error).split())
        if self.stopped is not None:
            raise self.stopped
        if not done:
            raise self._astray(system, task, said)

    def __call__(self, system: Any, time: float) -> bool:
        """Before the step that ends at `time` [s]; False ends the run."""
        try:
            self.now = round(time / self.step)
            if self.progress is not None and self.now % max(1, self.steps // TOLD) == 0:
                self.progress(self.now / self.steps)
        except BaseException as reason:
            self.stopped = reason
        return self.stopped is None

    def _astray(self, system: Any, task: str, said: str) -> CheckFailed:
        state = np.array(system.systemData.GetODE2Coordinates()).tolist()
        where = f"{said} at {self.now * self.step:.6g} s, step {self.now} of {self.steps} of {self.step:.3g} s"
        error = failed(task, where)
        error.evidence |= {"time": self.now * self.step, "step": self.now, "state": state}
        return error
