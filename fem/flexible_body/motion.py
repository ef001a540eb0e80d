"""A flexible body set free in exudyn, and what must not change while it flies: momentum, angular momentum and energy.

Exudyn integrates its floating-frame equations. The check does not ask it for energies: it takes place, rotation and modes at the
end, works out the velocity of every point of the solid and weighs it with the solid's own full matrices.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from fem.flexible_body.floating_frame import FloatingFrame
from fem.flexible_body.interruption import integrated
from fem.flexible_body.running import failed, finite, running
from fem.structure import Structure
from geometry.arrays import Array

DISSIPATION = 1.0
"""Spectral radius of exudyn's generalised-alpha method: 1 takes no energy out."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Instant:
    """A free flexible body at one instant, in the fixed frame.

    Attributes
    ----------
    energy : kinetic and elastic [J]
    momentum : (3,) [kg m/s]
    angular_momentum : (3,) [kg m²/s] about the fixed frame's origin
    rotation : (3, 3) of the body's frame
    deflection : [m] largest distance of a point from its place in the body's frame
    """

    energy: float
    momentum: Array
    angular_momentum: Array
    rotation: Array
    deflection: float


def now(structure: Structure, body: FloatingFrame) -> Instant:
    """Where `body`, made of `structure`, is in exudyn's present state."""
    with running("tell the state of the flexible body") as exudyn:
        kinds = exudyn.OutputVariableType
        output = [kinds.Position, kinds.Velocity, kinds.RotationMatrix, kinds.AngularVelocity]
        place, velocity, rotation, spin = (np.array(body.system.GetNodeOutput(body.node, kind)) for kind in output)
        q, rate = (finite(values, "integrate") for values in _coordinates(body))
    A, order = rotation.reshape(3, 3), structure.translations.ravel()
    amplitude, amplitude_rate = (x[body.frame_coordinates :] for x in (q, rate))
    shape, shape_rate = ((body.modes @ x).reshape(-1, 3) for x in (amplitude, amplitude_rate))
    arms = (structure.points - structure.reference_point + shape) @ A.T
    speeds = velocity + np.cross(spin, arms) + shape_rate @ A.T
    # The mass of a solid is the same in every direction, so it weighs velocities in any axes.
    weighted = (structure.mass.tocsr()[order][:, order] @ speeds.ravel()).reshape(-1, 3)
    stored = shape.ravel() @ (structure.stiffness.tocsr()[order][:, order] @ shape.ravel())
    return Instant(
        energy=float(np.sum(speeds * weighted) + stored) / 2,
        momentum=weighted.sum(axis=0),
        angular_momentum=np.cross(place + arms, weighted).sum(axis=0),
        rotation=A,
        deflection=float(np.linalg.norm(shape, axis=1).max()),
    )


def fly(structure: Structure, body: FloatingFrame, duration: float, steps: int) -> Instant:
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
        if not integrated(body.system, settings):
            raise failed(task, "the solver gave up")
    return now(structure, body)


def _coordinates(body: FloatingFrame) -> tuple[Any, Any]:
    data = body.system.systemData
    return data.GetODE2Coordinates(), data.GetODE2Coordinates_t()
