"""How well what the channels read agrees with itself, in units of the tolerances of an ordinary laboratory.

Three agreements need no model of the structure, only that the plates below it are stiff:

- redundancy: more than six accelerometers on table and cover plate tell one and the same base motion,
- parity: more than six force channels hold self-equilibrated readings, which cells of one stiffness do not have,
- structure: H is the mass matrix of a body (Eq. 1): symmetric, m_x = m_y = m_z, skew coupling, no phase, positive diagonal.
  Elastic structures are symmetric, too, and positive at the lowest line.

Each is a mean square of 1 where channels are off by their tolerances, and grows to hundreds with a wrong sign. The lowest lines
are used, where the structure answers most rigidly; what elasticity adds there is allowed for by the way H grows over them, with
omega². Everything is computed for many variants of the readings at once, since mistakes are found by trying to undo them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array, Integers
from geometry.dynamic_mass import ComplexArray
from geometry.frames import rigid_transformation
from geometry.sensors import Channel, ChannelTable, resultants
from geometry.tolerances import Tolerances
from identification import base_motion
from identification.base_motion import STANDARD_GRAVITY
from identification.campaign_checks import RIGID_GROUPS
from identification.rigid_body import BASIS
from identification.spectra.line_spectra import Spectra

REACH = 1.5
"""Lines up to so many times the lowest one are used."""

LINES = 3
"""How many of them: faults that do not depend on frequency show at every line alike."""


CLIP = 2.0
"""How far the largest reading of a channel may lie beyond that of most others, and still tell how much moved."""

NEGATIVE = 1e6
"""Mean square of a mass or a moment of inertia below zero: no tolerance makes one."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Readings:
    """What the channels of table, cover plate and force measurement read at the lowest lines.

    Attributes
    ----------
    table : these channels
    rows : (n, a, 6) what the accelerometers among them read of the apparent base motion
    omega : (n,) [rad/s]
    values : (r, n, c) complex
    noise : (r, n, c) standard deviation
    lines : (n,) indices of the lines in the spectra
    tolerances : of the laboratory
    """

    table: ChannelTable
    rows: Array
    omega: Array
    values: ComplexArray
    noise: Array
    lines: Integers
    tolerances: Tolerances


@dataclass(frozen=True, eq=False, kw_only=True)
class Misfit:
    """Mean squares of v variants of the readings, 1 where they are off by the tolerances, 0 where there is nothing to compare.

    Attributes
    ----------
    redundancy, parity, structure : (v,)
    """

    redundancy: Array
    parity: Array
    structure: Array

    @property
    def total(self) -> Array:
        """(v,) their sum."""
        return self.redundancy + self.parity + self.structure

    @property
    def worst(self) -> Array:
        """(v,) the largest of the three."""
        return np.asarray(np.max([self.redundancy, self.parity, self.structure], axis=0))


def readings(spectra: Spectra, tolerances: Tolerances, gravity: float = STANDARD_GRAVITY) -> Readings:
    """The lowest lines of the channels that can be compared; `gravity` [m/s²] is for channels that do not feel a tilt."""
    low = np.flatnonzero(spectra.frequency <= REACH * spectra.frequency[0])
    lines = np.unique(np.linspace(low[0], low[-1], LINES).round().astype(np.intp))
    moved = spectra.table.select(group=RIGID_GROUPS, quantity="acceleration")
    chosen = [*moved, *spectra.table.select(group="fmd", quantity=("force", "moment"))]
    return Readings(
        table=spectra.table.subset(chosen),
        rows=base_motion.rows(spectra, moved, gravity)[lines],
        omega=2 * np.pi * spectra.frequency[lines],
        values=spectra.values[:, lines][:, :, chosen],
        noise=spectra.noise[:, lines][:, :, chosen],
        lines=lines,
        tolerances=tolerances,
    )


def redundancy(of: Readings, values: ComplexArray, noise: Array) -> Array:
    """(v,) that of the accelerometers alone."""
    return _motion(of, values, noise).left_over


def parity(of: Readings, values: ComplexArray, noise: Array) -> Array:
    """(v,) that of the force channels alone."""
    return _load(of, values, noise).left_over


def misfit(of: Readings, values: ComplexArray, noise: Array) -> Misfit:
    """The misfit of variants (v, r, n, c) of the readings and of their noise; structure takes six runs."""
    motion, load = _motion(of, values, noise), _load(of, values, noise)
    third = _structure(of, _entries(motion, load)) if values.shape[1] >= 6 else np.zeros(len(values))
    return Misfit(redundancy=motion.left_over, parity=load.left_over, structure=third)


def deviation(of: Readings) -> Array:
    """(n, 6, 6) standard deviation of the entries of H by the tolerances, its base motion as in `identification.base_motion`."""
    values, noise = of.values[None], of.noise[None]
    groups = base_motion.groups_used(of.table)
    used = [k for k, channel in enumerate(_pick_ups(of)) if channel.group in groups]
    T = np.linalg.pinv(of.rows[:, used])
    sd = _tolerance(of, values, noise)[..., used]
    covariance = np.einsum("njc,vrnc,nkc->vrnjk", T, sd**2, T, optimize=True)
    u = np.einsum("njc,vrnc->vrnj", T, values[..., used])
    side = _Side(values=u, covariance=covariance, left_over=np.zeros(1))
    return np.asarray(_entries(side, _load(of, values, noise)).deviation[0])


def elasticity(of: Readings, H: ComplexArray) -> Array:
    """What |H| (..., n, 6, 6) may hold beyond a body: it grows with omega², by what is seen from the first line to the last."""
    if len(of.omega) < 2:
        return np.zeros(H.shape)
    first, last = of.omega[[0, -1]] ** 2
    return np.asarray(np.abs(H[..., -1:, :, :] - H[..., :1, :, :]) * (of.omega**2 / (last - first))[:, None, None])


@dataclass(frozen=True, eq=False, kw_only=True)
class _Side:
    """Six motions or loads (v, r, n, 6), their covariances by tolerance (v, r, n, 6, 6), and the mean square (v,) left over."""

    values: ComplexArray
    covariance: Array
    left_over: Array


def _pick_ups(of: Readings) -> list[Channel]:
    """The accelerometers. They stand before the load cells."""
    return [of.table.channels[k] for k in of.table.select(quantity="acceleration")]


def _tolerance(of: Readings, values: ComplexArray, noise: Array) -> Array:
    """(v, r, n, a) standard deviation of the accelerometers: own gain and delay, place and angle in what is around."""
    channels, t = _pick_ups(of), of.tolerances
    a, floor = values[..., : len(channels)], noise[..., : len(channels)]
    rough = (np.linalg.pinv(of.rows) @ _clipped(a)[..., None])[..., 0]
    local = np.stack([rough @ rigid_transformation(_place(channel) - of.table.origin).T for channel in channels], axis=-2)
    across, turning = np.linalg.norm(local, axis=-1), np.linalg.norm(rough[..., 3:], axis=-1, keepdims=True)
    gain = np.array([t.table_gain if channel.group == "table" else t.gain for channel in channels])
    own = np.abs(a) ** 2 * (gain**2 + (of.omega[:, None] * t.delay) ** 2)
    sd = np.sqrt(own + (t.angle * across) ** 2 + (t.position * turning) ** 2 + floor**2)
    rounding = np.finfo(np.float64).eps * np.abs(a).max(axis=-1, keepdims=True) + np.finfo(np.float64).tiny
    return np.asarray(np.maximum(sd, rounding))


def _clipped(a: ComplexArray) -> ComplexArray:
    """Readings (v, r, n, a) cut off far beyond the largest of most channels: one in a wrong unit shall not excuse the others."""
    size = np.abs(a)
    usual = np.median(size.max(axis=(1, 2)), axis=-1)[:, None, None, None]
    return np.asarray(a * np.minimum(1.0, CLIP * usual / np.maximum(size, np.finfo(np.float64).tiny)))


def _motion(of: Readings, values: ComplexArray, noise: Array) -> _Side:
    """Eqs. 6 and 7, every accelerometer of table and cover plate weighted by its tolerance."""
    G, sd = of.rows, _tolerance(of, values, noise)
    a, count = values[..., : G.shape[1]], G.shape[1]
    # Six unknowns and rows of one geometry: the normal equations are quick, and safe at condition numbers of tens.
    outer = (G[..., :, None] * G[..., None, :]).reshape(*G.shape[:2], 36)
    covariance = np.linalg.inv((sd[..., None, :] ** -2 @ outer).reshape(*sd.shape[:-1], 6, 6))
    u = covariance @ ((a / sd**2)[..., None, :] @ G).swapaxes(-1, -2)
    return _Side(
        values=u[..., 0],
        covariance=np.asarray(covariance, dtype=np.float64),
        left_over=_mean_square((a - (G @ u)[..., 0]) / sd) * count / max(count - 6, 1),
    )


def _place(channel: Channel) -> Array:
    """(3,) [m] where a channel sits; the mean of several places."""
    return np.asarray(np.mean([place.position for place in channel.places], axis=0))


def _load(of: Readings, values: ComplexArray, noise: Array) -> _Side:
    """Resultants, and what is self-equilibrated: the null space of the sums that make them."""
    chosen = list(of.table.select(quantity=("force", "moment")))
    T, f, t = resultants([of.table.channels[k] for k in chosen], of.table.origin), values[..., chosen], of.tolerances
    F = f @ T.T
    variance = np.abs(f) ** 2 * (t.gain**2 + (of.omega[:, None] * t.delay) ** 2) + noise[..., chosen] ** 2
    crossed = np.concatenate(
        [np.repeat(np.sum(np.abs(F[..., part]) ** 2, axis=-1)[..., None], 3, axis=-1) for part in HALVES], -1
    )
    covariance = np.einsum("jc,...c,kc->...jk", T, variance, T, optimize=True) + t.crosstalk**2 * crossed[..., None] * np.eye(6)
    N = np.linalg.svd(T)[2][6:].T
    spread = (variance + t.cell_stiffness**2 * np.abs(f) ** 2) @ N**2
    tiny = np.finfo(np.float64).tiny
    left_over = _mean_square(f @ N / np.sqrt(np.maximum(spread, tiny))) if N.size else np.zeros(len(values))
    return _Side(values=F, covariance=covariance, left_over=left_over)


HALVES = (slice(3), slice(3, 6))
"""Translations and rotations, forces and moments."""


@dataclass(frozen=True, eq=False, kw_only=True)
class _Entries:
    """H (v, n, 6, 6) at the lowest lines, and the standard deviation of each entry by the tolerances."""

    matrix: ComplexArray
    deviation: Array


def _entries(motion: _Side, load: _Side) -> _Entries:
    U, F = motion.values.transpose(0, 2, 3, 1), load.values.transpose(0, 2, 3, 1)  # (v, n, 6, r)
    P = np.linalg.pinv(U)
    H = F @ P
    through = np.einsum("vnij,vrnjk,vnik->vrni", H, motion.covariance, H.conj(), optimize=True).real
    own = np.diagonal(load.covariance, axis1=-2, axis2=-1)
    return _Entries(matrix=H, deviation=np.sqrt(np.einsum("vrni,vnrk->vnik", own + through, np.abs(P) ** 2, optimize=True)))


def _structure(of: Readings, found: _Entries) -> Array:
    """Mean squares (v,) of what H has that no body has and that no structure has, and the price of a negative mass."""
    H, sd = found.matrix, found.deviation
    lowest = np.diagonal(H[:, 0], axis1=1, axis2=2).real
    negative = np.any(lowest <= 0, axis=1)
    square = np.maximum(_unlike_a_body(H, np.hypot(sd, elasticity(of, H))), _unsymmetric(H, sd))
    return np.asarray(square + NEGATIVE * negative)


def _unlike_a_body(H: ComplexArray, sd: Array) -> Array:
    """Mean square (v,) of what the best mass matrix of Eq. 1 leaves of H (v, n, 6, 6)."""
    weight = 1 / sd.reshape(len(H), -1)
    rows = np.tile(BASIS.reshape(10, 36).T, (H.shape[1], 1)) * weight[..., None]
    b = H.reshape(len(H), -1) * weight
    p = np.linalg.pinv(rows) @ b.real[..., None]
    return _mean_square(b - (rows @ p)[..., 0])


def _unsymmetric(H: ComplexArray, sd: Array) -> Array:
    """Mean square (v,) of H (v, n, 6, 6) less its transpose, which elasticity leaves alone."""
    j, k = np.triu_indices(6, 1)
    return _mean_square((H[..., j, k] - H[..., k, j]) / np.hypot(sd[..., j, k], sd[..., k, j]))


def _mean_square(values: ComplexArray) -> Array:
    """(v,) over all but the first axis."""
    return np.asarray(np.mean(np.abs(values.reshape(len(values), -1)) ** 2, axis=1))
