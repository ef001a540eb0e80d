"""Small meshes of a block, hexahedra or the tetrahedra that these are cut into, straight or bent by a function."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import permutations

import numpy as np

from fem.solid.mesh import LOCAL_HEX27, LOCAL_TET10, SolidMesh
from geometry.arrays import Array, Integers

HEX, TET = 27, 10
"""Nodes of a cell: hexahedra and tetrahedra."""

PART = "block"


def block(
    sides: Sequence[float], counts: Sequence[int], nodes: int = HEX, bent: Callable[[Array], Array] | None = None
) -> SolidMesh:
    """A block from the origin to `sides` [m] in `counts` cells along each side, every cell six tetrahedra where `nodes` is TET.

    `bent` gives the places (p, 3) [m] of the mesh's points instead of their straight ones.
    """
    grid = 2 * np.asarray(counts) + 1
    places = np.stack(np.meshgrid(*(np.linspace(0, L, n) for L, n in zip(sides, grid, strict=True)), indexing="ij"), axis=-1)
    points = places.reshape(-1, 3)
    corners = 2 * np.stack(np.meshgrid(*(np.arange(n) for n in counts), indexing="ij"), axis=-1).reshape(-1, 1, 1, 3)
    steps = (corners + _cells(nodes)).reshape(-1, nodes, 3)
    cells: Integers = np.ravel_multi_index(np.moveaxis(steps, -1, 0), tuple(grid))
    moved = points if bent is None else bent(points)
    return SolidMesh(points=moved, cells=cells, part=np.zeros(len(cells), dtype=np.intp), parts=(PART,))


def _cells(nodes: int) -> Integers:
    """Half steps (k, nodes, 3) from a hexahedron's low corner to the nodes of the k cells that it is made of."""
    if nodes == HEX:
        return np.rint(2 * LOCAL_HEX27).astype(np.intp)[None]
    # Kuhn's six tetrahedra: from corner to opposite corner along the three edges in every order.
    paths = [np.cumsum([np.zeros(3), *np.eye(3)[list(order)]], axis=0) for order in permutations(range(3))]
    turned = [path if np.linalg.det(path[1:] - path[0]) > 0 else path[[0, 2, 1, 3]] for path in paths]
    return np.array([np.rint(2 * (path[0] + LOCAL_TET10 @ (path[1:] - path[0]))) for path in turned], dtype=np.intp)
