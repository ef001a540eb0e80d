"""The table under an exudyn model: a body without mass whose six coordinates are prescribed, joined to the model's foot.

The joint's own sensors are the load cells: exudyn gives force and torque in the axes of the joint's first marker, which are the
table's, about the joint, which is the reference point.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from fem.flexible_body.driven_base import bodies, drive
from fem.flexible_body.driven_base.scene import Number, Scene, recorded, watch_node, watch_object
from fem.flexible_body.native import Native
from geometry.arrays import Array

SIGNS = np.array([-1.0, -1.0, -1.0, -1.0, 1.0, 1.0])
"""From what exudyn's joint reports to the load of the table on the foot.

Forces are those on the first marker, the table. Torques are the multipliers of the constraints z0 . y1 = 0, z0 . x1 = 0 and
x0 . y1 = 0 between the axes of both markers (exudyn's documentation of ObjectJointGeneric): a small turn of the second about x
raises the first, turns about y and z lower the other two, so that these alone change sign.
"""

LEVEL = ("Acceleration", "AngularAcceleration")


@dataclass(frozen=True, eq=False, kw_only=True)
class Table:
    """A driven table with its sensors.

    Attributes
    ----------
    axes : the constraints that drive it
    accelerations, loads : sensors of the table's node, in the laboratory's axes, and of the joint, in the table's
    places : sensors of accelerations by name, in the laboratory's axes
    """

    axes: tuple[Number, ...]
    accelerations: tuple[Number, ...]
    loads: tuple[Number, ...]
    places: Mapping[str, Number]


def scene_of(exudyn: Any, native: Native) -> Scene:
    """The system of `native`, open for more items."""
    from exudyn import itemInterface

    items: Any = itemInterface
    ground = native.system.AddObject(items.ObjectGround())
    origin = native.system.AddNode(items.NodePointGround())
    return Scene(exudyn=exudyn, items=items, container=native.container, system=native.system, ground=ground, origin=origin)


def under(scene: Scene, native: Native, places: Mapping[str, Array], *, velocity: bool) -> Table:
    """A table in the origin, joined to the foot of `native` there; places (3,) [m] ride on the node that is nearest to them."""
    table = bodies.massless(scene)
    axes = drive.driven(scene, table, velocity=velocity)
    foot = native.nodes[0][0]
    ends = [_marker(scene, table.body, np.zeros(3)), _marker(scene, _massless(scene, foot), -native.points[foot])]
    joint = int(scene.system.AddObject(scene.items.ObjectJointGeneric(markerNumbers=ends)))
    return Table(
        axes=axes,
        accelerations=tuple(watch_node(scene, table.node, output) for output in LEVEL),
        loads=tuple(watch_object(scene, joint, output) for output in ("ForceLocal", "TorqueLocal")),
        places={name: _watch_place(scene, native, place) for name, place in places.items()},
    )


def accelerations(scene: Scene, table: Table) -> Array:
    """(n, 6) of the table's origin [m/s²] and its angular acceleration [rad/s²], in the laboratory's axes."""
    return recorded(scene, table.accelerations)


def loads(scene: Scene, table: Table) -> Array:
    """(n, 6) force [N] and moment [N m] about the origin of the table on its load, in the table's axes."""
    return np.asarray(recorded(scene, table.loads) * SIGNS)


def _watch_place(scene: Scene, native: Native, place: Array) -> Number:
    node = int(np.argmin(np.linalg.norm(native.points - place, axis=1)))
    sensor = scene.items.SensorBody(
        bodyNumber=_massless(scene, node),
        localPosition=(place - native.points[node]).tolist(),
        outputVariableType=scene.exudyn.OutputVariableType.Acceleration,
        storeInternal=True,
    )
    return int(scene.system.AddSensor(sensor))


def _massless(scene: Scene, node: Number) -> Number:
    """A body that marks places around `node`."""
    return int(scene.system.AddObject(scene.items.ObjectRigidBody(mass=0.0, inertia=[0.0] * 6, nodeNumber=node)))


def _marker(scene: Scene, body: Number, place: Array) -> Number:
    return int(scene.system.AddMarker(scene.items.MarkerBodyRigid(bodyNumber=body, localPosition=place.tolist())))
