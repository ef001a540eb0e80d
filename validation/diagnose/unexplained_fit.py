"""`Misfit`: how badly a fitted candidate misses, in all, where it does worst, and what its tolerances paid for it.

Tolerances can swallow a fault with no trace in chi², at an absurd price. What they should cost is known: of a linear model with
prior variances T and posterior covariance C the offsets of a fit scatter, over all laboratories and their noise, by T - C. Hence

    E sum z² = tr S,    var sum z² = 2 tr S²,    S = 1 - T^-1/2 C T^-1/2 ,

and each z by itself by the root of its S_kk: a tolerance of which the data say little ought not to have moved at all. What chi²
should be the same algebra would say, were the model-error floor an error that a model makes. It is a bound; so chi² is compared
with that of data in which nothing is wrong, and nowhere taken for what it would be if noise were all.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geometry.dynamic_mass import ComplexArray
from geometry.frames import Array
from identification.self_calibration.solve import eliminated
from validation.diagnose.diagnosis import Candidate
from validation.estimation import likelihood
from validation.estimation.fit import FLOOR
from validation.estimation.likelihood import ObservedLines, cost_of, observed, root
from validation.estimation.problem import TOLERANCES, Fit, Lines, Predicted, Prediction, Wanted
from validation.estimation.screening import Products

# Whitened residuals of a fitted candidate, data set by data set, with the share of every channel that inputs leave free.


@dataclass(frozen=True, eq=False, kw_only=True)
class Whitened:
    """One data set at the lines of a fit.

    Attributes
    ----------
    prediction : of it
    lines : (m,) their indices
    frequency : (m,) [Hz]
    seen, predicted : at the fit
    weight : (r, m, c) one over the standard deviation of each of real and imaginary part
    values : (r, m, c) residuals times weight, latent inputs eliminated
    basis : (r, m, c, k) orthonormal columns of what inputs explain; None where inputs are known
    inputs : (r, m, k) known or estimated
    """

    prediction: Prediction
    lines: Lines
    frequency: Array
    seen: ObservedLines
    predicted: Predicted
    weight: Array
    values: ComplexArray
    basis: ComplexArray | None
    inputs: ComplexArray

    @property
    def name(self) -> str:
        """Of the data set."""
        return self.prediction.measured.name

    @property
    def free(self) -> Array:
        """(r, m, c) real numbers that inputs leave of each channel, 0 to 2: |values|² where nothing is wrong."""
        if self.basis is None:
            return np.full(self.values.shape, 2.0)
        return np.asarray(2 * (1 - np.sum(np.abs(self.basis) ** 2, axis=-1)))

    def kept(self, white: ComplexArray, channels: npt.NDArray[np.int64]) -> ComplexArray:
        """(r, m, c, q) what inputs do not explain of whitened changes (r, m, c', q) of the `channels` (c',)."""
        whole = np.zeros((*self.values.shape, white.shape[-1]), dtype=np.complex128)
        whole[:, :, channels] = white
        if self.basis is not None:
            whole -= self.basis @ (self.basis[:, :, channels].conj().swapaxes(-1, -2) @ white)
        return whole


def whitened(of: Candidate, *, derivatives: Wanted = False) -> Iterator[Whitened]:
    """Every data set of `of` at the lines of its fit."""
    offsets = {**of.problem.start, **of.fit.by_name}
    for one in of.problem.predictions:
        lines = of.problem.lines_of(one)
        seen, predicted = observed(one.measured, lines), one.at(offsets, lines, derivatives=derivatives)
        yield _whitened(one, lines, seen, predicted)


def _whitened(one: Prediction, lines: Lines, seen: ObservedLines, predicted: Predicted) -> Whitened:
    w = seen.weight(FLOOR, predicted.noise)
    A = np.broadcast_to(predicted.rows, (len(seen.runs), *predicted.rows.shape[-3:]))
    basis: ComplexArray | None = None
    if seen.inputs is not None:
        u = seen.inputs
        values = np.asarray(w * (seen.values - (A @ u[..., None])[..., 0]))
    else:
        values, basis, u = (np.stack(each) for each in zip(*map(eliminated, A, seen.values, w), strict=True))
    return Whitened(
        prediction=one,
        lines=lines,
        frequency=one.measured.frequency[lines],
        seen=seen,
        predicted=predicted,
        weight=w,
        values=values,
        basis=basis,
        inputs=np.asarray(u),
    )


FEWEST = 12.0
"""[count] of free real numbers below which a channel of a run, or a stretch of it, gets no figure of its own. Exercised by
tests/validation/diagnosing/unexplained/test_misfit.py."""

STRETCHES = 5
"""[count] of stretches of equally many lines in which a channel of a run is looked at. Exercised by
tests/validation/diagnosing/unexplained/test_misfit.py."""

SCALES = ("loss",)
"""Families that are relative changes of what scatters by its logarithm: a loss factor may be three times as large, never none."""

TOLD = 0.1
"""[share] of its prior variance that the data must have taken off a tolerance for its z to be compared with what is due.
Exercised by tests/validation/diagnosing/unexplained/test_misfit.py."""


@dataclass(frozen=True, kw_only=True)
class ChannelMisfit:
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
    """How badly a candidate misses.

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
    worst: ChannelMisfit
    worst_stretch: ChannelMisfit
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


def misfit(candidate: Candidate) -> Misfit:
    """Of `candidate` at its lines."""
    return of_data(candidate.fit, list(whitened(candidate)))


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


def _cells(of: Whitened, stretches: int) -> Iterator[ChannelMisfit]:
    measured, free = of.prediction.measured, of.free
    for lines in np.array_split(np.arange(len(of.frequency)), stretches):
        if not len(lines):
            continue
        band = (float(of.frequency[lines[0]]), float(of.frequency[lines[-1]]))
        chi2, own = np.sum(np.abs(of.values[:, lines]) ** 2, axis=1), np.sum(free[:, lines], axis=1)
        for r, c in np.argwhere(own >= FEWEST):
            share = float(chi2[r, c] / own[r, c])
            yield ChannelMisfit(data_set=of.name, run=measured.runs[r], channel=measured.channels[c], band=band, misfit=share)


def _worst(cells: Sequence[ChannelMisfit]) -> ChannelMisfit:
    nothing = ChannelMisfit(data_set="", run="", channel="", band=(0.0, 0.0), misfit=0.0)
    return max(cells, key=lambda cell: cell.misfit, default=nothing)


def _moved(fit: Fit) -> tuple[Array, Array, list[str]]:
    """z (q,) of the tolerances, S (q, q) by which they scatter where nothing is wrong, and their names."""
    at = [k for k, one in enumerate(fit.parameters) if one.kind in TOLERANCES and np.isfinite(one.tolerance)]
    sd = np.array([fit.parameters[k].tolerance for k in at])
    names = [fit.parameters[k].name for k in at]
    S = np.eye(len(at)) - fit.covariance[np.ix_(at, at)] / np.outer(sd, sd)
    offsets = fit.offsets[at]
    scale = np.array([name.partition(":")[0] in SCALES for name in names], dtype=bool) & (offsets > 0)
    return np.where(scale, np.log1p(np.maximum(offsets, 0.0)), offsets) / sd, S, names


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


# How an unexplained residual may go with frequency: the few ways in which physics does.
#
# Of a pair of axes the course is that of its entry of the dynamic mass, dH = a c(omega); of a channel that of the share of its
# reading, dy = a c(omega) y. Coefficients a are real: a spring is no damper.


STIFFNESS, MASS, DAMPING, RESONANCE, DELAY, GAIN, TILT, NOISE, IRREGULAR = LIKENESSES = (
    *("stiffness", "mass", "damping", "resonance", "delay", "gain", "tilt", "noise", "irregular"),
)
"""What an unexplained residual can look like."""

REFERENCE = 10.0
"""[Hz] at which shares are stated that change with frequency. Exercised by
tests/validation/diagnosing/unexplained/test_described.py."""

FREQUENCIES = 36
"""[count] of frequencies of resonances over the band. Exercised by tests/validation/diagnosing/unexplained/test_described.py."""

RATIOS = (0.004, 0.015, 0.05)
"""[1] Damping ratios of these resonances. Exercised by tests/validation/diagnosing/unexplained/test_described.py."""


@dataclass(frozen=True, eq=False, kw_only=True)
class FrequencyLaw:
    """One way to go.

    Attributes
    ----------
    looks_like : of `LIKENESSES`
    text : in words, to follow "it" or "a share that"
    of : values (m,) complex at omega (m,) [rad/s]
    unit : of the coefficient of a translation with a translation, or of a channel
    frequency, ratio : of a resonance
    stated : whether the coefficient means something by itself
    """

    looks_like: str
    text: str
    of: Callable[[Array], ComplexArray]
    unit: str = "1"
    frequency: float | None = None
    ratio: float | None = None
    stated: bool = True


def _power(factor: complex, power: float, per: float = 1.0) -> Callable[[Array], ComplexArray]:
    return lambda omega: factor * np.asarray(omega / per, dtype=np.complex128) ** power


AT = 2 * np.pi * REFERENCE

OF_PAIRS = (
    FrequencyLaw(looks_like=MASS, text="is constant over frequency", of=_power(1, 0), unit="kg"),
    FrequencyLaw(
        looks_like=STIFFNESS, text="falls with the square of frequency, as that of a spring", of=_power(-1, -2), unit="N/m"
    ),
    FrequencyLaw(
        looks_like=DAMPING, text="falls with frequency and is out of phase, as of a damper", of=_power(-1j, -1), unit="N s/m"
    ),
    FrequencyLaw(
        looks_like=STIFFNESS,
        text="grows with the square of frequency, as of something that gives",
        of=_power(1, 2, AT),
        unit="kg",
        stated=False,
    ),
    FrequencyLaw(
        looks_like=DAMPING,
        text="is constant over frequency and out of phase, as of a loss",
        of=_power(-1j, 0),
        unit="kg",
        stated=False,
    ),
    FrequencyLaw(
        looks_like=DELAY,
        text="grows with frequency and is out of phase, as of a delay",
        of=_power(-1j, 1, AT),
        unit="kg",
        stated=False,
    ),
)
"""Of an entry of the dynamic mass."""

OF_SHARES = (
    FrequencyLaw(looks_like=GAIN, text="a gain", of=_power(1, 0)),
    FrequencyLaw(looks_like=DELAY, text="a delay", of=_power(-1j, 1), unit="s"),
    FrequencyLaw(looks_like=GAIN, text="a gain that grows with the square of frequency", of=_power(1, 2, AT)),
    FrequencyLaw(looks_like=GAIN, text="a gain that falls with the square of frequency", of=_power(1, -2, AT)),
    FrequencyLaw(looks_like=GAIN, text="a share that falls with frequency, as of a high-pass", of=_power(1j, -1, AT)),
    FrequencyLaw(looks_like=GAIN, text="a turned phase, the same at all frequencies", of=_power(1j, 0)),
    FrequencyLaw(looks_like=GAIN, text="a gain that drifts along the sweep", of=lambda w: np.log(w / AT).astype(np.complex128)),
    FrequencyLaw(looks_like=DELAY, text="a delay that grows along the sweep", of=lambda w: -1j * w * np.log(w / w[0]), unit="s"),
)
"""Of the share of a reading."""

OF_PARTS = (
    FrequencyLaw(looks_like="", text="as much as it may differ at all frequencies", of=_power(1, 0)),
    FrequencyLaw(looks_like="", text="the more the higher the frequency", of=_power(1, 1, AT)),
    FrequencyLaw(looks_like="", text="the more the lower the frequency", of=_power(1, -1, AT)),
    FrequencyLaw(looks_like=DAMPING, text="out of phase, as of a loss", of=_power(1j, 0)),
    FrequencyLaw(looks_like=DAMPING, text="out of phase and growing with frequency, as of a damper", of=_power(1j, 1, AT)),
)
"""Of a part whose stiffness or loss is not what the model says; what it looks like is said by the part."""

OF_PLACES = (
    FrequencyLaw(looks_like=MASS, text="a mass", of=_power(1, 0), unit="kg"),
    FrequencyLaw(looks_like=STIFFNESS, text="a spring", of=_power(-1, -2), unit="N/m"),
    FrequencyLaw(looks_like=DAMPING, text="a damper", of=_power(-1j, -1), unit="N s/m"),
)
"""Of what a place of the article is loaded with."""

OF_JOINTS = (
    FrequencyLaw(looks_like=STIFFNESS, text="a compliance", of=_power(1, 2), unit="m/N"),
    FrequencyLaw(looks_like=DAMPING, text="a compliance that is out of phase, as of a loss", of=_power(-1j, 2), unit="m/N"),
)
"""Of what lies between cover plate and article."""

TILTING = FrequencyLaw(looks_like=TILT, text="gravity that a tilt adds", of=_power(1, -2), unit="m/s^2")
"""Of accelerometers that tilt with what they sit on: they read it once too often, or not at all."""

HEARD_PLAINLY = FrequencyLaw(looks_like=GAIN, text="the same share at all frequencies", of=_power(1, 0))
HEARD_FALLING = FrequencyLaw(
    looks_like=TILT, text="falls with the square of frequency, as gravity on a tilting sensor", of=_power(1, -2)
)


def resonances(omega: Array) -> tuple[FrequencyLaw, ...]:
    """Resonances within the band of `omega` (m,), ``omega² / (omega_0² - omega² + 2 i zeta omega_0 omega)``."""
    low, high = omega[0] / (2 * np.pi), omega[-1] / (2 * np.pi)
    return tuple(resonance(float(f), zeta) for f in np.geomspace(low, high, FREQUENCIES) for zeta in RATIOS)


def resonance(frequency: float, ratio: float) -> FrequencyLaw:
    """The one at `frequency` [Hz] with damping `ratio`."""
    own = 2 * np.pi * frequency
    return FrequencyLaw(
        looks_like=RESONANCE,
        text=f"a resonance at {frequency:.3g} Hz",
        of=lambda w: np.asarray(w**2 / (own**2 - w**2 + 2j * ratio * own * w), dtype=np.complex128),
        unit="kg",
        frequency=frequency,
        ratio=ratio,
    )


# What columns would explain of an unexplained residual, many at once: places times courses over frequency.
#
# At the end of a fit the residual r, whitened and with latent inputs eliminated, is what tolerances and inputs have left over.
# To first order the readings deviate from those of the model as drawn by r + J x, x the offsets of the fit, with covariance 1 +
# J T J^T where nothing is wrong, T the prior variances. Since r = (1 + J T J^T)^-1 (r + J x) at the minimum, a column e that
# anything else would add is told from r alone, as in `validation.estimation.screening`:
#
#     a = e^T r / (e^T e - e^T J C J^T e),      gain = a e^T r / 2  [nats],      C = (J^T J + T^-1)^-1 .
#
# What tolerances swallowed is counted with what they left; no tolerance needs to be undone. Where the fit stopped short of its
# minimum, what its next step would still take, with the gradient g of its whole cost, is counted too: e^T r + e^T J C g.


LEAST = 1e-4
"""[share] of a column that parameters of the fit must leave; what is left of less is no straight line. Exercised by
tests/validation/diagnosing/unexplained/test_described.py."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Swallowing:
    """One data set, and the parameters of the fit.

    Attributes
    ----------
    of : the data set
    names : (a,) of those parameters that act here
    moved : (m, r, c, a) what they do to the whitened readings, inputs eliminated
    root : (a, p) their rows of the root of the covariance of all p, C = root root^T
    slope : (p,) root^T g, of all data sets together
    """

    of: Whitened
    names: tuple[str, ...]
    moved: ComplexArray
    root: Array
    slope: Array

    @property
    def left(self) -> ComplexArray:
        """(m, r, c) whitened residuals."""
        return self.of.values.swapaxes(0, 1)


@dataclass(frozen=True, eq=False, kw_only=True)
class Answers:
    """How a data set answers to columns e.

    Attributes
    ----------
    score : (..., q) e^T r
    own : (..., q) e^T e
    swallowed : (..., q, p) root^T J^T e
    """

    score: Array
    own: Array
    swallowed: Array


@dataclass(frozen=True, eq=False, kw_only=True)
class Gains:
    """What columns would explain.

    Attributes
    ----------
    gain : (..., q) [nats]
    size : (..., q) the coefficients
    """

    gain: Array
    size: Array


def swallowing(data: Sequence[Whitened], candidate: Candidate) -> list[Swallowing]:
    """Of all data sets of `candidate`, with the parameters of its fit that could move."""
    fit = candidate.fit
    at = np.flatnonzero(np.diag(fit.covariance) > 0)
    R, free = root(fit.covariance[np.ix_(at, at)]), tuple(fit.parameters[k] for k in at)
    cost = cost_of(candidate.problem, free, FLOOR, fit.by_name)
    away, rows = cost.knowledge(cost.at(fit.by_name))
    acting = [[k for k, one in enumerate(free) if one.name in each.predicted.changes] for each in data]
    names = [tuple(free[k].name for k in some) for some in acting]
    moved = [_change_by(one, some) for one, some in zip(data, names, strict=True)]
    gradient = rows.T @ away
    for some, V, one in zip(acting, moved, data, strict=True):
        # (p,) J^T r
        flat = V.reshape(-1, V.shape[-1])
        onto = np.asarray((flat.conj().T @ one.values.swapaxes(0, 1).ravel()).real)
        gradient[some] -= onto
    slope = R.T @ gradient
    found = zip(data, names, moved, acting, strict=True)
    return [Swallowing(of=one, names=mine, moved=V, root=R[some], slope=slope) for one, mine, V, some in found]


def _change_by(of: Whitened, names: Sequence[str]) -> ComplexArray:
    r, m, c = of.values.shape
    found = np.empty((m, r, c, len(names)), dtype=np.complex128)
    for run in range(r):
        found[:, run] = likelihood.whitened(of.seen, of.predicted, names, FLOOR, run)[1]
    return found


def products(of: Swallowing, readings: ComplexArray, channels: npt.NDArray[np.int64]) -> Products:
    """Of changes of the readings (r, m, c', q), SI, of the `channels` (c',) alone."""
    at, white = of.of, readings * of.of.weight[:, :, channels, None]
    m, q = white.shape[1], white.shape[3]
    e = white.transpose(1, 3, 0, 2).conj().reshape(m, q, -1)  # inputs are eliminated from the other side of every product
    return Products(
        frequency=at.frequency,
        names=tuple(map(str, range(q))),
        residual=(e @ of.left[:, :, channels].reshape(m, -1, 1))[..., 0],
        others=np.asarray(e @ of.moved[:, :, channels].reshape(m, e.shape[2], -1)),
        square=np.sum(np.abs(at.kept(white, channels)) ** 2, axis=(0, 2)),
    )


def following(of: Products, courses: ComplexArray, root: Array) -> Answers:
    """Of the columns times each of `courses` (k, m); with k in front of every shape."""
    m, q, p = of.others.shape
    turned = courses.conj()
    parts = np.concatenate([turned.real, -turned.imag], axis=1)  # the real part of a product, as one real product
    others = parts @ np.concatenate([of.others.real, of.others.imag]).reshape(2 * m, q * p)
    return Answers(
        score=(turned @ of.residual).real,
        own=np.abs(courses) ** 2 @ of.square,
        swallowed=others.reshape(len(courses), q, p) @ root,
    )


def gains(answers: Sequence[Answers], slope: Array) -> Gains:
    """Of the same columns with one coefficient in several data sets; `slope` as `Swallowing` has it."""
    swallowed = sum(one.swallowed for one in answers)
    score, own = sum(one.score for one in answers) + swallowed @ slope, sum(one.own for one in answers)
    told = own - np.sum(np.square(swallowed), axis=-1)
    sure = told > LEAST * own
    size = np.where(sure, score / np.where(sure, told, 1.0), 0.0)
    return Gains(gain=0.5 * size * score, size=size)
