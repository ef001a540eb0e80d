"""SuperLU, which comes with SciPy: sparse LU of any regular matrix, real or complex.

For a symmetric matrix the fill is ordered for A + A^T and the pivots are taken from the diagonal unless they are poor, which
keeps the factors near the size of a Cholesky factor (Li, ACM TOMS 31, 2005).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fem.factorisers.factor import Factor, Singular, Values
from fem.structure import Sparse

DIAGONAL_PIVOT = 1e-3
"""A diagonal pivot is taken when it is at least this share of the largest entry of its column."""


def factorise(matrix: Sparse, definite: bool) -> Factor:
    """Factors of a square sparse matrix; a promise of definiteness is of no use to it.

    Raises
    ------
    Singular : a pivot is exactly zero.
    """
    from scipy.sparse import csc_array
    from scipy.sparse.linalg import splu

    options = {"SymmetricMode": True}
    try:
        lu = splu(csc_array(matrix), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=DIAGONAL_PIVOT, options=options)
    except RuntimeError as error:
        raise Singular(str(error)) from None
    return SuperLU(lu)


class SuperLU:
    """Factors held by SuperLU."""

    name = "superlu"

    def __init__(self, lu: Any) -> None:
        self._lu = lu

    def solve(self, B: Values) -> Values:
        """Solution of ``A X = B`` for B (n,) or (n, k)."""
        return np.asarray(self._lu.solve(B))
