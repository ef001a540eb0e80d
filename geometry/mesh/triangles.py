"""`TriangleMesh`: a surface of triangles as two arrays, and what can be read from the arrays alone."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array, frozen
from geometry.frames import Pose

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


def turned(mesh: TriangleMesh) -> TriangleMesh:
    """`mesh` with its inside out."""
    return TriangleMesh(vertices=mesh.vertices, faces=mesh.faces[:, ::-1])


def placed(mesh: TriangleMesh, pose: Pose) -> TriangleMesh:
    """`mesh`, given in its own frame, seen in the outer frame of `pose`."""
    return TriangleMesh(vertices=pose.apply(mesh.vertices), faces=mesh.faces)


def scaled(mesh: TriangleMesh, factor: float) -> TriangleMesh:
    """`mesh` with every length times `factor`, which must be positive."""
    return TriangleMesh(vertices=mesh.vertices * factor, faces=mesh.faces)
