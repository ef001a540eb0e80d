"""What a channel reads beyond what all the others say it should, and how surprising that is.

At one line of one run y = A u + e, e with the covariance S = D + V V^H of noise D and of all tolerances V that were not
fitted. With latent inputs u the projector

    P = S^-1 - S^-1 A (A^H S^-1 A)^-1 A^H S^-1                      (P = S^-1 and y - A u in place of y where u is known)

gives for every channel c at once what it reads beyond its prediction from all other channels, and the standard deviation of that,

    d_c = (P y)_c / P_cc ,      sd_c = P_cc^-1/2

(leave-one-out residuals of generalised least squares; Dubrule, Math. Geology 15, 1983). A channel that is off by itself
stands out by d_c; neighbours that merely share its tolerances do not. y^H P y is chi² over all of them.

What the model gets wrong shows in the loads instead: their error R (y_f - A_f u), u from the channels that are not judged,
adds up what every load cell sees a little of. Its covariance is that of the same linear form.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray

CHECKED = 1e-6
"""Share of its own variance that must be left of a channel's redundancy; below, nothing checks it."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Deviations:
    """Errors and what is expected of them.

    Attributes
    ----------
    value : (..., m) complex, SI
    expected : (..., m) standard deviation; infinite where nothing checks the row
    """

    value: ComplexArray
    expected: Array


def covariance(noise: Array, spread: ComplexArray) -> ComplexArray:
    """S (..., c, c) of noise with standard deviations (..., c) and of tolerances (..., c, p)."""
    S = spread @ spread.conj().swapaxes(-1, -2)
    diagonal = np.arange(S.shape[-1])
    S[..., diagonal, diagonal] += np.square(noise)
    return np.asarray(S)


def left_over(y: ComplexArray, A: ComplexArray, S: ComplexArray, known: ComplexArray | None) -> tuple[Deviations, Array]:
    """What each channel reads beyond its prediction from all others, (..., c), and chi² of all of them together (...).

    Parameters
    ----------
    y : (..., c)
    A : (..., c, k)
    S : (..., c, c)
    known : (..., k) inputs; None where they are latent
    """
    scale = np.sqrt(np.diagonal(S, axis1=-2, axis2=-1).real)
    white = A / scale[..., None]
    P = np.linalg.inv(S / (scale[..., :, None] * scale[..., None, :]))
    e = (y if known is None else y - _times(A, known)) / scale
    if known is None:
        B = P @ white
        P = P - B @ np.linalg.solve(white.conj().swapaxes(-1, -2) @ B, B.conj().swapaxes(-1, -2))
    r, own = _times(P, e), np.maximum(np.diagonal(P, axis1=-2, axis2=-1).real, 0.0)
    checked = own > CHECKED
    safe = np.where(checked, own, 1.0)
    value = np.where(checked, r / safe, 0.0) * scale
    expected = np.where(checked, scale / np.sqrt(safe), np.inf)
    chi2 = np.sum(e.conj() * r, axis=-1).real
    return Deviations(value=value, expected=expected), np.asarray(chi2)


def judged_error(
    y: ComplexArray, A: ComplexArray, S: ComplexArray, known: ComplexArray | None, judged: npt.NDArray[np.bool_]
) -> tuple[ComplexArray, ComplexArray]:
    """Error (..., f) of the judged channels with inputs from all others, and its covariance (..., f, f).

    Parameters are those of `left_over`; `judged` (c,) bool.
    """
    f, a = np.flatnonzero(judged), np.flatnonzero(~np.asarray(judged, dtype=bool))
    if known is not None:
        return (y - _times(A, known))[..., f], np.asarray(S[..., f[:, None], f])
    weighed = np.linalg.solve(S[..., a[:, None], a], A[..., a, :]).conj().swapaxes(-1, -2)
    inputs = np.linalg.solve(weighed @ A[..., a, :], weighed)
    L = np.zeros((*A.shape[:-2], len(f), A.shape[-2]), dtype=np.complex128)
    L[..., a] = -A[..., f, :] @ inputs
    L[..., np.arange(len(f)), f] = 1.0
    return _times(L, y), np.asarray(L @ S @ L.conj().swapaxes(-1, -2))


def combined(error: ComplexArray, covariance: ComplexArray, R: Array) -> Deviations:
    """Combinations R (m, f) of errors (..., f) with `covariance` (..., f, f)."""
    variance = np.einsum("mf,...fg,mg->...m", R, covariance, R, optimize=True).real
    return Deviations(value=_times(R.astype(np.complex128), error), expected=np.sqrt(np.maximum(variance, 0.0)))


def _times(matrix: ComplexArray, vector: ComplexArray) -> ComplexArray:
    return np.asarray((matrix @ vector[..., None])[..., 0])
