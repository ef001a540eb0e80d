"""Table, cover plate and article as exudyn has them.

Each has a node of six coordinates: displacement, and angles about x, y, z as `NodeRigidBodyRxyz` counts them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from fem.base_excitation.rig import Body
from fem.flexible_body.driven_base.scene import Number, Scene, node
from fem.flexible_body.inertia import to_exudyn
from geometry.arrays import Array
from geometry.inertia import Inertia

BASE = 6
"""Coordinates of a rigid node."""


@dataclass(frozen=True, kw_only=True)
class Rigid:
    """A rigid body: exudyn's number of its object, and of its node."""

    body: Number
    node: Number


@dataclass(frozen=True, kw_only=True)
class Reduced:
    """The article: exudyn's number of its object, of the node of its base, and of the node of its other coordinates, if any."""

    body: Number
    node: Number
    modes: Number | None

    @property
    def nodes(self) -> tuple[Number, ...]:
        """All its nodes, in the order of the reduced coordinates."""
        return (self.node,) if self.modes is None else (self.node, self.modes)


def massless(scene: Scene) -> Rigid:
    """A table: no mass, so that what moves it is the load of what stands on it and nothing else."""
    return _rigid(scene, "table", mass=0.0, centerOfMass=[0.0] * 3, inertia=[0.0] * 6)


def rigid(scene: Scene, inertia: Inertia, name: str) -> Rigid:
    """A body with `inertia` about the origin.

    Raises
    ------
    BadInput : no body has this inertia.
    """
    six = to_exudyn(inertia.about(np.zeros(3)), name)
    return _rigid(scene, name, mass=six.Mass(), centerOfMass=list(six.COM()), inertia=list(six.GetInertia6D()))


def reduced(scene: Scene, article: Body, seat: Array) -> Reduced:
    """The article's matrices as they are, its origin at `seat` (3,) [m]."""
    matrices, size = article.reduced, article.reduced.mass.shape[0]
    base = _base(scene, seat, "base of the article")
    modes = _generic(scene, size - BASE) if size > BASE else None
    item = scene.items.ObjectGenericODE2(
        nodeNumbers=[base] if modes is None else [base, modes],
        massMatrix=np.array(matrices.mass),
        stiffnessMatrix=np.array(matrices.stiffness),
        dampingMatrix=np.array(matrices.viscous),
    )
    return Reduced(body=int(scene.system.AddObject(item)), node=base, modes=modes)


def _rigid(scene: Scene, name: str, **inertia: Any) -> Rigid:
    base = _base(scene, np.zeros(3), name)
    body = scene.system.AddObject(scene.items.ObjectRigidBody(nodeNumber=base, **inertia))
    return Rigid(body=int(body), node=base)


def _base(scene: Scene, position: Array, name: str) -> Number:
    places = [*position.tolist(), 0.0, 0.0, 0.0]
    return node(scene, name, scene.items.NodeRigidBodyRxyz(referenceCoordinates=places))


def _generic(scene: Scene, size: int) -> Number:
    rest = {name: [0.0] * size for name in ("referenceCoordinates", "initialCoordinates", "initialCoordinates_t")}
    return node(scene, "article", scene.items.NodeGenericODE2(numberOfODE2Coordinates=size, **rest))
