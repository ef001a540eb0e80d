"""`Scene`: an exudyn system while it is put together, and the few things that every part of a rig does to it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from geometry.arrays import Array

Number = int
"""Exudyn's number of a node, marker, object or sensor."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Scene:
    """An exudyn system that grows.

    Attributes
    ----------
    exudyn : the module
    items : its `itemInterface`, where every part of a model is described
    container : owns `system`, which dies with it
    system : exudyn's `MainSystem`
    ground : number of the ground object
    origin : number of a ground node, against which coordinates are measured
    names : what the nodes are, by number; exudyn's own names must differ, and there may be two of a kind
    alive : what exudyn refers to and would not keep alive by itself
    before_step : what brings the state of a part up to date before every step
    """

    exudyn: Any
    items: Any
    container: Any
    system: Any
    ground: Number
    origin: Number
    names: dict[Number, str] = field(default_factory=dict)
    alive: list[Any] = field(default_factory=list)
    before_step: list[Callable[[Any], None]] = field(default_factory=list)


def empty(exudyn: Any) -> Scene:
    """A system with nothing but ground."""
    from exudyn import itemInterface

    items: Any = itemInterface
    container = exudyn.SystemContainer()
    system = container.AddSystem()
    ground = system.AddObject(items.ObjectGround())
    origin = system.AddNode(items.NodePointGround())
    return Scene(exudyn=exudyn, items=items, container=container, system=system, ground=int(ground), origin=int(origin))


def node(scene: Scene, name: str, item: Any) -> Number:
    """Add the node `item`, which is called `name` when something goes wrong with it."""
    number = int(scene.system.AddNode(item))
    scene.names[number] = name
    return number


def coordinate(scene: Scene, of: Number, number: int) -> Number:
    """A marker on one coordinate of the node `of`."""
    return int(scene.system.AddMarker(scene.items.MarkerNodeCoordinate(nodeNumber=of, coordinate=number)))


def place(scene: Scene, body: Number, position: Array) -> Number:
    """A marker at `position` (3,) [m] of a rigid body or of the ground."""
    return int(scene.system.AddMarker(scene.items.MarkerBodyPosition(bodyNumber=body, localPosition=position.tolist())))


def watch_object(scene: Scene, number: Number, output: str) -> Number:
    """A sensor that records what exudyn calls `output` of an object."""
    return _watch(scene, scene.items.SensorObject, output, objectNumber=number)


def watch_node(scene: Scene, number: Number, output: str) -> Number:
    """A sensor that records what exudyn calls `output` of a node."""
    return _watch(scene, scene.items.SensorNode, output, nodeNumber=number)


def recorded(scene: Scene, sensors: tuple[Number, ...]) -> Array:
    """(n, k) what `sensors` recorded, side by side, without the time."""
    return np.hstack([np.asarray(scene.system.GetSensorStoredData(sensor))[:, 1:] for sensor in sensors])


def _watch(scene: Scene, kind: Any, output: str, **what: Number) -> Number:
    variable = getattr(scene.exudyn.OutputVariableType, output)
    return int(scene.system.AddSensor(kind(outputVariableType=variable, storeInternal=True, **what)))
