"""Exchangeable factorisers of sparse symmetric matrices.

factor = factorise(K, definite=True)
x = factor.solve(b)
"""

from __future__ import annotations

from fem.factorisers import superlu
from fem.factorisers.factor import Factor, Singular
from fem.structure import Sparse

__all__ = ["Factor", "Singular", "factorise"]


def factorise(matrix: Sparse, *, definite: bool = False, name: str | None = None) -> Factor:
    """Factors of a sparse symmetric `matrix`.

    Raises
    ------
    Singular : it is singular, or was promised to be positive definite and is not.
    """
    return superlu.factorise(matrix)
