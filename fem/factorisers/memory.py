"""How large will the factors be? Estimated from the pattern alone before hours and the machine are spent on it.

Degrees of freedom with the same neighbours (the three of a node) are merged. The graph of what is left is dissected: a
breadth-first search from one end falls into levels, the last nodes of the smallest level near the middle are the separator, both
halves are dissected again (George, SIAM J. Numer. Anal. 10, 1973). A separator of s rows whose piece touches b rows of earlier
separators fills s (s + 1) / 2 + s b entries of the Cholesky factor. Minimum degree does a little better; that allowed for, the
sum lies within a factor of 1.4 of what SuperLU fills on bars, plates and blocks of hexahedra and curved tetrahedra.
"""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np

from fem.structure import Sparse
from geometry.arrays import Integers
from geometry.errors import BadInput

BYTES = {"superlu": 30.0, "cholmod": 30.0, "pardiso": 16.0}
"""Peak memory for each entry of a real Cholesky factor [B], measured on plates and blocks of 45 000 to 165 000 rows."""

BETTER = 0.75
"""Fill of the factorisers' own orders as a share of what this dissection comes to."""

COMPLEX = 2.0
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
        raise BadInput(
            source="factorisation",
            field=name,
            problem=f"{matrix.shape[0]} degrees of freedom would need about {_gb(needed)}, and {_gb(free)} are available",
            remedy=f"Use a coarser mesh or fewer layers of elements, a beam model, or {leave}",
        )


def predicted_bytes(matrix: Sparse, name: str) -> float:
    """Peak memory [B] that the factoriser `name` will take for `matrix`, to about a factor of 1.5."""
    return BYTES[name] * (COMPLEX if matrix.dtype.kind == "c" else 1.0) * predicted_entries(matrix)


def predicted_entries(matrix: Sparse) -> float:
    """Entries of the Cholesky factor of a matrix with this symmetric pattern, in an order that keeps them few."""
    graph, weight = _merged(matrix)
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
    limits = [limit for limit in (_free_of_machine(), _free_of_group()) if limit is not None]
    return min(limits, default=None)


def _merged(matrix: Sparse) -> tuple[Sparse, Integers]:
    """Graph of the rows of `matrix`, those with the same pattern merged into one, and how many each stands for."""
    from scipy.sparse import csr_array

    pattern = csr_array(matrix)
    names = np.random.default_rng(0).integers(1, 2**62, pattern.shape[0])
    starts = np.minimum(pattern.indptr[:-1], max(pattern.nnz - 1, 0))
    sums = np.where(np.diff(pattern.indptr) > 0, np.add.reduceat(names[pattern.indices], starts), 0)
    _, first, label, weight = np.unique(sums, return_index=True, return_inverse=True, return_counts=True)
    rows = pattern[first]
    graph = csr_array((np.ones(rows.nnz, dtype=np.int32), label[rows.indices], rows.indptr), shape=(len(first), len(first)))
    graph.sum_duplicates()
    return graph, weight


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
    first, last = _narrowest(np.append(0, np.cumsum(weight[order])[ends - 1]), ends)
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


def _narrowest(weights: Integers, ends: Integers) -> tuple[int, int]:
    """Bounds of the smallest level near the middle; `weights` are summed up to each level's end, from zero."""
    middle = (weights[:-1] + weights[1:]) / 2 / weights[-1]
    near = (middle > MIDDLE[0]) & (middle < MIDDLE[1])
    if not np.any(near):
        near = np.abs(middle - 0.5) == np.abs(middle - 0.5).min()
    level = int(np.flatnonzero(near)[np.argmin(np.diff(weights)[near])])
    return int(ends[level - 1]) if level else 0, int(ends[level])


def _free_of_machine() -> float | None:
    try:
        lines = Path("/proc/meminfo").read_text(encoding="ascii").splitlines()
        return next(1024.0 * int(line.split()[1]) for line in lines if line.startswith("MemAvailable:"))
    except (OSError, StopIteration):
        return _installed()


def _installed() -> float | None:
    try:
        return float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    except (AttributeError, ValueError, OSError):
        return None


def _free_of_group() -> float | None:
    """What a container leaves this process (cgroup version 2)."""
    try:
        limit, used = (int(Path("/sys/fs/cgroup", name).read_text(encoding="ascii")) for name in ("memory.max", "memory.current"))
    except (OSError, ValueError):  # no such file, or "max": no limit
        return None
    return float(max(limit - used, 0))


def _gb(size: float) -> str:
    return f"{size / 1e9:.3g} GB"
