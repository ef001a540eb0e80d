"""Shapes as data: boxes and cylinders that add material, boxes and cylinders that take it away.

A `Shape` is what a drawing says and nothing more. Two readers that share no arithmetic turn it into inertia: `geometry.cad` lets
OCC cut the solids and integrates the B-rep; `geometry.multibody` lets Pinocchio add closed-form primitives, voids with negative
mass. They can only agree when every void lies wholly inside the material and no two voids overlap, so a wrong drawing shows
itself as a disagreement of the routes.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array, frozen
from geometry.frames import Pose

MOST_HOLES = 200
"""On one circle; every hole is cut by OCC, one after the other."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Box:
    """Cuboid of edge lengths `size` (3,) [m], centred on its own origin, edges along its own axes."""

    size: Array

    def __post_init__(self) -> None:
        object.__setattr__(self, "size", frozen(self.size, (3,), "size"))
        _require_positive(self.size, "size")

    @property
    def volume(self) -> float:
        """Volume [m³]."""
        return float(np.prod(self.size))


@dataclass(frozen=True, eq=False, kw_only=True)
class Cylinder:
    """Solid cylinder of `diameter` [m] and `height` [m], centred on its own origin, axis along its own z."""

    diameter: float
    height: float

    def __post_init__(self) -> None:
        _require_positive(np.array([self.diameter]), "diameter")
        _require_positive(np.array([self.height]), "height")

    @property
    def volume(self) -> float:
        """Volume [m³]."""
        return float(np.pi / 4 * self.diameter**2 * self.height)


Primitive = Box | Cylinder


@dataclass(frozen=True, eq=False, kw_only=True)
class Placed:
    """A primitive and where it sits in the frame of its part."""

    primitive: Primitive
    pose: Pose = field(default_factory=Pose)


@dataclass(frozen=True, eq=False, kw_only=True)
class Shape:
    """Material and voids of one part, in the part's frame.

    Attributes
    ----------
    solids : primitives of material; they may touch but not overlap
    voids : primitives cut out of it; each wholly inside the material, none overlapping another
    """

    solids: tuple[Placed, ...]
    voids: tuple[Placed, ...] = ()

    def __post_init__(self) -> None:
        there, taken = (sum(placed.primitive.volume for placed in kind) for kind in (self.solids, self.voids))
        if taken >= there:
            raise ValueError(f"`voids` must take away less than there is, found {taken:.6g} m³ of {there:.6g} m³")

    @property
    def planar(self) -> bool:
        """Whether every face is a plane, so that a mesh of it is exact."""
        return all(isinstance(placed.primitive, Box) for placed in self.solids + self.voids)


def upright(primitive: Primitive, *, bottom: float, x: float = 0.0, y: float = 0.0) -> Placed:
    """`primitive` standing on height `bottom` [m], its vertical axis through (`x`, `y`) [m]."""
    height = primitive.height if isinstance(primitive, Cylinder) else primitive.size[2]
    return Placed(primitive=primitive, pose=Pose(position=np.array([x, y, bottom + height / 2])))


def drilled(positions: npt.ArrayLike, *, diameter: float, bottom: float, depth: float) -> tuple[Placed, ...]:
    """Vertical holes of `diameter` [m] and `depth` [m] upwards from height `bottom` [m], at `positions` (n, 2) [m]."""
    hole = Cylinder(diameter=diameter, height=depth)
    return tuple(upright(hole, bottom=bottom, x=x, y=y) for x, y in np.asarray(positions, dtype=np.float64))


def bolt_circle(count: int, diameter: float, first_angle: float = 0.0) -> Array:
    """Centres (count, 2) [m] of equally spaced holes on a circle of `diameter` [m], the first at `first_angle` [rad].

    Raises
    ------
    ValueError : fewer than none, or more than `MOST_HOLES`.
    """
    if not 0 <= count <= MOST_HOLES:
        raise ValueError(f"`count` of holes must lie between 0 and {MOST_HOLES}, found {count}")
    angle = first_angle + 2 * np.pi * np.arange(count) / count
    return diameter / 2 * np.column_stack([np.cos(angle), np.sin(angle)])


def rectangle(length_x: float, length_y: float) -> Array:
    """Corners (4, 2) [m] of a rectangle centred on the axis, counter-clockwise from +x +y."""
    return np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]]) * [length_x / 2, length_y / 2]


def _require_positive(values: Array, name: str) -> None:
    if not np.all(np.isfinite(values)) or np.any(values <= 0):
        raise ValueError(f"`{name}` must be positive and finite, found {values.tolist()}")
