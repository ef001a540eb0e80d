"""A solid as exudyn's flexible body: floating frame of reference, modes by Hurty, Craig and Bampton.

Full sparse stiffness and mass go into exudyn's `FEMinterface`; the modes are found there with all held nodes as one rigid
interface, which is the body's frame. `ObjectFFRFreducedOrder` then moves it through any motion however large, and exudyn's
linearisation of that body on its frame gives frequencies and dynamic mass. The few modes kept would leave the static share of the
others out; the static answers to six accelerations of the base are therefore put beside them as modes (attachment modes of Craig
and Chang; mode acceleration), so that the reduced body answers as the full one does up to the square of the frequency.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from fem.exudyn.run import failed, finite, integrated, running
from fem.reduction import static_shapes
from fem.structure import Structure, restricted
from geometry.errors import BadInput
from geometry.frames import Array, Integers

LARGEST = 100_000
"""Degrees of freedom beyond which exudyn's factorisations, three by SuperLU, take hours and the memory of a large machine."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Flight:
    """How a free body sets off: `velocity` (3,) [m/s] of its frame and `angular_velocity` (3,) [rad/s], undeformed."""

    velocity: Array
    angular_velocity: Array


@dataclass(frozen=True, eq=False, kw_only=True)
class FloatingFrame:
    """A flexible body in exudyn.

    Attributes
    ----------
    container : owns `system`, which dies with it
    system : exudyn's `MainSystem`, assembled: the body alone, free
    node : number of its frame's node; its coordinates come first, then those of the modes
    frame_coordinates : six with angles, which are good for small motions; seven with Euler parameters, which turn anywhere
    modes : (3 p, m) what the modes do to the points, x, y, z of one after the other
    eigenvalues : (k,) [(rad/s)²] that exudyn found for the full matrices
    """

    container: Any
    system: Any
    node: int
    frame_coordinates: int
    modes: Array
    eigenvalues: Array


def floating_frame(structure: Structure, count: int, *, flight: Flight | None = None) -> FloatingFrame:
    """`structure` as exudyn's flexible body with `count` modes of its held base and the static answers of the others.

    Its frame is the base, at the structure's reference point. Without a `flight` it is at rest and ready to be linearised: angles
    about x, y, z, that about y short of a right angle. With one it sets off, turns by Euler parameters and as far as it likes.

    Raises
    ------
    BadInput : a structure with rotations, with a base that does not hold whole nodes (exudyn's body is made of solids), or with
        more than `LARGEST` degrees of freedom.
    CheckFailed : exudyn failed.
    """
    held = _held_nodes(structure)
    _require_small(structure)
    with running("make a flexible body of the solid") as exudyn:
        from exudyn import FEM

        tools: Any = FEM

        # Exudyn's `FEMinterface` with the structure's points and matrices, ordered point by point, from the reference point
        order = structure.translations.ravel()
        solid = tools.FEMinterface()
        solid.nodes = {"Position": structure.points - structure.reference_point}
        solid.massMatrix, solid.stiffnessMatrix = (
            matrix.tocsr()[order][:, order] for matrix in (structure.mass, structure.stiffness)
        )
        solid.ComputeHurtyCraigBamptonModes([held.tolist()], nEigenModes=count, computationMode=tools.HCBstaticModeSelection.RBE2)
        ascending = np.argsort(solid.eigenValues)
        modes = finite(solid.modeBasis["matrix"][:, ascending], "find the modes of the solid")
        modes = _with_static(structure, solid, modes)
        solid.modeBasis["matrix"] = modes
        container = exudyn.SystemContainer()
        system = container.AddSystem()
        nodes = exudyn.NodeType
        kind = nodes.RotationRxyz if flight is None else nodes.RotationEulerParameters
        if flight is None:
            velocities = {}
        else:
            velocities = {"initialVelocity": flight.velocity.tolist(), "initialAngularVelocity": flight.angular_velocity.tolist()}
        body = tools.ObjectFFRFreducedOrderInterface(solid, rigidBodyNodeType=kind)
        made = body.AddObjectFFRFreducedOrder(system, **velocities)
        system.Assemble()
    return FloatingFrame(
        container=container,
        system=system,
        node=int(made["nRigidBody"]),
        frame_coordinates=6 if flight is None else 7,
        modes=modes,
        eigenvalues=solid.eigenValues[ascending],
    )


def _with_static(structure: Structure, solid: Any, modes: Array) -> Array:
    """`modes` and beside them what the free part does statically when the base is accelerated, mass-orthogonal to them."""
    order = structure.translations.ravel()
    free = np.flatnonzero(np.isin(order, structure.free))
    M, K = (restricted(matrix, free) for matrix in (solid.massMatrix, solid.stiffnessMatrix))
    load = (solid.massMatrix @ structure.rigid[order])[free]
    added = static_shapes(K, M, load, modes[free])
    beside = np.zeros((len(order), added.shape[1]))
    beside[free] = added
    return np.hstack([modes, beside])


def _held_nodes(structure: Structure) -> Integers:
    """Points that the base holds.

    Raises
    ------
    BadInput : degrees of freedom that are no translation of a point, or a point held in some directions only.
    """
    n = structure.mass.shape[0]
    if structure.translations.size != n or np.unique(structure.translations).size != n:
        raise _no_solid(f"{n} degrees of freedom, of which {np.unique(structure.translations).size} move points")
    held = np.isin(structure.translations, structure.held)
    if np.any(held.any(axis=1) != held.all(axis=1)):
        raise _no_solid("a point that is held in some directions only")
    return np.flatnonzero(held.all(axis=1))


def _require_small(structure: Structure) -> None:
    n = structure.mass.shape[0]
    if n > LARGEST:
        raise BadInput(
            source="exudyn's flexible body",
            field="mass",
            problem=f"exudyn factorises full matrices up to {LARGEST} degrees of freedom here, found {n}",
            remedy="Use a coarser mesh, or exudyn's native beams",
        )


def _no_solid(found: str) -> BadInput:
    return BadInput(
        source="exudyn's flexible body",
        field="translations",
        problem=f"every degree of freedom must move a point along x, y or z, and held points must be held wholly; found {found}",
        remedy="Use a solid model, or exudyn's native beams",
    )


# A flexible body set free in exudyn, and what must not change while it flies: momentum, angular momentum and energy.
#
# Exudyn integrates its floating-frame equations. The check does not ask it for energies: it takes place, rotation and modes at
# the end, works out the velocity of every point of the solid and weighs it with the solid's own full matrices.


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
