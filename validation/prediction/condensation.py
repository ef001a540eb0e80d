"""From reduced matrices to what is measured: the dynamic mass of a moving base, the accelerances of a held structure.

With D = M - (K + i (omega C + S)) / omega², the dynamic stiffness over -omega², b the base and q the rest, the answer to unit
accelerations of the base is T = [1; -D_qq^-1 D_qb] and

    H = T^T D T = D_bb - D_bq D_qq^-1 D_qb,                  dH = T^T dD T,

because H is stationary in the answer (Fox & Kapoor, AIAA Journal 6, 1968, for eigenvalues): a derivative costs two thin products,
and none of the solution itself. Likewise an accelerance A = phi_r^T D^-1 phi_d, with dA = -(D^-1 phi_r)^T dD (D^-1 phi_d).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray
from validation.effects.stages import Matrices
from validation.prediction.tangent import Tangent

FEW = 3
"""Up to so many coordinates a sum of outer products is the quicker way."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Answered:
    """Transfer at every line, and the answers of all coordinates that its derivatives are made of.

    Attributes
    ----------
    frequency : (n,) [Hz]
    matrix : (n, r, d) complex: dynamic mass (n, 6, 6) about the article's origin, or accelerance [1/kg]
    left, right : (k, n, r), (k, n, d), by coordinate: d matrix = sign * left^T dD right
    sign : +1 of a dynamic mass, -1 of an accelerance
    """

    frequency: Array
    matrix: ComplexArray
    left: ComplexArray
    right: ComplexArray
    sign: float


def dynamic_mass(matrices: Matrices, frequency: npt.ArrayLike) -> Answered:
    """Blocked dynamic mass (n, 6, 6) about the article's origin at `frequency` (n,) [Hz], above zero.

    Raises
    ------
    numpy.linalg.LinAlgError : a line lies on an undamped mode.
    """
    lines = np.atleast_1d(np.asarray(frequency, dtype=np.float64))
    b = matrices.base
    D = _dynamic(matrices, lines)
    answer = -np.linalg.solve(D[:, b:, b:], D[:, b:, :b])
    H = D[:, :b, :b] + D[:, :b, b:] @ answer
    moved = np.broadcast_to(np.eye(b, dtype=np.complex128), (len(lines), b, b))
    T = _by_coordinate(np.concatenate([moved, answer], axis=1))
    return Answered(frequency=lines, matrix=H, left=T, right=T, sign=1.0)


def accelerance(matrices: Matrices, frequency: npt.ArrayLike, responses: npt.ArrayLike, drive: npt.ArrayLike) -> Answered:
    """Accelerations (n, r, d) [m/s² per N] of a held structure along `responses` for forces along `drive`.

    Parameters
    ----------
    frequency : (n,) [Hz], above zero
    responses, drive : (r, k), (d, k) what each coordinate moves along them, see `along`

    Raises
    ------
    numpy.linalg.LinAlgError : a line lies on an undamped mode.
    """
    lines = np.atleast_1d(np.asarray(frequency, dtype=np.float64))
    rows, forces = np.atleast_2d(np.asarray(responses, dtype=np.float64)), np.atleast_2d(np.asarray(drive, dtype=np.float64))
    loads = np.vstack([rows, forces]).T.astype(np.complex128)
    whole = np.broadcast_to(loads, (len(lines), *loads.shape))
    both = np.asarray(np.linalg.solve(_dynamic(matrices, lines), whole), dtype=np.complex128)
    left, right = both[:, :, : len(rows)], both[:, :, len(rows) :]
    return Answered(frequency=lines, matrix=rows @ right, left=_by_coordinate(left), right=_by_coordinate(right), sign=-1.0)


def along(matrices: Matrices, place: str, direction: npt.ArrayLike) -> Array:
    """(k,) what each coordinate moves `place` along `direction` (3,), a unit vector.

    Raises
    ------
    KeyError : no such place.
    """
    return np.asarray(np.asarray(direction, dtype=np.float64) @ matrices.places[place])


def tangents(answered: Answered, changes: Mapping[str, Tangent]) -> dict[str, ComplexArray]:
    """By parameter d matrix / d offset, (n, r, d)."""
    return {name: _tangent(answered, change) for name, change in changes.items()}


def _by_coordinate(answer: ComplexArray) -> ComplexArray:
    return np.ascontiguousarray(answer.transpose(1, 0, 2))


def _tangent(answered: Answered, change: Tangent) -> ComplexArray:
    """Each field by itself: those that do not change cost nothing, nor do coordinates that do not."""
    left, right = (side if len(change.at) == len(side) else side[change.at] for side in (answered.left, answered.right))
    omega = (2 * np.pi * answered.frequency)[:, None, None]
    found = np.zeros_like(answered.matrix)
    fields = (
        (change.mass, 1.0),
        (change.stiffness, -1 / omega**2),
        (change.viscous, -1j / omega),
        (change.structural, -1j / omega**2),
    )
    for matrix, factor in fields:
        if np.any(matrix):
            found += factor * _product(left, matrix, right, change.crossing)
    return answered.sign * found


def _product(left: ComplexArray, matrix: Array, right: ComplexArray, crossing: int | None) -> ComplexArray:
    """left^T matrix right, (n, r, d), of sides (k, n, r) and (k, n, d): one real product for all lines."""
    if crossing is not None:
        return _crossed(left, matrix[crossing], right, crossing)
    k, n, d = right.shape
    pulled = (matrix @ right.reshape(k, n * d).view(np.float64)).view(np.complex128).reshape(k, n, d)
    if k <= FEW:
        return np.asarray(np.sum(left[:, :, :, None] * pulled[:, :, None, :], axis=0))
    return np.asarray(left.transpose(1, 2, 0) @ pulled.transpose(1, 0, 2))


def _crossed(left: ComplexArray, row: Array, right: ComplexArray, r: int) -> ComplexArray:
    """The same of a matrix of which row and column `r` alone are there, alike: two sums over the coordinates."""
    half = np.array(row)
    half[r] /= 2
    over_left, over_right = (np.tensordot(half, side, axes=1) for side in (left, right))
    return np.asarray(left[r][:, :, None] * over_right[:, None] + over_left[:, :, None] * right[r][:, None])


def _dynamic(matrices: Matrices, lines: Array) -> ComplexArray:
    """D (n, k, k) at `lines` (n,) [Hz]."""
    omega = (2 * np.pi * lines)[:, None, None]
    D = np.empty((len(lines), *matrices.mass.shape), dtype=np.complex128)
    D.real = matrices.mass - matrices.stiffness / omega**2
    D.imag = -(omega * matrices.viscous + matrices.structural) / omega**2
    return D
