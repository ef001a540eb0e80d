"""`Modes` from exudyn's linearised systems: of one mesh, and of two that say where they go.

Exudyn's beam bends too stiffly by the square of the element length h. With half of h the error is a quarter, so that
``fine + (fine - coarse) / 3`` is free of it and wrong with the fourth power (Richardson). Squared frequencies, participation
and the static answer to an accelerated base are extrapolated; the rigid mass needs none, because linear shapes hold it exactly. A
mode of the fine mesh is told on the coarse one by its shape, since neighbours in frequency may pass one another; short waves
that the coarse mesh cannot tell keep what the fine one says.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem.flexible_body.linearised import Linearised
from fem.modes import Modes
from geometry.arrays import Array

ALIKE = 0.8
"""Least modal assurance between a mode of the fine mesh and the one of the coarse mesh that is taken for it."""


@dataclass(frozen=True, eq=False)
class _Dynamics:
    squares: Array  # (n,) [(rad/s)²]
    participation: Array  # (6, n)
    static: Array  # (6, 6), of all modes


def single(system: Linearised, lossy: Array, reference_point: Array, count: int) -> Modes:
    """The lowest `count` modes of `system`; `lossy` (n, n) is the sum of eta_p K_p in its coordinates."""
    found = _dynamics(system)
    kept = _Dynamics(found.squares[:count], found.participation[:, :count], found.static)
    return _modes(system, kept, lossy, reference_point)


def extrapolated(coarse: Linearised, fine: Linearised, lossy: Array, reference_point: Array, count: int) -> Modes:
    """The lowest `count` modes that `coarse` and `fine` lead to; `lossy` is that of `fine`.

    The nodes of the plan of `coarse` come first in that of `fine`.
    """
    partner, sign = _partners(coarse, fine, count)
    a, b, known = _dynamics(coarse), _dynamics(fine), partner >= 0
    squares, L = b.squares[:count].copy(), b.participation[:, :count].copy()
    squares[known] = _richardson(a.squares[partner[known]], squares[known])
    L[:, known] = _richardson(sign[known] * a.participation[:, partner[known]], L[:, known])
    return _modes(fine, _Dynamics(squares, L, _richardson(a.static, b.static)), lossy, reference_point)


def _dynamics(system: Linearised) -> _Dynamics:
    return _Dynamics((2 * np.pi * system.frequency) ** 2, system.participation, system.compliance())


def _modes(system: Linearised, found: _Dynamics, lossy: Array, reference_point: Array) -> Modes:
    """`found` as `Modes`, ascending; damping from the strain energy of the shapes of `system`."""
    rising = np.argsort(found.squares)
    squares, L, phi = found.squares[rising], found.participation[:, rising], system.shapes[:, rising]
    omega = np.sqrt(squares)
    scale = omega / (2 * np.pi * system.frequency[rising])
    S = np.outer(scale, scale) * (phi.T @ lossy @ phi)
    return Modes(
        frequency=omega / (2 * np.pi),
        damping_ratio=np.diag(S) / (2 * squares),
        participation=L,
        rigid_mass=_symmetric(system.rigid_mass),
        residual=_symmetric(found.static - (L / squares) @ L.T),
        reference_point=reference_point,
        shapes=np.zeros((0, len(squares))),
        viscous=np.zeros((len(squares), len(squares))),
        structural=_symmetric(S),
    )


def _partners(coarse: Linearised, fine: Linearised, count: int) -> tuple[Array, Array]:
    """For each of the lowest `count` modes of `fine` its number in `coarse`, -1 for none, and the sign that makes both agree."""
    from scipy.optimize import linear_sum_assignment

    here, there = _common(coarse, fine).T
    M, a, b = coarse.mass[np.ix_(here, here)], coarse.shapes[here], fine.shapes[there, :count]
    cross = a.T @ M @ b
    assurance = cross**2 / np.outer(_norms(a, M), _norms(b, M))
    rows, columns = linear_sum_assignment(assurance, maximize=True)
    partner = rows[np.argsort(columns)]
    own = np.arange(len(partner))
    return np.where(assurance[partner, own] >= ALIKE, partner, -1), np.sign(cross[partner, own])


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
