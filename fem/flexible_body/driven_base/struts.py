"""Cables to the ground and local dampers: a spring and a damper from a place of the article to the ground or to the table."""

from __future__ import annotations

import numpy as np

from fem.base_excitation.rig import Body, Strut
from fem.flexible_body.driven_base.bodies import BASE, Reduced, Rigid
from fem.flexible_body.driven_base.scene import Number, Scene, node, place
from geometry.arrays import Array


def attach(scene: Scene, strut: Strut, article: Body, stands: Reduced, seat: Array, table: Rigid) -> None:
    """Put `strut` between its place of `article`, which `stands` at `seat` (3,) [m], and the ground or the table beneath."""
    shape = article.places[strut.place]
    position = seat + position_of(shape)
    other = place(scene, scene.ground if strut.to == "ground" else table.body, position)
    connector = scene.items.ObjectConnectorCartesianSpringDamper
    ends = [_follower(scene, strut.place, stands, shape, seat, position), other]
    scene.system.AddObject(connector(markerNumbers=ends, stiffness=strut.stiffness.tolist(), damping=strut.damping.tolist()))


def position_of(shape: Array) -> Array:
    """(3,) [m] of a place from the article's origin: what its coordinates say of a turn of the base, -skew(p), read backwards."""
    turn = shape[:, 3:BASE]
    return np.array([turn[1, 2] - turn[2, 1], turn[2, 0] - turn[0, 2], turn[0, 1] - turn[1, 0]]) / 2


def _follower(scene: Scene, name: str, stands: Reduced, shape: Array, seat: Array, position: Array) -> Number:
    """A marker on a point without mass that one linear constraint ties to all coordinates of the article."""
    items, system = scene.items, scene.system
    point = node(scene, f"place {name}", items.NodePoint(referenceCoordinates=position.tolist()))
    system.AddObject(items.ObjectMassPoint(mass=0.0, nodeNumber=point))
    ends = [
        system.AddMarker(items.MarkerNodeCoordinates(nodeNumber=point)),
        system.AddMarker(items.MarkerObjectODE2Coordinates(objectNumber=stands.body)),
    ]
    apart = shape[:, :3] @ seat - position  # these markers count the places at rest in
    tie = items.ObjectConnectorCoordinateVector
    system.AddObject(tie(markerNumbers=ends, scalingMarker0=np.eye(3), scalingMarker1=np.array(shape), offset=apart))
    return int(system.AddMarker(items.MarkerNodePosition(nodeNumber=point)))
