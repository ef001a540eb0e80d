"""What a picture of a mode draws: bodies fine enough to bend, with the displacement of every vertex."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array, frozen
from validation.pictures.bodies import DrawnBody

CREASE = 30.0
"""Faces that meet at more than this angle [°] have an edge worth drawing."""

PASSES = 10
"""Of halving at most: a plate of one metre comes down to a millimetre."""

Integers = npt.NDArray[np.int64]


@dataclass(frozen=True, eq=False, kw_only=True)
class MovingBody:
    """One body of a mode's picture.

    Attributes
    ----------
    name : as in the article
    vertices : (n, 3) [m], at rest, in the article's frame
    faces : (k, 3), indices of the vertices of each triangle
    edges : (e, 2), indices of the ends of each piece of a sharp edge
    displacement : (n, 3), of the mode, in any scale that all bodies of the picture share
    """

    name: str
    vertices: Array
    faces: Integers
    edges: Integers
    displacement: Array

    def __post_init__(self) -> None:
        n = len(self.vertices)
        object.__setattr__(self, "vertices", frozen(self.vertices, (n, 3), "vertices"))
        object.__setattr__(self, "displacement", frozen(self.displacement, (n, 3), "displacement"))

    @property
    def size(self) -> Array:
        """Length of the displacement (n,)."""
        return np.asarray(np.linalg.norm(self.displacement, axis=1))


def bendable(body: DrawnBody, longest: float) -> DrawnBody:
    """`body` with its triangles halved until no side is longer than `longest` [m]; the surface stays the same and closed."""
    mesh = _poly(body).subdivide_adaptive(max_edge_len=longest, max_tri_area=np.inf, max_n_passes=PASSES)
    return DrawnBody(
        name=body.name,
        material=body.material,
        vertices=np.asarray(mesh.points, dtype=np.float64),
        faces=mesh.faces.reshape(-1, 4)[:, 1:],
        counted=body.counted,
    )


def sharp_edges(body: DrawnBody) -> Integers:
    """The edges (e, 2) of `body` where its faces meet at an angle, as indices of its vertices."""
    mesh = _poly(body)
    mesh.point_data["number"] = np.arange(len(body.vertices))
    edges = mesh.extract_feature_edges(CREASE, boundary_edges=False, manifold_edges=False, non_manifold_edges=False)
    if not edges.n_cells:
        return np.zeros((0, 2), dtype=np.int64)
    return np.asarray(edges.point_data["number"][edges.lines.reshape(-1, 3)[:, 1:]], dtype=np.int64)


def largest(bodies: Sequence[MovingBody]) -> float:
    """Length of the largest displacement of all `bodies`."""
    return max((float(body.size.max(initial=0.0)) for body in bodies), default=0.0)


def _poly(body: DrawnBody):  # type: ignore[no-untyped-def]  # a `pyvista.PolyData`; the library is imported inside
    import pyvista

    return pyvista.PolyData(np.array(body.vertices), np.column_stack([np.full(len(body.faces), 3), body.faces]).ravel())
