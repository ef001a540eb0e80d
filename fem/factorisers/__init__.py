"""Exchangeable factorisers of sparse symmetric matrices.

    factor = factorise(K, definite=True)
    x = factor.solve(b)

    superlu   comes with SciPy; everything, up to about 250 000 degrees of freedom of a solid
    cholmod   optional; real positive definite matrices only: a base that is held, or a shift below zero
    pardiso   optional; everything; orders by nested dissection and is the leanest and fastest on solids

The optional ones come with ``pip install massline[fast]`` and are picked up when they are there.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib.util import find_spec

from fem.factorisers import cholmod, pardiso, superlu
from fem.factorisers.factor import Factor, Singular
from fem.factorisers.memory import require_memory
from fem.structure import Sparse
from geometry.errors import BadInput
from geometry.keys import one_of

__all__ = ["NAMES", "Factor", "Singular", "choose", "factorise", "installed"]

NAMES = ("superlu", "cholmod", "pardiso")

SMALL = 10_000
"""Up to so many rows SuperLU answers before the library of another is loaded, and memory is no question."""

_LIBRARIES = {"superlu": "scipy", "cholmod": "kvxopt", "pardiso": "pypardiso"}
_METHODS: dict[str, Callable[[Sparse, bool], Factor]] = {
    "superlu": superlu.factorise,
    "cholmod": cholmod.factorise,
    "pardiso": pardiso.factorise,
}


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
        return _best(matrix, definite)
    one_of(name, NAMES, source="factoriser", where="name")
    if name not in installed():
        raise BadInput(
            source="factoriser",
            field=name,
            problem=f"the library {_LIBRARIES[name]} is not installed",
            remedy="Install massline[fast], or use superlu",
        )
    if name == "cholmod" and not _real_definite(matrix, definite):
        raise BadInput(
            source="factoriser",
            field=name,
            problem="it serves real positive definite matrices only, and this one is complex or shifted into its spectrum",
            remedy="Use superlu or pardiso",
        )
    return name


def _best(matrix: Sparse, definite: bool) -> str:
    if matrix.shape[0] <= SMALL:
        return "superlu"
    able = ("pardiso", "cholmod", "superlu") if _real_definite(matrix, definite) else ("pardiso", "superlu")
    return next(name for name in able if name in installed())


def _real_definite(matrix: Sparse, definite: bool) -> bool:
    return definite and matrix.dtype.kind != "c"
