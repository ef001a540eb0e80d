"""Closed forms of straight uniform beams, none of which knows of an element: the references of the beam and solid rows.

Bending is governed by w' = psi + Q / (k G A), psi' = M / (E I), M' = -Q - rho I omega² psi, Q' = -rho A omega² w with w the
deflection, psi the rotation of the section, M the bending moment and Q the shear force (Timoshenko 1921; Huang 1961). What these
four become over a whole beam is the exponential of their matrix, so a frequency equation is one 2 x 2 determinant of it, and the
answer to a moving clamp is one linear system. Letting k G A go to infinity and rho I to zero leaves Euler and Bernoulli's beam,
whose roots come here from the textbook equation instead.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array

ComplexMatrix = npt.NDArray[np.complex128]

STEPS = 2000
"""Steps of the frequency axis in which a determinant is looked at for a change of sign."""


@dataclass(frozen=True, kw_only=True)
class Beam:
    """A straight uniform beam that bends in one plane.

    Attributes
    ----------
    length : [m]
    bending : E I [N m²]; complex with a loss factor
    shear : k G A [N]; infinite for none
    mass : rho A [kg/m]
    rotary : rho I [kg m]
    """

    length: float
    bending: complex
    shear: complex = np.inf
    mass: float
    rotary: float = 0.0


def euler_bernoulli_cantilever(beam: Beam, count: int) -> Array:
    """Frequencies (count,) [Hz] from ``1 + cos x cosh x = 0`` (Blevins, Table 8-1)."""
    return _euler_bernoulli(beam, count, lambda x: np.cos(x) + 1 / np.cosh(x), [(k - 0.5) * np.pi for k in range(1, count + 1)])


def euler_bernoulli_free(beam: Beam, count: int) -> Array:
    """Frequencies (count,) [Hz] of the elastic modes from ``1 - cos x cosh x = 0`` (Blevins, Table 8-1)."""
    return _euler_bernoulli(beam, count, lambda x: np.cos(x) - 1 / np.cosh(x), [(k + 0.5) * np.pi for k in range(1, count + 1)])


def timoshenko_cantilever(beam: Beam, count: int) -> Array:
    """Frequencies (count,) [Hz] at which a clamped beam can move with neither moment nor shear at its tip."""
    highest = 1.01 * euler_bernoulli_cantilever(beam, count)[-1]  # shear and rotary inertia only lower them
    return _roots(lambda f: _determinants(_over(beam, 2 * np.pi * f)[:, 2:, 2:]), highest, count)


def timoshenko_free(beam: Beam, count: int) -> Array:
    """Frequencies (count,) [Hz] of the elastic modes of a beam with neither moment nor shear at both ends."""
    highest = 1.01 * euler_bernoulli_free(beam, count)[-1]
    return _roots(lambda f: _determinants(_over(beam, 2 * np.pi * f)[:, 2:, :2]), highest, count)


def rod_fixed_free(wave_speed: float, length: float, count: int) -> Array:
    """Frequencies (count,) [Hz] of a rod in tension or torsion, clamped at one end: ``(2 k - 1) c / (4 L)``."""
    return np.asarray((2 * np.arange(1, count + 1) - 1) * wave_speed / (4 * length), dtype=np.float64)


def rod_dynamic_mass(inertia: float, wave_speed: complex, length: float, frequency: npt.ArrayLike) -> ComplexMatrix:
    """Base load for a unit base acceleration (n,) of a rod of `inertia` [kg or kg m²]: ``m tan(k L) / (k L)``, k = omega / c."""
    x = 2 * np.pi * np.asarray(frequency) * length / wave_speed
    return np.asarray(inertia * np.tan(x) / x, dtype=np.complex128)


def base_driven(beam: Beam, frequency: npt.ArrayLike) -> ComplexMatrix:
    """Blocked dynamic mass (n, 2, 2) of a cantilever at its clamp: deflection and rotation driven, shear and moment answered.

    The beam lies along x from the clamp and deflects along y, so that the rotation is about z and the moment that the clamp
    exerts as well. The frequency must not be zero.
    """
    omega = 2 * np.pi * np.atleast_1d(np.asarray(frequency, dtype=np.float64))
    T = _over(beam, omega)
    # At the tip M = Q = 0 = T[2:, :2] @ (w, psi) + T[2:, 2:] @ (M, Q); the clamp exerts -Q along y and -M about z.
    answer = np.linalg.solve(T[:, 2:, 2:], T[:, 2:, :2])[:, ::-1]
    return np.asarray(answer / -(omega[:, None, None] ** 2), dtype=np.complex128)


def _over(beam: Beam, omega: Array) -> ComplexMatrix:
    """What the beam makes of w, psi, M, Q at its start (n, 4, 4): the exponential of its state matrix, by its eigenvectors.

    Deflection and rotation are measured in the beam's length and in radians, moment and force in E I / L and E I / L², or the
    exponential would lose digits to the units.
    """
    L, EI, s = beam.length, abs(beam.bending), omega**2
    A = np.zeros((len(omega), 4, 4), dtype=np.complex128)
    A[:, 0, 1], A[:, 0, 3] = 1.0, EI / L**2 / beam.shear
    A[:, 1, 2] = EI / beam.bending
    A[:, 2, 1], A[:, 2, 3] = -beam.rotary * s * L**2 / EI, -1.0
    A[:, 3, 0] = -beam.mass * s * L**4 / EI
    values, vectors = np.linalg.eig(A)
    T = (vectors * np.exp(values)[:, None, :]) @ np.linalg.inv(vectors)
    scale = np.array([L, 1.0, EI / L, EI / L**2])
    return np.asarray(scale[:, None] * T / scale[None, :], dtype=np.complex128)


def _determinants(blocks: ComplexMatrix) -> Array:
    return np.asarray(np.linalg.det(blocks).real)


def _euler_bernoulli(beam: Beam, count: int, equation: Callable[[float], float], near: list[float]) -> Array:
    from scipy.optimize import brentq

    roots = np.array([brentq(equation, x - 0.5, x + 0.5, xtol=1e-14) for x in near])
    return np.asarray((roots / beam.length) ** 2 / (2 * np.pi) * np.sqrt(abs(beam.bending) / beam.mass))


def _roots(function: Callable[[Array], Array], highest: float, count: int) -> Array:
    """The lowest `count` roots between a thousandth of `highest` and `highest`."""
    from scipy.optimize import brentq

    grid = np.linspace(1e-3 * highest, highest, STEPS)
    values = function(grid)
    signs = np.flatnonzero(np.sign(values[:-1]) != np.sign(values[1:]))[:count]
    return np.array([brentq(lambda f: function(np.array([f]))[0], grid[k], grid[k + 1], xtol=1e-13 * highest) for k in signs])
