"""`Misfit`: how badly a fitted hypothesis misses, in all, where it does worst, and what its tolerances paid for it.

Tolerances can swallow a fault with no trace in chi², at an absurd price. What they should cost is known: of a linear model with
prior variances T and posterior covariance C the offsets of a fit scatter, over all laboratories and their noise, by T - C. Hence

    E sum z² = tr S,    var sum z² = 2 tr S²,    S = 1 - T^-1/2 C T^-1/2 ,

and each z by itself by the root of its S_kk: a tolerance of which the data say little ought not to have moved at all. What chi²
should be the same algebra would say, were the model-error floor an error that a model makes. It is a bound; so chi² is compared
with that of data in which nothing is wrong, and nowhere taken for what it would be if noise were all.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray
from validation.diagnosing.bench import Hypothesis
from validation.diagnosing.leftover.whitened import Whitened, whitened
from validation.engine.evaluation import Fit
from validation.engine.parameter import TOLERANCES

FEWEST = 12.0
"""Free real numbers below which a channel of a run, or a stretch of it, gets no figure of its own."""

STRETCHES = 5
"""Stretches of equally many lines in which a channel of a run is looked at."""

SCALES = ("loss",)
"""Families that are relative changes of what scatters by its logarithm: a loss factor may be three times as large, never none."""

TOLD = 0.1
"""Share of its prior variance that the data must have taken off a tolerance for its z to be compared with what is due."""


@dataclass(frozen=True, kw_only=True)
class Cell:
    """One channel in one run.

    Attributes
    ----------
    data_set, run, channel : which
    band : (low, high) [Hz] of the lines
    misfit : chi² per free real number
    """

    data_set: str
    run: str
    channel: str
    band: tuple[float, float]
    misfit: float


@dataclass(frozen=True, eq=False, kw_only=True)
class Price:
    """What tolerances cost.

    Attributes
    ----------
    z2 : sum of z²
    due, sd : of it where nothing is wrong, and its standard deviation
    """

    z2: float
    due: float
    sd: float

    @property
    def excess(self) -> float:
        """What was paid beyond what is due, in standard deviations."""
        return (self.z2 - self.due) / self.sd if self.sd > 0 else 0.0


@dataclass(frozen=True, eq=False, kw_only=True)
class Misfit:
    """How badly a hypothesis misses.

    Attributes
    ----------
    per_degree : chi² of the data per degree of freedom
    by_data_set, by_run, by_channel : the same by name; runs as ``data set/run``, channels over all data sets
    worst : channel and run with the greatest misfit
    worst_stretch : the same of a part of the band
    price : of all tolerances
    by_family : of those of one family, such as "accelerometer-gain"
    largest : name and z of the tolerance that moved most
    least_due : name, z and z over the root of what is due, of the tolerance that moved farthest beyond that
    """

    per_degree: float
    by_data_set: Mapping[str, float]
    by_run: Mapping[str, float]
    by_channel: Mapping[str, float]
    worst: Cell
    worst_stretch: Cell
    price: Price
    by_family: Mapping[str, Price]
    largest: tuple[str, float]
    least_due: tuple[str, float, float]

    @property
    def scores(self) -> dict[str, float]:
        """One number each, to be held against those of nulls: the greater, the worse."""
        return {
            "misfit": self.per_degree,
            "data_set": max(self.by_data_set.values(), default=0.0),
            "run": max(self.by_run.values(), default=0.0),
            "channel": max(self.by_channel.values(), default=0.0),
            "cell": self.worst.misfit,
            "stretch": self.worst_stretch.misfit,
            "price": self.price.excess,
            "family": max((one.excess for one in self.by_family.values()), default=0.0),
            "largest": abs(self.largest[1]),
            "least_due": abs(self.least_due[2]),
        }


def misfit(hypothesis: Hypothesis) -> Misfit:
    """Of `hypothesis` at its lines."""
    return of_data(hypothesis.fit, list(whitened(hypothesis)))


def of_data(fit: Fit, data: Sequence[Whitened]) -> Misfit:
    """Of a fit whose residuals are known."""
    cells = [cell for one in data for cell in _cells(one, 1)]
    stretches = [cell for one in data for cell in _cells(one, STRETCHES)]
    z, S, names = _moved(fit)
    return Misfit(
        per_degree=fit.chi2 / fit.degrees_of_freedom,
        by_data_set=_shares([(one.name, one.values, one.free) for one in data]),
        by_run=_shares([piece for one in data for piece in _runs(one)]),
        by_channel=_shares([piece for one in data for piece in _channels(one)]),
        worst=_worst(cells),
        worst_stretch=_worst(stretches),
        price=_price(z, S),
        by_family=_families(z, S, names),
        largest=_largest(z, names),
        least_due=_least_due(z, S, names),
    )


Piece = tuple[str, ComplexArray, Array]
"""Name, whitened residuals and free real numbers, of one shape."""


def _runs(of: Whitened) -> Iterator[Piece]:
    for run, values, free in zip(of.prediction.measured.runs, of.values, of.free, strict=True):
        yield f"{of.name}/{run}", values, free


def _channels(of: Whitened) -> Iterator[Piece]:
    for k, channel in enumerate(of.prediction.measured.channels):
        yield channel, of.values[..., k], of.free[..., k]


def _shares(pieces: Sequence[Piece]) -> dict[str, float]:
    chi2: dict[str, float] = {}
    free: dict[str, float] = {}
    for name, values, own in pieces:
        chi2[name] = chi2.get(name, 0.0) + float(np.sum(np.abs(values) ** 2))
        free[name] = free.get(name, 0.0) + float(np.sum(own))
    return {name: chi2[name] / free[name] for name in chi2 if free[name] >= FEWEST}


def _cells(of: Whitened, stretches: int) -> Iterator[Cell]:
    measured, free = of.prediction.measured, of.free
    for lines in np.array_split(np.arange(len(of.frequency)), stretches):
        if not len(lines):
            continue
        band = (float(of.frequency[lines[0]]), float(of.frequency[lines[-1]]))
        chi2, own = np.sum(np.abs(of.values[:, lines]) ** 2, axis=1), np.sum(free[:, lines], axis=1)
        for r, c in np.argwhere(own >= FEWEST):
            share = float(chi2[r, c] / own[r, c])
            yield Cell(data_set=of.name, run=measured.runs[r], channel=measured.channels[c], band=band, misfit=share)


def _worst(cells: Sequence[Cell]) -> Cell:
    nothing = Cell(data_set="", run="", channel="", band=(0.0, 0.0), misfit=0.0)
    return max(cells, key=lambda cell: cell.misfit, default=nothing)


def _moved(fit: Fit) -> tuple[Array, Array, list[str]]:
    """z (q,) of the tolerances, S (q, q) by which they scatter where nothing is wrong, and their names."""
    at = [k for k, one in enumerate(fit.parameters) if one.kind in TOLERANCES and np.isfinite(one.tolerance)]
    sd = np.array([fit.parameters[k].tolerance for k in at])
    names = [fit.parameters[k].name for k in at]
    S = np.eye(len(at)) - fit.covariance[np.ix_(at, at)] / np.outer(sd, sd)
    return _by_logarithm(fit.offsets[at], names) / sd, S, names


def _by_logarithm(offsets: Array, names: Sequence[str]) -> Array:
    scale = np.array([name.partition(":")[0] in SCALES for name in names], dtype=bool) & (offsets > 0)
    return np.where(scale, np.log1p(np.maximum(offsets, 0.0)), offsets)


def _price(z: Array, S: Array) -> Price:
    return Price(z2=float(z @ z), due=float(np.trace(S)), sd=float(np.sqrt(2 * np.sum(S * S.T))))


def _families(z: Array, S: Array, names: Sequence[str]) -> dict[str, Price]:
    families = [name.partition(":")[0] for name in names]
    of = {family: np.array([one == family for one in families]) for family in families}
    return {family: _price(z[at], S[np.ix_(at, at)]) for family, at in of.items()}


def _largest(z: Array, names: Sequence[str]) -> tuple[str, float]:
    k = int(np.argmax(np.abs(z))) if len(z) else -1
    return (names[k], float(z[k])) if len(z) else ("", 0.0)


def _least_due(z: Array, S: Array, names: Sequence[str]) -> tuple[str, float, float]:
    due = np.diag(S)
    beyond = np.where(due >= TOLD, z / np.sqrt(np.maximum(due, TOLD)), 0.0)
    k = int(np.argmax(np.abs(beyond))) if len(z) else -1
    return (names[k], float(z[k]), float(beyond[k])) if len(z) else ("", 0.0, 0.0)
