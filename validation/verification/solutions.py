"""Eigenfrequencies of the bodies that the table checks, small ones dense and large ones by shift and invert."""

from __future__ import annotations

import numpy as np

from fem.eigen import Eigenpairs, floating_shift, lowest
from fem.solid.elasticity import Matrices, assemble
from fem.solid.mesh import SolidMesh
from fem.structure import Sparse
from geometry.arrays import Array
from geometry.materials import Material


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
