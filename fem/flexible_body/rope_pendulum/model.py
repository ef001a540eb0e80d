"""The rope pendulum made of exudyn's items.

The body is a rigid body on Euler parameters, so that it may turn as far as it likes; joints of ropes are mass points; a link
that does not stretch is a distance constraint, one that does a spring. Viscous damping about the vertical is a torsional damper
between ceiling and body. Exudyn makes the equations of motion of these; `statics` only says where everything is when it starts.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from fem.flexible_body.inertia import to_exudyn
from fem.flexible_body.rope_pendulum.statics import Pose, Ropework
from geometry.arrays import Array

Number = Any
"""Exudyn's number of a node, marker, object or sensor."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Model:
    """A rope pendulum in exudyn.

    Attributes
    ----------
    container : owns `system`, which dies with it
    system : exudyn's `MainSystem`, assembled
    place, rotation : sensors of the body's CoG and rotation matrix
    joints : sensors of the places of the ropes' joints, rope by rope
    lowest : sensors of the force in the lowest link of every rope
    """

    container: Any
    system: Any
    place: Number
    rotation: Number
    joints: tuple[Number, ...]
    lowest: tuple[Number, ...]


def build(exudyn: Any, work: Ropework, pose: Pose, velocity: Array, torsional: float, stretching: float) -> Model:
    """`work` in exudyn, starting at `pose` with `velocity` (k,) of the coordinates of `statics`.

    `torsional` [N m s/rad] damps the twist, `stretching` [N s/m] every link that stretches.
    """
    return _Builder(exudyn, work).build(pose, velocity, torsional, stretching)


class _Builder:
    def __init__(self, exudyn: Any, work: Ropework) -> None:
        from exudyn import itemInterface

        self.exudyn, self.work = exudyn, work
        self.items: Any = itemInterface
        self.container = exudyn.SystemContainer()
        self.system = self.container.AddSystem()

    def build(self, pose: Pose, velocity: Array, torsional: float, stretching: float) -> Model:
        ceiling = self.system.AddObject(self.items.ObjectGround())
        body = self._body(pose, velocity[:6])
        joints = self._joints(pose, velocity[6:].reshape(pose.joints.shape))
        lowest = [self._rope(i, ceiling, joints[i], body, stretching) for i in range(self.work.ropes)]
        if torsional:
            ends = [self._marker("MarkerBodyRigid", bodyNumber=one) for one in (ceiling, body)]
            self.system.AddObject(self.items.ObjectConnectorTorsionalSpringDamper(markerNumbers=ends, damping=torsional))
        kinds = self.exudyn.OutputVariableType
        model = Model(
            container=self.container,
            system=self.system,
            place=self._sensor("SensorBody", kinds.Position, bodyNumber=body),
            rotation=self._sensor("SensorBody", kinds.RotationMatrix, bodyNumber=body),
            joints=tuple(self._sensor("SensorNode", kinds.Position, nodeNumber=n) for rope in joints for n in rope),
            lowest=tuple(self._sensor("SensorObject", kinds.Force, objectNumber=link) for link in lowest),
        )
        self.system.Assemble()
        return model

    def _body(self, pose: Pose, velocity: Array) -> Number:
        from exudyn import rigidBodyUtilities

        rotations: Any = rigidBodyUtilities
        parameters = np.array(rotations.RotationMatrix2EulerParameters(pose.rotation))
        rates = rotations.AngularVelocity2EulerParameters_t(pose.rotation.T @ velocity[3:], parameters)
        node = self.system.AddNode(
            self.items.NodeRigidBodyEP(
                referenceCoordinates=[*pose.place, *parameters], initialVelocities=[*velocity[:3], *np.ravel(rates)]
            )
        )
        made = to_exudyn(self.work.body)
        item = self.items.ObjectRigidBody(mass=made.Mass(), inertia=made.GetInertia6D(), nodeNumber=node)
        body = self.system.AddObject(item)
        self._weighs(self._marker("MarkerBodyMass", bodyNumber=body))
        return body

    def _joints(self, pose: Pose, velocity: Array) -> list[list[Number]]:
        """Nodes of the mass points of every rope, from the ceiling down."""
        return [
            [self._point(place, speed) for place, speed in zip(places, speeds, strict=True)]
            for places, speeds in zip(pose.joints, velocity, strict=True)
        ]

    def _point(self, place: Array, speed: Array) -> Number:
        node = self.system.AddNode(self.items.NodePoint(referenceCoordinates=place.tolist(), initialVelocities=speed.tolist()))
        point = self.system.AddObject(self.items.ObjectMassPoint(mass=self.work.point_mass, nodeNumber=node))
        self._weighs(self._marker("MarkerBodyMass", bodyNumber=point))
        return node

    def _weighs(self, marker: Number) -> None:
        down = [0.0, 0.0, -self.work.gravity]
        self.system.AddLoad(self.items.LoadMassProportional(markerNumber=marker, loadVector=down))

    def _rope(self, i: int, ceiling: Number, joints: list[Number], body: Number, stretching: float) -> Number:
        """The links of rope `i`; the lowest is returned."""
        top = self._marker("MarkerBodyPosition", bodyNumber=ceiling, localPosition=self.work.anchors[i].tolist())
        foot = self._marker("MarkerBodyPosition", bodyNumber=body, localPosition=self.work.feet[i].tolist())
        ends = [top, *(self._marker("MarkerNodePosition", nodeNumber=node) for node in joints), foot]
        return [self._link(i, [a, b], stretching) for a, b in pairwise(ends)][-1]

    def _link(self, i: int, ends: list[Number], stretching: float) -> Number:
        length, compliance = float(self.work.link_lengths[i]), float(self.work.compliance[i])
        if not compliance:
            return self.system.AddObject(self.items.ObjectConnectorDistance(markerNumbers=ends, distance=length))
        spring = {"referenceLength": length, "stiffness": 1 / compliance, "damping": stretching}
        return self.system.AddObject(self.items.ObjectConnectorSpringDamper(markerNumbers=ends, **spring))

    def _marker(self, kind: str, **what: Any) -> Number:
        return self.system.AddMarker(getattr(self.items, kind)(**what))

    def _sensor(self, kind: str, output: Any, **what: Any) -> Number:
        keep = {"storeInternal": True, "writeToFile": False}
        return self.system.AddSensor(getattr(self.items, kind)(outputVariableType=output, **keep, **what))
