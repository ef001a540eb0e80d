"""Closed forms of straight uniform beams, none of which knows of an element: the references of the beam and solid rows.

Bending is governed by w' = psi + Q / (k G A), psi' = M / (E I), M' = -Q - rho I omega² psi, Q' = -rho A omega² w with w the
deflection, psi the rotation of the section, M the bending moment and Q the shear force (Timoshenko 1921; Huang 1961). What these
four become over a whole beam is the exponential of their matrix, so a frequency equation is one 2 x 2 determinant of it, and the
answer to a moving clamp is one linear system. Letting k G A go to infinity and rho I to zero leaves Euler and Bernoulli's beam,
whose roots come here from the textbook equation instead.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import permutations

import numpy as np
import numpy.typing as npt
from numpy.polynomial import legendre

from fem.modes import Eigenpairs, floating_shift, lowest
from fem.solid.assembly import LOCAL_HEX27, LOCAL_TET10, Matrices, SolidMesh, assemble
from fem.structure import Sparse
from geometry.article import Material
from geometry.frames import Array, Integers

ComplexMatrix = npt.NDArray[np.complex128]

STEPS = 2000
"""Steps of the frequency axis in which a determinant is looked at for a change of sign."""


@dataclass(frozen=True, kw_only=True)
class Beam:
    """A straight uniform beam that bends in one plane.

    Attributes
    ----------
    length : [m]
    bending : E I [N m²]; complex with a loss factor
    shear : k G A [N]; infinite for none
    mass : rho A [kg/m]
    rotary : rho I [kg m]
    """

    length: float
    bending: complex
    shear: complex = np.inf
    mass: float
    rotary: float = 0.0


def euler_bernoulli_cantilever(beam: Beam, count: int) -> Array:
    """Frequencies (count,) [Hz] from ``1 + cos x cosh x = 0`` (Blevins, Table 8-1)."""
    return _euler_bernoulli(beam, count, lambda x: np.cos(x) + 1 / np.cosh(x), [(k - 0.5) * np.pi for k in range(1, count + 1)])


def euler_bernoulli_free(beam: Beam, count: int) -> Array:
    """Frequencies (count,) [Hz] of the elastic modes from ``1 - cos x cosh x = 0`` (Blevins, Table 8-1)."""
    return _euler_bernoulli(beam, count, lambda x: np.cos(x) - 1 / np.cosh(x), [(k + 0.5) * np.pi for k in range(1, count + 1)])


def timoshenko_cantilever(beam: Beam, count: int) -> Array:
    """Frequencies (count,) [Hz] at which a clamped beam can move with neither moment nor shear at its tip."""
    highest = 1.01 * euler_bernoulli_cantilever(beam, count)[-1]  # shear and rotary inertia only lower them
    return _roots(lambda f: _determinants(_over(beam, 2 * np.pi * f)[:, 2:, 2:]), highest, count)


def timoshenko_free(beam: Beam, count: int) -> Array:
    """Frequencies (count,) [Hz] of the elastic modes of a beam with neither moment nor shear at both ends."""
    highest = 1.01 * euler_bernoulli_free(beam, count)[-1]
    return _roots(lambda f: _determinants(_over(beam, 2 * np.pi * f)[:, 2:, :2]), highest, count)


def rod_fixed_free(wave_speed: float, length: float, count: int) -> Array:
    """Frequencies (count,) [Hz] of a rod in tension or torsion, clamped at one end: ``(2 k - 1) c / (4 L)``."""
    return np.asarray((2 * np.arange(1, count + 1) - 1) * wave_speed / (4 * length), dtype=np.float64)


def rod_dynamic_mass(inertia: float, wave_speed: complex, length: float, frequency: npt.ArrayLike) -> ComplexMatrix:
    """Base load for a unit base acceleration (n,) of a rod of `inertia` [kg or kg m²]: ``m tan(k L) / (k L)``, k = omega / c."""
    x = 2 * np.pi * np.asarray(frequency) * length / wave_speed
    return np.asarray(inertia * np.tan(x) / x, dtype=np.complex128)


def base_driven(beam: Beam, frequency: npt.ArrayLike) -> ComplexMatrix:
    """Blocked dynamic mass (n, 2, 2) of a cantilever at its clamp: deflection and rotation driven, shear and moment answered.

    The beam lies along x from the clamp and deflects along y, so that the rotation is about z and the moment that the clamp
    exerts as well. The frequency must not be zero.
    """
    omega = 2 * np.pi * np.atleast_1d(np.asarray(frequency, dtype=np.float64))
    T = _over(beam, omega)
    # At the tip M = Q = 0 = T[2:, :2] @ (w, psi) + T[2:, 2:] @ (M, Q); the clamp exerts -Q along y and -M about z.
    answer = np.linalg.solve(T[:, 2:, 2:], T[:, 2:, :2])[:, ::-1]
    return np.asarray(answer / -(omega[:, None, None] ** 2), dtype=np.complex128)


def _over(beam: Beam, omega: Array) -> ComplexMatrix:
    """What the beam makes of w, psi, M, Q at its start (n, 4, 4): the exponential of its state matrix, by its eigenvectors.

    Deflection and rotation are measured in the beam's length and in radians, moment and force in E I / L and E I / L², or the
    exponential would lose digits to the units.
    """
    L, EI, s = beam.length, abs(beam.bending), omega**2
    A = np.zeros((len(omega), 4, 4), dtype=np.complex128)
    A[:, 0, 1], A[:, 0, 3] = 1.0, EI / L**2 / beam.shear
    A[:, 1, 2] = EI / beam.bending
    A[:, 2, 1], A[:, 2, 3] = -beam.rotary * s * L**2 / EI, -1.0
    A[:, 3, 0] = -beam.mass * s * L**4 / EI
    values, vectors = np.linalg.eig(A)
    T = (vectors * np.exp(values)[:, None, :]) @ np.linalg.inv(vectors)
    scale = np.array([L, 1.0, EI / L, EI / L**2])
    return np.asarray(scale[:, None] * T / scale[None, :], dtype=np.complex128)


def _determinants(blocks: ComplexMatrix) -> Array:
    return np.asarray(np.linalg.det(blocks).real)


def _euler_bernoulli(beam: Beam, count: int, equation: Callable[[float], float], near: list[float]) -> Array:
    from scipy.optimize import brentq

    roots = np.array([brentq(equation, x - 0.5, x + 0.5, xtol=1e-14) for x in near])
    return np.asarray((roots / beam.length) ** 2 / (2 * np.pi) * np.sqrt(abs(beam.bending) / beam.mass))


def _roots(function: Callable[[Array], Array], highest: float, count: int) -> Array:
    """The lowest `count` roots between a thousandth of `highest` and `highest`."""
    from scipy.optimize import brentq

    grid = np.linspace(1e-3 * highest, highest, STEPS)
    values = function(grid)
    signs = np.flatnonzero(np.sign(values[:-1]) != np.sign(values[1:]))[:count]
    return np.array([brentq(lambda f: function(np.array([f]))[0], grid[k], grid[k + 1], xtol=1e-13 * highest) for k in signs])


# Small meshes of a block, hexahedra or the tetrahedra that these are cut into, straight or bent by a function.


HEX, TET = 27, 10
"""Nodes of a cell: hexahedra and tetrahedra."""

PART = "block"


def block(
    sides: Sequence[float], counts: Sequence[int], nodes: int = HEX, bent: Callable[[Array], Array] | None = None
) -> SolidMesh:
    """A block from the origin to `sides` [m] in `counts` cells along each side, every cell six tetrahedra where `nodes` is TET.

    `bent` gives the places (p, 3) [m] of the mesh's points instead of their straight ones.
    """
    grid = 2 * np.asarray(counts) + 1
    places = np.stack(np.meshgrid(*(np.linspace(0, L, n) for L, n in zip(sides, grid, strict=True)), indexing="ij"), axis=-1)
    points = places.reshape(-1, 3)
    corners = 2 * np.stack(np.meshgrid(*(np.arange(n) for n in counts), indexing="ij"), axis=-1).reshape(-1, 1, 1, 3)
    steps = (corners + _cells(nodes)).reshape(-1, nodes, 3)
    cells: Integers = np.ravel_multi_index(np.moveaxis(steps, -1, 0), tuple(grid))
    moved = points if bent is None else bent(points)
    return SolidMesh(points=moved, cells=cells, part=np.zeros(len(cells), dtype=np.intp), parts=(PART,))


def _cells(nodes: int) -> Integers:
    """Half steps (k, nodes, 3) from a hexahedron's low corner to the nodes of the k cells that it is made of."""
    if nodes == HEX:
        return np.rint(2 * LOCAL_HEX27).astype(np.intp)[None]
    # Kuhn's six tetrahedra: from corner to opposite corner along the three edges in every order.
    paths = [np.cumsum([np.zeros(3), *np.eye(3)[list(order)]], axis=0) for order in permutations(range(3))]
    turned = [path if np.linalg.det(path[1:] - path[0]) > 0 else path[[0, 2, 1, 3]] for path in paths]
    return np.array([np.rint(2 * (path[0] + LOCAL_TET10 @ (path[1:] - path[0]))) for path in turned], dtype=np.intp)


# Ritz's method with Legendre polynomials: plates without any element, to as many digits as the degree allows.
#
# A second source for published plate frequencies. The displacements are sums of products of Legendre polynomials over the whole
# body; every free edge is a natural boundary condition, and the stiffness and mass are Kronecker products of integrals along one
# axis, which Gauss quadrature has exactly (Leissa, J. Sound Vib. 31, 1973, 257-293, with beam functions instead; Bardell,
# Langley and Dunsdon, J. Sound Vib. 191, 1996, 459-467, in the plane).


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


# Eigenfrequencies of the bodies that the table checks, small ones dense and large ones by shift and invert.


def frequencies(K: Array, M: Array, count: int, *, rigid: int = 0) -> Array:
    """The lowest `count` elastic frequencies [Hz], above `rigid` rigid motions; dense."""
    from scipy.linalg import eigh

    squares = eigh(K, M, eigvals_only=True, subset_by_index=[rigid, rigid + count - 1])
    return np.asarray(np.sqrt(squares) / (2 * np.pi))


def floating(K: Sparse, M: Sparse, count: int) -> Eigenpairs:
    """The `count` lowest eigenpairs of a body that floats freely or nearly so, its rigid motions among them."""
    return lowest(K, M, count, shift=floating_shift(K, M))


def solid(mesh: SolidMesh, material: Material) -> Matrices:
    """Stiffness and mass of a mesh of one material."""
    return assemble(mesh, dict.fromkeys(mesh.parts, material))
