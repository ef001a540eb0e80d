"""Is this mesh the skin of a body? The judge at the door of every mesh, with the evidence in the file's own unit.

A mesh has a volume, and so a mass, when every edge joins exactly two faces that agree on what is outside, and no face runs
through another one. Several separate pieces are one body in several places. A piece that is inside-out and lies wholly within
another one is a cavity and takes its volume off; one that is inside-out anywhere else is a mistake. Two pieces of the same
orientation may touch: the meshes of two curved parts that fit into one another always overlap by a sliver, so a share up to
`SLIVER` of the smaller one is a warning; more is an overlap, its mass would count twice, and it is refused.
"""

from __future__ import annotations

from collections.abc import Iterable
from itertools import islice

import numpy as np

from geometry.arrays import Array
from geometry.errors import BadInput
from geometry.lengths import METRE, LengthUnit
from geometry.mesh.self_intersection import intersecting_faces, shared_volume, winding_number
from geometry.mesh.triangles import Edges, Integers, TriangleMesh, connected, edges, joined, merged, piece_of_face, pieces

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
    _require_extent(mesh, source)
    _require_areas(mesh, source, unit)
    _require_single_faces(mesh, source, unit)
    found = edges(mesh)
    _require_watertight(mesh, found, source, unit)
    _require_one_outside(mesh, found, source, unit)
    return _require_simple(mesh, source, unit)


# --- triangles ------------------------------------------------------------------------------------------------------------


def _require_extent(mesh: TriangleMesh, source: str) -> None:
    if not len(mesh.faces):
        raise BadInput(source=source, problem="the mesh has no faces", remedy="Export the body again as a triangle mesh")
    corners = mesh.triangles.reshape(-1, 3)
    spread = np.linalg.svd(corners - corners.mean(axis=0), compute_uv=False)
    if spread[2] <= ROUNDING * np.sqrt(len(corners)) * np.abs(corners).max():
        raise BadInput(
            source=source,
            problem=f"the mesh is flat: all its {len(mesh.faces)} faces lie in one plane, so that it encloses no volume",
            remedy="Export the body, not one of its faces or its drawing",
        )


def _require_areas(mesh: TriangleMesh, source: str, unit: LengthUnit) -> None:
    t = mesh.triangles
    sides = t - np.roll(t, 1, axis=1)
    longest = np.linalg.norm(sides, axis=2).max(axis=1)
    doubled_area = np.linalg.norm(np.cross(sides[:, 1], sides[:, 2]), axis=1)
    degenerate = doubled_area <= longest * ROUNDING * np.abs(t).max()
    if degenerate.any():
        raise BadInput(
            source=source,
            problem=f"{_count(degenerate.sum(), 'face')} of {len(t)} without area, "
            f"at {_places(t[degenerate].mean(axis=1), unit)}",
            remedy="Merge doubled vertices and remove degenerate faces in the program that made the mesh, then export it again",
        )


def _require_single_faces(mesh: TriangleMesh, source: str, unit: LengthUnit) -> None:
    _, first, count = np.unique(np.sort(mesh.faces, axis=1), axis=0, return_index=True, return_counts=True)
    doubled = first[count > 1]
    if doubled.size:
        raise BadInput(
            source=source,
            problem=f"{_count(doubled.size, 'face')} given more than once, at {_places(_middles(mesh, doubled), unit)}",
            remedy="Remove the doubled faces; if the body was exported twice, export it once",
        )


# --- edges ----------------------------------------------------------------------------------------------------------------


def _require_watertight(mesh: TriangleMesh, found: Edges, source: str, unit: LengthUnit) -> None:
    single, crowded = found.ends[found.uses == 1], found.ends[found.uses > 2]
    if not single.size and not crowded.size:
        return
    problem = (
        f"the mesh is not watertight: {len(single) + len(crowded)} of its {len(found.ends)} edges do not join exactly two faces"
    )
    problem += f"; {_count(len(single), 'open edge')}" + _clusters(mesh, single, "hole", unit)
    if crowded.size:
        problem += f"; {_count(len(crowded), 'edge')} where up to {found.uses.max()} faces meet"
        problem += _clusters(mesh, crowded, "line", unit)
    raise BadInput(
        source=source,
        problem=problem,
        remedy="Close the holes and take bodies that share an edge apart in the program that made the mesh, then export it again",
    )


def _require_one_outside(mesh: TriangleMesh, found: Edges, source: str, unit: LengthUnit) -> None:
    broken = found.turns != 0
    if broken.any():
        raise BadInput(
            source=source,
            problem=f"the faces disagree on what is outside along {_count(broken.sum(), 'edge')}, "
            f"at {_places(mesh.vertices[found.ends[broken]].mean(axis=1), unit)}",
            remedy="Make the normals consistent (all outwards) in the program that made the mesh and export it again",
        )


def _clusters(mesh: TriangleMesh, ends: Integers, what: str, unit: LengthUnit) -> str:
    """Where the edges (n, 2) are: `` in 2 holes: 3 edges within (..) to (..); ...``."""
    if not ends.size:
        return ""
    clusters = _connected(ends)
    where = (f"{_count(len(edge), 'edge')} within {_box(mesh.vertices[edge.reshape(-1)], unit)}" for edge in clusters)
    return f" in {_count(len(clusters), what)}: {_listed(where, len(clusters))}"


def _connected(ends: Integers) -> list[Integers]:
    """The edges (n, 2) gathered into connected lines, the longest first."""
    vertices, index = np.unique(ends, return_inverse=True)
    index = index.reshape(-1, 2)
    label = connected(index, len(vertices))[index[:, 0]]
    return sorted((ends[label == number] for number in range(label.max() + 1)), key=len, reverse=True)


# --- pieces ---------------------------------------------------------------------------------------------------------------


def _require_simple(mesh: TriangleMesh, source: str, unit: LengthUnit) -> tuple[str, ...]:
    label, bodies = piece_of_face(mesh), pieces(mesh)
    pairs = intersecting_faces(mesh)
    within = label[pairs[:, 0]] == label[pairs[:, 1]]
    _require_no_crossing(mesh, pairs[within], source, unit)
    _require_orientation(bodies, source, unit)
    touching = np.unique(np.sort(label[pairs[~within]], axis=1), axis=0)
    _require_nested_cavities(bodies, touching, source, unit)
    return tuple(
        warning for first, second in touching if (warning := _contact(bodies, int(first), int(second), source, unit)) is not None
    )


def _require_no_crossing(mesh: TriangleMesh, pairs: Integers, source: str, unit: LengthUnit) -> None:
    if pairs.size:
        raise BadInput(
            source=source,
            problem=f"the surface runs through itself: {_count(len(pairs), 'pair')} of faces intersect, "
            f"within {_box(mesh.triangles[pairs].reshape(-1, 3), unit)}",
            remedy="Unite the crossing surfaces in the program that made the mesh and export it again",
        )


def _require_orientation(bodies: tuple[TriangleMesh, ...], source: str, unit: LengthUnit) -> None:
    volumes = np.array([body.volume for body in bodies])
    if np.all(volumes <= 0):
        raise BadInput(
            source=source,
            problem=f"the mesh is inside-out: its normals point inwards, its volume comes out as {_volume(volumes.sum(), unit)}",
            remedy="Flip the normals (reverse the faces) in the program that made the mesh and export it again",
        )


def _require_nested_cavities(bodies: tuple[TriangleMesh, ...], touching: Integers, source: str, unit: LengthUnit) -> None:
    """Around a body there must be nothing, around a cavity material, as far as they do not touch."""
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


def _contact(bodies: tuple[TriangleMesh, ...], first: int, second: int, source: str, unit: LengthUnit) -> str | None:
    a, b = bodies[first], bodies[second]
    shared = shared_volume(a, b)
    if shared > SLIVER * min(a.volume, b.volume):
        raise _overlap(f"pieces {first + 1} and {second + 1} overlap", shared, _common(a, b), source, unit)
    if shared > ROUNDING * min(a.volume, b.volume):
        return (
            f"{source}: pieces {first + 1} and {second + 1} touch and their meshes overlap by {_volume(shared, unit)}, "
            f"{shared / min(a.volume, b.volume):.2%} of the smaller one, which counts twice"
        )
    return None


def _misplaced(body: TriangleMesh, number: int, what: str, source: str, unit: LengthUnit) -> BadInput:
    return BadInput(
        source=source,
        problem=f"piece {number + 1} ({_box(body.vertices, unit)}) is inside-out and {what}, so that it is no cavity",
        remedy="Flip the normals of that piece if it is a body; if it is a cavity, leave a wall around it",
    )


def _overlap(what: str, volume: float, points: Array, source: str, unit: LengthUnit) -> BadInput:
    return BadInput(
        source=source,
        problem=f"{what}: {_volume(volume, unit)} within {_box(points, unit)} would count twice",
        remedy="Unite the pieces or cut one by the other in the program that made them; of a cavity, turn the normals inwards",
    )


def _common(a: TriangleMesh, b: TriangleMesh) -> Array:
    """Two corners of the box that the boxes around `a` and `b` have in common."""
    return np.array([np.maximum(a.bounds[0], b.bounds[0]), np.minimum(a.bounds[1], b.bounds[1])])


# --- words ----------------------------------------------------------------------------------------------------------------


def _count(number: int, what: str) -> str:
    return f"{number} {what}" if number == 1 else f"{number} {what}s"


def _listed(items: Iterable[str], total: int) -> str:
    more = f"; and {total - SHOWN} more" if total > SHOWN else ""
    return "; ".join(islice(items, SHOWN)) + more


def _places(points: Array, unit: LengthUnit) -> str:
    return _listed((unit.shown(point) for point in points), len(points))


def _box(points: Array, unit: LengthUnit) -> str:
    return f"{unit.shown(points.min(axis=0))} to {unit.shown(points.max(axis=0))}"


def _middles(mesh: TriangleMesh, faces: Integers) -> Array:
    middles: Array = mesh.triangles[faces].mean(axis=1)
    return middles


def _volume(volume: float, unit: LengthUnit) -> str:
    return f"{volume / unit.metres**3:.6g} {unit.name}³"
