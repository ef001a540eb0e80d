"""Drawings turned into OCC solids by CadQuery: material united, voids cut. In millimetres."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from geometry.article import Part
from geometry.frames import Pose
from geometry.shapes import Box, Placed, Primitive

MM = 1e-3
"""One OCC length unit in metres."""

OccShape = Any
"""A `cadquery.Shape`; the library has no types of its own."""


def solid(part: Part) -> OccShape:
    """The part as a CadQuery compound [mm], in the article's frame, its voids cut out."""
    return _cut(_compound(part.shape.solids), part.shape.voids).moved(location(part.pose))


def _cut(material: OccShape, voids: Iterable[Placed]) -> OccShape:
    tools = [_placed(void) for void in voids]
    return material.cut(*tools) if tools else material


def _compound(solids: Iterable[Placed]) -> OccShape:
    from cadquery import Compound

    return Compound.makeCompound([_placed(placed) for placed in solids])


def _placed(placed: Placed) -> OccShape:
    return _primitive(placed.primitive).moved(location(placed.pose))


def _primitive(primitive: Primitive) -> OccShape:
    """The primitive centred on its own origin."""
    from cadquery import Solid, Vector

    if isinstance(primitive, Box):
        x, y, z = primitive.size / MM
        return Solid.makeBox(x, y, z, Vector(-x / 2, -y / 2, -z / 2))
    height = primitive.height / MM
    return Solid.makeCylinder(primitive.diameter / 2 / MM, height, Vector(0, 0, -height / 2))


def location(pose: Pose) -> Any:
    """`pose` as a CadQuery location, its translation in millimetres."""
    from cadquery import Location
    from OCP.gp import gp_Trsf

    transformation = gp_Trsf()
    transformation.SetValues(*np.column_stack([pose.rotation, pose.position / MM]).ravel().tolist())
    return Location(transformation)
