"""Where the next pole starts: the frequency, damping and participation that take most out of what a fit left over.

On a grid of poles, in the band and around it, every entry of the leftover is fitted by a constant, omega² and the pole's own curve
omega² / (omega_r² - omega² + 2 i zeta omega_r omega), all entries and poles at once. The constants and omega² are what inertia and
residual mass could still take; the matrix of amplitudes of the third is cut down to rank one with a positive sign, for a mode of a
symmetric structure answers by L L^T.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray
from identification.elastic.lines import Lines
from identification.elastic.model import SCALE, UPPER

DAMPING = (0.0015, 0.004, 0.01, 0.03)
"""Ratios that are tried."""

BEYOND = (0.6, 1.7)
"""How far out of the band a pole is looked for: of its lower and of its upper end."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Candidate:
    """A pole to start from.

    Attributes
    ----------
    frequency : [Hz]
    damping_ratio : [1]
    participation : (6,) [sqrt(kg)], [sqrt(kg) m]
    gain : what it takes out of chi², as far as a linear fit tells
    """

    frequency: float
    damping_ratio: float
    participation: Array
    gain: float


def candidates(leftover: ComplexArray, lines: Lines, count: int = 3) -> tuple[Candidate, ...]:
    """The best `count` poles, apart from each other, for `leftover` (n, 21), measured less fitted; best first."""
    f, zeta = _grid(lines.frequency)
    amplitude, power = _amplitudes(leftover, lines, f, zeta)
    L, gain = _rank_one(amplitude, power)
    chosen: list[int] = []
    for k in np.argsort(-gain):
        apart = all(abs(f[k] - f[j]) > 0.02 * f[j] for j in chosen)
        if gain[k] > 0 and apart:
            chosen.append(int(k))
        if len(chosen) == count:
            break
    return tuple(Candidate(frequency=f[k], damping_ratio=zeta[k], participation=L[k], gain=gain[k]) for k in chosen)


def _grid(lines: Array) -> tuple[Array, Array]:
    """Frequencies and ratios (g,): as fine as the half-power width of the lightest in the band, coarse around it."""
    low, high = lines[0], lines[-1]
    count = int(np.ceil(np.log(high / low) / (2 * DAMPING[1])))
    inside = np.geomspace(low, high, max(count, 2))
    beyond = np.concatenate([np.geomspace(BEYOND[0] * low, 0.97 * low, 6), np.geomspace(1.03 * high, BEYOND[1] * high, 10)])
    f = np.concatenate([np.repeat(inside, len(DAMPING)), beyond])
    zeta = np.concatenate([np.tile(DAMPING, len(inside)), np.full(len(beyond), DAMPING[1])])
    return f, zeta


def _amplitudes(leftover: ComplexArray, lines: Lines, f: Array, zeta: Array) -> tuple[Array, Array]:
    """Amplitudes (g, 21) of the poles' curves and the weight (g, 21) of each: chi² falls by amplitude² x weight."""
    w = 2 * np.pi * lines.frequency
    p = 2 * np.pi * f[:, None]
    curve = w**2 / (p**2 - w**2 + 2j * zeta[:, None] * p * w)  # (g, n)
    weight = 2 / lines.deviation**2  # (n, 21)
    basis = _flat_basis(w, weight)  # (2, n, 21), orthonormal with the weight
    shares = [curve.real @ (weight * one) for one in basis]
    power = np.abs(curve) ** 2 @ weight - sum(share**2 for share in shares)
    left = leftover - sum(one * np.sum(weight * one * leftover.real, axis=0) for one in basis)
    against = curve.real @ (weight * left.real) + curve.imag @ (weight * left.imag)
    sound = power > 1e-9 * (np.abs(curve) ** 2 @ weight)
    return np.where(sound, against / np.where(sound, power, 1.0), 0.0), np.where(sound, power, 0.0)


def _flat_basis(w: Array, weight: Array) -> Array:
    """1 and omega², orthonormal over the lines under each entry's own weight (n, 21)."""
    one = np.broadcast_to(1 / np.sqrt(weight.sum(axis=0)), weight.shape)
    square = (w**2)[:, None] - one * np.sum(weight * one * (w**2)[:, None], axis=0)
    return np.stack([one, square / np.sqrt(np.sum(weight * square**2, axis=0))])


def _rank_one(amplitude: Array, power: Array) -> tuple[Array, Array]:
    """Participation (g, 6) and the fall of chi² (g,) it alone brings."""
    A = np.zeros((len(amplitude), 6, 6))
    A[:, UPPER[0], UPPER[1]] = A[:, UPPER[1], UPPER[0]] = amplitude
    values, vectors = np.linalg.eigh(A / np.outer(SCALE, SCALE))
    L = np.sqrt(np.maximum(values[:, -1], 0.0))[:, None] * vectors[:, :, -1] * SCALE
    taken = L[:, UPPER[0]] * L[:, UPPER[1]]
    return L, np.sum(power * (amplitude**2 - (amplitude - taken) ** 2), axis=1)
