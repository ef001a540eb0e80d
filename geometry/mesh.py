"""`TriangleMesh`: a surface of triangles as two arrays, and what can be read from the arrays alone."""

import io
import re
import warnings
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import chain, combinations, islice
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from geometry.errors import BadInput, require_fetched
from geometry.frames import Array, Pose, frozen
from geometry.inertia import Inertia
from geometry.toml_file import METRE, UNITS, LengthUnit, doubts, length_unit

DEFAULT_CHORD = 2e-6
"""Chord error of the mesh of an exact drawing [m]."""

Integers = npt.NDArray[np.int64]


@dataclass(frozen=True, eq=False, kw_only=True)
class TriangleMesh:
    """A surface of triangles, corners counter-clockwise when seen from outside.

    Attributes
    ----------
    vertices : (n, 3) [m], in the frame of the body
    faces : (k, 3), the vertices of each triangle
    """

    vertices: Array
    faces: Integers

    def __post_init__(self) -> None:
        vertices = frozen(self.vertices, (len(self.vertices), 3), "vertices")
        faces = np.array(self.faces, dtype=np.int64)
        if faces.ndim != 2 or faces.shape[1] != 3:
            raise ValueError(f"`faces` must have shape (k, 3), found {faces.shape}")
        if faces.size and (faces.min() < 0 or faces.max() >= len(vertices)):
            found = f"{faces.min()} to {faces.max()}"
            raise ValueError(f"`faces` must name vertices 0 to {len(vertices) - 1}, found {found}")
        faces.setflags(write=False)
        object.__setattr__(self, "vertices", vertices)
        object.__setattr__(self, "faces", faces)

    @property
    def triangles(self) -> Array:
        """Corners (k, 3 corners, 3) [m] of every face."""
        return self.vertices[self.faces]

    @property
    def bounds(self) -> Array:
        """Lower and upper corner (2, 3) [m] of the box around the faces."""
        corners = self.triangles.reshape(-1, 3)
        return np.array([corners.min(axis=0), corners.max(axis=0)])

    @property
    def volume(self) -> float:
        """Signed volume [m³] by the divergence theorem: negative for an inside-out mesh, meaningless for an open one."""
        a, b, c = np.moveaxis(self.triangles - self.bounds.mean(axis=0), 1, 0)
        return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


class Edges(NamedTuple):
    """The distinct edges of a mesh.

    Attributes
    ----------
    ends : (e, 2), the two vertices of each, ascending
    of_face : (k, 3), the edges of every face
    uses : (e,), how many faces meet there: 2 on a closed surface
    turns : (e,), along minus against: 0 where the two faces agree on what is outside
    """

    ends: Integers
    of_face: Integers
    uses: Integers
    turns: Integers


def edges(mesh: TriangleMesh) -> Edges:
    """The distinct edges of `mesh`, with what meets at each."""
    directed = mesh.faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    ends, index = np.unique(np.sort(directed, axis=1), axis=0, return_inverse=True)
    along = np.where(directed[:, 0] < directed[:, 1], 1, -1)
    index = index.reshape(-1)
    return Edges(
        ends=ends,
        of_face=index.reshape(-1, 3),
        uses=np.bincount(index, minlength=len(ends)),
        turns=np.bincount(index, weights=along, minlength=len(ends)).astype(np.int64),
    )


def piece_of_face(mesh: TriangleMesh) -> Integers:
    """(k,) number of the connected piece that each face belongs to, 0 for the piece of the first face; joined by edges."""
    count, edge = len(mesh.faces), edges(mesh)
    links = np.column_stack([np.repeat(np.arange(count), 3), count + edge.of_face.reshape(-1)])
    _, first, numbered = np.unique(connected(links, count + len(edge.ends))[:count], return_index=True, return_inverse=True)
    return np.argsort(np.argsort(first))[numbered.reshape(-1)].astype(np.int64)


def connected(links: Integers, nodes: int) -> Integers:
    """(nodes,) label of the connected part of a graph that each node belongs to; `links` (n, 2) are its edges."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    graph = coo_array((np.ones(len(links)), (links[:, 0], links[:, 1])), shape=(nodes, nodes))
    return np.asarray(connected_components(graph, directed=False)[1], dtype=np.int64)


def pieces(mesh: TriangleMesh) -> tuple[TriangleMesh, ...]:
    """The connected pieces of `mesh`, in the order of their first face."""
    label = piece_of_face(mesh)
    return tuple(selected(mesh, label == number) for number in range(int(label.max(initial=-1)) + 1))


def selected(mesh: TriangleMesh, chosen: npt.NDArray[np.bool_]) -> TriangleMesh:
    """The faces of `mesh` for which `chosen` (k,) is true, without the vertices that nothing uses any more."""
    used, faces = np.unique(mesh.faces[chosen], return_inverse=True)
    return TriangleMesh(vertices=mesh.vertices[used], faces=faces.reshape(-1, 3))


def joined(*meshes: TriangleMesh) -> TriangleMesh:
    """`meshes` as one, vertices kept apart."""
    offsets = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes[:-1])])
    return TriangleMesh(
        vertices=np.vstack([mesh.vertices for mesh in meshes]),
        faces=np.vstack([mesh.faces + offset for mesh, offset in zip(meshes, offsets, strict=True)]),
    )


def merged(mesh: TriangleMesh) -> TriangleMesh:
    """`mesh` with vertices at exactly the same place made one, so that neighbours know each other; unused ones are dropped."""
    places, index = np.unique(mesh.vertices + 0.0, axis=0, return_inverse=True)  # + 0.0 makes one zero of -0 and 0
    faces = index.reshape(-1)[mesh.faces]
    return selected(TriangleMesh(vertices=places, faces=faces), np.ones(len(faces), dtype=np.bool_))


def placed(mesh: TriangleMesh, pose: Pose) -> TriangleMesh:
    """`mesh`, given in its own frame, seen in the outer frame of `pose`."""
    return TriangleMesh(vertices=pose.apply(mesh.vertices), faces=mesh.faces)


def scaled(mesh: TriangleMesh, factor: float) -> TriangleMesh:
    """`mesh` with every length times `factor`, which must be positive."""
    return TriangleMesh(vertices=mesh.vertices * factor, faces=mesh.faces)


# Doors to libigl and Manifold: where a surface runs through itself, and how much space two bodies share.
#
# Both are free of the GPL: of libigl only what is under the MPL is asked, never `igl.copyleft`, which holds CGAL; Manifold is
# under the Apache licence. `tests/geometry/test_without_gpl.py` holds both to CGAL's exact answers.


CLEARLY = 1e-10
"""How far apart two directions are that rounding cannot have put apart: far above its 1e-16, far below what faces differ by. What
is nearer is left to exact predicates; the tests against CGAL hold it."""

TOGETHER = 1 << 15
"""Pairs of neighbours that are looked at in one go: enough for a call to cost nothing beside them, and few for the memory."""


def intersecting_faces(mesh: TriangleMesh) -> Integers:
    """Pairs (p, 2) of faces of `mesh` that have more in common than the corners they share, without tolerance.

    Every face has an area, and no two have the same corners. Faces without a common corner are told by libigl's exact predicates;
    its answer for neighbours allows for a tolerance and is not used. Near a corner that two faces share both are cones, and they
    have more in common where the arcs meet that they cut out of a sphere around it.
    """
    from igl.predicates import find_self_intersections

    if not len(mesh.faces):
        return np.empty((0, 2), dtype=np.int64)
    vertices, faces = np.array(mesh.vertices), np.array(mesh.faces)
    pairs = np.asarray(find_self_intersections(vertices, faces)[1], dtype=np.int64).reshape(-1, 2)
    apart = pairs[~(faces[pairs[:, 0], :, None] == faces[pairs[:, 1], None, :]).any(axis=(1, 2))]
    # Every face seen from each of its corners, ordered by corner: what lies `step` further on belongs to the same one or to none
    corner, face = faces.reshape(-1), np.repeat(np.arange(len(faces)), 3)
    ends = np.stack([np.roll(faces, -1, axis=1), np.roll(faces, -2, axis=1)], axis=2).reshape(-1, 2)
    order = np.argsort(corner, kind="stable")
    corner, face, ends = corner[order], face[order], ends[order]
    ways = vertices[ends] - vertices[corner, None]
    ways /= np.linalg.norm(ways, axis=2, keepdims=True)
    pending, doubtful, most = list[Integers](), [np.empty((0, 2), dtype=np.int64)], int(np.bincount(corner).max())
    for step in range(1, most):
        one = np.flatnonzero(corner[step:] == corner[:-step])
        pending.append(np.column_stack([one, one + step]))
        if step + 1 < most and sum(map(len, pending)) < TOGETHER:
            continue
        one, other = np.vstack(pending).T
        pending = []
        # Clear of one another where a plane through the corner parts them, along an edge that both may share
        for i, j in ((1, 0), (0, 1), (0, 0), (1, 1)):
            across = ways[one, i] - ways[other, j]
            here, there = (np.einsum("pij,pj->pi", ways[which], across) for which in (one, other))
            near = (here.min(axis=1) <= CLEARLY) | (there.max(axis=1) >= -CLEARLY)
            one, other = one[near], other[near]
        for i, j in ((1, 0), (0, 1), (0, 0), (1, 1)):
            along, here, there = ways[one, i], ways[one, 1 - i], ways[other, 1 - j]
            here, there = (way - np.sum(way * along, axis=1)[:, None] * along for way in (here, there))
            folded = (np.linalg.norm(np.cross(here, there), axis=1) <= CLEARLY) & (np.sum(here * there, axis=1) >= -CLEARLY)
            near = folded | (ends[one, i] != ends[other, j])
            one, other = one[near], other[near]
        doubtful.append(np.column_stack([one, other]))
    pairs = np.vstack(doubtful)
    pairs = pairs[_meet(vertices, corner[pairs[:, 0]], *ends[pairs.T])]
    return np.unique(np.sort(np.vstack([apart, face[pairs]]), axis=1), axis=0)


def _meet(vertices: Array, corner: Integers, one: Integers, other: Integers) -> npt.NDArray[np.bool_]:
    """Whether sectors between two `vertices` each (n, 2), seen from `corner` (n,), share a way other than a vertex of both."""
    from igl.predicates import orient3d

    def turn(plane: list[int], *corners: Array) -> Integers:
        """Which way three points (m, 3) turn in a `plane`: as they do seen from a point above the first one."""
        a, b, c = (points[:, [*plane, 0]] * [1.0, 1.0, 0.0] for points in corners)
        return np.asarray(orient3d(a, b, c, a + np.array([0.0, 0.0, 1.0])), dtype=np.int64)

    def upon(way: Array, first: Array, second: Array, o: Array) -> npt.NDArray[np.bool_]:
        """Whether `way`, in the plane of the sector from `first` to `second`, lies within it."""
        within, told = (np.zeros(len(way), dtype=np.bool_) for _ in range(2))
        for plane in ([0, 1], [1, 2], [2, 0]):
            around = turn(plane, o, first, second)
            inside = (turn(plane, o, first, way) * around >= 0) & (turn(plane, o, way, second) * around >= 0)
            within |= ~told & (around != 0) & inside
            told |= around != 0
        return within

    o, sides, within = vertices[corner], [], np.zeros(len(corner), dtype=np.bool_)
    for (first, second), ways in ((one.T, other.T), (other.T, one.T)):
        for way in ways:
            common = (way == first) | (way == second)
            side = np.asarray(orient3d(vertices[first], vertices[second], vertices[way], o), dtype=np.int64)
            sides.append(np.where(common, 0, side))
            flat = np.flatnonzero(~common & (side == 0))
            within[flat] |= upon(*(vertices[which[flat]] for which in (way, first, second, corner)))
    return within | ((sides[0] * sides[1] < 0) & (sides[2] * sides[3] < 0) & (sides[0] * sides[2] < 0))


def shared_volumes(bodies: Sequence[TriangleMesh]) -> dict[tuple[int, int], float]:
    """Volume [m³] that two of `bodies` share, by their numbers, where it is not zero; each closed, free of self-intersections.

    To rounding of the coordinates about the middle of all, where exact arithmetic would be without any.
    """
    from manifold3d import Error, Manifold, Mesh64

    if len(bodies) < 2:
        return {}
    bounds, shared = np.array([body.bounds for body in bodies]), dict[tuple[int, int], float]()
    middle = 0.5 * (bounds[:, 0].min(axis=0) + bounds[:, 1].max(axis=0))
    near = [
        (i, j)
        for i, j in combinations(range(len(bodies)), 2)
        if np.all(bounds[[i, j], 0].max(axis=0) < bounds[[i, j], 1].min(axis=0))
    ]
    solids = {
        k: Manifold(Mesh64(bodies[k].vertices - middle, bodies[k].faces.astype(np.uint64))) for k in sorted({*chain(*near)})
    }
    for i, j in near:
        both = solids[i] ^ solids[j]
        if both.status() != Error.NoError:
            raise ValueError(f"`bodies` must be closed surfaces, found {both.status().name}")
        if (volume := float(both.volume())) > 0:
            shared[i, j] = volume
    return shared


def winding_number(mesh: TriangleMesh, point: Array) -> int:
    """How many times `mesh` encloses `point` (3,) [m], which must not lie on it."""
    from igl import winding_number as enclosed

    return round(float(enclosed(mesh.vertices, mesh.faces, point.reshape(1, 3))[0]))


def winding_numbers(mesh: TriangleMesh, points: Array) -> Array:
    """(n,) generalised winding number of `mesh`, closed or not, about `points` (n, 3) [m]: the share of a full turn it closes."""
    from igl import fast_winding_number

    vertices, faces = np.array(mesh.vertices), np.array(mesh.faces)
    return np.asarray(fast_winding_number(vertices, faces, np.ascontiguousarray(points)))


def oriented(mesh: TriangleMesh) -> TriangleMesh:
    """`mesh` with neighbours that agree on what is outside; a patch that is open has its outside where it sees more of the sky.

    A patch that is closed, or that sees as much of the sky from either side, keeps the turn that most of its faces have.
    """
    from igl import ambient_occlusion, bfs_orient

    if not len(mesh.faces):
        return mesh
    faces, patch = (np.array(one) for one in bfs_orient(np.array(mesh.faces)))
    patch = patch.reshape(-1)
    same = np.any([(faces == np.roll(mesh.faces, k, axis=1)).all(axis=1) for k in range(3)], axis=0)
    turn = np.bincount(patch, weights=np.where(same, 1.0, -1.0)) < 0
    found = edges(mesh)
    is_open = np.zeros(len(turn), dtype=np.bool_)
    is_open[patch[(found.uses[found.of_face] != 2).any(axis=1)]] = True
    # The largest faces of every open patch look out along their normals and against them
    t = mesh.vertices[faces]
    normal = np.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0])
    area = np.linalg.norm(normal, axis=1)
    order = np.lexsort((-area, patch))
    rank = np.arange(len(order)) - np.searchsorted(patch[order], patch[order])
    looking = order[(rank < LOOKING) & is_open[patch[order]] & (area[order] > 0)]
    if looking.size:
        unit = normal[looking] / area[looking, None]
        away = 1e-6 * float(np.linalg.norm(np.ptp(mesh.bounds, axis=0)))
        middles = t[looking].mean(axis=1)
        hidden = [
            np.asarray(
                ambient_occlusion(np.array(mesh.vertices), faces, middles + sign * away * unit, sign * unit, RAYS)
            ).reshape(-1)
            for sign in (1.0, -1.0)
        ]
        sky = np.bincount(patch[looking], weights=area[looking] * (hidden[1] - hidden[0]), minlength=len(turn))
        size = np.bincount(patch[looking], weights=area[looking], minlength=len(turn))
        clear = is_open & (np.abs(sky) > 2 / np.sqrt(RAYS) * size)
        turn = np.where(clear, sky < 0, turn)
    return TriangleMesh(vertices=mesh.vertices, faces=np.where(turn[patch][:, None], faces[:, ::-1], faces))


LOOKING, RAYS = 8, 32
"""How many faces of a patch look for the sky, and along how many rays each; what they see differs by chance by 1 / sqrt(rays)."""


# The separate bodies of one mesh: every outer skin with the cavities inside it.


def bodies(mesh: TriangleMesh) -> tuple[TriangleMesh, ...]:
    """The bodies of a `mesh` that has passed `geometry.mesh`, in the order of the first face of their outer skin."""
    every = pieces(mesh)
    skins = [piece for piece in every if piece.volume > 0]
    within: list[list[TriangleMesh]] = [[] for _ in skins]
    for cavity in (piece for piece in every if piece.volume < 0):
        around = [number for number, skin in enumerate(skins) if winding_number(skin, cavity.vertices[0]) == 1]
        within[min(around, key=lambda number: skins[number].volume)].append(cavity)
    return tuple(joined(skin, *cavities) for skin, cavities in zip(skins, within, strict=True))


# Is this mesh the skin of a body? The judge at the door of every mesh, with the evidence in the file's own unit.
#
# A mesh has a volume, and so a mass, when every edge joins exactly two faces that agree on what is outside, and no face runs
# through another one. Several separate pieces are one body in several places. A piece that is inside-out and lies wholly within
# another one is a cavity and takes its volume off; one that is inside-out anywhere else is a mistake. Two pieces of the same
# orientation may touch: the meshes of two curved parts that fit into one another always overlap by a sliver, so a share up to
# `SLIVER` of the smaller one is a warning; more is an overlap, its mass would count twice, and it is refused.

ROUNDING = 16 * float(np.finfo(np.float64).eps)
"""Heights of triangles up to this times the largest coordinate are no more than rounding."""

SLIVER = 0.01
"""Largest share of the smaller piece that two touching pieces may have in common."""

SHOWN = 3
"""Places that a message lists before it says how many more there are."""


def require_closed_volume(mesh: TriangleMesh, source: str, unit: LengthUnit = METRE) -> tuple[str, ...]:
    """Pass only the skin of a body; lengths in messages are in `unit`, that of the file. Returns warnings in words.

    Vertices at exactly the same place are taken as one, whether or not the mesh repeats them.

    Raises
    ------
    BadInput : `mesh` is empty, degenerate (flat, faces without area, doubled faces), open, not a manifold, wound
        inconsistently, inside-out, self-intersecting, or made of pieces that overlap.
    """
    mesh = merged(mesh)
    if not len(mesh.faces):
        raise BadInput(source, "", "the mesh has no faces", "Export the body again as a triangle mesh")
    corners = mesh.triangles.reshape(-1, 3)
    spread = np.linalg.svd(corners - corners.mean(axis=0), compute_uv=False)
    if spread[2] <= ROUNDING * np.sqrt(len(corners)) * np.abs(corners).max():
        problem = f"the mesh is flat: all its {len(mesh.faces)} faces lie in one plane, so that it encloses no volume"
        raise BadInput(source, "", problem, "Export the body, not one of its faces or its drawing")
    t = mesh.triangles
    sides = t - np.roll(t, 1, axis=1)
    longest = np.linalg.norm(sides, axis=2).max(axis=1)
    doubled_area = np.linalg.norm(np.cross(sides[:, 1], sides[:, 2]), axis=1)
    degenerate = doubled_area <= longest * ROUNDING * np.abs(t).max()
    if degenerate.any():
        problem = f"{_count(degenerate.sum(), 'face')} of {len(t)} without area, at {_places(t[degenerate].mean(axis=1), unit)}"
        remedy = "Merge doubled vertices and remove degenerate faces in the program that made the mesh, then export it again"
        raise BadInput(source, "", problem, remedy)
    _, first, count = np.unique(np.sort(mesh.faces, axis=1), axis=0, return_index=True, return_counts=True)
    doubled = first[count > 1]
    if doubled.size:
        middles: Array = mesh.triangles[doubled].mean(axis=1)
        problem = f"{_count(doubled.size, 'face')} given more than once, at {_places(middles, unit)}"
        raise BadInput(source, "", problem, "Remove the doubled faces; if the body was exported twice, export it once")
    found = edges(mesh)
    single, crowded = found.ends[found.uses == 1], found.ends[found.uses > 2]
    if single.size or crowded.size:
        wrong, remedy = len(single) + len(crowded), "Close the holes and take bodies that share an edge apart in the program"
        problem = f"the mesh is not watertight: {wrong} of its {len(found.ends)} edges do not join exactly two faces"
        problem += f"; {_count(len(single), 'open edge')}" + _clusters(mesh, single, "hole", unit)
        if crowded.size:
            problem += f"; {_count(len(crowded), 'edge')} where up to {found.uses.max()} faces meet"
            problem += _clusters(mesh, crowded, "line", unit)
        raise BadInput(source, "", problem, f"{remedy} that made the mesh, then export it again")
    broken = found.turns != 0
    if broken.any():
        raise BadInput(
            source,
            "",
            f"the faces disagree on what is outside along {_count(broken.sum(), 'edge')}, "
            f"at {_places(mesh.vertices[found.ends[broken]].mean(axis=1), unit)}",
            "Make the normals consistent (all outwards) in the program that made the mesh and export it again",
        )
    return _require_simple(mesh, source, unit)


def _clusters(mesh: TriangleMesh, ends: Integers, what: str, unit: LengthUnit) -> str:
    """Where the edges (n, 2) are: `` in 2 holes: 3 edges within (..) to (..); ...``."""
    if not ends.size:
        return ""
    # The edges (n, 2) gathered into connected lines, the longest first
    vertices, index = np.unique(ends, return_inverse=True)
    index = index.reshape(-1, 2)
    label = connected(index, len(vertices))[index[:, 0]]
    clusters = sorted((ends[label == number] for number in range(label.max() + 1)), key=len, reverse=True)
    where = (f"{_count(len(edge), 'edge')} within {_box(mesh.vertices[edge.reshape(-1)], unit)}" for edge in clusters)
    return f" in {_count(len(clusters), what)}: {_listed(where, len(clusters))}"


def _require_simple(mesh: TriangleMesh, source: str, unit: LengthUnit) -> tuple[str, ...]:
    label, bodies = piece_of_face(mesh), pieces(mesh)
    pairs = intersecting_faces(mesh)
    within = label[pairs[:, 0]] == label[pairs[:, 1]]
    if np.any(within):
        raise BadInput(
            source,
            "",
            f"the surface runs through itself: {_count(int(within.sum()), 'pair')} of faces intersect, "
            f"within {_box(mesh.triangles[pairs[within]].reshape(-1, 3), unit)}",
            "Unite the crossing surfaces in the program that made the mesh and export it again",
        )
    volumes = np.array([body.volume for body in bodies])
    if np.all(volumes <= 0):
        problem = f"the mesh is inside-out: its normals point inwards, its volume comes out as {_volume(volumes.sum(), unit)}"
        remedy = "Flip the normals (reverse the faces) in the program that made the mesh and export it again"
        raise BadInput(source, "", problem, remedy)
    touching = np.unique(np.sort(label[pairs[~within]], axis=1), axis=0)
    # Around a body there must be nothing, around a cavity material, as far as they do not touch
    for number, body in enumerate(bodies):
        contacts = set(touching[(touching == number).any(axis=1)].reshape(-1).tolist())
        apart = [other for index, other in enumerate(bodies) if index != number and index not in contacts]
        around = winding_number(joined(*apart), body.vertices[0]) if apart else 0
        if body.volume < 0 and contacts:
            raise _misplaced(body, number, "touches or crosses another piece", source, unit)
        if body.volume < 0 and around != 1:
            raise _misplaced(body, number, "does not lie within another piece", source, unit)
        if body.volume > 0 and around != 0:
            raise _overlap(f"piece {number + 1} lies within another piece", body.volume, body.vertices, source, unit)
    warned = []
    for first, second in touching:
        a, b, both = bodies[first], bodies[second], f"pieces {first + 1} and {second + 1}"
        shared, smaller = shared_volumes((a, b)).get((0, 1), 0.0), min(a.volume, b.volume)
        if shared > SLIVER * smaller:
            common = np.array([np.maximum(a.bounds[0], b.bounds[0]), np.minimum(a.bounds[1], b.bounds[1])])
            raise _overlap(f"{both} overlap", shared, common, source, unit)
        if shared > ROUNDING * smaller:
            said = f"{both} touch and their meshes overlap by {_volume(shared, unit)}"
            warned.append(f"{source}: {said}, {shared / smaller:.2%} of the smaller one, which counts twice")
    return tuple(warned)


def _misplaced(body: TriangleMesh, number: int, what: str, source: str, unit: LengthUnit) -> BadInput:
    problem = f"piece {number + 1} ({_box(body.vertices, unit)}) is inside-out and {what}, so that it is no cavity"
    remedy = "Flip the normals of that piece if it is a body; if it is a cavity, leave a wall around it"
    return BadInput(source, "", problem, remedy)


def _overlap(what: str, volume: float, points: Array, source: str, unit: LengthUnit) -> BadInput:
    problem = f"{what}: {_volume(volume, unit)} within {_box(points, unit)} would count twice"
    remedy = "Unite the pieces or cut one by the other in the program that made them; of a cavity, turn the normals inwards"
    return BadInput(source, "", problem, remedy)


def _count(number: int, what: str) -> str:
    return f"{number} {what}" if number == 1 else f"{number} {what}s"


def _listed(items: Iterable[str], total: int) -> str:
    more = f"; and {total - SHOWN} more" if total > SHOWN else ""
    return "; ".join(islice(items, SHOWN)) + more


def _places(points: Array, unit: LengthUnit) -> str:
    return _listed((unit.shown(point) for point in points), len(points))


def _box(points: Array, unit: LengthUnit) -> str:
    return f"{unit.shown(points.min(axis=0))} to {unit.shown(points.max(axis=0))}"


def _volume(volume: float, unit: LengthUnit) -> str:
    return f"{volume / unit.metres**3:.6g} {unit.name}³"


# STL, PLY and OBJ files: bare numbers that become lengths only with a unit.

MESH_ENDINGS = (".stl", ".ply", ".obj")
"""What can be read, upper or lower case."""

_STATED = re.compile(r"\bunits?\s*[:=]\s*([A-Za-z]+)", re.IGNORECASE)
_COMMENT = {".stl": re.compile(rb"\A.{0,80}", re.DOTALL), ".ply": re.compile(rb"^(?:comment|obj_info).*$", re.MULTILINE)}
_COMMENT[".obj"] = re.compile(rb"^#.*$", re.MULTILINE)


class MeshFile(NamedTuple):
    """What a file holds: the mesh [m], the unit of its numbers, and what was noticed, in words."""

    mesh: TriangleMesh
    unit: LengthUnit
    warnings: tuple[str, ...]


def read_mesh(path: Path, unit: str | None = None) -> MeshFile:
    """The mesh in `path`, its numbers taken in `unit`, or in the unit that the file states in a comment.

    Raises
    ------
    BadInput : no mesh can be read, the unit is not given, unknown, or contradicts the file.
    """
    content = path.read_bytes()
    ending = path.suffix.lower()
    source = str(path)
    require_fetched(content, source)
    if b"\0" not in content[:1024] and b"facet" in content[:1024].lower() and b"endsolid" not in content.lower():
        content += b"\nendsolid"  # without which trimesh finds no face at all; a file that was cut short is found to be open
    # The unit that the file's own comments name, if any
    comments = b"\n".join(_COMMENT[ending].findall(content[:4096])).decode("latin-1")
    found = _STATED.search(comments)
    stated = found.group(1) if found else None
    if unit is None and stated is None:
        problem = "the file does not say in which unit its lengths are, and none was given"
        raise BadInput(source, "unit", problem, f"Give one of {', '.join(UNITS)}")
    meant = length_unit((stated if unit is None else unit) or "", source)
    if unit is not None and stated is not None and meant != length_unit(stated, source):
        problem = f"the unit given is {meant.name}, but the file says of itself that its unit is {stated}"
        raise BadInput(source, "unit", problem, "Leave the unit out to believe the file, or correct the file's comment")
    mesh = scaled(_parsed(content, ending, str(path)), meant.metres)
    return MeshFile(mesh=mesh, unit=meant, warnings=doubts(float(np.ptp(mesh.bounds, axis=0).max()), str(path), meant))


def _parsed(content: bytes, ending: str, source: str) -> TriangleMesh:
    import trimesh

    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            found: Any = trimesh.load_mesh(io.BytesIO(content), file_type=ending[1:], process=False)
            vertices, faces = np.array(found.vertices, dtype=np.float64), np.array(found.faces)
    except Exception as error:  # trimesh's readers raise whatever their parsing stumbles over
        raise _unreadable(ending, "its content does not follow the format", source) from error
    if faces.size == 0:
        raise _unreadable(ending, "no faces in it", source)
    if not np.isfinite(vertices).all():
        number = int((~np.isfinite(vertices)).any(axis=1).sum())
        raise _unreadable(ending, f"{number} of its {len(vertices)} vertices are not finite numbers", source)
    try:
        return merged(TriangleMesh(vertices=vertices, faces=faces))
    except ValueError as error:
        raise _unreadable(ending, str(error), source) from error


def _unreadable(ending: str, why: str, source: str) -> BadInput:
    problem = f"no mesh can be read from it as {ending[1:].upper()} ({' '.join(why.split())[:200]})"
    remedy = "Check that the file is whole and what its ending says, and export it again"
    return BadInput(source, "", problem, remedy)


# Door to trimesh: closed mesh -> `Inertia`, the second of the three routes, and mesh files -> `TriangleMesh`.
#
# trimesh gives mass -1 for an inside-out box and NaN for a flat one without a word, so `geometry.mesh` stands before it.
# Its tensors are matrix entries (products negative integrals, as in Eq. 4) about the *centre of mass*, for the density that it
# is told.


def inertia(mesh: TriangleMesh, density: float, source: str, unit: LengthUnit = METRE) -> Inertia:
    """Inertia about the mesh's origin of the body within `mesh`, of `density` [kg/m³].

    Exact for the polyhedron: Mirtich 1996, "Fast and accurate computation of polyhedral mass properties", as trimesh has it.
    `source` and `unit` are how a refusal names the mesh and its lengths.

    Raises
    ------
    BadInput : the mesh is not the skin of a body; `geometry.mesh` lists the ways.
    """
    require_closed_volume(mesh, source, unit)
    return inertia_unchecked(mesh, density)


def inertia_unchecked(mesh: TriangleMesh, density: float) -> Inertia:
    """As `inertia`, for a mesh that has passed `geometry.mesh` already, or that is a piece of one."""
    from trimesh.triangles import mass_properties

    middle = mesh.bounds.mean(axis=0)  # integrated about its middle, so that a body far from the origin loses no digits
    found: Any = mass_properties(mesh.triangles - middle, density=density)
    return Inertia.from_cog(found.mass, found.center_mass, found.inertia).moved(middle)
