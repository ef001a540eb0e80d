"""Quadrilaterals of a plan view: an article of upright boxes and cylinders from above, every edge a line of the mesh.

gmsh cuts all outlines with one another and covers what they enclose with curved quadrilaterals of nine nodes. A thin ring that
two plans share is divided equally in both, so that their meshes meet there node on node.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fem.solid.gmsh_session import session
from geometry.arrays import Array, Integers, frozen

QUAD9 = 10
"""gmsh's number for the quadrilateral of nine nodes: corners, edges, middle."""

LEAST_ON_A_CIRCLE = 8
"""Edges of a hole that is smaller than a cell."""

QUARTERS = 4

FRAME = 1.25
"""Side of the square around a small hole over its diameter."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Outline:
    """A rectangle or a circle in plan view.

    Attributes
    ----------
    centre : (2,) [m]
    size : (2,) [m] full lengths along its own axes; a circle has its diameter in both
    angle : [rad] from x to its own first axis
    round : whether it is a circle
    """

    centre: Array
    size: Array
    angle: float = 0.0
    round: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "centre", frozen(self.centre, (2,), "centre"))
        object.__setattr__(self, "size", frozen(self.size, (2,), "size"))

    @property
    def key(self) -> tuple[float, ...]:
        """Equal for outlines that lie on one another."""
        return tuple(np.round([*self.centre, *self.size, 0.0 if self.round else self.angle % np.pi, float(self.round)], 9))


@dataclass(frozen=True, eq=False, kw_only=True)
class Plan:
    """Quadrilaterals of nine nodes.

    Attributes
    ----------
    points : (p, 2) [m]
    quads : (q, 9) corners counter-clockwise, middles of the edges from the first to the second corner on, centre
    """

    points: Array
    quads: Integers

    @property
    def centres(self) -> Array:
        """Middle nodes (q, 2) [m]."""
        return np.asarray(self.points[self.quads[:, 8]])


def covered(outlines: Iterable[Outline], size: float, around: int) -> Plan:
    """The mesh of everything that `outlines` enclose, edges about `size` [m] long, circles of at least `around` edges."""
    distinct = list({outline.key: outline for outline in outlines}.values())
    walls = {circle.key for ring in _thin_rings(distinct, size) for circle in ring}
    small = [outline for outline in distinct if outline.round and outline.size[0] < size and outline.key not in walls]
    with session() as gmsh:
        drawn = [_face(gmsh.model.occ, outline) for outline in [*distinct, *map(_frame, small)]]
        drawn += [_spoke(gmsh.model.occ, *ring, turn) for ring in _thin_rings(distinct, size) for turn in range(QUARTERS)]
        drawn += [_diagonal(gmsh.model.occ, hole, turn) for hole in small for turn in range(QUARTERS)]
        if len(drawn) > 1:
            gmsh.model.occ.fragment(drawn[:1], drawn[1:])
        gmsh.model.occ.synchronize()
        _set_sizes(gmsh, size, around, np.array([circle.size[0] / 2 for ring in _thin_rings(distinct, size) for circle in ring]))
        _divide_rings(gmsh.model)
        gmsh.model.mesh.generate(2)
        return _read(gmsh)


def with_whole_walls(plan: Plan, inner: float, outer: float) -> Plan:
    """`plan` with one quadrilateral, not two, through the wall between circles of radius `inner` and `outer` [m] about the axis.

    Two that meet on the middle circle share an edge there, whose nodes become the middle nodes of the one.
    """
    radius = np.hypot(*plan.points.T)
    middle = np.hypot(*plan.centres.T)
    halves = np.flatnonzero((inner < middle) & (middle < outer))
    on_middle = np.abs(radius - (inner + outer) / 2) < 0.1 * (outer - inner)
    edges: dict[tuple[int, ...], list[Integers]] = {}
    for quad in plan.quads[halves]:
        side = next(n for n in range(4) if on_middle[quad[n]] and on_middle[quad[(n + 1) % 4]])
        turned = np.concatenate([np.roll(quad[:4], -side), np.roll(quad[4:8], -side)])
        edges.setdefault(tuple(sorted((turned[0], turned[1]))), []).append(turned)
    # a = (s, t, ...) with the shared edge s-t first, b the same edge from its other side: (t, s, ...)
    whole = [[a[2], a[3], b[2], b[3], a[6], a[0], b[6], a[1], a[4]] for a, b in edges.values()]
    return Plan(points=plan.points, quads=np.vstack([np.delete(plan.quads, halves, axis=0), np.array(whole, dtype=np.intp)]))


def _face(occ: Any, outline: Outline) -> tuple[int, int]:
    x, y = outline.centre
    a, b = outline.size
    tag = occ.addDisk(x, y, 0.0, a / 2, b / 2) if outline.round else occ.addRectangle(x - a / 2, y - b / 2, 0.0, a, b)
    # A circle begins where a spoke or a diagonal meets it, so that it falls into four quarters and no more.
    turn = _frame(outline).angle + np.pi / QUARTERS if outline.round and np.any(outline.centre) else outline.angle
    occ.rotate([(2, tag)], x, y, 0.0, 0.0, 0.0, 1.0, turn)
    return 2, tag


def _thin_rings(outlines: Sequence[Outline], size: float) -> list[tuple[Outline, Outline]]:
    """Neighbouring concentric circles, inner and outer, whose distance is less than half an edge: a tube's wall."""
    circles = sorted((outline for outline in outlines if outline.round), key=lambda circle: circle.size[0])
    pairs = [(a, b) for a in circles for b in circles if np.allclose(a.centre, b.centre) and b.size[0] > a.size[0]]
    return [(a, b) for a, b in pairs if (b.size[0] - a.size[0]) / 2 < size / 2]


def _spoke(occ: Any, inner: Outline, outer: Outline, turn: int) -> tuple[int, int]:
    """One of the lines that cut a thin ring into quarters, which gmsh can divide regularly."""
    angle = 2 * np.pi * turn / QUARTERS
    ends = [occ.addPoint(*(c.centre + c.size[0] / 2 * np.array([np.cos(angle), np.sin(angle)])), 0.0) for c in (inner, outer)]
    return 1, occ.addLine(*ends)


def _frame(hole: Outline) -> Outline:
    """A square around a small hole, one side facing the axis, so that regular cells surround the hole."""
    return Outline(centre=hole.centre, size=FRAME * hole.size, angle=float(np.arctan2(hole.centre[1], hole.centre[0])))


def _diagonal(occ: Any, hole: Outline, turn: int) -> tuple[int, int]:
    """A line from a small hole to a corner of its frame."""
    angle = _frame(hole).angle + 2 * np.pi * (turn + 0.5) / QUARTERS
    reach = (hole.size[0] / 2, FRAME * hole.size[0] / np.sqrt(2))
    ends = [occ.addPoint(*(hole.centre + r * np.array([np.cos(angle), np.sin(angle)])), 0.0) for r in reach]
    return 1, occ.addLine(*ends)


def _divide_rings(model: Any) -> None:
    """A regular mesh in every face between a quarter of a circle, two spokes, and another quarter or the side of a frame."""
    for _, face in model.getEntities(2):
        curves = [tag for _, tag in model.getBoundary([(2, face)], oriented=False)]
        kinds = sorted(model.getType(1, tag) for tag in curves)
        if (
            len(kinds) == QUARTERS
            and kinds[:2] != ["Line", "Line"]
            and kinds[2:] == ["Line", "Line"]
            and _is_quarter(model, curves)
        ):
            for tag in curves:
                if model.getType(1, tag) == "Line":
                    model.mesh.setTransfiniteCurve(tag, 2)
            model.mesh.setTransfiniteSurface(face)


def _is_quarter(model: Any, curves: Sequence[int]) -> bool:
    arcs = [model.getParametrizationBounds(1, tag) for tag in curves if model.getType(1, tag) != "Line"]
    return all(abs(float(high[0] - low[0]) - 2 * np.pi / QUARTERS) < 1e-6 for low, high in arcs)


def _set_sizes(gmsh: Any, size: float, around: int, walls: Array) -> None:
    """Recombined quadrilaterals, each divided once more by gmsh to be rid of triangles; circles divided by their size."""
    options = {
        "MeshSizeMax": 2 * size,
        "MeshSizeFromPoints": 0,
        "MeshSizeExtendFromBoundary": 0,
        "Algorithm": 8,
        "RecombineAll": 1,
        "RecombinationAlgorithm": 0,
        "SubdivisionAlgorithm": 1,
        "ElementOrder": 2,
        "SecondOrderIncomplete": 0,
    }
    for name, value in options.items():
        gmsh.option.setNumber(f"Mesh.{name}", value)
    for _, curve in gmsh.model.getEntities(1):
        if gmsh.model.getType(1, curve) != "Line":
            gmsh.model.mesh.setTransfiniteCurve(curve, _divisions(gmsh.model, curve, size, around, walls) + 1)


def _divisions(model: Any, curve: int, size: float, around: int, walls: Array) -> int:
    """Edges of an arc before gmsh divides each of them in two.

    A whole circle has `around` of them where it bounds the wall of a tube, more where it is larger (so that its polygon stays
    clear of the holes beside it) and few where it is a small hole.
    """
    low, high = (float(bound[0]) for bound in model.getParametrizationBounds(1, curve))
    radius = 1 / float(model.getCurvature(1, curve, [low])[0])
    if np.any(np.isclose(radius, walls)):
        whole: float = around
    else:
        whole = LEAST_ON_A_CIRCLE if 2 * radius < size else max(around, 6 * np.pi * radius / size)
    return max(1, round(whole * (high - low) / (4 * np.pi)))


def _read(gmsh: Any) -> Plan:
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    points = np.reshape(coordinates, (-1, 3))[:, :2]
    kinds, _, nodes = gmsh.model.mesh.getElements(2)
    if list(kinds) != [QUAD9]:
        raise RuntimeError(f"gmsh made cells of kinds {list(kinds)} where only quadrilaterals belong")
    place = np.zeros(int(tags.max()) + 1, dtype=np.intp)
    place[tags.astype(np.intp)] = np.arange(len(tags))
    quads = place[np.reshape(nodes[0], (-1, 9)).astype(np.intp)]
    return Plan(points=points, quads=_counter_clockwise(points, quads))


def _counter_clockwise(points: Array, quads: Integers) -> Integers:
    a, b, c = (points[quads[:, corner]] for corner in (0, 1, 3))
    (x1, y1), (x2, y2) = (b - a).T, (c - a).T
    turned = x1 * y2 - x2 * y1 < 0
    quads[turned] = quads[turned][:, [0, 3, 2, 1, 7, 6, 5, 4, 8]]
    return quads
