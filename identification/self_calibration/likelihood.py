"""The likelihood of one campaign: base motions are eliminated in closed form, line by line and run by run.

At one line of one run all channels read y = A u + n with six latent base motions u. Whitened by W = diag(1 / sd) of the real and
of the imaginary part, W A = Q R, the residual is what no base motion explains,

    r = (1 - Q Q^H) W y ,      u = R^-1 Q^H W y ,

and its derivative by a parameter of A is (variable projection in the form of Kaufman, BIT 15, 1975)

    dr = -(1 - Q Q^H) W (dA) u .

A = A0 + A1 H is affine in the dynamic mass, so that a structural parameter gives dA = A1 dH. The gradient r^T dr is exact; what
Kaufman leaves out of dr is of second order in r.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from geometry.dynamic_mass import ComplexArray
from geometry.frames import Array, frozen
from identification.chain import Derivative
from identification.elastic.model import UPPER, ElasticTerms
from identification.self_calibration import solve
from identification.self_calibration.solve import SILENT, Normal, Ways, normal_by_ways
from identification.spectra.line_spectra import Spectra


@dataclass(frozen=True, eq=False, kw_only=True)
class Observed:
    """What the channels read at the lines that are used.

    Attributes
    ----------
    frequency : (n,) [Hz]
    values : (r, n, c) complex
    weight : (r, n, c) one over the standard deviation of the real, and of the imaginary, part
    """

    frequency: Array
    values: ComplexArray
    weight: Array

    def __post_init__(self) -> None:
        object.__setattr__(self, "weight", frozen(self.weight, self.values.shape, "weight"))

    @property
    def size(self) -> int:
        """Real numbers that are left when six base motions are taken out of every line and run."""
        runs, lines, channels = self.values.shape
        return int(2 * runs * lines * (channels - 6))


def observed(spectra: Spectra, channels: Sequence[int], lines: npt.NDArray[np.int64], floor: float) -> Observed:
    """The chosen `channels` and `lines` (indices) of `spectra`, with a model-error `floor` relative to the level of each channel.

    Of a channel that is nearly silent in a run it is relative to `SILENT` of what its kind of channel reads.
    E|noise|² = sd² is shared by real and imaginary part.
    """
    chosen = np.ix_(np.arange(len(spectra.runs)), lines, np.asarray(channels))
    kind = solve.level_of_groups(spectra.values, np.array([one.quantity for one in spectra.table.channels]))
    level = np.hypot(solve.smoothed_level(spectra.frequency, spectra.values), SILENT * kind)
    variance = np.square(spectra.noise[chosen]) + np.square(floor * level[chosen])
    weight = np.sqrt(2 / np.maximum(variance, np.finfo(np.float64).tiny))
    return Observed(frequency=spectra.frequency[lines], values=spectra.values[chosen], weight=weight)


@dataclass(frozen=True, eq=False, kw_only=True)
class Rows:
    """The linear model of one campaign at its lines, and how it changes.

    Attributes
    ----------
    a0, a1 : (n, c, 6) of A = A0 + A1 H
    dynamic_mass : (n, 6, 6)
    chain : for every parameter of the chain the channels that it touches, and dA of these
    structure : (n, 6, 6, k) dH of the structural parameters
    """

    a0: ComplexArray
    a1: ComplexArray
    dynamic_mass: ComplexArray
    chain: Sequence[Derivative] = ()
    structure: ComplexArray | None = None


def residual(observed: Observed, rows: Rows) -> ComplexArray:
    """(r, n, c) whitened residual of every run and line."""
    A = rows.a0 + rows.a1 @ rows.dynamic_mass
    return np.stack([solve.eliminated(A, y, w)[0] for y, w in zip(observed.values, observed.weight, strict=True)])


def cost(observed: Observed, rows: Rows) -> float:
    """The cost of `normal` alone, added in the same order."""
    return sum(0.5 * float(np.sum(np.square(np.abs(one)))) for one in residual(observed, rows))


def _ways(rows: Rows) -> Ways:
    """The parameters of `rows` by how channels see them."""
    # The channels see structural parameters through the loads, most of the chain in one channel each
    lines, channels, _ = rows.a1.shape
    moved = np.zeros((lines, 6, 6, 0), dtype=np.complex128) if rows.structure is None else rows.structure
    loaded = np.flatnonzero(np.any(rows.a1 != 0, axis=(0, 2)))
    single = [k for k, one in enumerate(rows.chain) if len(one.channels) == 1]
    others = [k for k, one in enumerate(rows.chain) if len(one.channels) != 1]
    whole = np.zeros((len(others), lines, channels, 6), dtype=np.complex128)
    for place, k in enumerate(others):
        whole[place][:, rows.chain[k].channels] = rows.chain[k].rows
    return Ways(
        count=len(rows.chain) + moved.shape[-1],
        channels=loaded,
        through=rows.a1[:, loaded],
        common=len(rows.chain) + np.arange(moved.shape[-1]),
        quantities=np.ascontiguousarray(moved.transpose(0, 3, 1, 2)),
        single=np.array(single, dtype=np.int64),
        at=np.array([rows.chain[k].channels[0] for k in single], dtype=np.int64),
        rows=np.array([rows.chain[k].rows[:, 0] for k in single], dtype=np.complex128).reshape(len(single), lines, 6),
        others=np.array(others, dtype=np.int64),
        whole=whole,
    )


def normal(observed: Observed, rows: Rows) -> Normal:
    """The normal equations of the campaign, run by run; chain parameters first, then structural ones."""
    of = _ways(rows)
    A, found = rows.a0 + rows.a1 @ rows.dynamic_mass, []
    for y, w in zip(observed.values, observed.weight, strict=True):
        r, Q, u = solve.eliminated(A, y, w)
        found.append(normal_by_ways(of, r, Q, u, w))
    return solve.total(found, of.count)


# The same cost about one point, to second order in the chain and in the dynamic mass of every line.
#
# A structure shows in the channels through H alone, of which a line has 21 entries. What all runs say of them and of the chain is
# summed once; where a structure moves, it is then told for next to nothing, however curved its way: of the point are only base
# motions and directions of the residual. At the point itself cost, gradient and J^T J are the exact ones.


@dataclass(frozen=True, eq=False, kw_only=True)
class Near:
    """The cost of one campaign near a point.

    Attributes
    ----------
    chain : cost, gradient (p,) and matrix (p, p) of the chain alone
    gradient : (n, 21) by the entries of H in `UPPER`
    matrix : (n, 21, 21) of these, Hermitian
    met : (p, n, 21) of the chain with these
    """

    chain: Normal
    gradient: ComplexArray
    matrix: ComplexArray
    met: ComplexArray

    def cost(self, theta: Array, h: ComplexArray) -> float:
        """With the chain `theta` (p,) and the dynamic mass `h` (n, 21) away from the point."""
        met = np.tensordot(theta, self.met, axes=1) + (self.matrix @ h[..., None])[..., 0] / 2
        of_chain = (self.chain.gradient + self.chain.matrix @ theta / 2) @ theta
        return self.chain.cost + float(of_chain + np.vdot(h, self.gradient + met).real)

    def normal(self, theta: Array, h: ComplexArray, changes: ComplexArray) -> Normal:
        """The same to second order by the chain and by what changes H by `changes` (k, n, 21), in this order."""
        slope = self.gradient + np.tensordot(theta, self.met, axes=1) + (self.matrix @ h[..., None])[..., 0]
        turned = (changes.transpose(1, 0, 2) @ self.matrix.transpose(0, 2, 1)).transpose(1, 0, 2)
        moved, met = solve.as_real(changes), solve.as_real(self.met)
        across = moved @ met.T
        gradient = self.chain.gradient + self.chain.matrix @ theta + met @ solve.as_real(h[None])[0]
        return Normal(
            cost=self.cost(theta, h),
            gradient=np.concatenate([gradient, moved @ solve.as_real(slope[None])[0]]),
            matrix=np.block([[self.chain.matrix, across.T], [across, moved @ solve.as_real(turned).T]]),
        )


def near(observed: Observed, rows: Rows) -> Near:
    """The cost of the campaign near the point of `rows`, of which those of the structure are not asked for."""
    i, j = UPPER
    twice = i != j
    A, (runs, lines, _) = rows.a0 + rows.a1 @ rows.dynamic_mass, observed.values.shape
    gradient, matrix = np.zeros((lines, 6, 6), dtype=np.complex128), np.zeros((lines, 6, 6, 6, 6), dtype=np.complex128)
    met = np.empty((lines, len(rows.chain), 6, runs), dtype=np.complex128)
    motion = np.empty((lines, runs, 6), dtype=np.complex128)
    of, found = _ways(replace(rows, structure=None)), []
    for k, (y, w) in enumerate(zip(observed.values, observed.weight, strict=True)):
        r, Q, u = solve.eliminated(A, y, w)
        found.append(normal_by_ways(of, r, Q, u, w))
        # What loads do to the channels beside the inputs, (n, c, 6), and how all else meets it
        T = w[..., None] * rows.a1
        B = T - Q @ (Q.conj().transpose(0, 2, 1) @ T)
        Bh, motion[:, k] = B.conj().transpose(0, 2, 1), u.conj()
        here = met[..., k]
        here[:, of.single] = Bh[:, :, of.at].transpose(0, 2, 1) * (w[:, of.at] * np.einsum("bmk,mk->mb", of.rows, u))[..., None]
        here[:, of.others] = (w * (of.whole @ u[..., None])[..., 0]).transpose(1, 0, 2) @ B.conj()
        gradient -= (Bh @ r[..., None]) * motion[:, k, None, :]
        outer = motion[:, k, :, None] * u[:, None, :]
        matrix += (Bh @ B)[:, :, None, :, None] * outer[:, None, :, None, :]
    whole = (met.reshape(lines, -1, runs) @ motion).reshape(lines, len(rows.chain), 6, 6)

    def upper(one: ComplexArray) -> ComplexArray:
        return np.asarray(one[..., i, j] + np.where(twice, one[..., j, i], 0.0))

    return Near(
        chain=solve.total(found, of.count),
        gradient=upper(gradient),
        matrix=upper(upper(matrix).transpose(0, 3, 1, 2)).transpose(0, 2, 1),
        met=np.ascontiguousarray(upper(whole).transpose(1, 0, 2)),
    )


def gradients(observed: Observed, rows: Rows) -> Array:
    """(r, n, k) what every line of every run contributes to the gradient."""
    A, found = rows.a0 + rows.a1 @ rows.dynamic_mass, []
    structural = 0 if rows.structure is None else rows.structure.shape[-1]
    for y, w in zip(observed.values, observed.weight, strict=True):
        r, _, u = solve.eliminated(A, y, w)
        # (k, n, c) W (dA) u
        V = np.zeros((len(rows.chain) + structural, *w.shape), dtype=np.complex128)
        for k, change in enumerate(rows.chain):
            V[k][:, change.channels] = (change.rows @ u[..., None])[..., 0]
        if rows.structure is not None:
            load = np.einsum("nijk,nj->nik", rows.structure, u, optimize=True)
            V[len(rows.chain) :] = (rows.a1 @ load).transpose(2, 0, 1)
        found.append(-np.einsum("nc,knc->nk", r.conj(), w * V).real)
    return np.stack(found)


# Which lines the joint fit uses: few where H is smooth, all of them across a resonance.
#
# Beside resonances the model's own error is strongly correlated from line to line, so that neighbours add time and little else.
# A resonance of width 2 zeta f is told by the lines within a few widths of it. A set-up without any is told by its noise, which
# more lines average out: with 240 instead of 60 the moments of Cuboid and disc came out twice as well.

SMOOTH = 60
"""Lines over the band beside resonances."""

RIGID = 240
"""Lines over the band of a set-up in which nothing resonates."""

WIDTHS = 4.0
"""Half-power widths to either side of a pole within which every line counts."""

AT_MOST = 200
"""Lines in all: across resonances every second or third is taken where there are more."""

Indices = npt.NDArray[np.int64]


def chosen(frequency: Array, terms: ElasticTerms | None = None, *, smooth: int = SMOOTH, at_most: int = AT_MOST) -> Indices:
    """Indices of the lines of `frequency` (n,) [Hz] to use, ascending."""
    rigid = terms is None or not len(terms.frequency)
    count = min(max(smooth, RIGID) if rigid else smooth, len(frequency))
    even = np.unique(np.round(np.linspace(0, len(frequency) - 1, count)).astype(np.int64))
    if terms is None or rigid:
        return even
    width = 2 * terms.damping_ratio * terms.frequency
    near = np.any(np.abs(frequency[:, None] - terms.frequency) <= WIDTHS * width, axis=1)
    resonant = np.setdiff1d(np.flatnonzero(near), even)
    step = max(int(np.ceil(len(resonant) / max(at_most - len(even), 1))), 1)
    closest = np.argmin(np.abs(frequency[:, None] - terms.frequency), axis=0)
    return np.unique(np.concatenate([even, resonant[::step], closest])).astype(np.int64)
