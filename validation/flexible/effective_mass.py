"""How much of an article's mass its modes can carry, and how much rides on the base."""

from __future__ import annotations

import numpy as np

from fem.held_base import hold
from fem.structure import Structure
from geometry.arrays import Array

RESIDUAL = 1e-10
"""Relative residual at which the iteration ends; mass matrices are well conditioned, a few dozen steps do."""


def movable(structure: Structure) -> Array:
    """Effective mass (6,) [kg, kg m²] of *all* fixed-base modes about the reference point: ``diag(P^T M_ff^-1 P)``, P = (M T)_f.

    What is left of the rigid mass is carried by the held degrees of freedom themselves and shows in no mode.
    """
    from scipy.sparse import diags_array
    from scipy.sparse.linalg import cg

    held = hold(structure)
    diagonal = held.mass.diagonal()
    jacobi = diags_array(1 / np.where(diagonal > 0, diagonal, 1.0))
    carried = (p @ cg(held.mass, p, rtol=RESIDUAL, M=jacobi)[0] if p.any() else 0.0 for p in held.load.T)
    return np.array(list(carried))
