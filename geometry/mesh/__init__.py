"""The door to trimesh and libigl: triangle meshes, whether they are the skin of a body, and the inertia of what they enclose.

=================== ============================================================================================
triangles           `TriangleMesh` and what its two arrays tell: edges, pieces, volume
checks              the judge: open, inside-out, self-intersecting, degenerate, overlapping
self_intersection   libigl's exact intersections
mass                trimesh's mass properties and `Inertia`, there and back
files               STL, PLY and OBJ, with the unit that a file states about itself
=================== ============================================================================================
"""

from geometry.mesh.mass import MassProperties, from_trimesh, inertia, inertia_unchecked, to_trimesh
from geometry.mesh.triangles import TriangleMesh

__all__ = ["MassProperties", "TriangleMesh", "from_trimesh", "inertia", "inertia_unchecked", "to_trimesh"]
