"""Solids turned into closed triangle meshes with a stated chord error."""

from __future__ import annotations

import numpy as np

from geometry.article import Part
from geometry.cad.solids import MM, OccShape, solid
from geometry.mesh import TriangleMesh

ANGLE = 0.5
"""Largest angle between neighbouring facets [rad]: small holes keep at least twelve sides whatever the chord error."""

WELD = 1e-6
"""Vertices of neighbouring faces closer than this [mm] are one; OCC discretises a shared edge once, so they coincide."""


def tessellate(part: Part, chord: float) -> TriangleMesh:
    """Closed mesh of `part` in the article's frame; no chord lies further than `chord` [m] from the true surface."""
    return tessellate_solid(solid(part), chord)


def tessellate_solid(shape: OccShape, chord: float) -> TriangleMesh:
    """Closed mesh [m] of a CadQuery shape [mm] with chord error `chord` [m], vertices of neighbouring faces welded."""
    from OCP.BRepMesh import BRepMesh_IncrementalMesh
    from OCP.BRepTools import BRepTools

    BRepTools.Clean_s(shape.wrapped)  # OCC keeps a finer mesh made before; the chord error asked for is the one given
    # CadQuery by itself would take the chord error relative to each edge's length; here it is a length.
    BRepMesh_IncrementalMesh(shape.wrapped, chord / MM, False, ANGLE)
    points, triangles = shape.tessellate(chord / MM, ANGLE)
    vertices = np.array([point.toTuple() for point in points])
    _, first, welded = np.unique(np.round(vertices / WELD).astype(np.int64), axis=0, return_index=True, return_inverse=True)
    return TriangleMesh(vertices=vertices[first] * MM, faces=welded.ravel()[np.array(triangles)])
