"""`Condensed`: kept modes with the static answer of the truncated ones, where structural damping couples the two.

A lossy layer (silicone, loss factor 0.2) pulls at kept and truncated modes alike, and the truncated ones give way. With all modes in
hand the modal stiffness is A = Omega² + i S; taking the truncated ones as static leaves the Schur complement of A on the kept ones.
It needs none of the truncated modes, because it is the inverse of a block of A^-1, and that is a static solution with the complex
stiffness (Guyan's condensation, AIAA Journal 3, 1965, in modal coordinates):

    F_kk = (M Phi)^T (K + i S)^-1 M Phi,   F_kb = (M Phi)^T (K + i S)^-1 P,   F_bb = P^T (K + i S)^-1 P
    A = F_kk^-1,   L^T = A F_kb,   R = F_bb - F_kb^T A F_kb.

Without damping these are Omega², the participation and the residual mass themselves.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fem.factorisers import Factor, factorise
from fem.held_base import HeldBase
from fem.structure import Sparse
from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray

MODERATE = 0.5
"""Up to this loss factor the real factors serve: the series in K^-1 S converges like its powers."""

FEW = 2_000
"""Up to so many degrees of freedom a complex factorisation is the quicker way."""

SETTLED = 1e-10


@dataclass(frozen=True, eq=False, kw_only=True)
class Condensed:
    """Complex counterparts of squared frequencies, participation and residual mass.

    Attributes
    ----------
    stiffness : (n, n) [rad²/s²], symmetric
    participation : (6, n) [kg^0.5, kg^0.5 m]
    residual : (6, 6) [kg s², kg m s², kg m² s²], symmetric
    """

    stiffness: ComplexArray
    participation: ComplexArray
    residual: ComplexArray


def condensed(held: HeldBase, S: Sparse, greatest: float, shapes: Array, factor: Factor | None) -> Condensed:
    """The truncated modes of `held` condensed on `shapes` (f, n).

    Parameters
    ----------
    S : (f, f) sparse structural damping, sum of eta_p K_p
    greatest : the greatest loss factor in it
    factor : of the stiffness, if there is one already
    """
    n = shapes.shape[1]
    loads = np.hstack([held.mass @ shapes, held.load])
    F = loads.T @ _solved(held, S, greatest, factor)(loads)
    A = np.linalg.inv(F[:n, :n])
    L = A @ F[:n, n:]
    R = F[n:, n:] - F[n:, :n] @ L
    return Condensed(stiffness=(A + A.T) / 2, participation=np.ascontiguousarray(L.T), residual=(R + R.T) / 2)


def _solved(held: HeldBase, S: Sparse, greatest: float, factor: Factor | None) -> Callable[[Array], ComplexArray]:
    """Solution with K + i S."""
    if factor is None or greatest > MODERATE or held.free.size <= FEW:
        whole = factorise((held.stiffness + 1j * S).tocsc())
        return lambda B: np.asarray(whole.solve(B.astype(np.complex128)))
    return lambda B: _series(S, factor, B)


def _series(S: Sparse, factor: Factor, B: Array) -> ComplexArray:
    """(1 - i T + (i T)² - ...) K^-1 B with T = K^-1 S: real solutions only, as many as the greatest loss factor asks for."""
    term = np.asarray(factor.solve(B), dtype=np.float64)
    total, first, turn = term.astype(np.complex128), np.abs(term).max(), 1.0 + 0.0j
    while np.abs(term).max() > SETTLED * first:
        term, turn = np.asarray(factor.solve(S @ term)), -1j * turn
        total += turn * term
    return total
