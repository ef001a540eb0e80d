"""What noise does to a dynamic mass, and how noise of the motions is kept from making it too small.

Runs tell f_r = H u_r, but both sides are measured with noise, of covariances F_r and U_r. The residual e_r = f_r - H u_r then has
the covariance R_r = F_r + H U_r H^H. Least squares takes u_r for exact; with more than six runs its answer is too low by the
share of noise in the power of the motions. Likelihood takes the true motions for unknowns, too, and eliminates them: they are the
corrected

    v_r = u_r + U_r H^H R_r^-1 e_r ,      and H solves     sum_r R_r^-1 (f_r - H u_r) v_r^H = 0 ,

iterated until it stands still (Fuller, Measurement Error Models, 1987; total least squares of Golub and Van Loan, SIAM J. Numer.
Anal. 17, 1980, where all noise is alike). With six runs there is nothing to be corrected: e_r = 0 whatever they read.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray, DynamicMass
from geometry.errors import BadInput, CheckFailed
from identification.dynamic_mass import Estimate
from identification.run_noise import RunNoise

STEADY, ROUNDS = 1e-10, 100
"""Relative change of H at which the iteration ends, and after how many rounds at the latest."""


def balance(H: ComplexArray, motion: ComplexArray, load: ComplexArray, noise: RunNoise) -> tuple[ComplexArray, ComplexArray]:
    """Residuals f - H u (r, n, 6) and their covariance F + H U H^H (r, n, 6, 6) for H (n, 6, 6).

    Raises
    ------
    BadInput : the noise of some load and line is zero, so that nothing can be weighed by it.
    """
    R = noise.load + H @ noise.motion @ H.conj().swapaxes(1, 2)
    if not np.all(np.linalg.eigvalsh(R)[..., 0] > 0):
        problem = "loads and motions without any noise cannot be weighed by it"
        raise BadInput(source="errors in variables", field="noise", problem=problem, remedy="Give the noise of every channel")
    return np.asarray(load - np.einsum("njk,rnk->rnj", H, motion)), np.asarray(R)


def correction(H: ComplexArray, residual: ComplexArray, covariance: ComplexArray, noise: RunNoise) -> ComplexArray:
    """What the loads say against the motions: U H^H R^-1 e (r, n, 6)."""
    weighed = np.linalg.solve(covariance, residual[..., None])
    return np.asarray((noise.motion @ (H.conj().swapaxes(1, 2) @ weighed))[..., 0])


def corrected(
    load: npt.ArrayLike, motion: npt.ArrayLike, noise: RunNoise, estimate: Estimate
) -> tuple[DynamicMass, ComplexArray]:
    """H by errors in variables, from the least squares in `estimate`, and its covariance (n, 36, 36), entries row by row.

    Parameters
    ----------
    load, motion : (r, n, 6) spectra about the reference point of `estimate`
    noise : of both

    Raises
    ------
    BadInput : noise of zero.
    CheckFailed : the iteration does not settle, where noise is about as large as the motion.
    """
    F, U = np.asarray(load, dtype=np.complex128), np.asarray(motion, dtype=np.complex128)
    H = estimate.dynamic_mass.matrix
    for _ in range(ROUNDS):
        left, right = _normal(H, U, F, noise)
        new = np.asarray(np.linalg.solve(left, right[..., None]).reshape(H.shape), dtype=np.complex128)
        change = np.abs(new - H).max() / np.abs(new).max()
        H = new
        if change <= STEADY:
            return replace(estimate.dynamic_mass, matrix=H), _covariance(H, U, F, noise)
    raise CheckFailed("The correction of the motions' noise does not settle: it is about as large as the motions themselves")


def covariance(estimate: Estimate, noise: RunNoise) -> ComplexArray:
    """(n, 36, 36) covariance E h h^H of the entries of a least-squares H, row by row, by noise on both sides (first order)."""
    H, P = estimate.dynamic_mass.matrix, estimate.inverse
    R = noise.load + H @ noise.motion @ H.conj().swapaxes(1, 2)
    return np.asarray(np.einsum("rnij,nrk,nrl->nikjl", R, P, P.conj(), optimize=True).reshape(len(H), 36, 36))


def bias(estimate: Estimate, noise: RunNoise) -> Array:
    """(n,) by what share least squares of more than six runs takes H for too small: noise in the power of the motions, H N S^-1.

    The motion that has most of it counts. 0 of six runs, which leave nothing to be corrected.
    """
    if noise.motion.shape[0] <= 6:
        return np.zeros(len(estimate.inverse))
    inverse_power = np.einsum("nrj,nrk->njk", estimate.inverse.conj(), estimate.inverse)  # (S_u S_u^H)^-1, conjugate
    share = noise.motion.sum(axis=0) @ inverse_power.conj()
    return np.asarray(np.abs(np.linalg.eigvals(share)).max(axis=1))


def deviation(covariance: ComplexArray) -> Array:
    """(n, 6, 6) standard deviation of each entry of H from their covariance (n, 36, 36)."""
    return np.asarray(np.sqrt(np.diagonal(covariance, axis1=1, axis2=2).real).reshape(-1, 6, 6))


def _normal(H: ComplexArray, U: ComplexArray, F: ComplexArray, noise: RunNoise) -> tuple[ComplexArray, ComplexArray]:
    """Matrix (n, 36, 36) and right side (n, 36) of the equations for H, with motions corrected by the present H."""
    residual, R = balance(H, U, F, noise)
    V = (U + correction(H, residual, R, noise)).conj()
    weight = np.linalg.inv(R)
    left = np.einsum("rnaj,rnb,rnk->nabjk", weight, V, U, optimize=True).reshape(len(H), 36, 36)
    right = np.einsum("rnaj,rnj,rnb->nab", weight, F, V, optimize=True).reshape(len(H), 36)
    return np.asarray(left), np.asarray(right)


def _covariance(H: ComplexArray, U: ComplexArray, F: ComplexArray, noise: RunNoise) -> ComplexArray:
    """N^-1 N_v N^-1: N_v is told by the corrected motions, N by the true ones, whose power lacks the noise left in those."""
    residual, R = balance(H, U, F, noise)
    V, weight = U + correction(H, residual, R, noise), np.asarray(np.linalg.inv(R), dtype=np.complex128)
    HU = H @ noise.motion
    left_over = np.asarray((noise.motion - HU.conj().swapaxes(2, 3) @ weight @ HU).conj(), dtype=np.complex128)
    power = np.asarray(V.conj()[..., :, None] * V[..., None, :], dtype=np.complex128)
    of_corrected, of_true = _information(weight, power), _information(weight, power - left_over)
    inverse = np.linalg.inv(of_true)
    return np.asarray(inverse @ of_corrected @ inverse)


def _information(weight: ComplexArray, power: ComplexArray) -> ComplexArray:
    n = weight.shape[1]
    return np.asarray(np.einsum("rnaj,rnbk->nabjk", weight, power, optimize=True).reshape(n, 36, 36))
