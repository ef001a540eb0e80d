"""Coordinate systems of Nastran: where grid points stand, and which way their freedoms point.

A rectangular, cylindrical or spherical system is told by three points of another system (CORD2R, CORD2C, CORD2S) or by three
grid points (CORD1R, CORD1C, CORD1S). Number 0 is the basic one. Angles are in degrees.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from fem.mesh.deck_text import real
from geometry.errors import BadInput
from geometry.frames import Array

BASIC = "0"

CARD = re.compile(r"CORD([12])([RCS])")

FLAT = 1e-9
"""Sine of the angle between the two directions that span a system, below which they span none."""


@dataclass(frozen=True, eq=False, kw_only=True)
class System:
    """A system of coordinates.

    Attributes
    ----------
    kind : R, C (radius, angle about z, z) or S (radius, angle from z, angle about z)
    origin : (3,) basic coordinates
    axes : (3, 3) its x, y and z as rows, in basic coordinates
    """

    kind: str
    origin: Array
    axes: Array

    def point(self, at: Array) -> Array:
        """Basic coordinates (3,) of what stands `at` (3,) in it."""
        first, second, third = at.tolist()
        if self.kind == "R":
            own = at
        elif self.kind == "C":
            turn = np.radians(second)
            own = np.array([first * np.cos(turn), first * np.sin(turn), third])
        else:
            tilt, turn = np.radians([second, third])
            own = first * np.array([np.sin(tilt) * np.cos(turn), np.sin(tilt) * np.sin(turn), np.cos(tilt)])
        return np.asarray(self.origin + own @ self.axes)

    def directions(self, point: Array) -> Array:
        """Its three directions (3, 3) as rows, in basic coordinates, at the basic `point` (3,)."""
        if self.kind == "R":
            return self.axes
        x, y, z = (self.axes @ (point - self.origin)).tolist()
        turn, tilt = np.arctan2(y, x), np.arctan2(np.hypot(x, y), z)
        outward = np.array([np.cos(turn), np.sin(turn), 0.0])
        around, up = np.array([-np.sin(turn), np.cos(turn), 0.0]), np.array([0.0, 0.0, 1.0])
        if self.kind == "S":
            own = np.array([np.sin(tilt) * outward + np.cos(tilt) * up, np.cos(tilt) * outward - np.sin(tilt) * up, around])
        else:
            own = np.array([outward, around, up])
        return np.asarray(own @ self.axes)


@dataclass(eq=False, kw_only=True)
class Coordinates:
    """Systems and grid points of a deck as it writes them.

    Attributes
    ----------
    source : the deck
    systems : kind, system or none, and three points or grid points of each, by number
    grids : fields of each grid point, by number
    usual : fields that a grid point has where it leaves its own empty
    found : systems that are worked out
    """

    source: str
    systems: dict[str, tuple[str, str, tuple[Array, ...] | tuple[int, ...]]] = field(default_factory=dict)
    grids: dict[int, Sequence[str]] = field(default_factory=dict)
    usual: Sequence[str] = ()
    found: dict[str, System] = field(default_factory=dict)

    def add(self, card: str, fields: Sequence[str]) -> None:
        """Note the `card` of a system."""
        which, kind = CARD.fullmatch(card).groups()  # type: ignore[union-attr]
        f = [*fields, *(12 * [""])]
        if which == "2":
            points = tuple(np.array([real(text) for text in f[k : k + 3]]) for k in (2, 5, 8))
            self.systems[f[0]] = kind, f[1] or BASIC, points
            return
        for k in (0, 4):
            if f[k]:
                self.systems[f[k]] = kind, "", tuple(int(text) for text in f[k + 1 : k + 4])

    def grid(self, node: int) -> list[str]:
        """Fields (8,) of a grid point, the usual ones where it has none.

        Raises
        ------
        BadInput : systems or freedoms that are no numbers.
        """
        f = [one or other for one, other in zip([*self.grids[node], *8 * [""]], [*self.usual, *8 * [""]], strict=False)][:8]
        numbers = (f[1], *f[5:8])
        if any(text not in ("", "-1") and not text.isdigit() for text in numbers):  # -1: a point of a fluid
            problem = f"node {node} has {', '.join(numbers)!r} where its systems and freedoms are numbers"
            raise BadInput(source=self.source, field="GRID", problem=problem, remedy="Write it again; it may be damaged")
        return f

    def place(self, node: int, within: tuple[str, ...] = ()) -> Array:
        """Basic coordinates (3,) of a grid point.

        Raises
        ------
        BadInput : its system is not there, has no extent, or stands on itself; see `grid`.
        """
        _, system, *three = self.grid(node)[:5]
        at = np.array([real(text) for text in three])
        return at if (system or BASIC) == BASIC else self.system(system, within).point(at)

    def freedoms(self, node: int) -> Array | None:
        """Directions (3, 3) of the freedoms of a grid point as rows; None for the basic ones."""
        system = self.grid(node)[5] or BASIC
        if system in (BASIC, "-1"):
            return None
        own = self.system(system).directions(self.place(node))
        return None if np.allclose(own, np.eye(3), rtol=0, atol=FLAT) else own

    def system(self, number: str, within: tuple[str, ...] = ()) -> System:
        """The system of that number.

        Raises
        ------
        BadInput : see `place`.
        """
        if number == BASIC:
            return System(kind="R", origin=np.zeros(3), axes=np.eye(3))
        if number in self.found:
            return self.found[number]
        if number not in self.systems:
            raise self._refused(number, "is not there", "Include the file that has it")
        if number in within:
            raise self._refused(number, "stands on itself", "Correct the numbers")
        kind, below, points = self.systems[number]
        if below:
            base = self.system(below, (*within, number))
            a, b, c = (base.point(np.asarray(at)) for at in points)
        else:
            lost = [node for node in points if node not in self.grids]
            if lost:
                raise self._refused(number, f"stands on grid point {lost[0]}, which is not there", "Correct it")
            a, b, c = (self.place(int(node), (*within, number)) for node in points)
        z, to = b - a, c - a
        y = np.cross(z, to)
        if not np.linalg.norm(y) > FLAT * np.linalg.norm(z) * np.linalg.norm(to):
            raise self._refused(number, "has three points on one line", "Correct them")
        z, y = z / np.linalg.norm(z), y / np.linalg.norm(y)
        self.found[number] = System(kind=kind, origin=a, axes=np.array([np.cross(y, z), y, z]))
        return self.found[number]

    def _refused(self, number: str, problem: str, remedy: str) -> BadInput:
        return BadInput(source=self.source, field="CORD", problem=f"the coordinate system {number} {problem}", remedy=remedy)
