"""Modes of exudyn's frame on two meshes, and where the two say that they go.

Exudyn's beam bends too stiffly by the square of the element length h. With half of h the error is a quarter, so that
``fine + (fine - coarse) / 3`` is free of it and wrong with the fourth power (Richardson). Squared frequencies, participation
and the static answer to an accelerated base are extrapolated; the rigid mass needs none, because linear shapes hold it exactly. A
mode of the fine mesh is told on the coarse one by its shape, since neighbours in frequency may pass one another.
"""

from __future__ import annotations

import numpy as np

from fem.flexible_body.linearised import Linearised
from fem.flexible_body.running import exudyn_version
from fem.modes import Modes
from geometry.arrays import Array
from geometry.errors import CheckFailed

ALIKE = 0.5
"""Least modal assurance between a mode of the fine mesh and the one of the coarse mesh that is taken for it."""

EXTRA = 10
"""Modes that are solved for beyond those asked for, so that each finds its other."""


def extrapolated(coarse: Linearised, fine: Linearised, common: Array, lossy: Array, count: int) -> Modes:
    """The lowest `count` modes that `coarse` and `fine` lead to.

    Parameters
    ----------
    common : (n, 2) coordinates of one place in `coarse` and in `fine`
    lossy : (N, N) sum of eta_p K_p on the fine mesh

    Raises
    ------
    CheckFailed : a mode of the fine mesh has no likeness on the coarse one.
    """
    order, signs = _partners(coarse, fine, common, count)
    squares_coarse, squares = ((2 * np.pi * s.frequency) ** 2 for s in (coarse, fine))
    Omega2 = _richardson(squares_coarse[order], squares[:count])
    L = _richardson(signs * coarse.participation[:, order], fine.participation[:, :count])
    static = _richardson(coarse.compliance(), fine.compliance())
    rising = np.argsort(Omega2)
    Omega2, L = Omega2[rising], L[:, rising]
    omega, phi = np.sqrt(Omega2), fine.shapes[:, rising]
    scale = omega / np.sqrt(squares[rising])
    S = np.outer(scale, scale) * (phi.T @ lossy @ phi)
    residual = static - (L / Omega2) @ L.T
    return Modes(
        frequency=omega / (2 * np.pi),
        damping_ratio=np.diag(S) / (2 * Omega2),
        participation=L,
        rigid_mass=(fine.rigid_mass + fine.rigid_mass.T) / 2,
        residual=(residual + residual.T) / 2,
        reference_point=np.zeros(3),
        shapes=np.zeros((0, count)),
        viscous=np.zeros((count, count)),
        structural=(S + S.T) / 2,
    )


def _richardson(coarse: Array, fine: Array) -> Array:
    return np.asarray(fine + (fine - coarse) / 3)


def _partners(coarse: Linearised, fine: Linearised, common: Array, count: int) -> tuple[Array, Array]:
    """For each of the lowest `count` modes of `fine` its number in `coarse` and the sign that makes the shapes agree."""
    from scipy.optimize import linear_sum_assignment

    metric = coarse.mass[np.ix_(common[:, 0], common[:, 0])]
    a, b = coarse.shapes[common[:, 0]], fine.shapes[common[:, 1], :count]
    cross = a.T @ metric @ b
    assurance = cross**2 / np.outer(np.einsum("ir,ij,jr->r", a, metric, a), np.einsum("ir,ij,jr->r", b, metric, b))
    rows, columns = linear_sum_assignment(assurance, maximize=True)
    order = rows[np.argsort(columns)]
    likeness = assurance[order, np.arange(count)]
    if likeness.min() < ALIKE:
        worst = int(likeness.argmin())
        raise CheckFailed(
            f"exudyn {exudyn_version()}: mode {worst + 1} at {fine.frequency[worst]:.4g} Hz is not the same on two meshes "
            f"(modal assurance {likeness[worst]:.2f}). Ask for fewer modes or more elements.",
            assurance=likeness,
        )
    return order, np.sign(cross[order, np.arange(count)])
