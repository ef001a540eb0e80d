"""A flexible body set free in exudyn, and what must not change while it flies: momentum, angular momentum and energy.

Exudyn integrates its floating-frame equations. The check does not ask it for energies: it takes place, rotation and modes at the
end, works out the velocity of every point of the solid and weighs it with the solid's own full matrices.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem.flexible_body.floating_frame import FloatingFrame
from fem.flexible_body.running import failed, finite, running
from fem.structure import Structure
from geometry.arrays import Array

DISSIPATION = 1.0
"""Spectral radius of exudyn's generalised-alpha method: 1 takes no energy out."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Flight:
    """A free flexible body at one instant, in the fixed frame.

    Attributes
    ----------
    energy : kinetic and elastic [J]
    momentum : (3,) [kg m/s]
    angular_momentum : (3,) [kg m²/s] about the fixed frame's origin
    turned : (3,) [rad] the angles by which the body's frame has turned about x, y, z in this order
    deflection : [m] largest distance of a point from its place in the body's frame
    """

    energy: float
    momentum: Array
    angular_momentum: Array
    turned: Array
    deflection: float


def now(structure: Structure, body: FloatingFrame) -> Flight:
    """Where `body`, made of `structure`, is in exudyn's present state."""
    with running("tell the state of the flexible body") as exudyn:
        kinds = exudyn.OutputVariableType
        output = [kinds.Position, kinds.Velocity, kinds.RotationMatrix, kinds.AngularVelocity]
        place, velocity, rotation, spin = (np.array(body.system.GetNodeOutput(body.node, kind)) for kind in output)
        q, rate = (finite(read(), "integrate") for read in _readers(body))
    A, order = rotation.reshape(3, 3), structure.translations.ravel()
    shape, shape_rate = ((body.modes @ x[6:]).reshape(-1, 3) for x in (q, rate))
    arms = (structure.points - structure.reference_point + shape) @ A.T
    speeds = velocity + np.cross(spin, arms) + shape_rate @ A.T
    # The mass of a solid is the same in every direction, so it weighs velocities in any axes.
    weighted = (structure.mass.tocsr()[order][:, order] @ speeds.ravel()).reshape(-1, 3)
    elastic = body.modes @ q[6:]
    stored = elastic @ (structure.stiffness.tocsr()[order][:, order] @ elastic)
    return Flight(
        energy=float(np.sum(speeds * weighted) + stored) / 2,
        momentum=weighted.sum(axis=0),
        angular_momentum=np.cross(place + arms, weighted).sum(axis=0),
        turned=q[3:6],
        deflection=float(np.linalg.norm(shape, axis=1).max()),
    )


def fly(structure: Structure, body: FloatingFrame, duration: float, steps: int) -> Flight:
    """`body` after `duration` [s] of free flight in `steps` steps of exudyn.

    Raises
    ------
    CheckFailed : the integration failed or its result is not finite.
    """
    task = "integrate the free flexible body"
    with running(task) as exudyn:
        settings = exudyn.SimulationSettings()
        settings.solution.file.write = False
        settings.timeIntegration.numberOfSteps, settings.timeIntegration.endTime = steps, duration
        settings.timeIntegration.generalizedAlpha.spectralRadius = DISSIPATION
        if not body.system.SolveDynamic(settings):
            raise failed(task, "the solver gave up")
    return now(structure, body)


def _readers(body: FloatingFrame) -> tuple[object, object]:
    return body.system.systemData.GetODE2Coordinates, body.system.systemData.GetODE2Coordinates_t
