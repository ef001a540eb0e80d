"""Exact mass properties of OCC solids: the faces' own surfaces are integrated, nothing is meshed."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from geometry.article import Article
from geometry.cad.solids import MM, OccShape, solid
from geometry.inertia import Inertia

INTEGRATION_ERROR = 1e-12
"""Relative error asked of OCC's adaptive integration over curved faces."""


def inertia(article: Article) -> Inertia:
    """Inertia of the article's counted parts from their B-rep, about the article's origin, in its frame."""
    total = Inertia(parameters=np.zeros(10))
    for part in article.counted_parts:
        total = total + from_occ(solid(part), part.material.density)
    return total


def from_occ(shape: OccShape, density: float) -> Inertia:
    """Inertia of a CadQuery shape [mm] of uniform `density` [kg/m³], about the origin of the shape's frame.

    OCC integrates at unit density: volume in mm³, tensor about the centre of mass in mm⁵, products as matrix entries.
    """
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps

    properties = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape.wrapped, properties, INTEGRATION_ERROR, False, False)
    centre, matrix = properties.CentreOfMass(), properties.MatrixOfInertia()
    tensor = np.array([[matrix.Value(i, j) for j in (1, 2, 3)] for i in (1, 2, 3)])
    return Inertia.from_cog(
        density * properties.Mass() * MM**3,
        np.array([centre.X(), centre.Y(), centre.Z()]) * MM,
        density * tensor * MM**5,
    )


def to_occ(inertia: Inertia) -> tuple[float, tuple[float, float, float], tuple[tuple[float, ...], ...]]:
    """Mass [kg], CoG [mm] and tensor about the CoG [kg mm²] as nested tuples: what a CAD's mass-property sheet lists."""
    x, y, z = (inertia.cog / MM).tolist()
    return inertia.mass, (x, y, z), tuple(tuple(row) for row in (inertia.tensor_cog / MM**2).tolist())


def overlaps(article: Article) -> dict[tuple[str, str], float]:
    """Pairs of parts that share volume, and how much [m³], by intersecting their B-reps.

    Every part is looked at, counted or not. Contact without common volume is no overlap; what counts as none is relative, a
    part in 1e9 of the smaller body, since OCC's intersection of touching cylinders may leave slivers.
    """
    solids = {part.name: solid(part) for part in article.parts}
    volumes = {name: shape.Volume() for name, shape in solids.items()}
    shared = {
        (a, b): solids[a].intersect(solids[b]).Volume() for a, b in combinations(solids, 2) if _boxes_meet(solids[a], solids[b])
    }
    return {pair: v * MM**3 for pair, v in shared.items() if v > 1e-9 * min(volumes[pair[0]], volumes[pair[1]])}


def _boxes_meet(a: OccShape, b: OccShape) -> bool:
    """Whether the axis-aligned bounding boxes share a volume."""
    p, q = a.BoundingBox(), b.BoundingBox()
    lower = np.maximum([p.xmin, p.ymin, p.zmin], [q.xmin, q.ymin, q.zmin])
    upper = np.minimum([p.xmax, p.ymax, p.zmax], [q.xmax, q.ymax, q.zmax])
    return bool(np.all(upper > lower))
