"""`Driven`: the runs of one campaign by how strongly they were driven, and what the weaker ones hold beyond the stronger ones.

What is linear reads y = A u in every run, whatever A is: the readings of six independent runs span all that a seventh can read.
So no model is asked: the stronger runs B of all axes explain a weaker run, line by line, up to noise,

    r = (1 - Q Q^H) W y ,   W B = Q R ,   1 / W² = noise² + |c|² noise_B² + floor² ,   y ~ B c

and what is left over is not linear. Where the stronger runs do not span the six motions, the rows of the model stand in for those
that are missing; its errors then count with the little that the runs differ by.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray
from identification.self_calibration.elimination import eliminated, level_of_groups, smoothed_level
from validation.effects.catalogue import FAMILIES
from validation.effects.family import AMPLITUDE
from validation.prediction.series import SeriesPrediction

MOTIONS_OF_A_PLATE = 6

WEAKER = 0.9
"""Share of the strongest level of an axis below which a run was driven at another level."""

ALIKE = 0.99
"""Cosine from which two runs drive the same axes."""

FLOOR = 5e-4
"""What of a channel's level no recorder repeats from one run to the next, beside its noise."""

SPANNED = 20.0
"""How far above noise the weakest of six motions must stand in the stronger runs, for these to span them."""

WRONG = 0.1
"""How far off a model's rows may be that stand in for runs, as a share."""

Indices = npt.NDArray[np.int64]


@dataclass(frozen=True, eq=False, kw_only=True)
class Driven:
    """The runs of one campaign.

    Attributes
    ----------
    name : of the data set
    runs, axes : (r,) names, and what each drove in words
    share : (r,) of the level of the strongest run that drove the same
    partner : (r,) that strongest run; the run itself where it is the strongest
    channels : (c,) names
    judged : (c,) bool, forces
    frequency : (n,) [Hz]
    values, noise : (r, n, c) as `validation.engine.measured.Measured`
    level : (r, n, c) smoothed level, never silent
    rows : (n, c, 6) of the model, which stand in where the runs do not span
    """

    name: str
    runs: tuple[str, ...]
    axes: tuple[str, ...]
    share: Array
    partner: Indices
    channels: tuple[str, ...]
    judged: npt.NDArray[np.bool_]
    frequency: Array
    values: ComplexArray
    noise: Array
    level: Array
    rows: ComplexArray

    @property
    def weaker(self) -> tuple[int, ...]:
        """Indices of the runs that have a stronger partner."""
        return tuple(int(k) for k in np.flatnonzero(self.share < WEAKER))

    @property
    def stronger(self) -> tuple[int, ...]:
        """Indices of the strongest runs of their axes."""
        return tuple(int(k) for k in np.flatnonzero(self.share >= WEAKER))

    def at(self, lines: Indices) -> Driven:
        """The lines with these indices alone."""
        of_runs = {name: getattr(self, name)[:, lines] for name in ("values", "noise", "level")}
        return replace(self, frequency=self.frequency[lines], rows=self.rows[lines], **of_runs)


@dataclass(frozen=True, eq=False, kw_only=True)
class Beyond:
    """What a weaker run holds beyond the stronger ones.

    Attributes
    ----------
    run : its index
    whitened : (n, c) complex, of unit variance for each that is free
    free : (n, c) share of each channel's noise that is left over, diagonal of 1 - Q Q^H
    explained : (n, c, k) orthonormal, Q
    deviation : (n, c) standard deviation by which it was whitened
    weights : (n, h) c, what it takes of each of the stronger runs
    """

    run: int
    whitened: ComplexArray
    free: Array
    explained: ComplexArray
    deviation: Array
    weights: ComplexArray

    def projected(self, values: ComplexArray) -> ComplexArray:
        """(n, c) what of readings (n, c) the stronger runs do not explain, whitened."""
        white = (values / self.deviation)[..., None]
        return np.asarray((white - self.explained @ (self.explained.conj().transpose(0, 2, 1) @ white))[..., 0])

    @property
    def chi2(self) -> float:
        """Sum of squares; one for every complex number that is free."""
        return float(np.sum(np.abs(self.whitened) ** 2))

    @property
    def count(self) -> float:
        """Complex numbers that are free."""
        return float(np.sum(self.free))

    @property
    def by_channel(self) -> Array:
        """(n, c) by how much the sum of squares would fall without a channel; 1 on average where nothing is wrong."""
        return np.asarray(np.abs(self.whitened) ** 2 / np.maximum(self.free, FREE))


FREE = 1e-3
"""Share of a channel's noise below which the others do not say what it reads."""


def driven(one: SeriesPrediction) -> Driven:
    """The runs of `one`; what its model knows of an amplitude is taken off their readings."""
    measured = one.measured
    share, partner = _levels(one)
    linear = one.with_effects([effect for effect in one.effects if FAMILIES[effect.named.family].side != AMPLITUDE])
    start = {parameter.name: parameter.start for parameter in one.parameters}
    rows = linear.at(start, derivatives=False).rows
    values = measured.values if len(linear.effects) == len(one.effects) else _linear(one, rows)
    silent = level_of_groups(values, measured.judged)
    return Driven(
        name=measured.name,
        runs=measured.runs,
        axes=tuple(axis or "several axes" for axis in measured.axes),
        share=share,
        partner=partner,
        channels=measured.channels,
        judged=measured.judged,
        frequency=measured.frequency,
        values=values,
        noise=measured.noise,
        level=np.hypot(smoothed_level(measured.frequency, values), SILENT * silent),
        rows=rows if rows.ndim == 3 else rows[0],
    )


SILENT = 0.01
"""Share of what channels of its kind read at which a channel counts as silent."""


def _levels(one: SeriesPrediction) -> tuple[Array, Indices]:
    """(r,) shares of the strongest run that drove the same, and (r,) that run."""
    drive = np.stack([of.amplitude for of in one.tested.drives])
    size = np.linalg.norm(drive, axis=1)
    if not np.all(size > 0):
        drive, size = _as_read(one)
    along = drive / np.maximum(size, np.finfo(np.float64).tiny)[:, None]
    same = along @ along.T > ALIKE
    strongest = np.where(same, size[None], 0.0).max(axis=1)
    share = size / strongest
    partner = np.arange(len(size))
    for k in np.flatnonzero(share < WEAKER):
        rivals = np.flatnonzero(same[k] & (share >= WEAKER))
        partner[k] = rivals[np.argmax([_coherence(one, int(k), int(other)) for other in rivals])]
    return share, partner


def _as_read(one: SeriesPrediction) -> tuple[Array, Array]:
    """Drives of runs that state no amplitude: by the axis, in what their accelerometers read."""
    measured = one.measured
    moved = measured.values[..., ~measured.judged]
    size = np.sqrt(np.mean(np.abs(moved) ** 2, axis=(1, 2)))
    known = sorted(set(measured.axes))
    drive = np.zeros((len(size), len(known)))
    drive[np.arange(len(size)), [known.index(axis) for axis in measured.axes]] = size
    return drive, size


def _coherence(one: SeriesPrediction, k: int, other: int) -> float:
    a, b = one.measured.values[k].ravel(), one.measured.values[other].ravel()
    return float(np.abs(np.vdot(a, b)) / max(float(np.linalg.norm(a) * np.linalg.norm(b)), np.finfo(np.float64).tiny))


def _linear(one: SeriesPrediction, rows: ComplexArray) -> ComplexArray:
    """(r, n, c) readings less what the amplitude-dependent effects of the model make of them."""
    measured = one.measured
    own = one.at({parameter.name: parameter.start for parameter in one.parameters}, derivatives=False).rows
    found = np.array(measured.values)
    for k, y in enumerate(measured.values):
        A = own[k] if own.ndim == 4 else own
        w = 1 / np.hypot(measured.noise[k], WRONG * np.abs(y).max(axis=0))
        u = eliminated(A, y, w)[2]
        found[k] += ((rows - A) @ u[..., None])[..., 0]
    return found


def beyond(of: Driven, runs: Sequence[int] | None = None) -> tuple[Beyond, ...]:
    """What each of the weaker `runs` (all by default) holds beyond the stronger ones; none where channels are too few."""
    basis = of.values[list(of.stronger)].transpose(1, 2, 0)
    missing = not _spans(of, basis)
    columns = basis.shape[2] + (MOTIONS_OF_A_PLATE if missing else 0)
    if columns >= len(of.channels):
        return ()
    return tuple(_beyond(of, k, basis, missing=missing) for k in (of.weaker if runs is None else runs))


def _spans(of: Driven, basis: ComplexArray) -> bool:
    """Whether the stronger runs move in all six ways, well above their noise, at most lines."""
    if basis.shape[2] < MOTIONS_OF_A_PLATE:
        return False
    noise = np.sqrt(np.mean(of.noise[list(of.stronger)] ** 2, axis=0))
    noise = np.maximum(noise, FLOOR * of.level[list(of.stronger)].max(axis=0))
    sizes = np.linalg.svd(basis / noise[..., None], compute_uv=False)
    return bool(np.median(sizes[:, MOTIONS_OF_A_PLATE - 1]) > SPANNED)


def _beyond(of: Driven, k: int, basis: ComplexArray, *, missing: bool) -> Beyond:
    y, strong = of.values[k], list(of.stronger)
    own = np.hypot(of.noise[k], FLOOR * of.level[k])
    motions, made_of = _motions(basis, own)
    columns = np.concatenate([motions, of.rows], axis=2) if missing else motions
    u = eliminated(columns, y, 1 / own)[2]
    weights = (made_of @ u[:, : motions.shape[2], None])[..., 0]
    variance = own**2 + np.einsum("nh,hnc->nc", np.abs(weights) ** 2, of.noise[strong] ** 2)
    if missing:
        moved = (of.rows @ u[:, motions.shape[2] :, None])[..., 0]
        variance = variance + (WRONG * np.abs(moved)) ** 2
    deviation = np.sqrt(variance)
    whitened, Q, _ = eliminated(columns, y, 1 / deviation)
    free = 1 - np.sum(np.abs(Q) ** 2, axis=2)
    return Beyond(run=k, whitened=whitened, free=free, explained=Q, deviation=deviation, weights=weights)


def _motions(basis: ComplexArray, deviation: Array) -> tuple[ComplexArray, ComplexArray]:
    """(n, c, m) what the runs of `basis` (n, c, h) move, in at most six ways, and (n, h, m) of which runs each is made."""
    h = basis.shape[2]
    if h <= MOTIONS_OF_A_PLATE:
        return basis, np.broadcast_to(np.eye(h, dtype=np.complex128), (len(basis), h, h))
    U, S, Vh = np.linalg.svd(basis / deviation[..., None], full_matrices=False)
    kept = slice(MOTIONS_OF_A_PLATE)
    made_of = Vh[:, kept].conj().transpose(0, 2, 1) / S[:, None, kept]
    return np.asarray(U[..., kept] * deviation[..., None]), np.asarray(made_of)
