"""A mode that still rings when its record ends: what the cut makes of its resonance, and how to look at it by itself.

The response to a blow holds exp(lambda t), lambda = -zeta omega_1 + i omega_1 to first order in zeta. Its transform over T
seconds is that of the whole decay times 1 - exp((lambda - i omega) T), and at the lines k / T that is one number, the same at all
of them: the resonance keeps its shape, is too high or too low, and is turned. A fit that knows nothing of it takes it for mass.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray

WIDEST = 0.5
"""Damping ratio beyond which no resonance is left to fit."""


@dataclass(frozen=True, eq=False, kw_only=True)
class LoneMode:
    """One mode of several accelerances, fitted by itself.

    Attributes
    ----------
    frequency : [Hz]
    damping_ratio : [1]
    residues : (k,) complex; real for a mode of a lightly damped structure that was recorded to its end
    """

    frequency: float
    damping_ratio: float
    residues: ComplexArray

    @property
    def turn(self) -> float:
        """Angle [rad] by which the residues are turned from the real axis, their mean on the unit circle, in -pi/2 ... pi/2."""
        return float(np.angle(np.sum((self.residues / np.abs(self.residues)) ** 2)) / 2)


def kept(frequency: float, damping_ratio: float, duration: float) -> complex:
    """1 - exp(lambda T): what is kept of a mode's resonance at the lines k / T of a record of `duration` T [s]."""
    omega = 2 * np.pi * frequency
    return complex(1 - np.exp((-damping_ratio + 1j) * omega * duration))


def lone_mode(frequency: npt.ArrayLike, accelerances: npt.ArrayLike, near: float, damping_ratio: float = 0.002) -> LoneMode:
    """The mode that `accelerances` (n, k) at the lines `frequency` (n,) [Hz] show around it, beside a constant for all others.

    Every line counts relative to what it reads: the skirts, where leakage is least, as much as the peak.

    Parameters
    ----------
    near : [Hz] where to begin, within half its width
    damping_ratio : to begin with
    """
    from scipy.optimize import least_squares

    omega, y = 2 * np.pi * np.asarray(frequency, dtype=np.float64), np.asarray(accelerances, dtype=np.complex128)

    def left(x: Array) -> Array:
        error = _fitted(omega, y, x)[1].ravel()
        return np.concatenate([error.real, error.imag])

    limits = ([0.0, np.log(1e-6)], [np.inf, np.log(WIDEST)])
    found = least_squares(left, [near, np.log(damping_ratio)], x_scale=[1e-3 * near, 0.1], bounds=limits).x
    return LoneMode(frequency=float(found[0]), damping_ratio=float(np.exp(found[1])), residues=_fitted(omega, y, found)[0])


def _fitted(omega: Array, y: ComplexArray, x: Array) -> tuple[ComplexArray, ComplexArray]:
    """Residues (k,) at frequency x[0] [Hz] and damping exp(x[1]), and relative errors (n, k)."""
    own, zeta = 2 * np.pi * x[0], np.exp(x[1])
    basis = np.column_stack([omega**2 / (omega**2 - own**2 - 2j * zeta * own * omega), np.ones_like(omega)])
    weight = 1 / np.abs(y)
    found = [np.linalg.lstsq(w[:, None] * basis, w * one, rcond=None)[0] for w, one in zip(weight.T, y.T, strict=True)]
    return np.array(found)[:, 0], np.asarray((basis @ np.array(found).T - y) * weight)
