"""Are matrices symmetric and positive definite? By the signs of the pivots of L D L^T, which are those of the eigenvalues.

Sylvester's law of inertia: a symmetric matrix has as many negative eigenvalues as L D L^T has negative pivots. SuperLU keeps the
pivots on the diagonal when it is told that the matrix is symmetric; the matrix is scaled to a diagonal of ones first, so that
what counts as zero does not depend on units.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from fem.structure import Sparse
from geometry.arrays import Array, Integers

SYMMETRIC = 1e-6
"""Two entries across the diagonal may differ by this share of the largest in their rows: single precision and printed digits."""

ROUNDING = 1e-9
"""Rows count as this share of the stiffest one at least: `SYMMETRIC` times it is the rounding that a reduction leaves."""

SINGULAR = 1e-12
"""A pivot, of a matrix scaled to a diagonal of ones, that is rounding: a motion that costs no energy."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Factored:
    """A symmetric matrix A = S^-1 B S^-1 with B factored.

    Attributes
    ----------
    solve : gives A^-1 b for b (n, k)
    negative : number of negative eigenvalues
    zero : indices where the scaled pivot vanishes, first in the order of elimination; empty when regular
    """

    solve: Callable[[Array], Array]
    negative: int
    zero: Integers


def asymmetry(A: Sparse, masses: Array) -> tuple[float, int, int]:
    """Largest difference across the diagonal relative to the largest entries of its two rows, and its row and column.

    Where a reduction leaves nothing but rounding, as in the interface rows of a Craig-Bampton stiffness, rows count as `ROUNDING`
    of the stiffest one; divided by `masses` (n,), the diagonal of M, rows of translations, rotations and modes are comparable.
    """
    from scipy.sparse import coo_array

    rows = np.sqrt(np.maximum(abs(A).max(axis=1).toarray().ravel(), abs(A).max(axis=0).toarray().ravel()))
    heavy = masses > SINGULAR * masses.max()
    stiffest = np.max(rows[heavy] ** 2 / masses[heavy], initial=0.0)
    rows[heavy] = np.maximum(rows[heavy], np.sqrt(ROUNDING * masses[heavy] * stiffest))
    D = coo_array(A - A.T)
    if not D.nnz:
        return 0.0, 0, 0
    i, j = D.coords
    share = np.abs(D.data) / np.maximum(rows[i] * rows[j], np.finfo(np.float64).tiny)  # entries may be as small as that
    worst = int(np.argmax(share))
    return float(share[worst]), int(i[worst]), int(j[worst])


def symmetrised(A: Sparse) -> Sparse:
    """A, its two triangles averaged."""
    from scipy.sparse import csr_array

    return csr_array((A + A.T) / 2)


def factored(A: Sparse) -> Factored:
    """L D L^T of the symmetric sparse A, whose diagonal is positive."""
    from scipy.sparse import csc_array, diags_array
    from scipy.sparse.linalg import splu

    scale = 1 / np.sqrt(A.diagonal())
    S = diags_array(scale)
    B = csc_array(S @ A @ S)
    options: dict[str, Any] = {"SymmetricMode": True}
    try:
        lu = splu(B, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options)
    except RuntimeError:  # a pivot that is exactly zero; which one it is, is found with a little added to the diagonal
        lu = splu(B + csc_array(diags_array(np.full(B.shape[0], SINGULAR / 10))), "MMD_AT_PLUS_A", 0.0, options=options)
    pivots = lu.U.diagonal()
    zero = np.flatnonzero(np.abs(pivots) <= SINGULAR)
    columns = np.argsort(lu.perm_c)
    negative = int(np.count_nonzero(pivots < -SINGULAR))
    return Factored(solve=lambda b: scale[:, None] * lu.solve(scale[:, None] * b), negative=negative, zero=columns[zero])
