"""What exudyn says about small motions of an article: linearised matrices on a free base, eigen-solution on a held one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from fem.flexible_body import native
from fem.flexible_body.running import failed, finite, running
from fem.frame import Plan
from fem.structure import rigid_motion
from geometry.arrays import Array, frozen

BASE = 6
"""The first coordinates are those of the base."""

MainSystem = Any
"""An exudyn `MainSystem`; the library has no types of its own."""

SINGULAR = 1e-6
"""How far the linearised stiffness may answer to a rigid motion, relative to its largest entry."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Linearised:
    """Exudyn's linearised system of an article on a base that is free to move; the base has the first six coordinates.

    Attributes
    ----------
    mass, stiffness : (n, n) SI
    constraints : (n, c) columns of exudyn's constraint Jacobian: what rides on what
    rigid : (n, 6) what every coordinate does in the six unit motions of the base
    frequency : (m,) [Hz] by exudyn with the base held, ascending
    shapes : (n, m) mass-normalised, zero at the base
    nodes : exudyn's nodes for every node of the plan; empty where there is none
    """

    mass: Array
    stiffness: Array
    constraints: Array
    rigid: Array
    frequency: Array
    shapes: Array
    nodes: tuple[tuple[int, ...], ...] = ()

    def __post_init__(self) -> None:
        n, m = np.shape(self.shapes)
        shapes = {
            "mass": (n, n),
            "stiffness": (n, n),
            "constraints": (n, np.shape(self.constraints)[1]),
            "rigid": (n, 6),
            "frequency": (m,),
            "shapes": (n, m),
        }
        for name, shape in shapes.items():
            object.__setattr__(self, name, frozen(getattr(self, name), shape, name))

    @property
    def participation(self) -> Array:
        """L (6, m) of the modes about the origin [kg^0.5, kg^0.5 m]."""
        return np.asarray(self.rigid.T @ self.mass @ self.shapes)

    @property
    def rigid_mass(self) -> Array:
        """(6, 6) of the whole about the origin."""
        return np.asarray(self.rigid.T @ self.mass @ self.rigid)

    def compliance(self) -> Array:
        """Static answer (6, 6) [kg s² ...] to an accelerated base.

        It is P^T K^-1 P with P = M T: the sum of L L^T / omega² over all modes.
        """
        return np.asarray(self.answer(self.mass @ self.rigid, np.zeros((1, 1))), dtype=np.float64)

    def answer(self, loads: Array, lossy: Array) -> Any:
        """F^T (K + i S)^-1 F (m, m) for loads F (n, m) with the base held and the joints closed; real without `lossy` S."""
        n, c = self.constraints.shape
        K = self.stiffness + 1j * lossy if lossy.any() else self.stiffness
        saddle = np.block([[K, self.constraints], [self.constraints.T, np.zeros((c, c))]])
        X = np.linalg.solve(saddle[BASE:, BASE:], np.vstack([loads[BASE:], np.zeros((c, loads.shape[1]))]))
        return loads[BASE:].T @ X[: n - BASE]


def linearise(plan: Plan, count: int) -> Linearised:
    """Let exudyn linearise `plan` and find its lowest `count` modes.

    Raises
    ------
    CheckFailed : exudyn failed, a result is not finite, or a rigid motion meets stiffness.
    """
    task = "linearise the frame"
    with running(task) as exudyn:
        free = native.build(exudyn, plan, held=False)
        mass, stiffness, _damping, *rest = free.system.ComputeLinearizedSystem(returnConstraintJacobian=True)
    n = 6 * len(free.points)
    constraints = rest[0] if rest else np.zeros((n, 0))
    # A body without beams or springs has nothing that swings, and exudyn would be left without an equation.
    frequency, shapes = _eigen(plan, count) if plan.members or plan.ports else (np.zeros(0), np.zeros((n, 0)))
    result = Linearised(
        mass=finite(mass, task),
        stiffness=finite(stiffness, task),
        constraints=finite(constraints, task),
        rigid=rigid_motion(free.points),
        nodes=free.nodes,
        frequency=frequency,
        shapes=shapes,
    )
    _require_free(result, task)
    return result


def linearise_body(system: MainSystem, count: int, task: str) -> Linearised:
    """Let exudyn linearise a body without joints whose first six coordinates are its base, and find its lowest `count` modes.

    Raises
    ------
    CheckFailed : exudyn failed at `task`, or a result is not finite.
    """
    with running(task):
        mass, stiffness, _damping = system.ComputeLinearizedSystem()
        # Without a number of modes exudyn returns no shapes at all; with absolute values it makes a frequency of an instability.
        squares, shapes = system.ComputeODE2Eigenvalues(
            constrainedCoordinates=list(range(BASE)), numberOfEigenvalues=count, useAbsoluteValues=False
        )
    return Linearised(
        mass=finite(mass, task),
        stiffness=finite(stiffness, task),
        constraints=np.zeros((len(mass), 0)),
        rigid=np.eye(len(mass), BASE),
        frequency=_frequencies(squares, task),
        shapes=finite(shapes, task),
    )


def stiffness_of(plan: Plan) -> Array:
    """The (n, n) stiffness of `plan` by exudyn.

    Raises
    ------
    CheckFailed : exudyn failed, or the result is not finite.
    """
    task = "linearise the lossy frame"
    with running(task) as exudyn:
        return finite(native.build(exudyn, plan, held=False).system.ComputeLinearizedSystem()[1], task)


def _eigen(plan: Plan, count: int) -> tuple[Array, Array]:
    """Frequencies (m,) [Hz] and shapes (n, m) by exudyn, base held by a joint."""
    task = "solve for the eigenfrequencies"
    with running(task) as exudyn:
        held = native.build(exudyn, plan, held=True)
        squares, shapes = held.system.ComputeODE2Eigenvalues(numberOfEigenvalues=count, useAbsoluteValues=False)
    return _frequencies(squares, task), finite(shapes, task)


def _frequencies(squares: npt.ArrayLike, task: str) -> Array:
    """Frequencies [Hz] from exudyn's eigenvalues [(rad/s)²].

    Raises
    ------
    CheckFailed : one is NaN, zero or negative.
    """
    found = finite(squares, task)
    if found.size and found.min() <= 0:
        raise failed(task, f"the lowest squared frequency is {found.min():g} (rad/s)²; a part is not held or is unstable")
    return np.sqrt(found) / (2 * np.pi)


def _require_free(system: Linearised, task: str) -> None:
    for matrix, what in ((system.stiffness, "meets stiffness"), (system.constraints.T, "breaks a joint")):
        answer = np.abs(matrix @ system.rigid).max(initial=0.0) / np.abs(matrix).max(initial=1.0)
        if answer > SINGULAR:
            raise failed(task, f"a rigid motion of the base {what}, {answer:.1e} of the largest entry")
