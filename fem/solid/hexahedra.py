"""Hexahedra for articles of upright boxes and cylinders: a plan view, extruded layer by layer.

Thin plates and tubes standing upright are what tetrahedra do worst: a blade of 4 mm wants cells that are flat, and a silicone
layer of half a millimetre between two steel faces wants cells of 27 nodes, which do not lock. In plan view such an article is a
set of rectangles and circles; every layer between two heights is some of their quadrilaterals, stretched upwards. Layers share
nodes by construction. An article may be cut at heights where different plans meet, so that the flange's holes do not divide the
blades.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt

from fem.solid import assembly
from fem.solid.assembly import LOCAL_HEX27, SolidMesh, session
from geometry.article import Cylinder, Part
from geometry.errors import BadInput, CheckFailed
from geometry.frames import Array, Integers, freeze

# Quadrilaterals of a plan view: an article of upright boxes and cylinders from above, every edge a line of the mesh.
#
# gmsh cuts all outlines with one another and covers what they enclose with curved quadrilaterals of nine nodes. A thin ring that
# two plans share is divided equally in both, so that their meshes meet there node on node.

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
        freeze(self, centre=(2,), size=(2,))

    @property
    def key(self) -> tuple[float, ...]:
        """Equal for outlines that lie on one another."""
        return tuple(np.round([*self.centre, *self.size, 0.0 if self.round else self.angle % np.pi, float(self.round)], 9))


@dataclass(frozen=True, eq=False, kw_only=True)
class PlanMesh:
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


def covered(outlines: Iterable[Outline], size: float, around: int) -> PlanMesh:
    """The mesh of everything that `outlines` enclose, edges about `size` [m] long, circles of at least `around` edges."""
    distinct = list({outline.key: outline for outline in outlines}.values())
    # Neighbouring concentric circles, inner and outer, whose distance is less than half an edge: a tube's wall
    circles = sorted((one for one in distinct if one.round), key=lambda circle: circle.size[0])
    pairs = [(a, b) for a in circles for b in circles if np.allclose(a.centre, b.centre) and b.size[0] > a.size[0]]
    rings = [(a, b) for a, b in pairs if (b.size[0] - a.size[0]) / 2 < size / 2]
    walls = {circle.key for ring in rings for circle in ring}
    small = [outline for outline in distinct if outline.round and outline.size[0] < size and outline.key not in walls]
    with session() as gmsh:
        occ, drawn = gmsh.model.occ, []
        for outline in [*distinct, *map(_frame, small)]:
            (x, y), (a, b) = outline.centre, outline.size
            tag = occ.addDisk(x, y, 0.0, a / 2, b / 2) if outline.round else occ.addRectangle(x - a / 2, y - b / 2, 0.0, a, b)
            # A circle begins where a spoke or a diagonal meets it, so that it falls into four quarters and no more.
            turn = _frame(outline).angle + np.pi / QUARTERS if outline.round and np.any(outline.centre) else outline.angle
            occ.rotate([(2, tag)], x, y, 0.0, 0.0, 0.0, 1.0, turn)
            drawn.append((2, tag))
        # Spokes cut a thin ring into quarters, which gmsh can divide regularly; diagonals join a small hole to its frame
        quarters = 2 * np.pi * np.arange(QUARTERS) / QUARTERS
        lines = [(a.centre, a.size[0] / 2, b.centre, b.size[0] / 2, turn) for a, b in rings for turn in quarters]
        for hole in small:
            turns = _frame(hole).angle + 2 * np.pi * (np.arange(QUARTERS) + 0.5) / QUARTERS
            lines += [(hole.centre, hole.size[0] / 2, hole.centre, FRAME * hole.size[0] / np.sqrt(2), turn) for turn in turns]
        for start, near, end, far, turn in lines:
            along = np.array([np.cos(turn), np.sin(turn)])
            drawn.append((1, occ.addLine(occ.addPoint(*(start + near * along), 0.0), occ.addPoint(*(end + far * along), 0.0))))
        if len(drawn) > 1:
            occ.fragment(drawn[:1], drawn[1:])
        occ.synchronize()
        _divide(gmsh, size, around, np.array([circle.size[0] / 2 for ring in rings for circle in ring]))
        gmsh.model.mesh.generate(2)
        tags, coordinates, _ = gmsh.model.mesh.getNodes()
        points = np.reshape(coordinates, (-1, 3))[:, :2]
        kinds, _, nodes = gmsh.model.mesh.getElements(2)
        if list(kinds) != [QUAD9]:
            raise RuntimeError(f"gmsh made cells of kinds {list(kinds)} where only quadrilaterals belong")
        place = np.zeros(int(tags.max()) + 1, dtype=np.intp)
        place[tags.astype(np.intp)] = np.arange(len(tags))
        quads = place[np.reshape(nodes[0], (-1, 9)).astype(np.intp)]
        a, b, c = (points[quads[:, corner]] for corner in (0, 1, 3))
        (x1, y1), (x2, y2) = (b - a).T, (c - a).T
        clockwise = x1 * y2 - x2 * y1 < 0
        quads[clockwise] = quads[clockwise][:, [0, 3, 2, 1, 7, 6, 5, 4, 8]]
        return PlanMesh(points=points, quads=quads)


def with_whole_walls(plan: PlanMesh, inner: float, outer: float) -> PlanMesh:
    """`plan` with one quadrilateral, not two, through the wall between circles of radius `inner` and `outer` [m] about the axis.

    Two that meet on the middle circle share an edge there, whose nodes become the middle nodes of the one.
    """
    radius, middle = np.hypot(*plan.points.T), np.hypot(*plan.centres.T)
    halves = np.flatnonzero((inner < middle) & (middle < outer))
    on_middle = np.abs(radius - (inner + outer) / 2) < 0.1 * (outer - inner)
    edges: dict[tuple[int, ...], list[Integers]] = {}
    for quad in plan.quads[halves]:
        side = next(n for n in range(4) if on_middle[quad[n]] and on_middle[quad[(n + 1) % 4]])
        turned = np.concatenate([np.roll(quad[:4], -side), np.roll(quad[4:8], -side)])
        edges.setdefault(tuple(sorted((turned[0], turned[1]))), []).append(turned)
    # a = (s, t, ...) with the shared edge s-t first, b the same edge from its other side: (t, s, ...)
    whole = [[a[2], a[3], b[2], b[3], a[6], a[0], b[6], a[1], a[4]] for a, b in edges.values()]
    return PlanMesh(points=plan.points, quads=np.vstack([np.delete(plan.quads, halves, axis=0), np.array(whole, dtype=np.intp)]))


def _frame(hole: Outline) -> Outline:
    """A square around a small hole, one side facing the axis, so that regular cells surround the hole."""
    return Outline(centre=hole.centre, size=FRAME * hole.size, angle=float(np.arctan2(hole.centre[1], hole.centre[0])))


def _divide(gmsh: Any, size: float, around: int, walls: Array) -> None:
    """Recombined quadrilaterals, each divided once more by gmsh to be rid of triangles; circles divided by their size.

    A whole circle has `around` edges where it bounds the wall of a tube, more where it is larger (so that its polygon stays clear
    of the holes beside it) and few where it is a small hole. Every face between a quarter of a circle, two spokes, and another
    quarter or the side of a frame has a regular mesh.
    """
    model = gmsh.model
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
    for _, curve in model.getEntities(1):
        if model.getType(1, curve) != "Line":
            low, high = (float(bound[0]) for bound in model.getParametrizationBounds(1, curve))
            radius = 1 / float(model.getCurvature(1, curve, [low])[0])
            if np.any(np.isclose(radius, walls)):
                whole: float = around
            else:
                whole = LEAST_ON_A_CIRCLE if 2 * radius < size else max(around, 6 * np.pi * radius / size)
            edges = max(1, round(whole * (high - low) / (4 * np.pi)))  # gmsh divides each of them in two
            model.mesh.setTransfiniteCurve(curve, edges + 1)
    for _, face in model.getEntities(2):
        curves = [tag for _, tag in model.getBoundary([(2, face)], oriented=False)]
        lines = [tag for tag in curves if model.getType(1, tag) == "Line"]
        arcs = [model.getParametrizationBounds(1, tag) for tag in curves if tag not in lines]
        kinds = sorted(model.getType(1, tag) for tag in curves)
        between = len(kinds) == QUARTERS and kinds[:2] != ["Line", "Line"] and kinds[2:] == ["Line", "Line"]
        if between and all(abs(float(high[0] - low[0]) - 2 * np.pi / QUARTERS) < 1e-6 for low, high in arcs):
            for tag in lines:
                model.mesh.setTransfiniteCurve(tag, 2)
            model.mesh.setTransfiniteSurface(face)


Mask = npt.NDArray[np.bool_]

SAME = 1e-7
"""Heights and points closer than this [m] are one."""

GROWTH = 1.6
"""From layer to layer, away from a height where something begins or ends."""

THIN = 0.15
"""Wall over inner radius, below which one cell through the wall of a tube is enough."""

SHELL = 0.25
"""First layer beside such a height, as a share of the size of a cell: a thin tube's boundary layer is shorter than its waves."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Prism:
    """An upright primitive in the article's frame: its outline between two heights [m]."""

    outline: Outline
    bottom: float
    top: float

    @property
    def volume(self) -> float:
        """[m³]."""
        return float(np.prod(self.outline.size)) * (np.pi / 4 if self.outline.round else 1.0) * (self.top - self.bottom)


@dataclass(frozen=True, eq=False, kw_only=True)
class Upright:
    """A part as prisms of material and prisms cut out of it."""

    name: str
    solids: tuple[Prism, ...]
    voids: tuple[Prism, ...]

    @property
    def volume(self) -> float:
        """[m³]; every void lies in the material and none in another (`geometry.article`)."""
        return sum(prism.volume for prism in self.solids) - sum(prism.volume for prism in self.voids)

    @property
    def bottom(self) -> float:
        """Lowest height [m]."""
        return min(prism.bottom for prism in self.solids)

    @property
    def top(self) -> float:
        """Greatest height [m]."""
        return max(prism.top for prism in self.solids)

    def holds(self, points: Array, height: float) -> Mask:
        """Which of `points` (p, 2) lie in the part at `height`."""
        inside = np.zeros(len(points), dtype=bool)
        for prisms, value in ((self.solids, True), (self.voids, False)):
            for prism in prisms:
                if prism.bottom < height < prism.top:
                    outline = prism.outline
                    c, s = np.cos(outline.angle), np.sin(outline.angle)
                    own = (points - outline.centre) @ np.array([[c, -s], [s, c]]) / (outline.size / 2)
                    enclosed = np.asarray(np.hypot(*own.T) < 1 if outline.round else np.abs(own).max(axis=1) < 1)
                    inside[enclosed] = value
        return inside


def hexahedra(parts: Sequence[Part], *, sizes: Sequence[float], around: int = 24, cuts: Sequence[float] = ()) -> SolidMesh:
    """Mesh of `parts`, circles of `around` edges; plans change at the heights `cuts` [m], ascending.

    `sizes` are the widths of a cell [m], below the first cut, between the cuts and above the last.

    Raises
    ------
    BadInput : a part that does not stand upright, or one that reaches through a cut.
    CheckFailed : cells inside out, or a part that they do not fill.
    """
    uprights, limits = [upright(part) for part in parts], [-np.inf, *cuts, np.inf]
    pieces = [
        _extruded(group, uprights, size, around)
        for size, (low, high) in zip(sizes, pairwise(limits), strict=True)
        if (group := [u for u in uprights if low - SAME <= u.bottom and u.top <= high + SAME])
    ]
    there = {int(number) for numbers in [part for _, _, part in pieces] for number in np.unique(numbers)}
    for number, u in enumerate(uprights):
        if number not in there:
            problem = f"reaches from {1e3 * u.bottom:g} to {1e3 * u.top:g} mm, through a height at which the mesh is cut"
            raise BadInput(f"part {u.name}", "", problem, "Cut where one part stands on another")
    # One mesh, nodes of equal place made one, nodes of no cell left out
    offsets = np.cumsum([0, *(len(points) for points, _, _ in pieces)])
    points = np.concatenate([points for points, _, _ in pieces])
    cells = np.concatenate([cells + offset for (_, cells, _), offset in zip(pieces, offsets, strict=False)])
    used, cells = np.unique(cells, return_inverse=True)
    _, first, same = np.unique(np.round(points[used] / SAME).astype(np.int64), axis=0, return_index=True, return_inverse=True)
    made = SolidMesh(
        points=points[used][first],
        cells=same.reshape(-1)[cells].reshape(-1, 27),
        part=np.concatenate([part for _, _, part in pieces]),
        parts=tuple(u.name for u in uprights),
    )
    assembly.require_upright(made)
    if words := assembly.unfilled(made, [u.volume for u in uprights]):
        raise CheckFailed(f"{words}. Give a smaller element size")
    return made


def foot_height(parts: Sequence[Part]) -> float | None:
    """Height [m] at which a thin upright tube and all else that stands on it leave the one part below; None if that is not so.

    Such an article can be meshed in two plans that share the tube's ring: a flange with its holes, a mast with its blades.
    """
    try:
        uprights = sorted((upright(part) for part in parts), key=lambda u: u.bottom)
    except BadInput:
        return None
    if len(uprights) < 2:
        return None
    foot, first, *others = uprights
    stands = abs(first.bottom - foot.top) < SAME and all(u.bottom > foot.top + SAME for u in others)
    return foot.top if stands and _walls([first]) else None


def upright(part: Part) -> Upright:
    """`part` as prisms.

    Raises
    ------
    BadInput : one of its primitives is tilted.
    """
    prisms = []
    for placed in (*part.shape.solids, *part.shape.voids):
        pose, primitive = part.pose @ placed.pose, placed.primitive
        if abs(pose.rotation[2, 2] - 1) > SAME:
            problem = "hexahedra need upright boxes and cylinders, found a tilted one"
            raise BadInput(f"part {part.name}", "", problem, "Mesh the article with tetrahedra")
        if isinstance(primitive, Cylinder):
            outline = Outline(centre=pose.position[:2], size=np.full(2, primitive.diameter), round=True)
            height = primitive.height
        else:
            angle = float(np.arctan2(pose.rotation[1, 0], pose.rotation[0, 0]))
            outline = Outline(centre=pose.position[:2], size=primitive.size[:2], angle=angle)
            height = float(primitive.size[2])
        middle = float(pose.position[2])
        prisms.append(Prism(outline=outline, bottom=middle - height / 2, top=middle + height / 2))
    solids = len(part.shape.solids)
    return Upright(name=part.name, solids=tuple(prisms[:solids]), voids=tuple(prisms[solids:]))


Piece = tuple[Array, Integers, Integers]
"""Points (p, 3), cells (c, 27) and the part of each (c,)."""


def _extruded(group: Sequence[Upright], all_parts: Sequence[Upright], size: float, around: int) -> Piece:
    """One plan, extruded; circles of the parts beyond a cut are drawn in it where they stand on it."""
    prisms = [prism for u in group for prism in (*u.solids, *u.voids)]
    bottom, top = min(u.bottom for u in group), max(u.top for u in group)
    feet = [
        prism
        for u in all_parts
        for prism in (*u.solids, *u.voids)
        if abs(prism.bottom - top) < SAME or abs(prism.top - bottom) < SAME
    ]
    plan = covered([prism.outline for prism in (*prisms, *feet)], size, around)
    for inner, outer in _walls(all_parts):
        plan = with_whole_walls(plan, inner, outer)
    # Heights of the layers [m]: where anything begins or ends, and between those layers that grow towards the middle
    ends = np.sort([h for u in group for prism in (*u.solids, *u.voids) for h in (prism.bottom, prism.top)])
    breaks = ends[np.concatenate([[True], np.diff(ends) > SAME])]
    between = [_graded(low, high, size)[:-1] for low, high in pairwise(breaks)]
    heights, numbers = np.concatenate([*between, breaks[-1:]]), {u.name: number for number, u in enumerate(all_parts)}
    chosen = [
        (layer, quads, numbers[u.name])
        for layer, (low, high) in enumerate(pairwise(heights))
        for u in group
        if len(quads := np.flatnonzero(u.holds(plan.centres, (low + high) / 2)))
    ]
    # Cells of the chosen quadrilaterals of each layer; node n of level l is l times the nodes of the plan plus n
    levels, count = np.sort(np.concatenate([heights, (heights[1:] + heights[:-1]) / 2])), len(plan.points)
    # For every node of a hexahedron the node of the nine-node quadrilateral below it
    nine = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0.5, 0], [1, 0.5], [0.5, 1], [0, 0.5], [0.5, 0.5]])
    quad_place = np.array([int(np.flatnonzero((nine == node[:2]).all(axis=1))[0]) for node in LOCAL_HEX27])
    corner, level = quad_place, (2 * LOCAL_HEX27[:, 2]).astype(np.intp)
    cells = [plan.quads[quads][:, corner] + count * (2 * layer + level) for layer, quads, _ in chosen]
    part = [np.full(len(quads), number, dtype=np.intp) for _, quads, number in chosen]
    points = np.column_stack([np.tile(plan.points, (len(levels), 1)), np.repeat(levels, count)])
    return points, np.concatenate(cells), np.concatenate(part)


def _walls(uprights: Sequence[Upright]) -> list[tuple[float, float]]:
    """Inner and outer radius [m] of thin tubes about the axis."""
    tubes = [
        (void.outline.size[0] / 2, solid.outline.size[0] / 2)
        for u in uprights
        for solid in u.solids
        for void in u.voids
        if solid.outline.round and void.outline.round and not np.any(solid.outline.centre) and not np.any(void.outline.centre)
    ]
    return sorted({(float(a), float(b)) for a, b in tubes if b - a < THIN * a})


def _graded(low: float, high: float, size: float) -> Array:
    """Heights from `low` to `high` [m], layers growing from both ends to `size`."""
    half: list[float] = []
    while sum(half) < (high - low) / 2:
        half.append(min(size, SHELL * size * GROWTH ** len(half)))
    if len(half) == 1 or high - low <= size:
        return np.array([low, high])
    steps = np.array([*half, *half[::-1]])
    return low + (high - low) * np.concatenate([[0.0], np.cumsum(steps) / steps.sum()])
