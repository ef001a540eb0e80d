"""Door to trimesh: closed mesh -> `Inertia`, the second of the three routes, and mesh files -> `TriangleMesh`.

trimesh gives mass -1 for an inside-out box and NaN for a flat one without a word, so `geometry.mesh.checks` stands before it. Its
tensors are matrix entries (products negative integrals, as in Eq. 4) about the *centre of mass*, for the density that it is told.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy.typing as npt

from geometry.arrays import Array
from geometry.inertia import Inertia
from geometry.lengths import METRE, LengthUnit
from geometry.mesh.checks import require_closed_volume
from geometry.mesh.triangles import TriangleMesh


class MassProperties(NamedTuple):
    """Mass properties as trimesh has them: `mass` [kg], `center_mass` (3,) [m], `inertia` (3, 3) [kg m²] about it."""

    mass: float
    center_mass: Array
    inertia: Array


def from_trimesh(mass: float, center_mass: npt.ArrayLike, inertia: npt.ArrayLike) -> Inertia:
    """From trimesh's mass [kg], centre of mass (3,) [m] and tensor (3, 3) [kg m²] about it; the result is about the origin."""
    return Inertia.from_cog(mass, center_mass, inertia)


def to_trimesh(inertia: Inertia) -> MassProperties:
    """Mass, centre of mass and the tensor about it, as trimesh has them; the mass must not be zero."""
    return MassProperties(mass=inertia.mass, center_mass=inertia.cog, inertia=inertia.tensor_cog)


def inertia(mesh: TriangleMesh, density: float, source: str, unit: LengthUnit = METRE) -> Inertia:
    """Inertia about the mesh's origin of the body within `mesh`, of `density` [kg/m³].

    Exact for the polyhedron: Mirtich 1996, "Fast and accurate computation of polyhedral mass properties", as trimesh has it.
    `source` and `unit` are how a refusal names the mesh and its lengths.

    Raises
    ------
    BadInput : the mesh is not the skin of a body; `geometry.mesh.checks` lists the ways.
    """
    require_closed_volume(mesh, source, unit)
    return inertia_unchecked(mesh, density)


def inertia_unchecked(mesh: TriangleMesh, density: float) -> Inertia:
    """As `inertia`, for a mesh that has passed `geometry.mesh.checks` already, or that is a piece of one."""
    from trimesh.triangles import mass_properties

    middle = mesh.bounds.mean(axis=0)  # integrated about its middle, so that a body far from the origin loses no digits
    found: Any = mass_properties(mesh.triangles - middle, density=density)
    return from_trimesh(found.mass, found.center_mass, found.inertia).moved(middle)
