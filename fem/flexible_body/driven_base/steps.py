"""How long a step may be, and how well the equations of one can be solved.

A step must be short enough for the modes of the article that are kept as such: `fem.base_excitation.linear.require_fine` says how
many a period of the highest of them. Coordinates that carry static answers, load cells and joints may swing far faster; they need
not be followed, but a method that is not always stable must bear them.
"""

from __future__ import annotations

import sys
from dataclasses import replace
from math import ceil, pi

import numpy as np

from fem.base_excitation.base_motion import BaseMotion
from fem.base_excitation.linear import require_fine
from fem.base_excitation.rig import LATERAL, Rig
from fem.base_excitation.rig_structure import TABLE, matrices
from fem.flexible_body.driven_base import friction as bristles
from fem.flexible_body.driven_base.solver import STABLE, Solver
from fem.flexible_body.driven_base.struts import position_of
from geometry.arrays import Array
from geometry.errors import BadInput

MARGIN = 0.9
"""Share of the stability limit that is used."""

MOST = 32
"""Steps a sample beyond which another method is the better advice."""

EPS = sys.float_info.epsilon

ROUNDINGS = 8
"""Roundings of a place that add up in a spring's force."""

RESONANT = 1e4
"""Times the load of a rigid article that the forces within one may be when it resonates, and their roundings with them."""


def subdivision(rig: Rig, rate: float, solver: Solver) -> int:
    """Steps a sample, of a base motion at `rate` [Hz].

    Raises
    ------
    BadInput : too coarse for a kept mode, or for the solver's method to be stable; the message names what is needed.
    """
    least = _stable(highest(rig), rate, solver)
    steps = least if solver.subdivision is None else solver.subdivision
    if steps < least or least > MOST:
        found = f"found {steps}" if steps < least else f"more than {MOST} of them"
        raise BadInput(
            source="solver",
            field="subdivision",
            problem=f"{highest(rig):.4g} Hz, the rig's highest frequency, needs {least} steps a sample, {found}",
            remedy="Leave it out, soften the stiffest joint, or use generalised-alpha",
        )
    require_fine(rig.article, rate * steps)
    return steps


def highest(rig: Rig) -> float:
    """[Hz] the highest frequency of all that stands on the held table, gaps closed and loose parts sticking; 0 when rigid."""
    from scipy.linalg import eigvalsh

    cells = tuple(replace(cell, preload=None) for cell in rig.cells)
    structure = matrices(replace(rig, frictions=(), cells=cells))
    M, K = structure.mass, structure.stiffness
    for friction in rig.frictions:
        M, K = _with_part(M, K, structure.article[:3], friction.mass, LATERAL.index(friction.axis))
    free = slice(TABLE, None)
    return float(np.sqrt(eigvalsh(K[free, free], M[free, free]).max(initial=0.0)) / (2 * pi))


def residual(rig: Rig, motion: BaseMotion, step: float, solver: Solver) -> float:
    """What Newton's iteration may leave: a length [m] or a velocity [m/s] in joints and a force [N] elsewhere.

    In a joint, what is left over becomes an acceleration when it is divided by the step or its square, and is held to the
    tolerance. Springs between places set a floor: their force knows a place no better than a number of this size is rounded.
    """
    peak, travel = (float(np.abs(values).max(initial=0.0)) for values in (motion.acceleration, motion.displacement))
    mass = float(np.abs(rig.article.reduced.mass[:TABLE, :TABLE]).max()) + (0.0 if rig.cover is None else rig.cover.mass)
    rounding = EPS * (ROUNDINGS * _stiffest(rig, travel) + RESONANT * mass * peak)
    return max(solver.tolerance * peak * step ** (1 if solver.prescribes_velocity else 2), rounding, sys.float_info.min)


def _stable(frequency: float, rate: float, solver: Solver) -> int:
    limit = STABLE.get(solver.method)
    return 1 if limit is None else max(1, ceil(2 * pi * frequency / (MARGIN * limit * rate)))


def _with_part(M: Array, K: Array, base: Array, mass: float, axis: int) -> tuple[Array, Array]:
    """Matrices with one coordinate more: how far a part of `mass` [kg] moves along `axis` on `base`, (3, n) of the others."""
    size = len(M)
    rows = np.zeros((3, size + 1))
    rows[:, : base.shape[1]] = base
    rows[axis, size] = 1.0
    larger = [np.pad(matrix, (0, 1)) for matrix in (M, K)]
    larger[1][size, size] = mass * bristles.STIFFNESS
    return larger[0] + mass * rows.T @ rows, larger[1]


def _stiffest(rig: Rig, travel: float) -> float:
    """[N] the largest stiffness between two places, times how far they lie from F, or how far they travel [m] together."""
    springs = [cell.stiffness.max() * np.linalg.norm(cell.position) for cell in rig.cells]
    for strut in rig.struts:
        at = rig.seat + position_of(rig.article.places[strut.place])
        springs.append(strut.stiffness.max() * np.linalg.norm(at))
    if rig.flange is not None and rig.flange.compliance.any():
        springs.append(np.linalg.norm(rig.seat) / rig.flange.compliance[rig.flange.compliance > 0].min())
    springs += [friction.mass * bristles.STIFFNESS * travel for friction in rig.frictions]
    return float(max(springs, default=0.0))
