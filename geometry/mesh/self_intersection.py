"""Door to libigl: where a surface runs through itself, and how much space two bodies share.

Both answers come from CGAL in exact arithmetic (`igl.copyleft.cgal`, which carries CGAL's GPL; the rest of libigl is MPL): faces
that share a corner or an edge are not reported; faces that run through one another or lie on one another are, without tolerance.
"""

from __future__ import annotations

import numpy as np

from geometry.arrays import Array
from geometry.mesh.triangles import Integers, TriangleMesh


def intersecting_faces(mesh: TriangleMesh) -> Integers:
    """Pairs (p, 2) of faces of `mesh` that have more in common than the corners they share; every face must have an area."""
    from igl.copyleft.cgal import remesh_self_intersections

    if not len(mesh.faces):
        return np.empty((0, 2), dtype=np.int64)
    pairs = remesh_self_intersections(mesh.vertices, mesh.faces, detect_only=True)[2]
    return np.sort(np.asarray(pairs, dtype=np.int64), axis=1)


def shared_volume(first: TriangleMesh, second: TriangleMesh) -> float:
    """Volume [m³] that belongs to both bodies; each closed and free of self-intersections."""
    from igl.copyleft.cgal import mesh_boolean

    vertices, faces, _ = mesh_boolean(first.vertices, first.faces, second.vertices, second.faces, "intersect")
    return TriangleMesh(vertices=vertices, faces=faces).volume if len(faces) else 0.0


def winding_number(mesh: TriangleMesh, point: Array) -> int:
    """How many times `mesh` encloses `point` (3,) [m], which must not lie on it."""
    from igl import winding_number as enclosed

    return round(float(enclosed(mesh.vertices, mesh.faces, point.reshape(1, 3))[0]))
