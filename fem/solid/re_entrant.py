"""Re-entrant edges, found in a mesh: where the material around an edge of the skin fills more than half a turn.

The angles of all tetrahedra at an edge add up to the angle of the material there, whatever faces, bodies and seams meet in
it. The elastic stress is singular at such an edge, and uniform meshes converge slowly there (Williams, J. Appl. Mech. 19,
1952, 526).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from geometry.arrays import Array

HALF_A_TURN = np.deg2rad(200.0)
"""A flat skin has 180 degrees, and a coarse mesh of a round hole a little more."""

FULL_TURN = np.deg2rad(359.0)
"""Edges inside the material have it."""

_EDGES = ((0, 1), (1, 2), (0, 2), (0, 3), (2, 3), (1, 3))


def curves(gmsh: Any) -> list[int]:
    """Tags of the curves of the current model, meshed with first-order tetrahedra, that are re-entrant."""
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    place = np.argsort(tags)
    points = np.reshape(coordinates, (-1, 3))[place]
    number = np.zeros(int(max(tags)) + 1, dtype=np.int64)
    number[np.sort(tags)] = np.arange(len(tags))
    cells = number[np.concatenate(gmsh.model.mesh.getElements(3)[2]).astype(np.int64)].reshape(-1, 4)
    edges, angles = edge_angles(points, cells)
    sharp = {tuple(edge) for edge in edges[(angles > HALF_A_TURN) & (angles < FULL_TURN)].tolist()}
    return [curve for _, curve in gmsh.model.getEntities(1) if _is_sharp(gmsh, curve, number, sharp)]


def edge_angles(points: Array, cells: Any) -> tuple[Any, Array]:
    """Edges (e, 2) of the tetrahedra `cells` (c, 4), lower node first, and the angle [rad] of the material around each (e,)."""
    pairs, angles = [], []
    for a, b in _EDGES:
        c, d = (other for other in range(4) if other not in (a, b))
        pairs.append(np.sort(cells[:, [a, b]], axis=1))
        angles.append(_dihedral(*(points[cells[:, corner]] for corner in (a, b, c, d))))
    edges, where = np.unique(np.vstack(pairs), axis=0, return_inverse=True)
    return edges, np.asarray(np.bincount(where.ravel(), weights=np.concatenate(angles)), dtype=np.float64)


def _dihedral(a: Array, b: Array, c: Array, d: Array) -> Array:
    """Angle between the faces abc and abd along ab (n,)."""
    along = (b - a) / np.linalg.norm(b - a, axis=1, keepdims=True)
    sides = [v - np.sum(v * along, axis=1, keepdims=True) * along for v in (c - a, d - a)]
    cross = np.linalg.norm(np.cross(*sides), axis=1)
    return np.asarray(np.arctan2(cross, np.sum(sides[0] * sides[1], axis=1)))


def _is_sharp(gmsh: Any, curve: int, number: Any, sharp: set[tuple[int, ...]]) -> bool:
    """Whether half of the curve's edges or more are among `sharp`."""
    nodes = [np.reshape(group, (-1, 2)) for group in gmsh.model.mesh.getElements(1, curve)[2]]
    if not nodes:
        return False
    edges = np.sort(number[np.vstack(nodes).astype(np.int64)], axis=1).tolist()
    return 2 * sum(tuple(edge) in sharp for edge in edges) >= len(edges)
