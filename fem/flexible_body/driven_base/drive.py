"""What moves the table, step by step, and what may stop the run.

Before every step exudyn calls back once. The six values that the table must reach in it are set, the share done is told, and
whatever is raised there is kept and raised again once exudyn has stopped: exudyn itself would make an error of its own of it.

Between two samples the motion is the polynomial of fifth degree that has displacement, velocity and acceleration of both.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fem.base_excitation.base_motion import BaseMotion
from fem.flexible_body.driven_base.bodies import BASE, Rigid
from fem.flexible_body.driven_base.scene import Number, Scene, coordinate, watch_object
from geometry.arrays import Array

Progress = Callable[[float], None]
"""Called with the share done, 0 to 1; what it raises ends the run."""

TOLD = 200
"""Times in a run that progress is told."""


class Drive:
    """The callback of one run: it moves the table and can be stopped; it knows how far the run has come."""

    def __init__(self, scene: Scene, axes: tuple[Number, ...], targets: Array, rate: float, progress: Progress | None) -> None:
        self.others = scene.before_step
        moving = np.flatnonzero(targets.any(axis=0))  # the others stay where they are: a callback costs more than a step
        self.axes, self.targets = tuple(axes[axis] for axis in moving), targets[:, moving]
        self.rate = rate
        self.progress = progress
        self.step, self.steps = 0, len(targets) - 1
        self.stopped: BaseException | None = None

    def __call__(self, system: Any, time: float) -> bool:
        """Prepare the step that ends at `time` [s]; False ends the run."""
        try:
            self._prepare(system, time)
        except BaseException as reason:
            self.stopped = reason
        return self.stopped is None

    def _prepare(self, system: Any, time: float) -> None:
        self.step = round(time * self.rate)
        for axis, value in zip(self.axes, self.targets[self.step].tolist(), strict=True):
            system.SetObjectParameter(axis, "offset", value)
        for other in self.others:
            other(system)
        due = self.step % max(1, self.steps // TOLD) == 0 or self.step == self.steps
        if self.progress is not None and due:
            self.progress(self.step / self.steps)


def driven(scene: Scene, table: Rigid, *, velocity: bool) -> tuple[Number, ...]:
    """Constraints on the six coordinates of the table: their displacements are prescribed, or their velocities."""
    constraint = scene.items.ObjectConnectorCoordinate
    axes = []
    for axis in range(BASE):
        ends = [coordinate(scene, scene.origin, 0), coordinate(scene, table.node, axis)]
        axes.append(scene.system.AddObject(constraint(markerNumbers=ends, velocityLevel=velocity)))
    return tuple(int(axis) for axis in axes)


def loads(scene: Scene, axes: tuple[Number, ...]) -> tuple[Number, ...]:
    """Sensors of the constraints' forces: what stands on the table pulls at the ground, which is minus the load on it."""
    return tuple(watch_object(scene, axis, "Force") for axis in axes)


def targets(motion: BaseMotion, subdivision: int, *, velocity: bool) -> Array:
    """(n, 6) what the table must reach at every step, from time 0 on: displacements, or velocities.

    Parameters
    ----------
    subdivision : steps a sample
    """
    if subdivision == 1:
        return motion.velocity if velocity else motion.displacement
    u, v, a, h = motion.displacement, motion.velocity, motion.acceleration, 1 / motion.sampling_rate
    n = len(u) - 1
    ends = np.stack([u[:-1], h * v[:-1], h**2 * a[:-1], u[1:], h * v[1:], h**2 * a[1:]])
    weights = np.array([_quintic(j / subdivision, velocity=velocity) for j in range(subdivision)])
    between = np.einsum("je,eni->nji", weights, ends).reshape(n * subdivision, BASE)
    return np.vstack([between / h, v[-1:]]) if velocity else np.vstack([between, u[-1:]])


def _quintic(s: float, *, velocity: bool) -> Array:
    """(6,) weights of value, slope and curvature at 0 and at 1 in the polynomial of fifth degree at `s`, or in its slope."""
    ends = np.array([_powers(x, order) for x in (0.0, 1.0) for order in range(3)])
    return np.asarray(np.linalg.solve(ends.T, _powers(s, int(velocity))))


def _powers(s: float, order: int) -> Array:
    """(6,) derivatives of 1, s, s², ... of `order` at `s`."""
    from numpy.polynomial.polynomial import polyder, polyval

    return np.array([float(polyval(s, polyder(unit, order))) for unit in np.eye(BASE)])
