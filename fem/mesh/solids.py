"""Solid elements of a user's mesh: tetrahedra, hexahedra and wedges of first and second order, as isoparametric matrices."""

from functools import cache
from itertools import product

import numpy as np

from geometry.frames import Array

# Functions of an element: monomials whose combination is one at one node and zero at the others.
#
# An element is known by the places of its nodes in the reference cell and by the powers of its monomials; the inverse of the
# monomials at the nodes gives the functions (Zienkiewicz and Taylor, The Finite Element Method, volume 1, chapter 8). Nodes stand
# in the order of Abaqus: corners, then the middles of the edges of the bottom, of the top, and between the two.

_TETRAHEDRON = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
_WEDGE = [[0, 0, -1], [1, 0, -1], [0, 1, -1], [0, 0, 1], [1, 0, 1], [0, 1, 1]]
_BRICK = [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]]
_TETRAHEDRON_EDGES = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))
_WEDGE_EDGES = ((0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5))
_BRICK_EDGES = ((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7))
_CORNERS = {"tet": (_TETRAHEDRON, _TETRAHEDRON_EDGES), "wedge": (_WEDGE, _WEDGE_EDGES), "hex": (_BRICK, _BRICK_EDGES)}

_ALL = list(product(range(3), repeat=3))
_POWERS = {
    "tet4": [p for p in _ALL if sum(p) <= 1],
    "tet10": [p for p in _ALL if sum(p) <= 2],
    "wedge6": [p for p in _ALL if p[0] + p[1] <= 1 and p[2] <= 1],
    "wedge15": [p for p in _ALL if p[0] + p[1] <= 2 and (p[2] <= 1 or p[0] + p[1] <= 1) and sum(p) <= 3],
    "hex8": [p for p in _ALL if max(p) <= 1],
    "hex20": [p for p in _ALL if sum(power for power in p if power > 1) <= 2],
}
KINDS = tuple(_POWERS)
"""Names of the solid elements, each with the number of its nodes."""

BATCH = 4_000_000
"""Entries of element matrices at a time, which bounds the memory of an assembly."""


def shape(kind: str) -> str:
    """``tet``, ``wedge`` or ``hex``."""
    return kind.rstrip("0123456789")


@cache
def local_nodes(kind: str) -> Array:
    """Places (k, 3) of the nodes of an element of `kind` in its reference cell."""
    corners, edges = _CORNERS[shape(kind)]
    X = np.array(corners, dtype=np.float64)
    return X if len(X) == len(_POWERS[kind]) else np.vstack([X, [(X[a] + X[b]) / 2 for a, b in edges]])


def _monomials(X: Array, kind: str) -> Array:
    return np.asarray(np.prod(X[:, None, :] ** np.array(_POWERS[kind]), axis=2))


def functions(kind: str, X: Array) -> tuple[Array, Array]:
    """Values (q, k) and gradients (q, k, 3) of the functions of an element of `kind` at `X` (q, 3) in the reference cell."""
    powers, C = np.array(_POWERS[kind]), np.linalg.inv(_monomials(local_nodes(kind), kind))
    gradients = []
    for axis in range(3):
        lower = powers - np.eye(3, dtype=int)[axis] * (powers[:, axis, None] > 0)
        gradients.append(powers[:, axis] * np.prod(X[:, None, :] ** lower, axis=2) @ C)
    return np.asarray(_monomials(X, kind) @ C), np.stack(gradients, axis=2)


@cache
def quadrature(kind: str) -> tuple[Array, Array]:
    """Points (q, 3) and weights (q,) of Gauss, exact for stiffness and mass of an element of `kind` that is not distorted.

    Triangles and tetrahedra are squares and cubes collapsed to a corner (Stroud, Approximate Calculation of Multiple Integrals).
    """
    from scipy.special import roots_jacobi

    n = 2 if kind in ("tet4", "wedge6", "hex8") else 3

    def rule(power: int) -> tuple[Array, Array]:
        x, w = roots_jacobi(n, power, 0)
        return (1 + x) / 2, w / 2 ** (power + 1)

    through = np.polynomial.legendre.leggauss(n)
    rules = {"tet": (rule(2), rule(1), rule(0)), "wedge": (rule(1), rule(0), through), "hex": 3 * (through,)}[shape(kind)]
    x, y, z = (np.array(each) for each in zip(*product(*(points for points, _ in rules)), strict=True))
    W = np.prod(np.array(list(product(*(weights for _, weights in rules)))), axis=1)
    if shape(kind) == "tet":
        x, y, z = x, y * (1 - x), z * (1 - x) * (1 - y)
    elif shape(kind) == "wedge":
        x, y = x, y * (1 - x)
    return np.column_stack([x, y, z]), W


def determinants(kind: str, corners: Array) -> Array:
    """Determinant (c, q) [m³] of the mapping of elements with nodes at `corners` (c, k, 3), at quadrature points and nodes."""
    X = np.vstack([quadrature(kind)[0], local_nodes(kind)])
    return np.asarray(np.linalg.det(np.einsum("cki,qkj->cqij", corners, functions(kind, X)[1], optimize=True)))


def _slopes(kind: str, corners: Array, X: Array) -> tuple[Array, Array]:
    """Mapping (c, q, 3, 3) of elements at `X` (q, 3), and gradients (c, q, n, 3) of their functions and then of inner modes."""
    reference = functions(kind, X)[1]
    J = np.einsum("cki,qkj->cqij", corners, reference, optimize=True)
    gradients = np.einsum("qkj,cqji->cqki", reference, np.linalg.inv(J), optimize=True)
    if kind == "hex8":
        centre = np.einsum("cki,kj->cij", corners, functions(kind, np.zeros((1, 3)))[1][0])
        modes, scale = np.einsum("qm,mj->qmj", -2 * X, np.eye(3)), np.linalg.det(centre)[:, None] / np.linalg.det(J)
        bent = np.einsum("qmj,cji->cqmi", modes, np.linalg.inv(centre)) * scale[:, :, None, None]
        gradients = np.concatenate([gradients, bent], axis=2)
    return J, gradients


def _stiffness(gradients: Array, volume: Array, lam: float, mu: float) -> Array:
    """Stiffness (c, 3 n, 3 n) of functions with `gradients` (c, q, n, 3) at points of `volume` (c, q)."""
    (c, q, n), whole = gradients.shape[:3], (len(gradients), 3 * gradients.shape[2], 3 * gradients.shape[2])
    weighted = (gradients * volume[:, :, None, None]).reshape(c, q, 3 * n)
    pairs = weighted.transpose(0, 2, 1) @ gradients.reshape(c, q, 3 * n)
    blocks, K = pairs.reshape(-1, n, 3, n, 3), lam * pairs
    K += mu * blocks.transpose(0, 1, 4, 3, 2).reshape(whole)
    trace = mu * np.einsum("caibi->cab", blocks)
    for i in range(3):
        K.reshape(-1, n, 3, n, 3)[:, :, i, :, i] += trace
    return np.asarray(K)


def matrices(kind: str, corners: Array, lam: float, mu: float, density: float) -> tuple[Array, Array]:
    """Stiffness and mass (c, 3 k, 3 k) of elements of `kind` with nodes at `corners` (c, k, 3) [m].

    `lam`, `mu` are Lamé's constants [Pa], `density` is in kg/m³. Degrees of freedom are x, y, z of the first node, of the second
    ... The eight-node hexahedron has three incompatible modes that bend it, put away within the element; their gradients are
    those of its centre, so that constant strain is met in any shape (Taylor, Beresford and Wilson, Int. J. Num. Meth. Eng. 10,
    1976).
    """
    X, W = quadrature(kind)
    values = functions(kind, X)[0]
    J, gradients = _slopes(kind, corners, X)
    volume, k = np.linalg.det(J) * W, values.shape[1]
    K, n = _stiffness(gradients, volume, lam, mu), gradients.shape[2]
    if n > k:
        own, inner = slice(0, 3 * k), slice(3 * k, None)
        K = K[:, own, own] - K[:, own, inner] @ np.linalg.solve(K[:, inner, inner], K[:, inner, own])
    scalar = density * np.einsum("cq,qa,qb->cab", volume, values, values, optimize=True)
    M = np.zeros((len(corners), k, 3, k, 3))
    for i in range(3):
        M[:, :, i, :, i] = scalar
    return K, M.reshape(-1, 3 * k, 3 * k)


# How far a mesh is from its limit: what its strains jump by from element to element.
#
# Strains of an element differ from the mean of all elements at the node by about as much as from those of a mesh without end,
# and the energy of the difference is what the stiffness is too high by, to within a factor of two (O. C. Zienkiewicz and J. Z.
# Zhu, Int. J. Num. Meth. Eng. 33 (1992), 1331).


def strains(kind: str, corners: Array, moved: Array, lam: float, mu: float) -> Array:
    """Strain (c, k, 6, m) at the nodes of elements with nodes at `corners` (c, k, 3), which are `moved` (c, k, 3, m).

    xx, yy, zz, and yz, xz, xy times the root of two: the square of its length is that of the tensor. The hexahedron of eight
    nodes bends by its inner modes, too.
    """
    c, k, _, m = moved.shape
    if kind == "hex8":
        X, W = quadrature(kind)
        J, inside = _slopes(kind, corners, X)
        K, outer = _stiffness(inside, np.linalg.det(J) * W, lam, mu), 3 * k
        bent = -np.linalg.solve(K[:, outer:, outer:], K[:, outer:, :outer] @ moved.reshape(c, outer, m))
        moved = np.concatenate([moved, bent.reshape(c, -1, 3, m)], axis=1)
    slopes = np.einsum("cqkj,ckim->cqijm", _slopes(kind, corners, local_nodes(kind))[1], moved, optimize=True)
    turned = [(slopes[:, :, i, j] + slopes[:, :, j, i]) / np.sqrt(2) for i, j in ((1, 2), (0, 2), (0, 1))]
    return np.stack([*(slopes[:, :, i, i] for i in range(3)), *turned], axis=2)


def overlaps(kind: str, corners: Array) -> Array:
    """Integrals (c, k, k) [m³] of the products of two functions, by element; the mass of a density of 1."""
    X, W = quadrature(kind)
    values, reference = functions(kind, X)
    volume = np.linalg.det(np.einsum("cki,qkj->cqij", corners, reference, optimize=True)) * W
    return np.asarray(np.einsum("cq,qa,qb->cab", volume, values, values, optimize=True))


def located(kind: str, corners: Array, point: Array) -> tuple[Array, Array]:
    """Place in the reference cell (3,) nearest to `point` (3,) within one element (k, 3), and the functions (k,) there.

    Newton's iteration for the isoparametric map, then put back into the cell.
    """
    X = np.full(3, 0.25) if shape(kind) == "tet" else np.array([1 / 3, 1 / 3, 0.0]) if shape(kind) == "wedge" else np.zeros(3)
    for _ in range(20):
        values, gradients = functions(kind, X[None])
        step = np.linalg.lstsq(corners.T @ gradients[0], point - values[0] @ corners, rcond=None)[0]
        X = np.clip(X + step, -3.0, 3.0)
        if np.abs(step).max() < 1e-13:
            break
    if shape(kind) == "hex":
        inside = np.clip(X, -1, 1)
    elif shape(kind) == "tet":
        weights = np.maximum(np.append(1 - X.sum(), X), 0)
        inside = weights[1:] / weights.sum()
    else:
        weights = np.maximum([1 - X[0] - X[1], X[0], X[1]], 0)
        inside = np.append(weights[1:] / weights.sum(), np.clip(X[2], -1, 1))
    return X, functions(kind, inside[None])[0][0]
