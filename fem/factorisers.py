"""Exchangeable factorisers of sparse symmetric matrices.

    factor = factorise(K, definite=True)
    x = factor.solve(b)

    superlu   comes with SciPy; everything, up to about 250 000 degrees of freedom of a solid
    cholmod   optional; real positive definite matrices only: a base that is held, or a shift below zero
    pardiso   optional; everything; orders by nested dissection and is the leanest and fastest on solids

The optional ones come with ``pip install massline[fast]`` and are picked up when they are there.
"""

import os
from collections.abc import Callable
from contextlib import suppress
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from fem.structure import Sparse
from geometry.errors import BadInput
from geometry.frames import Integers
from geometry.toml_file import one_of

# What every factoriser gives back, and how it says that there are no factors.

Values = npt.NDArray[np.floating[Any] | np.complexfloating[Any, Any]]


class Factor(Protocol):
    """A factorised square matrix A."""

    name: str

    def solve(self, B: Values) -> Values:
        """Solution of ``A X = B`` for B (n,) or (n, k)."""


class Singular(ArithmeticError):
    """A matrix that has no factors of the kind asked for: singular, or not positive definite where that was promised."""


# CHOLMOD by kvxopt: supernodal Cholesky of a real positive definite matrix (Chen, Davis et al., ACM TOMS 35, 2008).
#
# It takes no pivots, so nothing indefinite: K - sigma M qualifies while sigma lies below the lowest eigenvalue.


class Cholmod:
    """Cholesky factor of a real positive definite matrix, of which only the lower triangle is read.

    Raises
    ------
    Singular : it is not positive definite.
    """

    name = "cholmod"

    def __init__(self, matrix: Sparse, definite: bool) -> None:
        from kvxopt import cholmod
        from scipy.sparse import tril

        self._kvxopt = kvxopt = import_module("kvxopt")  # its own types know neither its matrices' names nor NumPy's arrays
        entries = tril(matrix, format="coo")
        row, column = (kvxopt.matrix(index.astype(np.int64)) for index in (entries.row, entries.col))
        lower = kvxopt.spmatrix(kvxopt.matrix(np.asarray(entries.data, dtype=np.float64)), row, column, matrix.shape)
        self._factor = cholmod.symbolic(lower)
        try:
            cholmod.numeric(lower, self._factor)
            self.solve(np.zeros(matrix.shape[0]))  # a factor that broke off is noticed here only
        except ArithmeticError as error:
            raise Singular(f"not positive definite: {error}") from None

    def solve(self, B: Values) -> Values:
        """Solution of ``A X = B`` for B (n,) or (n, k)."""
        from kvxopt import cholmod

        X = self._kvxopt.matrix(np.asfortranarray(B, dtype=np.float64))
        cholmod.solve(self._factor, X)
        return np.array(X).reshape(B.shape)


# How large will the factors be? Estimated from the pattern alone before hours and the machine are spent on it.
#
# Degrees of freedom with the same neighbours (the three of a node) are merged. The graph of what is left is dissected: a
# breadth-first search from one end falls into levels, the last nodes of the smallest level near the middle are the separator,
# both halves are dissected again (George, SIAM J. Numer. Anal. 10, 1973). A separator of s rows whose piece touches b rows of
# earlier separators fills s (s + 1) / 2 + s b entries of the Cholesky factor. Minimum degree does a little better; that allowed
# for, the sum lies within a factor of 1.4 of what SuperLU fills on bars, plates and blocks of hexahedra and curved tetrahedra.

BYTES = {"superlu": 30.0, "cholmod": 30.0, "pardiso": 16.0}
"""Peak memory for each entry of a real Cholesky factor [B], measured on plates and blocks of 45 000 to 165 000 rows."""

BETTER = 0.75
"""Fill of the factorisers' own orders as a share of what this dissection comes to."""

COMPLEX_FACTOR = 2.0
LEAF = 60
MIDDLE = (0.3, 0.7)
"""Where between the two ends of a piece its separator may lie."""

ENOUGH = 0.9
"""Share of the available memory that the factors may take."""


def require_memory(matrix: Sparse, name: str, leaner: str | None = None) -> None:
    """Refuse a factorisation by the factoriser `name` that would not fit.

    Raises
    ------
    BadInput : with the estimate, what is available and the way out (`leaner` is a factoriser that needs less).
    """
    free = available()
    if free is None:
        return
    needed = predicted_bytes(matrix, name)
    if needed > ENOUGH * free:
        leave = f"use the leaner factoriser {leaner} (pip install massline[fast])" if leaner else "use a larger machine"
        problem = f"{matrix.shape[0]} degrees of freedom would need about {_gb(needed)}, and {_gb(free)} are available"
        remedy = f"Use a coarser mesh or fewer layers of elements, a beam model, or {leave}"
        raise BadInput("factorisation", name, problem, remedy)


def predicted_bytes(matrix: Sparse, name: str) -> float:
    """Peak memory [B] that the factoriser `name` will take for `matrix`, to about a factor of 1.5."""
    return BYTES[name] * (COMPLEX_FACTOR if matrix.dtype.kind == "c" else 1.0) * predicted_entries(matrix)


def predicted_entries(matrix: Sparse) -> float:
    """Entries of the Cholesky factor of a matrix with this symmetric pattern, in an order that keeps them few."""
    from scipy.sparse import csr_array

    # Graph of the rows of `matrix`, those with the same pattern merged into one, and how many each stands for
    pattern = csr_array(matrix)
    names = np.random.default_rng(0).integers(1, 2**62, pattern.shape[0])
    starts = np.minimum(pattern.indptr[:-1], max(pattern.nnz - 1, 0))
    sums = np.where(np.diff(pattern.indptr) > 0, np.add.reduceat(names[pattern.indices], starts), 0)
    _, first, label, weight = np.unique(sums, return_index=True, return_inverse=True, return_counts=True)
    kept = pattern[first]
    graph = csr_array((np.ones(kept.nnz, dtype=np.int32), label[kept.indices], kept.indptr), shape=(len(first), len(first)))
    graph.sum_duplicates()
    pieces: list[Integers] = [np.arange(len(weight))]
    entries = 0.0
    while pieces:
        piece = pieces.pop()
        rows = graph[piece]
        beyond = float(weight[np.setdiff1d(rows.indices, piece)].sum())
        separator, halves = _dissected(rows[:, piece], weight[piece])
        size = float(weight[piece[separator]].sum())
        share = 0.5 if not halves and len(piece) <= LEAF else 1.0  # a leaf is sparse inside
        entries += share * (size * (size + 1) / 2 + size * beyond)
        pieces += [piece[half] for half in halves]
    return BETTER * entries


def available() -> float | None:
    """Memory [B] that this process may still take, None where the system does not tell."""
    limits = []
    try:
        lines = Path("/proc/meminfo").read_text(encoding="ascii").splitlines()
        limits.append(next(1024.0 * int(line.split()[1]) for line in lines if line.startswith("MemAvailable:")))
    except (OSError, StopIteration):
        with suppress(AttributeError, ValueError, OSError):
            limits.append(float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")))
    with suppress(OSError, ValueError):  # a container (cgroup version 2); no such file, or "max": no limit
        limit, used = (int(Path("/sys/fs/cgroup", name).read_text(encoding="ascii")) for name in ("memory.max", "memory.current"))
        limits.append(float(max(limit - used, 0)))
    return min(limits, default=None)


def _dissected(graph: Sparse, weight: Integers) -> tuple[Integers, list[Integers]]:
    """Separator and the pieces that it leaves; all of a small piece is its own separator."""
    everything = np.arange(len(weight))
    if len(weight) <= LEAF:
        return everything, []
    order, ends = _levels(graph, 0)
    if len(order) < len(weight):
        return everything[:0], [order, np.setdiff1d(everything, order)]
    order, ends = _levels(graph, int(order[-1]))
    if len(ends) < 3:
        return everything, []
    # Bounds of the smallest level near the middle; `weights` are summed up to each level's end, from zero
    weights = np.append(0, np.cumsum(weight[order])[ends - 1])
    middle = (weights[:-1] + weights[1:]) / 2 / weights[-1]
    near = (middle > MIDDLE[0]) & (middle < MIDDLE[1])
    if not np.any(near):
        near = np.abs(middle - 0.5) == np.abs(middle - 0.5).min()
    narrowest = int(np.flatnonzero(near)[np.argmin(np.diff(weights)[near])])
    first, last = int(ends[narrowest - 1]) if narrowest else 0, int(ends[narrowest])
    beyond = np.zeros(len(weight), dtype=np.int32)
    beyond[order[last:]] = 1
    level = order[first:last]
    needed = (graph[level] @ beyond > 0) | (
        last == len(order)
    )  # of quadratic elements a level is several layers of nodes; the last of them separates
    halves = np.append(order[:first], level[~needed]), order[last:]
    return level[needed], [half for half in halves if len(half)]


def _levels(graph: Sparse, start: int) -> tuple[Integers, Integers]:
    """Vertices in the order of a breadth-first search, and where in it each level ends."""
    from scipy.sparse.csgraph import breadth_first_order

    order, before = breadth_first_order(graph, start)
    place = np.zeros(graph.shape[0], dtype=np.intp)
    place[order] = np.arange(len(order))
    parents = place[before[order[1:]]]  # never falls along the search
    ends = [1]
    while ends[-1] < len(order):
        ends.append(1 + int(np.searchsorted(parents, ends[-1])))
    return order, np.array(ends)


def _gb(size: float) -> str:
    return f"{size / 1e9:.3g} GB"


# PARDISO of Intel's MKL by pypardiso: symmetric factors of any kind, by nested dissection (Schenk & Gärtner, FGCS 20, 2004).
#
# pypardiso offers its own user the unsymmetric kind only. The symmetric kinds read the upper triangle and need half the memory.


DEFINITE, INDEFINITE, COMPLEX = 2, -2, 6
"""Kinds of symmetric matrices in PARDISO's numbering (`mtype`)."""

_ANALYSE_AND_FACTORISE, _SOLVE = 12, 33

_REFINEMENT, _ONLY_AFTER_POOR_PIVOTS = 8, 0
"""By default every solution is refined twice, which costs twice as much again and gains nothing on good pivots."""


class Pardiso:
    """Symmetric factors of a sparse matrix, of which only the upper triangle is read; MKL's memory is freed with this object.

    Raises
    ------
    Singular : a pivot is zero, or the matrix was promised to be positive definite and is not.
    """

    name = "pardiso"
    _solver: Any = None

    def __init__(self, matrix: Sparse, definite: bool) -> None:
        from pypardiso import PyPardisoSolver
        from pypardiso.pardiso_wrapper import PyPardisoError
        from scipy.sparse import coo_array, csr_array, triu

        kind = COMPLEX if matrix.dtype.kind == "c" else DEFINITE if definite else INDEFINITE
        # Upper triangle by rows, columns ascending, with every diagonal entry stored, be it zero: PARDISO wants it so
        entries, every = triu(matrix, format="coo"), np.arange(matrix.shape[0])
        values = np.append(entries.data, np.zeros(len(every), dtype=matrix.dtype))
        places = np.append(entries.row, every), np.append(entries.col, every)
        self._upper = upper = csr_array(coo_array((values, places), shape=matrix.shape))
        upper.sort_indices()
        self._solver = solver = PyPardisoSolver(mtype=kind, phase=_ANALYSE_AND_FACTORISE)
        try:
            solver._call_pardiso(upper, np.zeros((upper.shape[0], 1), dtype=upper.dtype))
        except PyPardisoError as error:
            raise Singular(str(error)) from None
        solver.set_iparm(_REFINEMENT, _ONLY_AFTER_POOR_PIVOTS)

    def solve(self, B: Values) -> Values:
        """Solution of ``A X = B`` for B (n,) or (n, k)."""
        self._solver.set_phase(_SOLVE)
        return np.asarray(self._solver._call_pardiso(self._upper, np.asfortranarray(B, dtype=self._upper.dtype)))

    def __del__(self) -> None:
        if self._solver is not None:
            self._solver.free_memory(everything=True)


# SuperLU, which comes with SciPy: sparse LU of any regular matrix, real or complex.
#
# For a symmetric matrix the fill is ordered for A + A^T and the pivots are taken from the diagonal unless they are poor, which
# keeps the factors near the size of a Cholesky factor (Li, ACM TOMS 31, 2005).

DIAGONAL_PIVOT = 1e-3
"""A diagonal pivot is taken when it is at least this share of the largest entry of its column."""


class SuperLU:
    """Factors of a square sparse matrix; a promise of definiteness is of no use to it.

    Raises
    ------
    Singular : a pivot is exactly zero.
    """

    name = "superlu"

    def __init__(self, matrix: Sparse, definite: bool) -> None:
        from scipy.sparse import csc_array
        from scipy.sparse.linalg import splu

        options = {"SymmetricMode": True}
        try:
            self._lu = splu(csc_array(matrix), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=DIAGONAL_PIVOT, options=options)
        except RuntimeError as error:
            raise Singular(str(error)) from None

    def solve(self, B: Values) -> Values:
        """Solution of ``A X = B`` for B (n,) or (n, k)."""
        return np.asarray(self._lu.solve(B))


NAMES = ("superlu", "cholmod", "pardiso")

SMALL = 10_000
"""Up to so many rows SuperLU answers before the library of another is loaded, and memory is no question."""

_LIBRARIES = {"superlu": "scipy", "cholmod": "kvxopt", "pardiso": "pypardiso"}
_METHODS: dict[str, Callable[[Sparse, bool], Factor]] = {"superlu": SuperLU, "cholmod": Cholmod, "pardiso": Pardiso}


def factorise(matrix: Sparse, *, definite: bool = False, name: str | None = None) -> Factor:
    """Factors of a sparse symmetric `matrix` (n, n), real or complex (then symmetric, not Hermitian).

    Parameters
    ----------
    definite : the caller promises a real positive definite matrix
    name : one of `NAMES`; the best that is installed when None

    Raises
    ------
    Singular : it is singular, or was promised to be positive definite and is not.
    BadInput : the factoriser does not exist, is not installed, cannot serve this matrix, or its factors would not fit in memory.
    """
    chosen = choose(matrix, definite, name)
    if matrix.shape[0] > SMALL:
        require_memory(matrix, chosen, leaner="pardiso" if chosen != "pardiso" else None)
    return _METHODS[chosen](matrix, definite)


def installed() -> tuple[str, ...]:
    """Those of `NAMES` whose library is there."""
    return tuple(name for name in NAMES if find_spec(_LIBRARIES[name]))


def choose(matrix: Sparse, definite: bool, name: str | None = None) -> str:
    """The factoriser that serves `matrix`: `name`, or the best that is installed.

    Raises
    ------
    BadInput : no such factoriser, its library is not installed, or it cannot serve a matrix of this kind.
    """
    if name is None:
        if matrix.shape[0] <= SMALL:
            return "superlu"
        able = ("pardiso", "cholmod", "superlu") if _real_definite(matrix, definite) else ("pardiso", "superlu")
        return next(name for name in able if name in installed())
    one_of(name, NAMES, source="factoriser", where="name")
    if name not in installed():
        problem = f"the library {_LIBRARIES[name]} is not installed"
        raise BadInput("factoriser", name, problem, "Install massline[fast], or use superlu")
    if name == "cholmod" and not _real_definite(matrix, definite):
        problem = "it serves real positive definite matrices only, and this one is complex or shifted into its spectrum"
        raise BadInput("factoriser", name, problem, "Use superlu or pardiso")
    return name


def _real_definite(matrix: Sparse, definite: bool) -> bool:
    return definite and matrix.dtype.kind != "c"
