"""The lowest eigenvalues of K x = lambda M x, by inverting about a shift.

Both methods look for the largest theta = 1 / (lambda - sigma), where a discretised structure keeps its lowest modes well apart
from a crowd that nobody wants (Ericsson & Ruhe, Math. Comp. 35, 1980). Small problems go to LAPACK, large ones to ARPACK's
Lanczos iteration with a factorised K - sigma M. A mass matrix may be singular (joints without mass): there theta is zero.

Lanczos sees one vector of equal eigenvalues, and the others only as rounding brings them in; symmetric articles have many. So the
rest of the space is searched once more from another start. When a mode turns up there below the last one kept, the iteration
is repeated in that rest, and the lowest of both are kept.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from fem.factorisers import Factor, Singular, factorise
from fem.structure import Sparse
from geometry.arrays import Array
from geometry.errors import CheckFailed

DENSE = 250
"""Up to so many degrees of freedom LAPACK is the faster way."""

SEEN = 1e-12
"""Share of the largest theta below which rounding decides: frequencies beyond a million times the lowest are not given."""

CONVERGED = 1e-10
"""Relative residual at which Lanczos may stop; the eigenvalues are then right to its square."""

SEARCH_STEPS = 20
ROUNDS = 4
MISSED = 1.001
"""How far theta of the searched rest may lie above the last mode's before that mode counts as missed."""

Progress = Callable[[int], None]
"""Called with the number of solutions with the factors so far; it may raise to end the iteration."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Eigenpairs:
    """The lowest eigenvalues and their vectors.

    Attributes
    ----------
    values : (n,) [rad²/s²], ascending
    vectors : (f, n) mass-normalised; the entry largest in size of each is positive
    factor : what was factorised for them, K - shift M; None when LAPACK did it
    """

    values: Array
    vectors: Array
    factor: Factor | None = None


def lowest(
    stiffness: Sparse,
    mass: Sparse,
    count: int,
    *,
    shift: float = 0.0,
    factoriser: str | None = None,
    progress: Progress | None = None,
) -> Eigenpairs:
    """The `count` eigenpairs of (K, M) nearest above `shift`, or all there are when they are fewer.

    Parameters
    ----------
    stiffness, mass : (f, f) sparse, symmetric; K positive semi-definite, M too
    shift : [rad²/s²], not above the lowest eigenvalue; below zero for a body that floats freely (`floating_shift`)
    factoriser : name as in `fem.factorisers`; chosen by itself when None
    progress : hook, see `Progress`

    Raises
    ------
    CheckFailed : K - shift M is singular, the iteration does not converge, or a mode was missed.
    """
    size = stiffness.shape[0]
    if size == 0:
        return Eigenpairs(values=np.zeros(0), vectors=np.zeros((0, 0)))
    if size <= DENSE or count > size // 4:
        return _by_lapack(stiffness, mass, count, shift)
    return _by_lanczos(stiffness, mass, count, shift, factoriser, progress or (lambda solved: None))


def floating_shift(stiffness: Sparse, mass: Sparse) -> float:
    """A shift below zero for a body that floats freely, in the scale of its matrices [rad²/s²].

    Small beside the stiffness, so that the elastic modes keep their distance, and large beside its rounding.
    """
    K, M = stiffness.diagonal(), mass.diagonal()
    return -1e-9 * float(np.median(K[M > 0] / M[M > 0]))


def _by_lapack(K: Sparse, M: Sparse, count: int, shift: float) -> Eigenpairs:
    from scipy.linalg import LinAlgError, eigh

    m = M.toarray()
    try:
        theta, vectors = eigh(m, K.toarray() - shift * m)
    except LinAlgError:
        raise _floats() from None
    best = np.flatnonzero(theta > SEEN * theta[-1])[::-1][:count]
    return _sorted(shift + 1 / theta[best], vectors[:, best] / np.sqrt(theta[best]))


def _by_lanczos(K: Sparse, M: Sparse, count: int, shift: float, factoriser: str | None, progress: Progress) -> Eigenpairs:

    try:
        factor = factorise(K - shift * M if shift else K, definite=True, name=factoriser)
    except Singular:
        raise _floats() from None
    solve = _counting(factor, progress)
    pairs = _iterated(K, M, count, shift, solve, np.zeros((K.shape[0], 0)))
    for _ in range(ROUNDS):
        best = largest_left(M, pairs.vectors, solve)
        if best <= MISSED / (pairs.values[-1] - shift):
            return replace(pairs, factor=factor)
        others = _iterated(K, M, count, shift, solve, pairs.vectors)
        pairs = _lowest_of(pairs, others, count)
    frequency = np.sqrt(max(shift + 1 / best, 0.0)) / (2 * np.pi)
    raise CheckFailed(
        f"The eigenvalue iteration missed a mode near {frequency:.4g} Hz. Ask for a few more modes.", frequency_hz=frequency
    )


def _iterated(K: Sparse, M: Sparse, count: int, shift: float, solve: Callable[[Array], Array], known: Array) -> Eigenpairs:
    """`count` eigenpairs by ARPACK in the space M-orthogonal to the modes `known` (f, m)."""
    from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigsh

    def inverse(b: Array) -> Array:
        x = solve(b)
        return np.asarray(x - known @ (known.T @ (M @ x)))

    size = K.shape[0]
    start = inverse(M @ np.random.default_rng(0).standard_normal(size))  # M first: a massless direction has no place in it
    operator = LinearOperator(K.shape, matvec=inverse, dtype=np.float64)
    ncv = min(size, max(2 * count + 1, 20))
    try:
        return _sorted(*eigsh(K, count, M=M, sigma=shift, OPinv=operator, v0=start, ncv=ncv, tol=CONVERGED))
    except ArpackNoConvergence as error:
        raise CheckFailed(
            f"The eigenvalue iteration found {len(error.eigenvalues)} of {count} modes and stopped. Ask for fewer modes, or "
            "check that stiffness and mass are symmetric and in the same units.",
            found=len(error.eigenvalues),
        ) from None


def _lowest_of(some: Eigenpairs, others: Eigenpairs, count: int) -> Eigenpairs:
    together = _sorted(np.append(some.values, others.values), np.hstack([some.vectors, others.vectors]))
    return Eigenpairs(values=together.values[:count], vectors=together.vectors[:, :count])


def largest_left(M: Sparse, vectors: Array, solve: Callable[[Array], Array]) -> float:
    """A lower bound of theta in the space M-orthogonal to `vectors` (f, n): some Lanczos steps from a start of their own."""
    from scipy.linalg import eigh_tridiagonal

    basis = np.zeros((len(vectors), 0))
    diagonal: list[float] = []
    beside: list[float] = []
    vector = solve(M @ np.random.default_rng(1).standard_normal(len(vectors)))
    for _ in range(min(SEARCH_STEPS, vectors.shape[0] - vectors.shape[1])):
        for known in (vectors, basis, vectors, basis):  # twice is enough (Parlett, The Symmetric Eigenvalue Problem, 6.9)
            vector = vector - known @ (known.T @ (M @ vector))
        norm = float(np.sqrt(max(vector @ (M @ vector), 0.0)))
        if diagonal:
            if norm <= SEEN * max(diagonal):
                break
            beside.append(norm)
        elif norm == 0.0:
            return 0.0
        vector = vector / norm
        basis = np.column_stack([basis, vector])
        weighed = M @ vector
        vector = solve(weighed)
        diagonal.append(float(weighed @ vector))
    return float(eigh_tridiagonal(diagonal, beside, eigvals_only=True)[-1])


def _counting(factor: Factor, progress: Progress) -> Callable[[Array], Array]:
    solved = 0

    def solve(b: Array) -> Array:
        nonlocal solved
        solved += 1
        progress(solved)
        return np.asarray(factor.solve(b), dtype=np.float64)

    return solve


def _sorted(values: Array, vectors: Array) -> Eigenpairs:
    order = np.argsort(values)
    vectors = vectors[:, order]
    signs = np.sign(vectors[np.argmax(np.abs(vectors), axis=0), np.arange(len(order))])
    return Eigenpairs(values=values[order], vectors=vectors * signs)


def _floats() -> CheckFailed:
    return CheckFailed(
        "The stiffness resists no motion of at least one part of the structure: it floats freely or a joint of it swings. "
        "Hold it, connect it, or ask for a floating body."
    )
