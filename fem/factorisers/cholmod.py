"""CHOLMOD by kvxopt: supernodal Cholesky of a real positive definite matrix (Chen, Davis, Hager, Rajamanickam, ACM TOMS 35, 2008).

It takes no pivots, so nothing indefinite: K - sigma M qualifies while sigma lies below the lowest eigenvalue.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

import numpy as np

from fem.factorisers.factor import Factor, Singular, Values
from fem.structure import Sparse


def factorise(matrix: Sparse, definite: bool) -> Factor:
    """Cholesky factor of a real positive definite matrix, of which only the lower triangle is read.

    Raises
    ------
    Singular : it is not positive definite.
    """
    from kvxopt import cholmod

    lower = _lower(matrix)
    factor = Cholmod(cholmod.symbolic(lower))
    try:
        cholmod.numeric(lower, factor._factor)
        factor.solve(np.zeros(matrix.shape[0]))  # a factor that broke off is noticed here only
    except ArithmeticError as error:
        raise Singular(f"not positive definite: {error}") from None
    return factor


class Cholmod:
    """A factor held by CHOLMOD."""

    name = "cholmod"

    def __init__(self, factor: Any) -> None:
        self._factor = factor

    def solve(self, B: Values) -> Values:
        """Solution of ``A X = B`` for B (n,) or (n, k)."""
        from kvxopt import cholmod

        X = _library().matrix(np.asfortranarray(B, dtype=np.float64))
        cholmod.solve(self._factor, X)
        return np.array(X).reshape(B.shape)


def _lower(sparse: Sparse) -> Any:
    from scipy.sparse import tril

    entries, kvxopt = tril(sparse, format="coo"), _library()
    row, column = (kvxopt.matrix(index.astype(np.int64)) for index in (entries.row, entries.col))
    return kvxopt.spmatrix(kvxopt.matrix(np.asarray(entries.data, dtype=np.float64)), row, column, sparse.shape)


def _library() -> Any:
    """kvxopt, whose own types know neither its matrices' names nor NumPy's arrays."""
    return import_module("kvxopt")
