"""A structure of ours in exudyn, as a part of a larger multibody system: a solid's full matrices, or reduced ones.

python examples/in_exudyn.py          a steel bar: its frequencies by us, and by exudyn from the same matrices
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from rich.console import Console
from rich.table import Table

from fem.damping import DEFAULT_RATIO
from fem.exudyn.linear import BASE, Linearised, MainSystem, extrapolated, frequencies
from fem.exudyn.run import ORDER_OF_SIX, ExudynInertia, finite, running
from fem.modes import Modes, fixed_base, static_shapes
from fem.solid.model import structure as solid_of
from fem.structure import Sparse, Structure, restricted
from geometry.article import Article, Box, Part, Shape, material, upright
from geometry.errors import BadInput
from geometry.frames import Array
from geometry.inertia import Inertia

# A solid as exudyn's flexible body: floating frame of reference, modes by Hurty, Craig and Bampton.
#
# Full sparse stiffness and mass go into exudyn's `FEMinterface`; the modes are found there with all held nodes as one rigid
# interface, which is the body's frame. `ObjectFFRFreducedOrder` then moves it through any motion however large, and exudyn's
# linearisation of that body on its frame gives frequencies and dynamic mass. The static answers to six accelerations of the base
# stand beside the modes as further ones (`fem.modes.static_shapes`).

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
    eigenvalues : (k,) [(rad/s)²] that exudyn found for the full matrices, ascending
    """

    container: Any
    system: Any
    node: int
    frame_coordinates: int
    modes: Array
    eigenvalues: Array


def by_points(structure: Structure, matrix: Sparse) -> Sparse:
    """A `matrix` (n, n) of a solid `structure`, ordered point by point as exudyn's flexible body has it."""
    order = structure.translations.ravel()
    return matrix.tocsr()[order][:, order]


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
    order, n = structure.translations.ravel(), structure.mass.shape[0]
    held, moving = np.isin(structure.translations, structure.held), np.unique(order).size
    wrong = ""
    if order.size != n or moving != n:
        wrong = f"{n} degrees of freedom, of which {moving} move points"
    elif np.any(held.any(axis=1) != held.all(axis=1)):
        wrong = "a point that is held in some directions only"
    if wrong or n > LARGEST:
        whole = "every degree of freedom must move a point along x, y or z, and held points must be held wholly"
        large = f"exudyn factorises full matrices up to {LARGEST} degrees of freedom here, found {n}"
        raise BadInput(
            "exudyn's flexible body",
            "translations" if wrong else "mass",
            f"{whole}; found {wrong}" if wrong else large,
            f"Use a {'solid model' if wrong else 'coarser mesh'}, or exudyn's native beams",
        )
    with running("make a flexible body of the solid") as exudyn:
        from exudyn import FEM

        tools: Any = FEM
        solid = tools.FEMinterface()
        solid.nodes = {"Position": structure.points - structure.reference_point}
        solid.massMatrix, solid.stiffnessMatrix = (by_points(structure, one) for one in (structure.mass, structure.stiffness))
        base = np.flatnonzero(held.all(axis=1)).tolist()
        solid.ComputeHurtyCraigBamptonModes([base], nEigenModes=count, computationMode=tools.HCBstaticModeSelection.RBE2)
        ascending = np.argsort(solid.eigenValues)
        modes = finite(solid.modeBasis["matrix"][:, ascending], "find the modes of the solid")
        free = np.flatnonzero(np.isin(order, structure.free))
        M, K = (restricted(matrix, free) for matrix in (solid.massMatrix, solid.stiffnessMatrix))
        static = static_shapes(K, M, (solid.massMatrix @ structure.rigid[order])[free], modes[free])
        beside = np.zeros((n, static.shape[1]))
        beside[free] = static
        solid.modeBasis["matrix"] = np.hstack([modes, beside])
        container = exudyn.SystemContainer()
        system, kinds = container.AddSystem(), exudyn.NodeType
        kind, velocities = kinds.RotationRxyz, {}
        if flight is not None:
            kind, velocities = kinds.RotationEulerParameters, {"initialVelocity": flight.velocity.tolist()}
            velocities["initialAngularVelocity"] = flight.angular_velocity.tolist()
        body = tools.ObjectFFRFreducedOrderInterface(solid, rigidBodyNodeType=kind)
        made = body.AddObjectFFRFreducedOrder(system, **velocities)
        system.Assemble()
    return FloatingFrame(
        container=container,
        system=system,
        node=int(made["nRigidBody"]),
        frame_coordinates=6 if flight is None else 7,
        modes=solid.modeBasis["matrix"],
        eigenvalues=solid.eigenValues[ascending],
    )


def modes_of_solid(structure: Structure, count: int = 30) -> Modes:
    """The lowest `count` fixed-base modes of a solid: exudyn solves its full K and M and linearises its flexible body.

    Raises
    ------
    BadInput : a structure that is no solid, no mode asked for.
    CheckFailed : exudyn failed.
    """
    if count < 1:
        problem = f"at least one mode is needed, found {count}"
        raise BadInput("modes", "count", problem, "Ask for 30")
    body = floating_frame(structure, count)
    system = linearise_body(body.system, count)
    losses = 2 * DEFAULT_RATIO * system.stiffness
    if structure.loss_factors and structure.part_stiffness:
        losses = np.zeros_like(system.stiffness)
        for part, eta in structure.loss_factors.items():
            K = by_points(structure, structure.part_stiffness[part])
            losses[BASE:, BASE:] += eta * (body.modes.T @ (K @ body.modes))
    return extrapolated(None, system, losses, structure.reference_point, count)


# Plumbing: our reduced matrices put into exudyn as they are.
#
# Six rigid motions of the base come first, fixed-base modes after them, as Craig and Bampton order them. Exudyn adds nothing but
# its own reading of them, so that agreement says that they arrived - not that they are right. It is how a reduced article gets
# into a larger multibody system.


def placed(stiffness: npt.ArrayLike, mass: npt.ArrayLike, damping: npt.ArrayLike | None = None) -> tuple[Any, MainSystem]:
    """Exudyn's container and assembled system with one `ObjectGenericODE2` of these (6 + n, 6 + n) matrices, the base free.

    Raises
    ------
    CheckFailed : exudyn refused them.
    """
    K, M = np.asarray(stiffness, dtype=np.float64), np.asarray(mass, dtype=np.float64)
    C = np.zeros_like(K) if damping is None else np.asarray(damping, dtype=np.float64)
    with running("take reduced matrices") as exudyn:
        from exudyn import itemInterface

        items: Any = itemInterface
        container = exudyn.SystemContainer()
        system = container.AddSystem()
        rest = {name: [0.0] * len(M) for name in ("referenceCoordinates", "initialCoordinates", "initialCoordinates_t")}
        node = system.AddNode(items.NodeGenericODE2(numberOfODE2Coordinates=len(M), **rest))
        item = items.ObjectGenericODE2(nodeNumbers=[node], massMatrix=M, stiffnessMatrix=K, dampingMatrix=C)
        system.AddObject(item)
        system.Assemble()
    return container, system


def from_exudyn(body: ExudynInertia, reference_point: npt.ArrayLike = (0.0, 0.0, 0.0)) -> Inertia:
    """A `RigidBodyInertia` as `Inertia`; its reference point lies at `reference_point` (3,) [m] of the body's frame."""
    six = np.asarray(body.GetInertia6D(), dtype=np.float64)[ORDER_OF_SIX]
    parameters = np.concatenate([[body.Mass()], body.Mass() * np.asarray(body.COM()), six])
    return Inertia(parameters=parameters, reference_point=np.asarray(reference_point, dtype=np.float64))


def linearise_body(system: MainSystem, count: int) -> Linearised:
    """Let exudyn linearise a `system` without joints whose first six coordinates are its base, and find its lowest `count` modes.

    Raises
    ------
    CheckFailed : exudyn failed, a result is not finite, or a mode has no stiffness.
    """
    task = "linearise the flexible body"
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
        frequency=frequencies(squares, task),
        shapes=finite(shapes, task),
    )


def linearised(stiffness: npt.ArrayLike, mass: npt.ArrayLike) -> Linearised:
    """What exudyn makes of reduced matrices (6 + n, 6 + n): its linearised system, and all modes with the base held.

    Raises
    ------
    CheckFailed : exudyn refused them, or they hold a mode without stiffness.
    """
    _container, system = placed(stiffness, mass)
    return linearise_body(system, len(np.asarray(mass)) - BASE)


def main(console: Console) -> None:
    """Print the frequencies of a steel bar of 20 x 5 x 200 mm on its narrow end."""
    shape = Shape(solids=(upright(Box(size=np.array([0.02, 0.005, 0.2])), bottom=0.0),))
    bar = solid_of(Article(name="bar", parts=(Part(name="bar", material=material("steel"), shape=shape),)), size=0.01)
    shown = Table("mode", "ours [Hz]", "exudyn's [Hz]")
    for k, pair in enumerate(zip(fixed_base(bar, 5).frequency, modes_of_solid(bar, 5).frequency, strict=True), start=1):
        shown.add_row(str(k), *(f"{f:.6g}" for f in pair))
    console.print(shown)


if __name__ == "__main__":
    main(Console())
