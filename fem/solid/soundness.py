"""What a mesh must be: a face to be held at, every body joined to it by faces, no cell inside out, all the volume drawn."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from fem.solid.elasticity import jacobians, volumes
from fem.solid.mesh import LOCAL_HEX27, SolidMesh
from geometry.arrays import Array, Integers
from geometry.errors import BadInput, CheckFailed

ON_THE_PLANE = 1e-6
"""Distance from the base plane, as a share of the article's size, within which a node lies on it."""

VOLUME = 1e-3
"""Share of a part's volume that its cells may miss. Arcs of degree 2 miss 1.6e-4 of a circle at twelve of them, 8e-4 at eight;
plane faces miss nothing."""

_TETRAHEDRON = tuple(combinations(range(4), 3))
_HEXAHEDRON = tuple(
    tuple(int(node) for node in np.flatnonzero(LOCAL_HEX27[:8, axis] == end)) for axis in range(3) for end in (0.0, 1.0)
)
_FACES = {10: _TETRAHEDRON, 27: _HEXAHEDRON}
"""Corners of the faces of a cell, by its number of nodes."""


def base(mesh: SolidMesh) -> Integers:
    """Nodes on the mounting face, the plane z = min of `mesh`; ascending.

    Raises
    ------
    BadInput : no cell has a face on that plane, so that nothing would be held; the message says what touches it.
    """
    on = _on_the_plane(mesh)
    if not np.any(_held_cells(mesh, on)):
        lowest = mesh.points[np.argmin(mesh.points[:, 2])]
        raise BadInput(
            source="mesh",
            field="base",
            problem=f"no face lies on the lowest plane: the article meets z = {1e3 * lowest[2]:.4g} mm in {int(on.sum())} "
            f"node(s) only, the lowest at {_place(lowest)}, and cannot be held there",
            remedy="Turn it so that its mounting face is a plane and points down, or add the foot it stands on",
        )
    return np.flatnonzero(on)


def require_connected(mesh: SolidMesh) -> None:
    """Refuse a body that no chain of common faces joins to the base; touching in an edge or a point is a hinge, not a joint.

    Raises
    ------
    BadInput : which parts float, where, and how far from the rest.
    """
    label = _joined(mesh)
    loose = np.setdiff1d(label, label[_held_cells(mesh, _on_the_plane(mesh))])
    if not len(loose):
        return
    said = [_floating(mesh, label == k) for k in loose[:3]]
    more = f"; and {len(loose) - 3} more" if len(loose) > 3 else ""
    raise BadInput(
        source="mesh",
        field="parts",
        problem=f"{len(loose)} {'body is' if len(loose) == 1 else 'bodies are'} not joined to the base by any face: "
        f"{'; '.join(said)}{more}",
        remedy="Let the faces coincide in the CAD, or add what joins the bodies",
    )


def require_upright(mesh: SolidMesh) -> None:
    """Refuse cells that are inside out or have no volume.

    Raises
    ------
    CheckFailed : how many, in which parts, and where the worst are.
    """
    least = jacobians(mesh).min(axis=1)
    bad = np.flatnonzero(least <= 0)
    if not len(bad):
        return
    worst = bad[np.argsort(least[bad], kind="stable")][:3]
    places = "; ".join(f"{mesh.parts[mesh.part[cell]]} at {_place(mesh.points[mesh.cells[cell]].mean(axis=0))}" for cell in worst)
    raise CheckFailed(
        f"{len(bad)} of {len(mesh.cells)} elements are inverted, the worst in {places}. Give a smaller element size",
        elements=bad,
    )


def require_filled(mesh: SolidMesh, drawn: Sequence[float]) -> None:
    """Refuse a mesh that is not as large as its drawing; arguments as of `unfilled`.

    Raises
    ------
    CheckFailed : which parts, and how much of each is missing or too much.
    """
    if words := unfilled(mesh, drawn):
        raise CheckFailed(f"{words}. Give a smaller element size")


def unfilled(mesh: SolidMesh, drawn: Sequence[float] | Array) -> str:
    """Which parts' cells are not as large as drawn, in words; nothing when all are.

    Cells far larger than the curvature of a face can be upright and yet cut a part off: a rod has lost 41 % of its volume so.

    Parameters
    ----------
    drawn : (parts,) volume [m³] of each part, from its drawing and not from a mesh
    """
    found = np.bincount(mesh.part, weights=volumes(mesh), minlength=len(mesh.parts))
    error = found / np.asarray(drawn) - 1
    bad = np.flatnonzero(~(np.abs(error) <= VOLUME))
    said = [f"{abs(error[k]):.2%} of {mesh.parts[k]} {'are missing' if error[k] < 0 else 'are too much'}" for k in bad]
    return f"the elements do not fill the drawing: {', '.join(said)} ({VOLUME:.1%} allowed)" if said else ""


def _on_the_plane(mesh: SolidMesh) -> np.ndarray:
    z = mesh.points[:, 2]
    return np.asarray(z <= z.min() + ON_THE_PLANE * np.ptp(mesh.points, axis=0).max())


def _held_cells(mesh: SolidMesh, on: np.ndarray) -> np.ndarray:
    """Whether a cell has all corners of a face among the nodes `on`; (c,)."""
    corners = on[mesh.cells]
    return np.asarray(np.any([corners[:, list(face)].all(axis=1) for face in _faces(mesh)], axis=0))


def _faces(mesh: SolidMesh) -> Sequence[tuple[int, ...]]:
    return _FACES[mesh.cells.shape[1]]


def _joined(mesh: SolidMesh) -> Integers:
    """Number of the body of cells joined by faces that each cell belongs to; (c,)."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    faces = np.sort(np.vstack([mesh.cells[:, list(face)] for face in _faces(mesh)]), axis=1)
    cell = np.tile(np.arange(len(mesh.cells)), len(_faces(mesh)))
    order = np.lexsort(faces.T)
    same = np.all(faces[order][1:] == faces[order][:-1], axis=1)
    a, b = cell[order][:-1][same], cell[order][1:][same]
    graph = coo_array((np.ones(len(a), dtype=np.int8), (a, b)), shape=(len(mesh.cells),) * 2)
    return np.asarray(connected_components(graph, directed=False)[1], dtype=np.intp)


def _floating(mesh: SolidMesh, cells: np.ndarray) -> str:
    from scipy.spatial import cKDTree

    own, others = np.unique(mesh.cells[cells]), np.unique(mesh.cells[~cells])
    names = ", ".join(mesh.parts[k] for k in np.unique(mesh.part[cells]))
    if not len(others):
        return names
    distance, _ = cKDTree(mesh.points[others]).query(mesh.points[own])
    nearest = int(np.argmin(distance))
    return f"{names} (its node at {_place(mesh.points[own[nearest]])} is {1e3 * distance[nearest]:.3g} mm from the nearest other)"


def _place(point: Array) -> str:
    return "(" + ", ".join(f"{1e3 * value:.1f}" for value in point) + ") mm"
