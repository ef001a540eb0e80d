"""`Heard`: what every channel of a campaign reads at its lowest lines, beside what all others and the model say it should read.

There every structure is nearly a rigid body, so that the nominal model is right to some ten per cent, and a discrete mistake is
wrong by hundreds. What moved is estimated from whichever six channels let most of the others agree: a channel that is wrong, or
several, or all of one kind, then stands alone against the rest however wrong it is (random sample consensus, Fischler & Bolles,
Communications of the ACM 24 (1981), 381). How far a reading lies from what it should be is told without any scale,

    |y - p| / (|y| + |p|)     each line and run in units of what is usual there

0 where they agree, 0.1 for a gain of 20 %, 0.8 for g taken for m/s², 1 for a wrong sign.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray
from validation.prediction.series import SeriesPrediction

REACH = 1.5
"""Lines up to so many times the lowest one are used."""

LINES = 4
"""How many of them."""

MOTIONS_OF_A_PLATE = 6

DRAWS = 400
"""Sets of six channels that are tried, of the accelerometers alone and of all channels."""

CONDITION = 40.0
"""Of the rows of six channels, beyond which they do not tell the motion."""

DISTANT = 0.15
"""Distance of a reading from what it should be at which it stops to count much."""

NEAR = 0.25
"""Distance within which a channel takes part in the final estimate: a gain of two thirds."""

PORTION = 100
"""Sets that are worked on at once."""

ROUNDS = 3
"""Times that the final estimate is repeated with the channels that are near."""

FAINT = 0.3
"""Share of what a channel should read over all runs that counts as its level where it should read less."""

TINY = float(np.finfo(np.float64).tiny)


@dataclass(frozen=True, eq=False, kw_only=True)
class Heard:
    """One campaign at its lowest lines; runs and lines in one axis of m.

    Attributes
    ----------
    name : of the data set
    channels : (c,) names
    quantities : (c,) "acceleration", "force" or "moment"
    lines : how many of m belong to one run
    reading : (m, c) y
    expected : (m, c) p, by the other channels and the model
    noise : (m, c)
    """

    name: str
    channels: tuple[str, ...]
    quantities: tuple[str, ...]
    lines: int
    reading: ComplexArray
    expected: ComplexArray
    noise: Array

    @property
    def level(self) -> Array:
        """(m, c) what each channel should read, never nothing."""
        return np.asarray(level(self.expected[None])[0])


def heard(one: SeriesPrediction) -> Heard:
    """The lowest lines of `one`, by its model as it stands."""
    measured = one.measured
    lines = _lines(measured.frequency)
    rows = one.at({parameter.name: parameter.start for parameter in one.parameters}, lines, derivatives=False).rows
    y = measured.values[:, lines]
    p = _agreed(rows if rows.ndim == 4 else rows[None], y, ~measured.judged)
    of = {channel.name: channel.quantity for channel in one.tested.campaign.table.channels}
    return Heard(
        name=measured.name,
        channels=measured.channels,
        quantities=tuple(of[name] for name in measured.channels),
        lines=len(lines),
        reading=y.reshape(-1, y.shape[2]),
        expected=p.reshape(-1, y.shape[2]),
        noise=measured.noise[:, lines].reshape(-1, y.shape[2]),
    )


def distance(y: ComplexArray, p: ComplexArray) -> Array:
    """(..., c) of readings y (..., r, n, c) from what they should be, 0 to 1; every run counts, loud or not."""
    size = level(p)
    off, both = _norm((y - p) / size), _norm(y / size) + _norm(p / size)
    return np.asarray(off / np.maximum(both, TINY))


def level(p: ComplexArray) -> Array:
    """(..., r, n, c) of what channels should read, never nothing."""
    usual = np.sqrt(np.mean(np.abs(p) ** 2, axis=(-3, -2), keepdims=True))
    return np.asarray(np.maximum(np.hypot(np.abs(p), FAINT * usual), TINY))


def _norm(values: ComplexArray) -> Array:
    return np.asarray(np.linalg.norm(values, axis=(-3, -2)))


def _lines(frequency: Array) -> npt.NDArray[np.int64]:
    low = np.flatnonzero(frequency <= REACH * frequency[0])
    return np.unique(np.linspace(low[0], low[-1], LINES).round().astype(np.int64))


def _agreed(A: ComplexArray, y: ComplexArray, moved: npt.NDArray[np.bool_]) -> ComplexArray:
    """(r, n, c) what the channels should read, A (r or 1, n, c, 6), by the motion on which most of them agree."""
    p = _by_six(A, y, moved)
    for _ in range(ROUNDS):
        near = distance(y, p) < NEAR
        weight = near / np.maximum(np.sqrt(np.mean(np.abs(p) ** 2, axis=(0, 1))), TINY)
        if np.linalg.matrix_rank(weight[:, None] * A[0, 0]) < MOTIONS_OF_A_PLATE:
            break
        p = (A @ (np.linalg.pinv(weight[:, None] * A) @ (weight * y)[..., None]))[..., 0]
    return np.asarray(p)


def _by_six(A: ComplexArray, y: ComplexArray, moved: npt.NDArray[np.bool_]) -> ComplexArray:
    """The same by the six channels whose motion the others contradict least."""
    every = np.arange(len(moved))
    sets = np.vstack([_drawn(every[moved]), _drawn(every)])
    sets = sets[_condition(A[0, 0], sets) < CONDITION]
    if not len(sets):
        weight = 1 / np.maximum(np.linalg.norm(A, axis=-1), TINY)
        return np.asarray((A @ (np.linalg.pinv(weight[..., None] * A) @ (weight * y)[..., None]))[..., 0])
    best, least = np.zeros_like(y), np.inf
    for part in np.array_split(sets, max(1, len(sets) // PORTION)):
        of_sets = np.linalg.inv(A[:, :, part].transpose(2, 0, 1, 3, 4)) @ y[:, :, part].transpose(2, 0, 1, 3)[..., None]
        p = (A @ of_sets)[..., 0]
        d = distance(y, p) ** 2
        cost = np.sum(d / (d + DISTANT**2), axis=1)
        if cost.min() < least:
            best, least = p[int(np.argmin(cost))], float(cost.min())
    return np.asarray(best)


def _drawn(channels: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
    """(DRAWS, 6) sets of six of them; always the same, so that a diagnosis can be repeated."""
    if len(channels) < MOTIONS_OF_A_PLATE:
        return np.zeros((0, MOTIONS_OF_A_PLATE), dtype=np.int64)
    generator = np.random.default_rng(0)
    return np.stack([generator.choice(channels, MOTIONS_OF_A_PLATE, replace=False) for _ in range(DRAWS)])


def _condition(A: ComplexArray, sets: npt.NDArray[np.int64]) -> Array:
    """(k,) of the rows (c, 6) of each set, rows and columns of one size."""
    even = A / np.maximum(np.linalg.norm(A, axis=1, keepdims=True), TINY)
    even = even / np.maximum(np.linalg.norm(even, axis=0), TINY)
    sizes = np.linalg.svd(even[sets], compute_uv=False)
    return np.asarray(sizes[:, 0] / np.maximum(sizes[:, -1], TINY))
