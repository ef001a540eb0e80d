"""PARDISO of Intel's MKL by pypardiso: symmetric factors of any kind, by nested dissection (Schenk & Gärtner, FGCS 20, 2004).

pypardiso offers its own user the unsymmetric kind only. The symmetric kinds read the upper triangle and need half the memory.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fem.factorisers.factor import Factor, Singular, Values
from fem.structure import Sparse

DEFINITE, INDEFINITE, COMPLEX = 2, -2, 6
"""Kinds of symmetric matrices in PARDISO's numbering (`mtype`)."""

_ANALYSE_AND_FACTORISE, _SOLVE = 12, 33

_REFINEMENT, _ONLY_AFTER_POOR_PIVOTS = 8, 0
"""By default every solution is refined twice, which costs twice as much again and gains nothing on good pivots."""


def factorise(matrix: Sparse, definite: bool) -> Factor:
    """Symmetric factors of a sparse matrix, of which only the upper triangle is read.

    Raises
    ------
    Singular : a pivot is zero, or the matrix was promised to be positive definite and is not.
    """
    from pypardiso import PyPardisoSolver
    from pypardiso.pardiso_wrapper import PyPardisoError

    kind = COMPLEX if matrix.dtype.kind == "c" else DEFINITE if definite else INDEFINITE
    upper = _upper(matrix)
    solver = PyPardisoSolver(mtype=kind, phase=_ANALYSE_AND_FACTORISE)
    factor = Pardiso(solver, upper)
    try:
        solver._call_pardiso(upper, np.zeros((upper.shape[0], 1), dtype=upper.dtype))
    except PyPardisoError as error:
        raise Singular(str(error)) from None
    solver.set_iparm(_REFINEMENT, _ONLY_AFTER_POOR_PIVOTS)
    return factor


class Pardiso:
    """Factors held by MKL; they are freed with this object."""

    name = "pardiso"

    def __init__(self, solver: Any, upper: Sparse) -> None:
        self._solver, self._upper = solver, upper

    def solve(self, B: Values) -> Values:
        """Solution of ``A X = B`` for B (n,) or (n, k)."""
        self._solver.set_phase(_SOLVE)
        return np.asarray(self._solver._call_pardiso(self._upper, np.asfortranarray(B, dtype=self._upper.dtype)))

    def __del__(self) -> None:
        self._solver.free_memory(everything=True)


def _upper(sparse: Sparse) -> Sparse:
    """Upper triangle by rows, columns ascending, with every diagonal entry stored, be it zero: PARDISO wants it so."""
    from scipy.sparse import coo_array, csr_array, triu

    entries, every = triu(sparse, format="coo"), np.arange(sparse.shape[0])
    values = np.append(entries.data, np.zeros(len(every), dtype=sparse.dtype))
    places = np.append(entries.row, every), np.append(entries.col, every)
    upper = csr_array(coo_array((values, places), shape=sparse.shape))
    upper.sort_indices()
    return upper
