"""Ritz's method with Legendre polynomials: plates without any element, to as many digits as the degree allows.

A second source for published plate frequencies. The displacements are sums of products of Legendre polynomials over the whole
body; every free edge is a natural boundary condition, and the stiffness and mass are Kronecker products of integrals along one
axis, which Gauss quadrature has exactly (Leissa, J. Sound Vib. 31, 1973, 257-293, with beam functions instead; Bardell, Langley
and Dunsdon, J. Sound Vib. 191, 1996, 459-467, in the plane).
"""

from __future__ import annotations

import numpy as np
from numpy.polynomial import legendre

from geometry.arrays import Array

FREE = 3
"""Rigid motions of a plate across itself, and of one in its plane."""


def thin_plate(side: float, thickness: float, E: float, nu: float, density: float, *, degree: int, count: int) -> Array:
    """Bending frequencies (count,) [Hz] of a free square plate after Kirchhoff, rigid motions left out."""
    A = [[_integral(degree, side, r, s) for s in range(3)] for r in range(3)]
    D = E * thickness**3 / (12 * (1 - nu**2))
    K = _kron(A[2][2], A[0][0]) + _kron(A[0][0], A[2][2]) + 2 * (1 - nu) * _kron(A[1][1], A[1][1])
    K += nu * (_kron(A[2][0], A[0][2]) + _kron(A[0][2], A[2][0]))
    return _elastic(D * K, density * thickness * _kron(A[0][0], A[0][0]), count)


def in_plane(side: float, E: float, nu: float, density: float, *, degree: int, count: int) -> Array:
    """In-plane frequencies (count,) [Hz] of a free square plate in plane stress, rigid motions left out."""
    mu, lam = E / (2 * (1 + nu)), E * nu / (1 - nu**2)
    one = [[_integral(degree, side, r, s) for s in range(2)] for r in range(2)]

    def product(b: int, d: int) -> Array:
        """Integral of the derivative along b of one product of polynomials times that along d of another."""
        along = [one[int(k == b)][int(k == d)] for k in range(2)]
        return _kron(*along)

    P = [[product(b, d) for d in range(2)] for b in range(2)]
    K = np.block([[lam * P[a][c] + mu * P[c][a] + mu * (a == c) * (P[0][0] + P[1][1]) for c in range(2)] for a in range(2)])
    return _elastic(K, _kron(np.eye(2), density * _kron(one[0][0], one[0][0])), count)


def _kron(a: Array, b: Array) -> Array:
    return np.asarray(np.kron(a, b), dtype=np.float64)


def _integral(degree: int, length: float, r: int, s: int) -> Array:
    """Integral over (0, length) of the r-th derivative of P_i times the s-th of P_j, (degree + 1, degree + 1)."""
    x, w = legendre.leggauss(degree + 1)
    values = [legendre.legval(x, legendre.legder(np.eye(degree + 1), n)) * (2 / length) ** n for n in (r, s)]
    return np.asarray(values[0] * w @ values[1].T * length / 2)


def _elastic(K: Array, M: Array, count: int) -> Array:
    from scipy.linalg import eigh

    squares = eigh(K, M, eigvals_only=True, subset_by_index=[0, FREE + count - 1])
    return np.asarray(np.sqrt(squares[FREE:]) / (2 * np.pi))
