"""`Modes` from exudyn's linearised systems: of one mesh, and of two that say where they go.

Exudyn's beam bends too stiffly by the square of the element length h. With half of h the error is a quarter, so that
``fine + (fine - coarse) / 3`` is free of it and wrong with the fourth power (Richardson). Modal stiffness, participation and the
static answer to an accelerated base are extrapolated; the rigid mass needs none, because linear shapes hold it exactly.
Neighbours in frequency may pass one another or mix from mesh to mesh, so the coarse modes are first turned among themselves to
look like the fine ones (Procrustes), within a window of frequency; short waves that the coarse mesh cannot tell keep what the
fine one says.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem.condensed import Condensed
from fem.flexible_body.linearised import Linearised
from fem.flexible_body.running import failed
from fem.modes import Modes
from geometry.arrays import Array, Integers

ALIKE = 0.8
"""Least share of a mode of the fine mesh that coarse modes near its frequency must hold for it to be extrapolated."""

WINDOW = 0.3
"""How far in frequency, relative, coarse modes may lie to be taken for a fine one."""


@dataclass(frozen=True, eq=False, kw_only=True)
class _Found:
    """Modes on the mesh of `system`, and where extrapolation puts them; all ascending."""

    system: Linearised
    shapes: Array  # (N, n), mass-normalised
    squares: Array  # (n,) [(rad/s)²]
    participation: Array  # (6, n)
    static: Array  # (6, 6), of all modes
    own: Array  # (n, n) modal stiffness on the mesh itself


def single(system: Linearised, lossy: Array, reference_point: Array, count: int) -> Modes:
    """The lowest `count` modes of `system`; `lossy` (n, n) is the sum of eta_p K_p in its coordinates."""
    squares = _squares(system)[:count]
    found = _Found(
        system=system,
        shapes=system.shapes[:, :count],
        squares=squares,
        participation=system.participation[:, :count],
        static=system.compliance(),
        own=np.diag(squares),
    )
    return _modes(found, lossy, reference_point)


def extrapolated(coarse: Linearised, fine: Linearised, lossy: Array, reference_point: Array, count: int) -> Modes:
    """The lowest `count` modes that `coarse` and `fine` lead to; `lossy` is that of `fine`.

    The nodes of the plan of `coarse` come first in that of `fine`.

    Raises
    ------
    CheckFailed : the two meshes are too far apart to be extrapolated.
    """
    known, turn = _turn(coarse, fine, count)
    own, L = np.diag(_squares(fine)[:count]), fine.participation[:, :count].copy()
    A = own.copy()
    A[np.ix_(known, known)] = _richardson(turn.T @ (_squares(coarse)[:, None] * turn), own[np.ix_(known, known)])
    L[:, known] = _richardson(coarse.participation @ turn, L[:, known])
    squares, V = np.linalg.eigh(_symmetric(A))
    if squares.size and squares[0] <= 0:
        raise failed("solve on two meshes", "both lead to a negative squared frequency; the coarser one needs more elements")
    found = _Found(
        system=fine,
        shapes=fine.shapes[:, :count] @ V,
        squares=squares,
        participation=L @ V,
        static=_richardson(coarse.compliance(), fine.compliance()),
        own=V.T @ own @ V,
    )
    return _modes(found, lossy, reference_point)


def _squares(system: Linearised) -> Array:
    return np.asarray((2 * np.pi * system.frequency) ** 2)


def _modes(found: _Found, lossy: Array, reference_point: Array) -> Modes:
    """`found` as `Modes`; damping from the strain energy of its shapes."""
    n, omega, L = found.squares.size, np.sqrt(found.squares), found.participation
    moved = omega / np.sqrt(np.diag(found.own))
    S = np.outer(moved, moved) * (found.shapes.T @ lossy @ found.shapes)
    residual = _symmetric(found.static - (L / found.squares) @ L.T)
    return Modes(
        frequency=omega / (2 * np.pi),
        damping_ratio=np.diag(S) / (2 * found.squares),
        participation=L,
        rigid_mass=_symmetric(found.system.rigid_mass),
        residual=residual,
        reference_point=reference_point,
        shapes=np.zeros((0, n)),
        viscous=np.zeros((n, n)),
        structural=_symmetric(S),
        condensed=_condensed(found, lossy, moved, residual) if n and lossy.any() else None,
    )


def _condensed(found: _Found, lossy: Array, moved: Array, residual: Array) -> Condensed:
    """What the loss makes of stiffness, participation and residual, as `fem.condensed` has it, on the mesh and carried along.

    The mesh's own couplings by loss are kept; its modal stiffness is scaled by `moved` on both sides, its participation and
    residual are shifted, to where extrapolation has put the undamped ones.
    """
    system, n = found.system, found.squares.size
    P = system.mass @ system.rigid
    own_L = P.T @ found.shapes
    F = system.answer(np.hstack([system.mass @ found.shapes, P]), lossy)
    A = np.linalg.inv(F[:n, :n])
    X = A @ F[:n, n:]
    R = F[n:, n:] - F[n:, :n] @ X + residual - (system.compliance() - own_L @ np.linalg.solve(found.own, own_L.T))
    stiffness = np.asarray(np.outer(moved, moved) * A, dtype=np.complex128)
    return Condensed(
        stiffness=(stiffness + stiffness.T) / 2, participation=X.T + (found.participation - own_L), residual=(R + R.T) / 2
    )


def _turn(coarse: Linearised, fine: Linearised, count: int) -> tuple[Integers, Array]:
    """Which of the lowest `count` modes of `fine` the coarse mesh can tell, (k,), and what turns its own (m,) into them.

    The second, (m, k), is orthogonal.
    """
    if not count:
        return np.zeros(0, dtype=np.intp), np.zeros((coarse.frequency.size, 0))
    here, there = _common(coarse, fine).T
    M, a, b = coarse.mass[np.ix_(here, here)], coarse.shapes[here], fine.shapes[there, :count]
    cross = a.T @ M @ b / np.sqrt(np.outer(_norms(a, M), _norms(b, M)))
    cross[np.abs(coarse.frequency[:, None] / fine.frequency[:count] - 1) > WINDOW] = 0.0
    known = np.flatnonzero(np.sum(cross**2, axis=0) >= ALIKE)
    U, _, Vt = np.linalg.svd(cross[:, known], full_matrices=False)
    return known, np.asarray(U @ Vt)


def _common(coarse: Linearised, fine: Linearised) -> Array:
    """(n, 2) coordinates in `coarse` and in `fine` of every place that both have."""
    places = zip(coarse.nodes, fine.nodes, strict=False)
    pairs = np.array([pair for a, b in places for pair in zip(a, b, strict=True)])
    return np.asarray((6 * pairs[:, None, :] + np.arange(6)[None, :, None]).reshape(-1, 2))


def _norms(shapes: Array, M: Array) -> Array:
    return np.asarray(np.einsum("ir,ir->r", shapes, M @ shapes))


def _richardson(coarse: Array, fine: Array) -> Array:
    return np.asarray(fine + (fine - coarse) / 3)


def _symmetric(matrix: Array) -> Array:
    return np.asarray((matrix + matrix.T) / 2)
