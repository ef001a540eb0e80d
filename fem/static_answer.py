"""What truncated modes answer statically, as coordinates of a reduced body (mode acceleration, attachment modes).

The few modes kept would leave the static share of the others out. The static answers to six accelerations of the base, less
what the kept modes hold of them, are put beside the modes as further shapes: the reduced body then answers as the full one does
up to the fourth power of the frequency, residual mass included (Craig & Chang, AIAA Journal 15, 1977).
"""

from __future__ import annotations

import numpy as np

from fem.factorisers import factorise
from fem.structure import Sparse
from geometry.arrays import Array

REDUNDANT = 1e-8
"""Share of a static answer that may lie outside the modes already there, below which it is left out."""


def static_shapes(stiffness: Sparse, mass: Sparse, load: Array, shapes: Array) -> Array:
    """Static answers to `load` beside mass-normalised `shapes`: orthonormal in the mass, to one another and to `shapes`.

    Parameters
    ----------
    stiffness, mass : (f, f) sparse, of the free degrees of freedom
    load : (f, k), of unit accelerations of the base
    shapes : (f, n)

    Returns
    -------
    (f, m) : m at most k, fewer where the modes already answer a load in full
    """
    if not len(load):
        return np.zeros((0, 0))
    static = factorise(stiffness, definite=True).solve(load)
    size = np.sqrt(np.einsum("ir,ir->r", static, mass @ static))
    static = static[:, size > 0] / size[size > 0]
    left = static - shapes @ (shapes.T @ (mass @ static))
    left -= shapes @ (shapes.T @ (mass @ left))  # twice is enough, against rounding
    square, directions = np.linalg.eigh(left.T @ (mass @ left))
    kept = square > REDUNDANT**2
    return np.asarray(left @ directions[:, kept] / np.sqrt(square[kept]))
