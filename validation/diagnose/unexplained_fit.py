"""What would explain a residual: whitened residuals of a fitted candidate, the few ways in which physics goes with frequency, and
what columns of places times courses would gain."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from geometry.dynamic_mass import ComplexArray
from geometry.frames import Array
from identification.self_calibration.solve import eliminated
from validation.diagnose.diagnosis import Candidate
from validation.estimation import likelihood
from validation.estimation.fit import FLOOR
from validation.estimation.likelihood import ObservedLines, cost_of, observed, root
from validation.estimation.problem import Lines, Predicted, Prediction
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

    @classmethod
    def of(cls, candidate: Candidate, one: Prediction) -> "Whitened":
        """The data set of `one` at the lines of the fit of `candidate`."""
        lines = candidate.problem.lines_of(one)
        offsets = {**candidate.problem.start, **candidate.fit.by_name}
        seen, predicted = observed(one.measured, lines), one.at(offsets, lines, derivatives=True)
        w = seen.weight(FLOOR, predicted.noise)
        A = np.broadcast_to(predicted.rows, (len(seen.runs), *predicted.rows.shape[-3:]))
        basis: ComplexArray | None = None
        if seen.inputs is not None:
            u = seen.inputs
            values = np.asarray(w * (seen.values - (A @ u[..., None])[..., 0]))
        else:
            values, basis, u = (np.stack(each) for each in zip(*map(eliminated, A, seen.values, w), strict=True))
        return cls(
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

    @property
    def name(self) -> str:
        """Of the data set."""
        return self.prediction.measured.name

    @cached_property
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


# How an unexplained residual may go with frequency: the few ways in which physics does.
#
# Of a pair of axes the course is that of its entry of the dynamic mass, dH = a c(omega); of a channel that of the share of its
# reading, dy = a c(omega) y. Coefficients a are real: a spring is no damper.


STIFFNESS, MASS, DAMPING, RESONANCE, DELAY, GAIN, TILT, NOISE, IRREGULAR = LIKENESSES = (
    *("stiffness", "mass", "damping", "resonance", "delay", "gain", "tilt", "noise", "irregular"),
)
"""What an unexplained residual can look like."""

REFERENCE = 10.0
"""[Hz] at which shares are stated that change with frequency. Held by test_unexplained.py."""

FREQUENCIES = 36
"""[count] of frequencies of resonances over the band. Held by test_unexplained.py."""

RATIOS = (0.004, 0.015, 0.05)
"""[1] Damping ratios of these resonances. Exercised by test_unexplained.py."""


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
    *(
        FrequencyLaw(looks_like=like, text=text, of=of, unit="kg", stated=False)
        for like, text, of in (
            (STIFFNESS, "grows with the square of frequency, as of something that gives", _power(1, 2, AT)),
            (DAMPING, "is constant over frequency and out of phase, as of a loss", _power(-1j, 0)),
            (DELAY, "grows with frequency and is out of phase, as of a delay", _power(-1j, 1, AT)),
        )
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

CROSSTALK_CONSTANT = FrequencyLaw(looks_like=GAIN, text="the same share at all frequencies", of=_power(1, 0))
CROSSTALK_FALLING = FrequencyLaw(
    looks_like=TILT, text="falls with the square of frequency, as gravity on a tilting sensor", of=_power(1, -2)
)


def resonance(frequency: float, ratio: float) -> FrequencyLaw:
    """At `frequency` [Hz] with damping `ratio`: ``omega² / (omega_0² - omega² + 2 i zeta omega_0 omega)``."""
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
"""[share] of a column that parameters of the fit must leave; less is no straight line. Held by test_unexplained.py."""


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
    _kept: dict[bytes, tuple[ComplexArray, ComplexArray]] = field(default_factory=dict, init=False, repr=False)

    def beyond(self, rows: ComplexArray) -> ComplexArray:
        """(r, m, c) by how much less is left, whitened, with the readings `rows` (n, c, k) in place of those of the fit."""
        return self.of.values - likelihood.residual(self.of.seen, replace(self.of.predicted, rows=rows), FLOOR)

    def answers(self, beyond: ComplexArray) -> "Answers":
        """How it answers to some columns (q, r, m, c) as they are, without the first order."""
        left, flat = (np.ascontiguousarray(one.swapaxes(-2, -3)).view(np.float64) for one in (self.of.values, beyond))
        flat = flat.reshape(len(beyond), -1)
        return Answers(score=flat @ left.ravel(), own=np.sum(flat**2, axis=1), swallowed=flat @ self._real @ self.root)

    @cached_property
    def _real(self) -> Array:
        """(2 m r c, a) real and imaginary part of `moved`, one below the other."""
        return np.stack([self.moved.real, self.moved.imag], axis=-2).reshape(-1, self.moved.shape[-1])

    def on(self, channels: npt.NDArray[np.int64]) -> tuple[ComplexArray, ComplexArray]:
        """(m, r c', 1) whitened residuals and (m, r c', a) what the parameters do, of `channels` (c',); kept, since many ask."""
        which = channels.tobytes()
        if which not in self._kept:
            m, r, c, a = self.moved.shape
            every = np.array_equal(channels, np.arange(c))
            left, moved = self.of.values.swapaxes(0, 1), self.moved
            left, moved = (left, moved) if every else (left[:, :, channels], moved[:, :, channels])
            self._kept[which] = left.reshape(m, -1, 1), moved.reshape(m, r * len(channels), a)
        return self._kept[which]


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


def swallowing(candidate: Candidate) -> list[Swallowing]:
    """Of all data sets of `candidate`, with the parameters of its fit that could move."""
    fit, data = candidate.fit, [Whitened.of(candidate, one) for one in candidate.problem.predictions]
    at = np.flatnonzero(np.diag(fit.covariance) > 0)
    R, free = root(fit.covariance[np.ix_(at, at)]), tuple(fit.parameters[k] for k in at)
    cost = cost_of(candidate.problem, free, FLOOR, fit.by_name)
    away, rows = cost.knowledge(cost.at(fit.by_name))
    gradient = rows.T @ away
    found = []
    for one in data:
        some = [k for k, parameter in enumerate(free) if parameter.name in one.predicted.changes]
        names = tuple(free[k].name for k in some)
        r, m, c = one.values.shape
        moved = np.empty((m, r, c, len(names)), dtype=np.complex128)
        for run in range(r):
            moved[:, run] = likelihood.whitened(one.seen, one.predicted, names, FLOOR, run)[1]
        # (p,) J^T r
        flat = moved.reshape(-1, moved.shape[-1])
        gradient[some] -= np.asarray((flat.conj().T @ one.values.swapaxes(0, 1).ravel()).real)
        found.append((one, names, moved, R[some]))
    slope = R.T @ gradient
    return [Swallowing(of=one, names=names, moved=moved, root=own, slope=slope) for one, names, moved, own in found]


def products(of: Swallowing, readings: ComplexArray, channels: npt.NDArray[np.int64]) -> Products:
    """Of changes of the readings (r, m, c', q), SI, of the `channels` (c',) alone."""
    at, white = of.of, readings * of.of.weight[:, :, channels, None]
    m, q = white.shape[1], white.shape[3]
    e = white.transpose(1, 3, 0, 2).conj().reshape(m, q, -1)  # inputs are eliminated from the other side of every product
    left, moved = of.on(channels)
    return Products(
        frequency=at.frequency,
        names=tuple(map(str, range(q))),
        residual=(e @ left)[..., 0],
        others=np.asarray(e @ moved),
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


def gain(answers: Sequence[Answers], slope: Array) -> Array:
    """(q,) [nats] of columns as they are, each in several data sets."""
    swallowed = slope + sum(one.swallowed for one in answers)
    squares = np.sum(swallowed**2 - slope**2, axis=-1)
    return np.asarray(sum(one.score - 0.5 * one.own for one in answers) + 0.5 * squares)


def gains(answers: Sequence[Answers], slope: Array) -> Gains:
    """Of the same columns with one coefficient in several data sets; `slope` as `Swallowing` has it."""
    swallowed = sum(one.swallowed for one in answers)
    score, own = sum(one.score for one in answers) + swallowed @ slope, sum(one.own for one in answers)
    told = own - np.sum(np.square(swallowed), axis=-1)
    sure = told > LEAST * own
    size = np.where(sure, score / np.where(sure, told, 1.0), 0.0)
    return Gains(gain=0.5 * size * score, size=size)
