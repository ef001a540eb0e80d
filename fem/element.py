"""The Timoshenko beam element: exact in statics, with consistent mass and rotary inertia.

Deflection v and rotation theta of the section are interpolated by the static solution of the loaded beam (Friedman and Kosmatka,
An improved two-node Timoshenko beam finite element, Computers & Structures 47, 1993). With Phi = 12 E I / (k G A L²), the ratio
of bending to shear stiffness, they are a cubic and a quadratic; as Phi goes to zero they become the Hermite cubic and its slope,
and the element that of Rayleigh. They hold every rigid motion, so the mass matrix carries the rigid-body inertia exactly. Shear
is constant in an element: a frequency's error falls with the fourth power of the element's length in bending, with the second
in what shear adds, which matters on stubby beams only.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from fem.section import Section
from geometry.arrays import Array


@dataclass(frozen=True, eq=False, kw_only=True)
class Element:
    """Matrices of one element in its own axes.

    Degrees of freedom: u v w rx ry rz at the start, the same at the end, then `nodal` more at the start, as many at the end, and
    `inner` ones that the element keeps to itself.

    Attributes
    ----------
    stiffness : by part, (n, n) each
    mass : (n, n)
    nodal, inner : how many degrees of freedom there are beyond the twelve; n = 12 + 2 nodal + inner
    """

    stiffness: Mapping[str, Array]
    mass: Array
    nodal: int = 0
    inner: int = 0


AXIAL, TORSION = [0, 6], [3, 9]
IN_XY = [1, 5, 7, 11]  # v and rz: bending about z
IN_XZ = [2, 4, 8, 10]  # w and ry: bending about y, where a positive slope is a negative rotation
SIGN_XZ = np.array([1.0, -1.0, 1.0, -1.0])

GAUSS_POINTS, GAUSS_WEIGHTS = ((x + 1) / 2 if n == 0 else x / 2 for n, x in enumerate(np.polynomial.legendre.leggauss(4)))
"""On 0 ... 1; exact up to the seventh power, and no product of two shape functions has more than the sixth."""


def timoshenko(section: Section, length: float, part: str) -> Element:
    """Element of `length` [m] of a uniform beam that belongs to `part`."""
    k, m = np.zeros((2, 12, 12))
    k[np.ix_(AXIAL, AXIAL)] = section.axial / length * _BAR_STIFFNESS
    k[np.ix_(TORSION, TORSION)] = section.torsion / length * _BAR_STIFFNESS
    m[np.ix_(AXIAL, AXIAL)] = section.mass * length / 6 * _BAR_MASS
    m[np.ix_(TORSION, TORSION)] = (section.rotary_y + section.rotary_z) * length / 6 * _BAR_MASS
    for dofs, sign, bending, shear, rotary in (
        (IN_XY, np.ones(4), section.bending_z, section.shear_y, section.rotary_z),
        (IN_XZ, SIGN_XZ, section.bending_y, section.shear_z, section.rotary_y),
    ):
        phi = 12 * bending / (shear * length**2)
        k[np.ix_(dofs, dofs)] = np.outer(sign, sign) * bending_stiffness(bending, phi, length)
        m[np.ix_(dofs, dofs)] = np.outer(sign, sign) * bending_mass(section.mass, rotary, phi, length)
    return Element(stiffness={part: k}, mass=m)


def bending_stiffness(bending: float, phi: float, L: float) -> Array:
    """Stiffness (4, 4) of v, theta at the start and at the end: bending E I [N m²], Phi [1], length L [m]."""
    a, b, c = 6 * L, (4 + phi) * L * L, (2 - phi) * L * L
    k = np.array([[12, a, -12, a], [a, b, -a, c], [-12, -a, 12, -a], [a, c, -a, b]])
    return np.asarray(bending / (L**3 * (1 + phi)) * k)


def bending_mass(mass: float, rotary: float, phi: float, L: float) -> Array:
    """Mass (4, 4) of the same: `mass` [kg/m] that moves with v and `rotary` inertia [kg m] that turns with theta."""
    v, theta = shape_functions(GAUSS_POINTS, phi, L)
    w = GAUSS_WEIGHTS * L
    return np.asarray(mass * (v * w) @ v.T + rotary * (theta * w) @ theta.T)


def shape_functions(xi: Array, phi: float, L: float) -> tuple[Array, Array]:
    """Deflection and rotation (4, len(xi)) at `xi` = x / L for unit v, theta at the start and at the end."""
    e = 1 + phi
    v = [
        2 * xi**3 - 3 * xi**2 - phi * xi + e,
        L * (xi**3 - (2 + phi / 2) * xi**2 + (1 + phi / 2) * xi),
        -2 * xi**3 + 3 * xi**2 + phi * xi,
        L * (xi**3 - (1 - phi / 2) * xi**2 - phi / 2 * xi),
    ]
    theta = [
        6 / L * (xi**2 - xi),
        3 * xi**2 - (4 + phi) * xi + e,
        -6 / L * (xi**2 - xi),
        3 * xi**2 - (2 - phi) * xi,
    ]
    return np.array(v) / e, np.array(theta) / e


_BAR_STIFFNESS = np.array([[1.0, -1.0], [-1.0, 1.0]])
_BAR_MASS = np.array([[2.0, 1.0], [1.0, 2.0]])
