"""A spatial frame of Rayleigh beams: straight elements with axial, torsional and bending stiffness and rotary inertia.

The element is the classical cubic one (Przemieniecki, Theory of Matrix Structural Analysis, chapters 5 and 11, without shear
deformation). Its shape functions hold every rigid motion, so the assembled mass matrix carries the rigid-body inertia exactly.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array, frozen


@dataclass(frozen=True, eq=False, kw_only=True)
class Section:
    """Stiffness and inertia of a beam per unit length, in the section's own axes y, z.

    Attributes
    ----------
    axial : E A [N]
    torsion : G J [N m²]
    bending_y, bending_z : E I about the section's y and z axes [N m²]
    mass : [kg/m]
    rotary_y, rotary_z : rho I about the section's y and z axes [kg m]
    """

    axial: float
    torsion: float
    bending_y: float
    bending_z: float
    mass: float
    rotary_y: float
    rotary_z: float


@dataclass(frozen=True, eq=False, kw_only=True)
class Member:
    """A chain of equal elements along nodes, all with one section.

    Attributes
    ----------
    nodes : indices of the nodes in order
    section : what every element of it is made of
    z_axis : (3,) unit vector, the section's z axis in the frame; perpendicular to the member
    """

    nodes: tuple[int, ...]
    section: Section
    z_axis: Array

    def __post_init__(self) -> None:
        object.__setattr__(self, "z_axis", frozen(self.z_axis, (3,), "z_axis"))


def assemble(nodes: npt.ArrayLike, members: Iterable[Member]) -> tuple[Array, Array]:
    """Stiffness and mass of the frame.

    Parameters
    ----------
    nodes : (n, 3) [m]
    members : the beams between them

    Returns
    -------
    K, M : (6 n, 6 n) [N/m, N, N m] and [kg, kg m, kg m²]; x, y, z, alpha, beta, gamma of node 0, then of node 1 ...
    """
    points = np.asarray(nodes, dtype=np.float64)
    K, M = np.zeros((2, 6 * len(points), 6 * len(points)))
    for member in members:
        for a, b in pairwise(member.nodes):
            k, m = _element(points[a], points[b], member.section, member.z_axis)
            dofs = np.ix_(_dofs(a, b), _dofs(a, b))
            K[dofs] += k
            M[dofs] += m
    return K, M


def add_lumped(M: Array, node: int, mass_matrix: Array) -> None:
    """Add a rigid body's 6x6 mass matrix about `node` to the frame's `M`, in place."""
    M[6 * node : 6 * node + 6, 6 * node : 6 * node + 6] += mass_matrix


def _dofs(a: int, b: int) -> list[int]:
    return [*range(6 * a, 6 * a + 6), *range(6 * b, 6 * b + 6)]


def _element(start: Array, end: Array, section: Section, z_axis: Array) -> tuple[Array, Array]:
    """Stiffness and mass (12, 12) of one element in the frame's axes."""
    length = float(np.linalg.norm(end - start))
    x_axis = (end - start) / length
    R = np.kron(np.eye(4), np.vstack([x_axis, np.cross(z_axis, x_axis), z_axis]))
    return R.T @ _stiffness(section, length) @ R, R.T @ _mass(section, length) @ R


# Degrees of freedom of the element in its own axes: u v w rx ry rz at the start, then at the end.
_AXIAL, _TORSION = [0, 6], [3, 9]
_IN_XY = ([1, 5, 7, 11], 1.0)  # v and rz: bending about z
_IN_XZ = ([2, 4, 8, 10], -1.0)  # w and ry: bending about y, where a positive slope is a negative rotation


def _stiffness(s: Section, L: float) -> Array:
    k = np.zeros((12, 12))
    k[np.ix_(_AXIAL, _AXIAL)] = s.axial / L * _BAR_STIFFNESS
    k[np.ix_(_TORSION, _TORSION)] = s.torsion / L * _BAR_STIFFNESS
    for (dofs, sign), bending in ((_IN_XY, s.bending_z), (_IN_XZ, s.bending_y)):
        k[np.ix_(dofs, dofs)] = bending / L**3 * _signed(_hermite_stiffness(L), sign)
    return k


def _mass(s: Section, L: float) -> Array:
    m = np.zeros((12, 12))
    m[np.ix_(_AXIAL, _AXIAL)] = s.mass * L / 6 * _BAR_MASS
    m[np.ix_(_TORSION, _TORSION)] = (s.rotary_y + s.rotary_z) * L / 6 * _BAR_MASS
    for (dofs, sign), rotary in ((_IN_XY, s.rotary_z), (_IN_XZ, s.rotary_y)):
        m[np.ix_(dofs, dofs)] = _signed(s.mass * L / 420 * _hermite_mass(L) + rotary / (30 * L) * _hermite_slope(L), sign)
    return m


_BAR_STIFFNESS = np.array([[1.0, -1.0], [-1.0, 1.0]])
_BAR_MASS = np.array([[2.0, 1.0], [1.0, 2.0]])


def _hermite_stiffness(L: float) -> Array:
    a, b = 6 * L, L * L
    return np.array([[12, a, -12, a], [a, 4 * b, -a, 2 * b], [-12, -a, 12, -a], [a, 2 * b, -a, 4 * b]])


def _hermite_mass(L: float) -> Array:
    b = L * L
    return np.array(
        [
            [156, 22 * L, 54, -13 * L],
            [22 * L, 4 * b, 13 * L, -3 * b],
            [54, 13 * L, 156, -22 * L],
            [-13 * L, -3 * b, -22 * L, 4 * b],
        ]
    )


def _hermite_slope(L: float) -> Array:
    a, b = 3 * L, L * L
    return np.array([[36, a, -36, a], [a, 4 * b, -a, -b], [-36, -a, 36, -a], [a, -b, -a, 4 * b]])


def _signed(matrix: Array, sign: float) -> Array:
    """`matrix` with the sign of both rotations changed where `sign` is -1."""
    s = np.array([1.0, sign, 1.0, sign])
    return matrix * np.outer(s, s)
