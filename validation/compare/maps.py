"""Where a model fails: every channel and every load over frequency and runs, every pair of axes over frequency, every run.

All of it is told at the plain fit - tolerances of the measurement not fitted - in standard deviations of what noise, model-error
floor and those tolerances let expect, and in per cent of the level there.
"""

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Self

import numpy as np
import numpy.typing as npt

from geometry.dynamic_mass import LEVELS, MOTIONS, ComplexArray
from geometry.errors import BadInput
from geometry.frames import Array, Integers
from geometry.inertia import LOADS, of_motions, of_resultants
from geometry.sensors import ChannelTable, resultants
from identification.base_motion import base_motion
from identification.base_motion import resultants as identification_resultants
from identification.dynamic_mass import Estimate, from_runs
from identification.elastic.fit import levels
from identification.response_functions import QUANTITIES
from identification.self_calibration.solve import eliminated, inverse, smoothed_level
from identification.spectra.line_spectra import Spectra
from validation.estimation import evaluate
from validation.estimation.fit import FLOOR, PLAIN_FLOOR, at_bounds
from validation.estimation.likelihood import cost_of, left_of_run, level_of, observed, root
from validation.estimation.problem import (
    STRUCTURAL,
    Change,
    Conveyed,
    Fit,
    Lines,
    Measured,
    Offsets,
    Predicted,
    Prediction,
    Problem,
)
from validation.prediction.response_functions import ResponseFunctionTest

# What is not known at a plain fit: every tolerance of the measurement, and how the fit answered to it.
#
# A gain that is off by its tolerance moves the inertia of the FMD that a plain fit identifies, and so what that fit leaves
# over. To first order the fit answers to an offset s of a tolerance by
#
#     d theta = -N_ff^-1 N_fs ds
#
# with N the second derivatives of its cost, so that one standard deviation of every tolerance moves a whole vector of offsets.
# What the fitted parameters keep of their own uncertainty is a further doubt, its square root a vector for each of them.


@dataclass(frozen=True, eq=False, kw_only=True)
class Doubt:
    """Independent unknowns, each with a standard deviation of 1, and the offsets that they move.

    Attributes
    ----------
    tolerances : (q,) by name, standard deviation of each tolerance that was not fitted
    fitted : (p,) names of the parameters that were and could move
    answer : (p, q) what one standard deviation of every tolerance does to them
    own : (p, p) what is left unknown of them when all tolerances are known
    of_modes : names of those tolerances that are not of the measurement but of modes, of whatever configuration
    """

    tolerances: dict[str, float]
    fitted: tuple[str, ...] = ()
    answer: Array
    own: Array
    of_modes: frozenset[str] = frozenset()


def doubt(problem: Problem, plain: Fit) -> Doubt:
    """At the plain fit of `problem`, on its lines."""
    fitted = {one.name for one in plain.parameters}
    others = [one for one in problem.parameters if one.name not in fitted and 0 < one.tolerance < np.inf]
    loose = {one.name: one.tolerance for one in others}
    free = at_bounds(cost_of(problem, plain.parameters, PLAIN_FLOOR, plain=True), plain.by_name).free
    held = {name: x for name, x in plain.by_name.items() if name not in {one.name for one in free}}
    cost = cost_of(problem, (*free, *others), PLAIN_FLOOR, held, plain=True)
    N = cost.total(cost.at(plain.by_name))[0].matrix
    p = len(free)
    own = inverse(N[:p, :p]) if p else np.zeros((0, 0))
    return Doubt(
        tolerances=loose,
        fitted=tuple(one.name for one in free),
        answer=-own @ N[:p, p:] * np.array(list(loose.values())),
        own=root(own) if p else own,
        of_modes=frozenset(one.name for one in problem.parameters if one.kind == STRUCTURAL),
    )


# A prediction with its tolerances, some lines at a time: what every channel reads, and by how much what was not fitted
# may move it.
#
# All tangents of a series on all lines are more than a laptop holds; a chunk of lines is soon done and forgotten. Nor are they
# ever made: the unknowns x of the tolerances and e of the fit move the readings by D x + F (A x + B e), so that their covariance
# is
#
#     D D^H + F (A A^T + B B^T) F^H + F A D^H + D A^T F^H .
#
# F has a column for each of the few parameters that were fitted, and most columns of D are of one channel alone.


TOGETHER = 192
"""Lines of a chunk."""


@dataclass(frozen=True, eq=False, kw_only=True)
class ReadingSpread:
    """What one standard deviation of everything that is not known does to the readings of some lines, SI.

    Attributes
    ----------
    by_fit : (r, n, p, c) F by column, d readings / d fitted parameter, of those that act here
    known : (p, p) A A^T + B B^T, of all tolerances but those of modes
    met : (r, n, p, c) D A^T by column, of the same
    alone, at : (r, n, s) what those tolerances do that move one channel, and (s,) that channel
    across : (r, n, w, c) what the others do
    by_modes : (r, n, m, c) D + F A by column, of what the model leaves open of modes; of those that do not act here R F, R^T R =
        A A^T
    """

    by_fit: ComplexArray
    known: Array
    met: ComplexArray
    alone: ComplexArray
    at: Integers
    across: ComplexArray
    by_modes: ComplexArray

    @classmethod
    def of(cls, unknown: Doubt, found: Predicted, inputs: ComplexArray) -> Self:
        """From derivatives of rows, and the `inputs` (r, n, k) that turn them into readings."""
        names = list(unknown.tolerances)
        here = np.array([name in found.changes for name in unknown.fitted], dtype=bool)
        fitted = [name for name in unknown.fitted if name in found.changes]
        modes = [name for name in names if name in unknown.of_modes and name in found.changes]
        elsewhere = [name for name in names if name in unknown.of_modes and name not in found.changes]
        others = [name for name in names if name not in unknown.of_modes]
        acting = [name for name in others if name in found.changes]
        single = [name for name in acting if len(found.changes[name].channels) == 1]
        wide = [name for name in acting if len(found.changes[name].channels) != 1]
        sizes = {**unknown.tolerances, **dict.fromkeys(unknown.fitted, 1.0)}

        def moved(some: Sequence[str]) -> ComplexArray:
            """(r, n, len(some), c) by their sizes."""
            readings = np.zeros((*inputs.shape[:2], len(some), found.rows.shape[-2]), dtype=np.complex128)
            for k, name in enumerate(some):
                if (change := found.changes.get(name)) is not None:
                    readings[:, :, k, list(change.channels)] = sizes[name] * _readings(change, inputs)
            return readings

        def answers(some: Sequence[str]) -> Array:
            """(p, len(some)) A."""
            return np.asarray(unknown.answer[here][:, [names.index(name) for name in some]])

        by_fit, across = moved(fitted), moved(wide)
        at = np.array([found.changes[name].channels[0] for name in single], dtype=np.int64)
        alone = np.zeros((*inputs.shape[:2], len(single)), dtype=np.complex128)
        for k, name in enumerate(single):
            alone[..., k] = sizes[name] * _readings(found.changes[name], inputs)[..., 0]
        met, A = _mixed(answers(wide), across), answers(single)
        for channel in np.unique(at):
            met[..., channel] += alone[..., at == channel] @ A[:, at == channel].T
        return cls(
            by_fit=by_fit,
            known=answers(others) @ answers(others).T + unknown.own[here] @ unknown.own[here].T,
            met=met,
            alone=alone,
            at=at,
            across=across,
            by_modes=np.concatenate(
                [
                    moved(modes) + _mixed(answers(modes).T, by_fit),
                    _mixed(np.asarray(np.linalg.qr(answers(elsewhere).T, mode="r")), by_fit),
                ],
                axis=2,
            ),
        )

    @cached_property
    def covariances(self) -> tuple[ComplexArray, ComplexArray]:
        """(r, n, c, c) of the readings by everything but modes, and by these."""
        half = _products(_mixed(self.known / 2, self.by_fit) + self.met, self.by_fit)
        S = half + half.conj().swapaxes(-1, -2) + _products(self.across, self.across)
        for channel in np.unique(self.at):
            S[:, :, channel, channel] += np.sum(np.square(np.abs(self.alone[..., self.at == channel])), axis=-1)
        return S, _products(self.by_modes, self.by_modes)

    def through(self, W: ComplexArray, inverse: ComplexArray) -> Array:
        """(n, i, j) variance of the sum of W dy `inverse` over the runs, on all of which tolerances act alike.

        Parameters
        ----------
        W : (n, i, c)
        inverse : (n, r, j)
        """
        turned = inverse.swapaxes(1, 2)

        def whole(moved: ComplexArray) -> ComplexArray:
            """(n, j, m, i) of what moves the readings (r, n, m, c)."""
            r, n, m, c = moved.shape
            by_run = turned @ moved.swapaxes(0, 1).reshape(n, r, m * c)
            return np.asarray(by_run.reshape(n, by_run.shape[1], m, c) @ W.swapaxes(1, 2)[:, None])

        F = whole(self.by_fit)
        variance = np.sum((F.conj() * (_mixed(self.known, F) + 2 * whole(self.met))).real, axis=2)
        for moved in (self.across, self.by_modes):
            variance += np.sum(np.square(np.abs(whole(moved))), axis=2)
        alone = np.square(np.abs(turned @ self.alone.swapaxes(0, 1)))
        for channel in np.unique(self.at):
            variance += np.sum(alone[..., self.at == channel], axis=-1)[..., None] * np.square(np.abs(W[:, None, :, channel]))
        return np.asarray(variance.swapaxes(1, 2))


@dataclass(frozen=True, eq=False, kw_only=True)
class Chunk:
    """Some lines of a prediction.

    Attributes
    ----------
    lines : (n,) indices
    rows : (r, n, c, k) what the channels read for a unit of every input
    inputs : (r, n, k) of the runs, which turn a tolerance into a reading
    noise : (r, n, c) standard deviation by noise and model-error floor
    weight : (r, n, c) by which the plain error tells inputs
    spread : what everything that is not known does to the readings
    """

    lines: Lines
    rows: ComplexArray
    inputs: ComplexArray
    noise: Array
    weight: Array
    spread: ReadingSpread


def chunks(prediction: Prediction, offsets: Offsets, unknown: Doubt) -> Iterator[Chunk]:
    """The lines of `prediction` at `offsets`, in order; `unknown` is what may be otherwise.

    Raises
    ------
    numpy.linalg.LinAlgError : the channels do not tell the inputs at a line.
    """
    measured = prediction.measured
    count = len(measured.frequency)
    for first in range(0, count, TOGETHER):
        lines = np.arange(first, min(first + TOGETHER, count), dtype=np.int64)
        found, seen = prediction.at(offsets, lines), observed(measured, lines)
        rows, u = np.broadcast_to(found.rows, (len(measured.runs), *found.rows.shape[-3:])), seen.inputs
        if u is None:
            weight = seen.weight(FLOOR, found.noise)
            u = np.stack([eliminated(*of_run)[2] for of_run in zip(rows, seen.values, weight, strict=True)])
        yield Chunk(
            lines=lines,
            rows=rows,
            inputs=u,
            noise=np.sqrt(2) / seen.weight(FLOOR, found.noise),  # of which the weight is that of a real or an imaginary part
            weight=observed(measured, lines, plain=True).weight(evaluate.FLOOR, found.noise),
            spread=ReadingSpread.of(unknown, found, u),
        )


def _readings(change: Change | Conveyed, u: ComplexArray) -> ComplexArray:
    """(r, n, len(change.channels)) d readings / d offset for inputs u (r, n, k)."""
    by_line = u.transpose(1, 2, 0)
    if isinstance(change, Conveyed):
        return np.asarray((change.through @ (change.quantities @ by_line)).transpose(2, 0, 1))
    if change.rows.ndim == 4:
        return np.asarray((change.rows @ u[..., None])[..., 0])
    return np.asarray((change.rows @ by_line).transpose(2, 0, 1))


def _mixed(matrix: Array, moved: ComplexArray) -> ComplexArray:
    """A real `matrix` (m, k) times `moved` (..., k, c)."""
    return np.asarray(matrix @ np.ascontiguousarray(moved).view(np.float64)).view(np.complex128)


def _products(a: ComplexArray, b: ComplexArray) -> ComplexArray:
    """(..., c, c) sum of the columns of a (..., k, c) times those of b, conjugated."""
    return np.asarray(a.swapaxes(-1, -2) @ b.conj())


# What a channel reads beyond what all the others say it should, and how surprising that is.
#
# At one line of one run y = A u + e, e with the covariance S = D + V V^H of noise D and of all tolerances V that were not
# fitted. With latent inputs u the projector
#
#     P = S^-1 - S^-1 A (A^H S^-1 A)^-1 A^H S^-1                      (P = S^-1 and y - A u in place of y where u is known)
#
# gives for every channel c at once what it reads beyond its prediction from all other channels, and the standard deviation of
# that,
#
#     d_c = (P y)_c / P_cc ,      sd_c = P_cc^-1/2
#
# (leave-one-out residuals of generalised least squares; Dubrule, Math. Geology 15, 1983). A channel that is off by itself
# stands out by d_c; neighbours that merely share its tolerances do not. y^H P y is chi² over all of them.
#
# What the model gets wrong shows in the loads instead: their error R (y_f - A_f u), u from the channels that are not judged,
# adds up what every load cell sees a little of. Its covariance is that of the same linear form.


ROUNDING = 1e-12
"""Share of its variance by which every channel is unsure on its own, so that what all share of it is no singular matrix."""

CHECKED = 1e-6
"""Share of its own variance that must be left of a channel's redundancy; below, nothing checks it."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Deviations:
    """Errors and what is expected of them.

    Attributes
    ----------
    value : (..., m) complex, SI
    expected : (..., m) standard deviation; infinite where nothing checks the row
    """

    value: ComplexArray
    expected: Array


def with_noise(covariance: ComplexArray, noise: Array) -> ComplexArray:
    """`covariance` (..., c, c) with noise of standard deviations (..., c) as well."""
    S, diagonal = np.array(covariance), np.arange(noise.shape[-1])
    S[..., diagonal, diagonal] += np.square(noise)
    return S


def left_over(y: ComplexArray, A: ComplexArray, S: ComplexArray, known: ComplexArray | None) -> tuple[Deviations, Array]:
    """What each channel reads beyond its prediction from all others, (..., c), and chi² of all of them together (...).

    Parameters
    ----------
    y : (..., c)
    A : (..., c, k)
    S : (..., c, c)
    known : (..., k) inputs; None where they are latent
    """
    scale = np.sqrt(np.diagonal(S, axis1=-2, axis2=-1).real)
    white = A / scale[..., None]
    P = np.linalg.inv(S / (scale[..., :, None] * scale[..., None, :]))
    e = (y if known is None else y - _times(A, known)) / scale
    r, own = _times(P, e), np.asarray(np.diagonal(P, axis1=-2, axis2=-1).real, dtype=np.float64)
    if known is None:
        B = np.asarray(P @ white, dtype=np.complex128)
        weighed = np.asarray(np.linalg.solve(white.conj().swapaxes(-1, -2) @ B, B.conj().swapaxes(-1, -2)), dtype=np.complex128)
        r = np.asarray(r - _times(B, _times(weighed, e)))
        own = np.asarray(own - np.sum((B * weighed.swapaxes(-1, -2)).real, axis=-1))
    own = np.maximum(own, 0.0)
    checked = own > CHECKED
    safe = np.where(checked, own, 1.0)
    value = np.where(checked, r / safe, 0.0) * scale
    expected = np.where(checked, scale / np.sqrt(safe), np.inf)
    chi2 = np.sum(e.conj() * r, axis=-1).real
    return Deviations(value=value, expected=expected), np.asarray(chi2)


def judged_error(
    y: ComplexArray, A: ComplexArray, S: ComplexArray, known: ComplexArray | None, judged: npt.NDArray[np.bool_]
) -> tuple[ComplexArray, ComplexArray]:
    """Error (..., f) of the judged channels with inputs from all others, and its covariance (..., f, f).

    Parameters are those of `left_over`; `judged` (c,) bool.
    """
    f, a = np.flatnonzero(judged), np.flatnonzero(~np.asarray(judged, dtype=bool))
    if known is not None:
        return (y - _times(A, known))[..., f], np.asarray(S[..., f[:, None], f])
    weighed = np.linalg.solve(S[..., a[:, None], a], A[..., a, :]).conj().swapaxes(-1, -2)
    inputs = np.linalg.solve(weighed @ A[..., a, :], weighed)
    L = np.zeros((*A.shape[:-2], len(f), A.shape[-2]), dtype=np.complex128)
    L[..., a] = -A[..., f, :] @ inputs
    L[..., np.arange(len(f)), f] = 1.0
    return _times(L, y), np.asarray(L @ S @ L.conj().swapaxes(-1, -2))


def combined(error: ComplexArray, covariance: ComplexArray, R: Array) -> Deviations:
    """Combinations R (m, f) of errors (..., f) with `covariance` (..., f, f)."""
    variance = np.einsum("mf,...fg,mg->...m", R, covariance, R, optimize=True).real
    return Deviations(value=_times(R.astype(np.complex128), error), expected=np.sqrt(np.maximum(variance, 0.0)))


def _times(matrix: ComplexArray, vector: ComplexArray) -> ComplexArray:
    return np.asarray((matrix @ vector[..., None])[..., 0])


# Predicted beside measured 6 x 6 dynamic mass, pair of axes by pair of axes.
#
# The measured one is `identification.dynamic_mass` on base motions and resultants as everywhere. The predicted one goes the
# same way: the channels that the model predicts for the very runs are put through the same operators, so that an effect on a
# channel which the model knows is in both, and what they differ by is not the way in which they were made. With T and R the
# rows of motions and resultants, an error of the channels by dy changes H by
#
#     dH = (R dy - H T dy) S_u^-1                                                   (from Eq. 10)
#
# which gives the standard deviation of every entry from noise and tolerances.


@dataclass(frozen=True, eq=False, kw_only=True)
class Pairs:
    """The dynamic mass of one campaign, about F, of all that stands on the load cells.

    Attributes
    ----------
    campaign : name of the data set
    frequency : (n,) [Hz]
    measured, predicted : (n, 6, 6)
    expected : (n, 6, 6) standard deviation of their difference by noise and by tolerances that were not fitted
    level : (n, 6, 6) of row and column of the dynamic mass, of which an error is told in per cent: the greater of both
    """

    campaign: str
    frequency: Array
    measured: ComplexArray
    predicted: ComplexArray
    expected: Array
    level: Array

    @property
    def sigma(self) -> Array:
        """(n, 6, 6) difference in standard deviations."""
        return np.asarray(np.abs(self.measured - self.predicted) / self.expected)

    @property
    def percent(self) -> Array:
        """(n, 6, 6) difference in per cent of the dynamic mass."""
        return np.asarray(100 * np.abs(self.measured - self.predicted) / self.level)


@dataclass(frozen=True, eq=False, kw_only=True)
class Functions:
    """The response functions of one test, on the lines of its map, a run a drive and a channel a response.

    Attributes
    ----------
    unit : of a function, SI
    measured, predicted : (r, n, c)
    expected : (r, n, c) standard deviation of their difference by noise and by tolerances that were not fitted
    coherence : (r, n, c) [0 to 1]; None where it is not known
    """

    unit: str
    measured: ComplexArray
    predicted: ComplexArray
    expected: Array
    coherence: Array | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class Operators:
    """From channels to what H is made of.

    Attributes
    ----------
    motion : (n, 6, c) rows of Eq. 6
    load : (n, 6, c) rows of the resultants about F
    """

    motion: ComplexArray
    load: ComplexArray


def operators(table: ChannelTable, frequency: Array, noise: Array, gravity: float) -> Operators:
    """The operators of a campaign, told from what they make of a unit reading of each channel.

    Parameters
    ----------
    noise : (n, c) standard deviation, by which accelerometers are weighed

    Raises
    ------
    BadInput : the channels do not tell six motions or six loads.
    """
    n, c = len(frequency), len(table)
    unit = Spectra(
        table=table,
        frequency=frequency,
        values=np.broadcast_to(np.eye(c)[:, None, :], (c, n, c)),
        noise=np.broadcast_to(noise, (c, n, c)),
        quality=np.ones((c, n)),
        runs=tuple(map(str, range(c))),
        axes=("",) * c,
    )
    moved, loaded = base_motion(unit, gravity=gravity).values, identification_resultants(unit).values
    return Operators(motion=np.moveaxis(moved, 0, -1), load=np.moveaxis(loaded, 0, -1))


def through(of: Operators, y: ComplexArray, frequency: Array) -> Estimate:
    """The dynamic mass that the readings y (r, n, c) lead to.

    Raises
    ------
    BadInput : runs that do not tell six motions apart.
    """
    load, motion = ((rows @ y[..., None])[..., 0] for rows in (of.load, of.motion))
    return from_runs(load, motion, frequency)


def pair_lines(of: Operators, measured: Measured, part: Chunk) -> tuple[ComplexArray, ComplexArray, Array]:
    """Measured and predicted dynamic mass on the lines of `part`, and the variance of their difference, each (n, 6, 6).

    Raises
    ------
    BadInput : runs that do not tell six motions apart.
    """
    at = part.lines
    own, frequency = Operators(motion=of.motion[at], load=of.load[at]), measured.frequency[at]
    seen = through(own, measured.values[:, at], frequency).dynamic_mass.matrix
    estimate = through(own, (part.rows @ part.inputs[..., None])[..., 0], frequency)
    H = estimate.dynamic_mass.matrix
    # Tolerances act on all runs alike, noise on each alone
    W = own.load - H @ own.motion
    by_noise = np.einsum("nic,rnc,nrj->nij", np.abs(W) ** 2, part.noise**2, np.abs(estimate.inverse) ** 2, optimize=True)
    return seen, H, part.spread.through(W, estimate.inverse) + by_noise


LENGTHS = np.array([LEVELS["x"] / LEVELS[axis] for axis in MOTIONS])
"""(6,) [1] and [m]: moments divided by their nominal length are forces."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Map:
    """One data set: what its channels and loads read beyond what was expected.

    Attributes
    ----------
    data_set, configuration : its name and what was tested
    runs, axes : (r,) names, and what each drove
    frequency : (n,) [Hz]
    rows : (m,) names of the channels, then of the six loads where load cells tell them
    channels : how many of them are channels
    deviation : (r, n, m) complex, SI
    expected : (r, n, m) its standard deviation; infinite where nothing checks the row
    reading : (r, n, m) complex, what was expected to be read
    level : (r, n, m) of which a deviation is told in per cent
    inputs : (r, n, k) base motions or known inputs, as the channels that are not judged tell them
    misfit : (r, n) chi² per degree of freedom of all channels together, tolerances counted
    explained : (r, n) share of the judged channels' readings that the plain error is expected to be, by tolerances of the
        measurement
    explained_with_modes : (r, n) the same by what the model leaves open of its modes as well
    pairs : of the dynamic mass; None where runs or channels do not tell it
    functions : of a test by forces; None of any other
    remarks : sentences
    """

    data_set: str
    configuration: str
    runs: tuple[str, ...]
    axes: tuple[str, ...]
    frequency: Array
    rows: tuple[str, ...]
    channels: int
    deviation: ComplexArray
    expected: Array
    reading: ComplexArray
    level: Array
    inputs: ComplexArray
    misfit: Array
    explained: Array
    explained_with_modes: Array
    pairs: Pairs | None = None
    functions: Functions | None = None
    remarks: tuple[str, ...] = field(default=())

    @property
    def has_lines(self) -> bool:
        """Whether they are those of a spectrum; a table of modes has one, a run a mode."""
        return len(self.frequency) > 1

    @property
    def shown(self) -> str:
        """What the rows are."""
        return "channels and loads" if self.channels < len(self.rows) else "channels"

    @property
    def sigma(self) -> Array:
        """(r, n, m) deviations in standard deviations."""
        return np.asarray(np.abs(self.deviation) / self.expected)

    @property
    def percent(self) -> Array:
        """(r, n, m) deviations in per cent: of what the channel reads there, of the dynamic mass for a load."""
        return in_percent(self.deviation, self.level)


def in_percent(deviation: ComplexArray, level: Array) -> Array:
    """Deviations of any shape in per cent of their `level`."""
    return np.asarray(100 * np.abs(deviation) / np.maximum(level, np.finfo(np.float64).tiny ** 0.5))


@dataclass(frozen=True, eq=False, kw_only=True)
class Rig:
    """Where the channels of a data set sit.

    Attributes
    ----------
    table : with all channels of the data set
    gravity : [m/s²]
    """

    table: ChannelTable
    gravity: float

    def of(self, names: Collection[str]) -> ChannelTable:
        """The channels called `names`, in that order."""
        by_name = {one.name: one for one in self.table.channels}
        return ChannelTable(channels=tuple(by_name[name] for name in names), origin=self.table.origin)

    def loads(self, measured: Measured) -> Array | None:
        """(6, f) the loads about F from the judged channels; None where they do not tell all six."""
        table = self.of([name for name, judged in zip(measured.channels, measured.judged, strict=True) if judged])
        return resultants(table.channels, table.origin) if of_resultants(table).complete else None

    def operators(self, measured: Measured) -> tuple[Operators | None, tuple[str, ...]]:
        """From channels to the dynamic mass; or None, and why there is none."""
        table = self.of(measured.channels)
        seen = any(of_motions(table, (group,)).complete for group in ("cover", "table"))
        if not (seen and of_resultants(table).complete):
            return None, (f"{measured.name}: its channels do not tell six motions and six loads, so no dynamic mass is measured",)
        noise = np.sqrt(np.mean(measured.noise**2, axis=0))
        of = operators(table, measured.frequency, noise, self.gravity)
        try:
            through(of, measured.values, measured.frequency)
        except BadInput as error:
            return None, (f"{measured.name}: no dynamic mass is measured, {error.problem}; its runs are compared one by one",)
        return of, ()


def mapped(
    prediction: Prediction,
    offsets: Offsets,
    unknown: Doubt,
    rig: Rig | None = None,
    progress: Callable[[float], None] | None = None,
) -> Map:
    """The map of one data set.

    Parameters
    ----------
    offsets : of the plain fit
    unknown : what may be otherwise there
    rig : of a base-excitation test; without it there are neither loads nor pairs
    """
    measured = prediction.measured
    R = None if rig is None else rig.loads(measured)
    of, remarks = (None, ()) if rig is None else rig.operators(measured)
    said, both, whole, told = [], [], [], progress or (lambda share: None)
    for part in chunks(prediction, offsets, unknown):
        said.append(_of_lines(measured, part, R))
        if of is not None:
            both.append(pair_lines(of, measured, part))
        if isinstance(prediction, ResponseFunctionTest):
            square = np.diagonal(sum(part.spread.covariances), axis1=-2, axis2=-1).real
            whole.append((part.rows[..., 0], np.sqrt(np.square(part.noise) + square)))
        told((part.lines[-1] + 1) / len(measured.frequency))
    found = {key: np.concatenate([one[key] for one in said], axis=1) for key in said[0]}
    # Of a load all six of its run, predicted or measured, the greater
    level, of_loads = level_of(measured), slice(len(measured.channels), None)
    predicted = found["reading"][..., of_loads]
    if predicted.shape[-1]:
        loads = (predicted, predicted + found["deviation"][..., of_loads])
        power = np.maximum(*(smoothed_level(measured.frequency, one / LENGTHS) for one in loads))
        level = np.concatenate([level, np.sqrt(np.sum(power**2, axis=-1, keepdims=True)) * LENGTHS], axis=-1)
    pairs = None
    if both:
        seen, model, variance = (np.concatenate(each) for each in zip(*both, strict=True))
        pairs = Pairs(
            campaign=measured.name,
            frequency=measured.frequency,
            measured=seen,
            predicted=model,
            expected=np.sqrt(variance),
            level=np.maximum(levels(model), levels(seen)),
        )
    functions = None
    if isinstance(prediction, ResponseFunctionTest):
        predicted, expected = (np.concatenate(each, axis=1) for each in zip(*whole, strict=True))
        unit, coherence = QUANTITIES[prediction.quantity], prediction.coherence
        functions = Functions(unit=unit, measured=measured.values, predicted=predicted, expected=expected, coherence=coherence)
    return Map(
        data_set=measured.name,
        configuration=measured.configuration,
        runs=measured.runs,
        axes=measured.axes,
        frequency=measured.frequency,
        rows=(*measured.channels, *(() if R is None else LOADS)),
        channels=len(measured.channels),
        level=level,
        pairs=pairs,
        functions=functions,
        remarks=remarks,
        **found,
    )


def _of_lines(measured: Measured, part: Chunk, R: Array | None) -> dict[str, Array]:
    """What a chunk says, by field of `Map`."""
    y, A = measured.values[:, part.lines], part.rows
    of_tolerances, of_modes = part.spread.covariances
    S = with_noise(of_tolerances + of_modes, part.noise)
    S = S * (1 + ROUNDING * np.eye(S.shape[-1]))
    known = None if measured.inputs is None else measured.inputs[:, part.lines]
    own, chi2 = left_over(y, A, S, known)
    if known is None and measured.judged.all():  # the inputs are what the same channels say of each other
        error, spread = own.value, np.zeros((*own.value.shape, 0))
    else:
        error, spread = judged_error(y, A, S, known, measured.judged)
    loads = Deviations(value=error[..., :0], expected=np.zeros((*error.shape[:2], 0)))
    predicted = np.zeros((*error.shape[:2], 0), dtype=np.complex128)
    if R is not None:
        loads = combined(error, spread, R)
        predicted = (y[..., measured.judged] - error) @ R.T
    # (r, n, 2) squares of what tolerances, those of modes apart, make of the error that the engine calls plain; it knows no noise
    seen, squares, judged = observed(measured, part.lines), [], measured.judged
    for run, (rows, weight) in enumerate(zip(part.rows, part.weight, strict=True)):
        gain = left_of_run(seen, rows, weight, run, judged).gain
        L = np.eye(len(judged))[None, judged] if gain is None else gain
        squares.append([np.sum((L @ C[run] * L.conj()).real, axis=(1, 2)) for C in (of_tolerances, of_modes)])
    level = np.maximum(np.sum(np.abs(seen.values[..., judged]) ** 2, axis=-1), np.finfo(np.float64).tiny)
    by_tolerances, by_modes = np.maximum(np.stack(squares, axis=1), 0.0)
    recorded = np.any(measured.values, axis=(0, 1))  # what nobody measured is no data
    return {
        "inputs": part.inputs,
        "deviation": np.concatenate([own.value, loads.value], axis=-1),
        "expected": np.concatenate([np.where(recorded, own.expected, np.inf), loads.expected], axis=-1),
        "reading": np.concatenate([y - own.value, predicted], axis=-1),
        "misfit": chi2 / (A.shape[-2] - (A.shape[-1] if known is None else 0)),
        "explained": np.sqrt(by_tolerances / level),
        "explained_with_modes": np.sqrt((by_tolerances + by_modes) / level),
    }
