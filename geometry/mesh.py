"""The door to trimesh: a closed triangle mesh and its inertia."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array
from geometry.errors import BadInput
from geometry.inertia import Inertia


@dataclass(frozen=True, eq=False, kw_only=True)
class TriangleMesh:
    """Triangles: `vertices` (n, 3) [m] and `faces` (k, 3), counter-clockwise seen from outside."""

    vertices: Array
    faces: npt.NDArray[np.int64]


def inertia(mesh: TriangleMesh, density: float, source: str) -> Inertia:
    """Inertia of a closed mesh of uniform `density` [kg/m³], about the mesh's origin."""
    import trimesh

    body = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    if not body.is_volume:
        raise BadInput(source=source, problem="the mesh is not a closed volume", remedy="Close it")
    body.density = density
    return Inertia.from_cog(body.mass, body.center_mass, body.moment_inertia)
