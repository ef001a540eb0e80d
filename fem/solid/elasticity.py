"""Stiffness and mass of an elastic solid: scikit-fem's elements, mappings and quadrature, contracted cell by cell in batches.

The stiffness of isotropic elasticity between node a, direction i, and node b, direction j, of a cell is

    K = integral( lambda d_i N_a d_j N_b + mu d_j N_a d_i N_b + mu delta_ij grad N_a . grad N_b ) dV,

Lamé's lambda and mu those of the cell's part; the mass is integral(rho N_a N_b) dV in each direction (Hughes, The Finite
Element Method, chapters 2 and 7). A vector form of scikit-fem visits the 81 x 81 pairs of a hexahedron's functions one after the
other; the gradients of its scalar functions, contracted for many cells at once, are the same sum in a fraction of it. A test
holds the result against scikit-fem's own form.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from fem.moduli import moduli
from fem.solid.mesh import SolidMesh
from fem.structure import Sparse
from geometry.arrays import Array, Integers
from geometry.materials import Material

QUADRATURE = {10: 5, 27: 5}
"""Order of the rule by nodes of a cell: exact for the mass of straight cells, ample for slightly curved ones."""

BATCH = 1000
"""Cells at a time: bounds the memory of gradients at all quadrature points."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Matrices:
    """Of the unconstrained solid; degrees of freedom 3 p + (0, 1, 2) are x, y, z of point p.

    Attributes
    ----------
    stiffness, mass : (3 p, 3 p) sparse [N/m], [kg]
    part_stiffness : share of each part in the stiffness
    """

    stiffness: Sparse
    mass: Sparse
    part_stiffness: Mapping[str, Sparse]


def assemble(mesh: SolidMesh, materials: Mapping[str, Material]) -> Matrices:
    """Stiffness and mass of `mesh`; `materials` gives each part's.

    Raises
    ------
    BadInput : a material without a usable Young's modulus or Poisson's ratio.
    """
    constants = {name: lame(materials[name], name) for name in mesh.parts}
    shares, mass = {}, _zero(mesh)
    for index, name in enumerate(mesh.parts):
        own = np.flatnonzero(mesh.part == index)
        K, M = _zero(mesh), _zero(mesh)
        for cells, volume, gradients, values in _batches(mesh, own):
            K += _scattered(mesh, cells, _stiffness(gradients, volume, *constants[name]))
            M += _scattered(mesh, cells, _mass(values, volume, materials[name].density))
        shares[name], mass = K, mass + M
    return Matrices(stiffness=sum(shares.values(), _zero(mesh)), mass=mass, part_stiffness=shares)


def lame(material: Material, part: str = "part") -> tuple[float, float]:
    """Lamé's first constant and the shear modulus [Pa].

    Raises
    ------
    BadInput : as `fem.moduli.moduli`; it names the `part`.
    """
    E, mu = moduli(material, part)
    return mu * (E - 2 * mu) / (3 * mu - E), mu


def jacobians(mesh: SolidMesh) -> Array:
    """Determinants of the mapping (c, q) [m³] at the quadrature points of every cell; a cell with one below zero is inverted."""
    found = [np.linalg.det(mapping) for _, mapping in _mappings(mesh, np.arange(len(mesh.cells)))]
    return np.concatenate(found) if found else np.zeros((0, 0))


def volumes(mesh: SolidMesh) -> Array:
    """Volume (c,) [m³] of every cell, exact for curved ones; negative where a cell is inside out."""
    W, _, _ = _reference(mesh.cells.shape[1])
    return np.asarray(jacobians(mesh) @ W)


def _element(nodes: int) -> Any:
    from skfem import ElementHex2, ElementTetP2

    return {10: ElementTetP2, 27: ElementHex2}[nodes]()


def _reference(nodes: int) -> tuple[Array, Array, Array]:
    """Weights (q,), values (k, q) and gradients (3, k, q) of the functions in the reference cell."""
    from skfem.quadrature import get_quadrature

    element = _element(nodes)
    X, W = get_quadrature(element.refdom, QUADRATURE[nodes])
    pairs = [element.lbasis(X, k) for k in range(nodes)]
    values = np.array([np.broadcast_to(value, W.shape) for value, _ in pairs])
    return W, values, np.array([[np.broadcast_to(d, W.shape) for d in gradient] for _, gradient in pairs]).transpose(1, 0, 2)


def _mappings(mesh: SolidMesh, cells: Integers) -> Iterator[tuple[Integers, Array]]:
    """Batches of `cells` with the derivative of the isoparametric map, (c, q, 3, 3): dx_i / dX_j."""
    _, _, gradients = _reference(mesh.cells.shape[1])
    for first in range(0, len(cells), BATCH):
        batch = cells[first : first + BATCH]
        yield batch, np.einsum("cki,jkq->cqij", mesh.points[mesh.cells[batch]], gradients, optimize=True)


def _batches(mesh: SolidMesh, cells: Integers) -> Iterator[tuple[Integers, Array, Array, Array]]:
    """Batches of `cells`: volume at the quadrature points (c, q), gradients (c, 3, k, q), values (k, q)."""
    W, values, reference = _reference(mesh.cells.shape[1])
    for batch, mapping in _mappings(mesh, cells):
        volume: Array = np.abs(np.linalg.det(mapping)) * W
        gradients = np.einsum("cqji,jkq->cikq", np.linalg.inv(mapping), reference, optimize=True)
        yield batch, volume, gradients, values


def _stiffness(gradients: Array, volume: Array, lam: float, mu: float) -> Array:
    """Stiffness of a batch (c, k, 3, k, 3)."""
    weighted = gradients * volume[:, None, None, :]
    pairs = np.array([[a @ b.transpose(0, 2, 1) for b in gradients.swapaxes(0, 1)] for a in weighted.swapaxes(0, 1)])
    K = np.einsum("ijcab->caibj", lam * pairs) + np.einsum("jicab->caibj", mu * pairs)
    K[:, :, range(3), :, range(3)] += mu * np.einsum("iicab->cab", pairs)
    return np.asarray(K)


def _mass(values: Array, volume: Array, density: float) -> Array:
    scalar = density * np.einsum("aq,cq,bq->cab", values, volume, values, optimize=True)
    return np.asarray(np.einsum("cab,ij->caibj", scalar, np.eye(3)))


def _zero(mesh: SolidMesh) -> Sparse:
    from scipy.sparse import csr_array

    return csr_array((3 * len(mesh.points), 3 * len(mesh.points)))


def _scattered(mesh: SolidMesh, cells: Integers, blocks: Array) -> Sparse:
    """The batch's cell matrices added into one of the whole solid."""
    from scipy.sparse import coo_array

    dofs = (3 * mesh.cells[cells][:, :, None] + np.arange(3)).reshape(len(cells), -1)
    rows = np.broadcast_to(dofs[:, :, None], (*dofs.shape, dofs.shape[1]))
    shape = (3 * len(mesh.points), 3 * len(mesh.points))
    return coo_array((blocks.ravel(), (rows.ravel(), rows.swapaxes(1, 2).ravel())), shape=shape).tocsr()
