"""Ritz's method with Legendre polynomials: plates and blocks without any element, to as many digits as the degree allows.

A second source for published plate frequencies. The displacements are sums of products of Legendre polynomials over the whole
body; every free edge is a natural boundary condition, and the stiffness and mass are Kronecker products of integrals along one
axis, which Gauss quadrature has exactly (Leissa, J. Sound Vib. 31, 1973, 257-293, with beam functions instead; Bardell, Langley and
Dunsdon, J. Sound Vib. 191, 1996, 459-467, in the plane; Demarest, J. Acoust. Soc. Am. 49, 1971, 768-775, in space).
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce

import numpy as np
from numpy.polynomial import legendre

from geometry.arrays import Array

RIGID = 1e-6
"""Eigenvalues below this share of the largest kept are rigid motions."""


def thin_plate(side: float, thickness: float, E: float, nu: float, density: float, *, degree: int, count: int) -> Array:
    """Bending frequencies (count,) [Hz] of a free square plate after Kirchhoff, rigid motions left out."""
    A = [[_integral(degree, side, r, s) for s in range(3)] for r in range(3)]
    D = E * thickness**3 / (12 * (1 - nu**2))
    K = np.kron(A[2][2], A[0][0]) + np.kron(A[0][0], A[2][2]) + 2 * (1 - nu) * np.kron(A[1][1], A[1][1])
    K += nu * (np.kron(A[2][0], A[0][2]) + np.kron(A[0][2], A[2][0]))
    return _elastic(D * K, density * thickness * np.kron(A[0][0], A[0][0]), 3, count)


def in_plane(side: float, E: float, nu: float, density: float, *, degree: int, count: int) -> Array:
    """In-plane frequencies (count,) [Hz] of a free square plate in plane stress, rigid motions left out."""
    mu = E / (2 * (1 + nu))
    lam = E * nu / (1 - nu**2)
    K, M = _elasticity([side, side], [degree, degree], lam, mu, density)
    return _elastic(K, M, 3, count)


def block(sides: Sequence[float], E: float, nu: float, density: float, *, degrees: Sequence[int], count: int) -> Array:
    """Frequencies (count,) [Hz] of a free block in space, rigid motions left out."""
    mu = E / (2 * (1 + nu))
    lam = E * nu / ((1 + nu) * (1 - 2 * nu))
    K, M = _elasticity(sides, degrees, lam, mu, density)
    return _elastic(K, M, 6, count)


def _elasticity(sides: Sequence[float], degrees: Sequence[int], lam: float, mu: float, density: float) -> tuple[Array, Array]:
    """Stiffness and mass; the unknowns of displacement component a follow those of component a - 1."""
    axes = range(len(sides))
    one = [[[_integral(n, L, r, s) for s in range(2)] for r in range(2)] for L, n in zip(sides, degrees, strict=True)]

    def product(b: int, d: int) -> Array:
        """Integral over the body of the derivative along b of one product times that along d of another."""
        return reduce(np.kron, [one[k][int(k == b)][int(k == d)] for k in axes])

    P = [[product(b, d) for d in axes] for b in axes]
    laplace = sum(P[b][b] for b in axes)
    K = np.block([[lam * P[a][c] + mu * P[c][a] + (mu * laplace if a == c else 0.0) for c in axes] for a in axes])
    return K, np.kron(np.eye(len(sides)), density * reduce(np.kron, [one[k][0][0] for k in axes]))


def _integral(degree: int, length: float, r: int, s: int) -> Array:
    """Integral over (0, length) of the r-th derivative of P_i times the s-th of P_j, (degree + 1, degree + 1)."""
    x, w = legendre.leggauss(degree + 1)
    values = [legendre.legval(x, legendre.legder(np.eye(degree + 1), n)) * (2 / length) ** n for n in (r, s)]
    return np.asarray(values[0] * w @ values[1].T * length / 2)


def _elastic(K: Array, M: Array, rigid: int, count: int) -> Array:
    from scipy.linalg import eigh

    squares = eigh(K, M, eigvals_only=True, subset_by_index=[0, rigid + count - 1])
    if not abs(squares[rigid - 1]) < RIGID * squares[rigid]:
        raise ArithmeticError(f"{rigid} rigid motions expected, the last of them at {squares[rigid - 1]:g} rad²/s²")
    return np.asarray(np.sqrt(squares[rigid:]) / (2 * np.pi))
