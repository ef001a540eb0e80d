"""Where the next pole starts: the frequency, damping and participation that take most out of what a fit left over.

On a grid of poles, in the band and around it, every entry of the leftover is fitted by a constant, omega² and the pole's curve
omega² / (omega_r² - omega² + 2 i zeta omega_r omega), all entries and poles at once; the constants and omega² are what inertia
and residual mass could still take. The most promising are looked at closely: all parameters of the fit may give way to first
order, so that the slope which a resonance out of tune leaves beside it is not taken for another one, and the matrix of
amplitudes is cut down to rank one with a positive sign, for a mode of a symmetric structure answers by L L^T.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray
from identification.elastic.lines import Lines
from identification.elastic.model import SCALE, UPPER
from identification.elastic.refine import Refined, leftover, unit_of

DAMPING = (0.0015, 0.004, 0.01, 0.03)
"""Ratios that are tried."""

BEYOND = (0.6, 1.7)
"""How far out of the band a pole is looked for: of its lower and of its upper end."""


SHORT = 150
"""Poles of the grid that are looked at closely."""

LEAST = 1.0
"""Fall of chi² that is worth a try: what one number does by chance."""

ROUNDING = 1e-10
"""Added to the normal matrix, scaled to 1: parameters that the data do not see leave rounding there."""

APART = 0.02
"""Relative distance of two candidates: nearer ones are the same."""

RIDGE = 1e-3
"""Share of a pole's own curve that counts as explained by what is fitted already, so that no pole is put on another."""


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


def next_poles(at: Refined, lines: Lines, count: int = 8) -> tuple[Candidate, ...]:
    """The poles, apart from each other, that take most out of what the fit `at` leaves over, the best first."""
    f, zeta = _shortlist(at, lines)
    rhs, P = _projected(at, lines, f, zeta)
    L, gain = _rank_one(rhs, P)
    chosen: list[int] = []
    for k in np.argsort(-gain).tolist():
        if len(chosen) < count and gain[k] > LEAST and all(abs(f[k] / f[j] - 1) > APART for j in chosen):
            chosen.append(k)
    return tuple(Candidate(frequency=f[k], damping_ratio=zeta[k], participation=L[k], gain=gain[k]) for k in chosen)


def _shortlist(at: Refined, lines: Lines) -> tuple[Array, Array]:
    """The most promising of the grid, each entry fitted on its own by a constant, omega² and the curve of the pole."""
    f, zeta = _grid(lines.frequency)
    left = -leftover(at.vector, at.layout, lines)
    amplitude, power = _amplitudes(left, lines, f, zeta)
    best = np.argsort(-np.sum(power * amplitude**2, axis=1))[:SHORT]
    return f[best], zeta[best]


def _projected(at: Refined, lines: Lines, f: Array, zeta: Array) -> tuple[Array, Array]:
    """Right-hand sides (s, 21) and normal matrices (s, 21, 21) of the amplitudes once all parameters of the fit may give way."""
    n, k = len(lines.frequency), len(at.vector)
    curve = _curves(2 * np.pi * lines.frequency, f, zeta)
    g = curve.view(np.float64).reshape(len(f), n, 2)
    weight = np.sqrt(2) / lines.deviation
    J, r = at.jacobian.reshape(k, n, 21, 2), at.residual.reshape(n, 21, 2)
    rows = np.tensordot(g, weight[:, :, None] * J, axes=((1, 2), (1, 3)))  # (s, k, 21)
    own = np.abs(curve) ** 2 @ weight**2
    d = unit_of(at.information)
    root = np.linalg.cholesky(at.information / np.outer(d, d) + ROUNDING * np.eye(k)) * d[:, None]
    half = np.linalg.solve(root, rows)
    slope = np.linalg.solve(root, at.jacobian @ at.residual + at.prior)
    rhs = np.einsum("ske,k->se", half, slope) - np.tensordot(g, weight[:, :, None] * r, axes=((1, 2), (0, 2)))
    P = -half.swapaxes(1, 2) @ half
    P[:, np.arange(21), np.arange(21)] += own * (1 + RIDGE)
    return rhs, P


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
    curve = _curves(w, f, zeta)
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


def _curves(w: Array, f: Array, zeta: Array) -> ComplexArray:
    """omega² / (omega_r² - omega² + 2 i zeta omega_r omega) of every pole (g, n)."""
    p = 2 * np.pi * f[:, None]
    return np.asarray(w**2 / (p**2 - w**2 + 2j * zeta[:, None] * p * w))


def _rank_one(rhs: Array, P: Array) -> tuple[Array, Array]:
    """Of every pole the best of the six eigenvectors of its matrix of amplitudes: participation (s, 6) and fall of chi² (s,)."""
    i, j = UPPER
    A = np.zeros((len(rhs), 6, 6))
    A[:, i, j] = A[:, j, i] = np.linalg.solve(P, rhs[:, :, None])[:, :, 0]
    _, vectors = np.linalg.eigh(A / np.outer(SCALE, SCALE))
    u = vectors.swapaxes(1, 2) * SCALE  # (s, 6 vectors, 6)
    v = u[:, :, i] * u[:, :, j]
    along = np.einsum("sve,se->sv", v, rhs)
    size = np.maximum(along, 0.0) / np.einsum("sve,sef,svf->sv", v, P, v)
    gain = size * along
    best = np.argmax(gain, axis=1)
    k = np.arange(len(rhs))
    return np.sqrt(size[k, best])[:, None] * u[k, best], gain[k, best]
