"""The base-excited dynamic mass of a structure: from its modes for daily use, by direct solution line by line as the oracle.

With acceleration of the base u_b'' as the only load, Eq. 8 in matrix form is

    H = M_rigid + omega² L (Omega² - omega² + i (omega C + S))^-1 L^T + omega² R.

Without R the modes that are left out cost an error that grows as omega²; with it, as omega⁴. The base's own mass is in M_rigid.
"""

import numpy as np
import numpy.typing as npt

from fem.damping import Damping, damping_per_mode, default_damping, structural_matrix, viscous_matrix
from fem.factorisers import Singular, factorise
from fem.modes import Modes
from fem.structure import Structure, hold, restricted
from geometry.dynamic_mass import ComplexArray, DynamicMass
from geometry.errors import CheckFailed
from geometry.frames import Array

LINES = np.linspace(4.0, 32.0, 561)
"""Lines [Hz] of the usual band: 4 to 32 Hz, every 0.05 Hz."""


WELL_CONDITIONED = 1e6
"""Up to this condition of its eigenvectors a complex modal stiffness is diagonalised once instead of solved line by line."""


def modal(modes: Modes, frequency: npt.ArrayLike = LINES, *, residual: bool = True) -> DynamicMass:
    """Dynamic mass from `modes` at `frequency` (n,) [Hz], about their reference point (Eq. 8 in matrix form).

    Parameters
    ----------
    residual : with the static share of the modes that are not kept

    Raises
    ------
    CheckFailed : a line lies on an undamped mode.
    """
    lines = np.atleast_1d(np.asarray(frequency, dtype=np.float64))
    omega = 2 * np.pi * lines
    A: ComplexArray = np.diag((2 * np.pi * modes.frequency) ** 2) + 1j * modes.structural
    L, R = modes.participation.astype(np.complex128), modes.residual.astype(np.complex128)
    if residual and modes.condensed is not None:
        A, L, R = modes.condensed.stiffness, modes.condensed.participation, modes.condensed.residual
    elastic = _kept(A, modes.viscous, L, omega) + (R if residual else np.zeros_like(R))
    H = modes.rigid_mass + omega[:, None, None] ** 2 * elastic
    return DynamicMass(frequency=lines, matrix=_finite(H, lines), reference_point=modes.reference_point)


def direct(
    structure: Structure,
    frequency: npt.ArrayLike,
    damping: Damping | None = None,
    *,
    modes: Modes | None = None,
    factoriser: str | None = None,
) -> DynamicMass:
    """Dynamic mass of `structure` at `frequency` (n,) [Hz] by solving for every degree of freedom at every line.

    Solves (K + i omega C + i S - omega² M)_ff X = P; H = T^T M T + omega² P^T X, about the structure's reference point.

    Parameters
    ----------
    damping : as for `fem.modes.fixed_base`
    modes : bring them when the damping is per mode: it is then C = M Phi C_modal Phi^T M, and the modes left out have none

    Raises
    ------
    ValueError : damping per mode without `modes`.
    CheckFailed : a line lies on an undamped mode.
    """
    damping = damping or default_damping(structure)
    held, matrices = hold(structure), (viscous_matrix(damping, structure), structural_matrix(damping, structure))
    C, S = (None if matrix is None else restricted(matrix, structure.free) for matrix in matrices)
    # M Phi (f, n) and the modal viscous matrix of ratios and `modal`, where damping has them
    if damping.ratio is None and damping.modal is None:
        per_mode: tuple[Array, Array] | None = None
    else:
        if modes is None:
            raise ValueError("`modes` are needed where damping is given per mode")
        per_mode = held.mass @ modes.shapes[held.free], damping_per_mode(damping, 2 * np.pi * modes.frequency)
    lines = np.atleast_1d(np.asarray(frequency, dtype=np.float64))
    H = np.empty((len(lines), 6, 6), dtype=np.complex128)
    for line, omega in enumerate(2 * np.pi * lines):
        A = (held.stiffness - omega**2 * held.mass).astype(np.complex128)
        for matrix, factor in ((C, 1j * omega), (S, 1j)):
            if matrix is not None:
                A = A + factor * matrix
        try:
            solve = factorise(A, name=factoriser).solve
        except Singular:
            raise _undamped() from None
        X = solve(held.load.astype(np.complex128))
        if per_mode is not None:  # it enters by Woodbury's identity
            B, modal_viscous = per_mode
            Y, core = solve(B.astype(np.complex128)), 1j * omega * modal_viscous
            X = X - Y @ np.linalg.solve(np.eye(len(core)) + core @ (B.T @ Y), core @ (B.T @ X))
        H[line] = structure.rigid_mass + omega**2 * (held.load.T @ X)
    return DynamicMass(frequency=lines, matrix=_finite(H, lines), reference_point=structure.reference_point)


def _kept(A: ComplexArray, C: Array, L: ComplexArray, omega: Array) -> ComplexArray:
    """L (A + i omega C - omega²)^-1 L^T at every line, by the cheapest of three ways."""
    w = omega[:, None]
    if _diagonal(A) and _diagonal(C):
        return _summed(np.asarray(np.diag(A) + 1j * w * np.diag(C) - w**2), L, L.T)
    if not np.any(C):
        mu, V = np.linalg.eig(A)
        if np.linalg.cond(V) < WELL_CONDITIONED:
            return _summed(np.asarray(mu - w**2), L @ V, np.asarray(np.linalg.solve(V, L.T)))
    w = w[:, None]
    try:
        return np.asarray(L @ np.linalg.solve(A + 1j * w * C - w**2 * np.eye(len(A)), L.T))
    except np.linalg.LinAlgError:
        raise _undamped() from None


def _diagonal(matrix: Array | ComplexArray) -> bool:
    return not np.any(matrix - np.diag(np.diag(matrix)))


def _summed(D: ComplexArray, left: ComplexArray, right: ComplexArray) -> ComplexArray:
    """left D^-1 right at every line for diagonals D (lines, n): one product with all rank-one terms."""
    terms = np.einsum("ir,rj->rij", left, right).reshape(D.shape[1], 36)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray((1 / D @ terms).reshape(-1, 6, 6))


def _finite(H: ComplexArray, lines: Array) -> ComplexArray:
    good = np.isfinite(H).all(axis=(1, 2))
    if not np.all(good):
        raise _undamped(float(lines[~good][0]))
    return H


def _undamped(frequency: float | None = None) -> CheckFailed:
    where = "A line" if frequency is None else f"The line {frequency:g} Hz"
    return CheckFailed(f"{where} lies on an undamped mode, where the dynamic mass is infinite. Give damping or move the line.")
