"""The likelihood of one data set, whatever it is of: known or latent inputs, rows that runs share or not.

At one line of one run y = A u + n. Where the inputs u are latent they are eliminated in closed form
(`identification.self_calibration.solve`), and the derivative of the residual r = (1 - Q Q^H) W y is that of Kaufman (BIT
15, 1975), dr = -(1 - Q Q^H) W (dA) u, whose gradient is exact. Where they are known r = W (y - A u) and dr = -W (dA) u.

Noise is that of the data and a model-error floor that is proportional to the smoothed level of each channel; E|noise|² = sd² is
shared by real and imaginary part. "The likelihood" of the catalogue of effects.
"""

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache, partial
from types import MappingProxyType

import numpy as np
import numpy.typing as npt

from geometry.dynamic_mass import ComplexArray
from geometry.errors import CheckFailed
from geometry.frames import Array, frozen
from identification.self_calibration import solve
from identification.self_calibration.solve import SILENT, Normal, Ways, normal_by_ways
from validation.estimation.problem import (
    EFFECT,
    Change,
    Conveyed,
    Lines,
    Measured,
    Offsets,
    Parameter,
    Predicted,
    Prediction,
    Problem,
)

FEW = 24
"""[count] of parameters of several channels that go no common way up to which it is the quicker. Exercised by
engine/test_likelihood.py."""


def ways(changes: Mapping[str, Change | Conveyed], names: Sequence[str], count: int) -> Ways | None:
    """Of the parameters `names` of a prediction of `count` channels; None where most go ways of their own."""
    moves = [changes[name] for name in names]
    seen = Counter(id(one.through) for one in moves if isinstance(one, Conveyed))
    if not seen:
        return None
    ((way, _),) = seen.most_common(1)
    common = [k for k, one in enumerate(moves) if isinstance(one, Conveyed) and id(one.through) == way]
    rest = [k for k in range(len(moves)) if k not in set(common)]
    single = [k for k in rest if len(moves[k].channels) == 1]
    others = [k for k in rest if len(moves[k].channels) != 1]
    if len(others) > FEW or any(moves[k].rows.ndim != 3 for k in rest):
        return None
    conveyed = [one for k in common if isinstance(one := moves[k], Conveyed)]
    through, quantities = conveyed[0].through, np.stack([one.quantities for one in conveyed], axis=1)
    lines, inputs = len(through), quantities.shape[-1]
    whole = np.zeros((len(others), lines, count, inputs), dtype=np.complex128)
    for place, k in enumerate(others):
        whole[place][:, moves[k].channels] = moves[k].rows
    own = [np.broadcast_to(moves[k].rows[:, 0], (lines, inputs)) for k in single]
    return Ways(
        count=len(moves),
        channels=np.array(conveyed[0].channels, dtype=np.int64),
        through=through,
        common=np.array(common, dtype=np.int64),
        quantities=quantities,
        single=np.array(single, dtype=np.int64),
        at=np.array([moves[k].channels[0] for k in single], dtype=np.int64),
        rows=np.array(own, dtype=np.complex128).reshape(len(single), lines, inputs),
        others=np.array(others, dtype=np.int64),
        whole=whole,
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class ObservedLines:
    """What one data set reads at the lines that are used.

    Attributes
    ----------
    runs : (r,) names
    values : (r, m, c) complex
    noise : (r, m, c) standard deviation of the noise
    floor : (r, m, c) standard deviation that a model-error floor of 1 gives
    inputs : (r, m, k) where they are known
    turned : (r, m, c) standard deviation that its model-error floor gives at least
    unmeasured : (c,) bool, the channels that stand for what nobody measured; (1,) where there are none
    parts : numbers that a value is made of: 2, or 1 of real ones
    """

    runs: tuple[str, ...]
    values: ComplexArray
    noise: Array
    floor: Array
    inputs: ComplexArray | None
    turned: Array | float = 0.0
    unmeasured: npt.NDArray[np.bool_] = field(default_factory=lambda: np.zeros(1, dtype=bool))
    parts: int = 2

    def weight(self, floor: float, noise: Array | None = None) -> Array:
        """(r, m, c) one over the standard deviation of each part of a value; `noise` in place of the data's own."""
        variance = np.square(self.noise if noise is None else noise) + np.square(np.maximum(floor * self.floor, self.turned))
        return np.asarray(np.sqrt(self.parts / np.maximum(variance, np.finfo(np.float64).tiny)))


TURNED = 0.01
"""[share] of what a channel reads that a delay within its tolerance changes by turning it, from which that is its model-error
floor in a `plain` fit, which fits no delays. Held by virtual_test/test_structures.py."""


def observed(measured: Measured, lines: Lines, *, plain: bool = False) -> ObservedLines:
    """`measured` at `lines` (indices), as a `plain` fit sees it or one of all tolerances."""
    turned: Array | float = 0.0
    if plain:
        turned = 2 * np.pi * measured.frequency[lines, None] * measured.late
        turned = np.where(turned > TURNED, turned, 0.0) * level_of(measured)[:, lines]
    return ObservedLines(
        runs=measured.runs,
        values=measured.values[:, lines],
        noise=measured.noise[:, lines],
        floor=floor_of(measured)[:, lines],
        inputs=None if measured.inputs is None else measured.inputs[:, lines],
        turned=turned,
        unmeasured=np.isin(measured.channels, measured.unmeasured),
        parts=1 if measured.is_real else 2,
    )


@lru_cache(maxsize=8)
def level_of(measured: Measured) -> Array:
    """(r, n, c) what every channel reads; every fit and every map asks for it.

    Of a channel that is nearly silent in a run it is `SILENT` of what channels read that are judged, or not judged, as it is.
    """
    level = solve.smoothed_level(measured.frequency, measured.values)
    return frozen(np.hypot(level, SILENT * solve.level_of_groups(measured.values, measured.judged)), level.shape, "level")


def floor_of(measured: Measured) -> Array:
    """(r, n, c) the level that a model-error floor is relative to: what a channel reads, and what it hears by its slant of the
    motion along the one axis that is driven."""
    level = level_of(measured)
    driven = level[:, :, np.isin(measured.channels, measured.pilots)].max(axis=2, keepdims=True, initial=0.0)
    return np.asarray(np.hypot(level, driven))


def normals(seen: ObservedLines, predicted: Predicted, free: Sequence[str], floor: float) -> dict[str, Normal]:
    """By run the normal equations in the parameters `free`; those that do not act here have no rows."""
    own = [name for name in free if name in predicted.changes]
    weight = seen.weight(floor, predicted.noise)
    at = np.array([k for k, name in enumerate(free) if name in predicted.changes], dtype=np.int64)
    common, found = ways(predicted.changes, own, seen.values.shape[2]), {}
    for run, name in enumerate(seen.runs):
        r, Q, u = _residual(_of_run(predicted.rows, run), seen, weight, run)
        if common is None:
            one = solve.normal_equations(r, Q, _moved(predicted, own, run, u, weight[run]))
        else:
            one = normal_by_ways(common, r, Q, u, weight[run])
        # `one` in a vector of `count` parameters of which it knows those `at`
        count = len(free)
        gradient, matrix = np.zeros(count), np.zeros((count, count))
        gradient[at] = one.gradient
        matrix[np.ix_(at, at)] = one.matrix
        found[name] = Normal(cost=one.cost, gradient=gradient, matrix=matrix)
    return found


def whitened(
    seen: ObservedLines, predicted: Predicted, names: Sequence[str], floor: float, run: int
) -> tuple[ComplexArray, ComplexArray]:
    """Residual (m, c) of one run, and minus its derivatives (m, c, p) by the offsets of `names`, inputs eliminated from both."""
    weight = seen.weight(floor, predicted.noise)
    r, Q, u = _residual(_of_run(predicted.rows, run), seen, weight, run)
    V = np.ascontiguousarray(_moved(predicted, names, run, u, weight[run]).transpose(1, 2, 0))
    return r, V if Q is None else V - Q @ (Q.conj().transpose(0, 2, 1) @ V)


def residual(seen: ObservedLines, predicted: Predicted, floor: float) -> ComplexArray:
    """(r, m, c) whitened residuals."""
    weight = seen.weight(floor, predicted.noise)
    rows = (_of_run(predicted.rows, run) for run in range(len(seen.runs)))
    return np.stack([_residual(A, seen, weight, run)[0] for run, A in enumerate(rows)])


def freedom(seen: ObservedLines, predict: Callable[[], Predicted], floor: float) -> Array:
    """(r, m, c) By how much chi² grows with the variance of each channel; their sum are its degrees of freedom. Known inputs take
    nothing, and what is predicted is not asked for.

    Latent inputs take what they can: with the projection P = 1 - Q Q^H that eliminates them, the residuals of the channels R that
    were read have the mean square sum_c v_c sum_(a in R) |P_ac|², where v_c is the variance of channel c over what is allowed
    for. An input that nobody measured is stated as the largest that it may be, so that v = 0 there, and what is left is tr P_RR²
    (T. Hastie and R. Tibshirani, Generalized Additive Models, 1990, 3.5). Were it as large as that, chi² would come to tr P_RR.
    """
    if seen.inputs is not None:
        return np.broadcast_to(np.float64(seen.parts), seen.values.shape)
    predicted, read = predict(), np.broadcast_to(~seen.unmeasured, seen.values.shape[2:])
    Q, _ = np.linalg.qr(seen.weight(floor, predicted.noise)[..., None] * predicted.rows)
    unread = Q[..., ~read, :] @ Q.conj().swapaxes(-1, -2)  # rows of -P; as P² = P, the others need not be made
    left = 1 - np.sum(np.square(np.abs(Q)), axis=-1) - np.sum(np.square(np.abs(unread)), axis=-2)
    return np.asarray(seen.parts * read * np.maximum(left, 0.0))


def _of_run(rows: ComplexArray, run: int) -> ComplexArray:
    return rows if rows.ndim == 3 else np.asarray(rows[run])


def _residual(
    A: ComplexArray, seen: ObservedLines, weight: Array, run: int
) -> tuple[ComplexArray, ComplexArray | None, ComplexArray]:
    """Whitened residual (m, c), Q (m, c, k) of what was eliminated, and inputs (m, k) of one run."""
    y, w = seen.values[run], weight[run]
    if seen.inputs is None:
        return solve.eliminated(A, y, w)
    u = seen.inputs[run]
    return np.asarray(w * (y - (A @ u[..., None])[..., 0])), None, np.asarray(u)


def _moved(predicted: Predicted, names: Sequence[str], run: int, u: ComplexArray, w: Array) -> ComplexArray:
    """(p, m, c) W (dA) u of one run."""
    V = np.zeros((len(names), *w.shape), dtype=np.complex128)
    for k, name in enumerate(names):
        change = predicted.changes[name]
        if isinstance(change, Conveyed):
            V[k][:, change.channels] = (change.through @ (change.quantities @ u[..., None]))[..., 0]
        else:
            V[k][:, change.channels] = (_of_run(change.rows, run) @ u[..., None])[..., 0]
    V *= w
    return V


# `Cost`: what a fit makes small: half the squares of misfit, of facts, and of what is known beforehand.

NOTHING: Offsets = MappingProxyType({})


@dataclass(frozen=True, eq=False, kw_only=True)
class Cost:
    """Of a problem in some of its parameters.

    Attributes
    ----------
    problem : what is compared
    free : (p,) the parameters that move
    floor : model-error floor, relative
    base : offsets at which the others stand, those of the model where nothing is said
    held : parameters of the fit that stand at a bound; what is known of them counts
    plain : whether declared parameters stay within what a plain fit allows them
    worth : that the end of a way must lie below to matter; the way is given up where it will not come there
    """

    problem: Problem
    free: tuple[Parameter, ...]
    floor: float
    base: Offsets = field(default_factory=lambda: NOTHING)
    held: tuple[Parameter, ...] = ()
    plain: bool = False
    worth: float = np.inf
    observed: tuple[tuple[Prediction, Lines, ObservedLines], ...] = field(default=(), repr=False)

    def __post_init__(self) -> None:
        if not self.observed:
            chosen = ((one, self.problem.lines_of(one)) for one in self.problem.predictions)
            object.__setattr__(
                self, "observed", tuple((one, lines, observed(one.measured, lines, plain=self.plain)) for one, lines in chosen)
            )

    @cached_property
    def names(self) -> tuple[str, ...]:
        """(p,) of the free parameters."""
        return tuple(one.name for one in self.free)

    @cached_property
    def bounds(self) -> tuple[Array, Array]:
        """(p,) least and (p,) greatest offsets of the free parameters."""
        pairs = np.array([one.bounds(plain=self.plain) for one in self.free]).reshape(-1, 2)
        return pairs[:, 0], pairs[:, 1]

    def offsets(self, x: Array) -> dict[str, float]:
        """Of all parameters, the free ones at `x` (p,)."""
        return {**self.problem.start, **self.base, **dict(zip(self.names, map(float, x), strict=True))}

    def at(self, offsets: Offsets) -> Array:
        """(p,) of the free parameters from `offsets`, those of the model where nothing is said."""
        return np.array([offsets.get(one.name, one.start) for one in self.free])

    def holding(self, held: Mapping[str, float]) -> "Cost":
        """The same with the parameters `held` at these offsets, and all others of the fit free."""
        everything = (*self.free, *self.held)
        return replace(
            self,
            free=tuple(one for one in everything if one.name not in held),
            held=tuple(one for one in everything if one.name in held),
            base={**self.base, **held},
        )

    def by_run(self, x: Array) -> dict[tuple[str, str], Normal]:
        """Normal equations of the data at `x` (p,) by data set and run."""
        found: dict[tuple[str, str], Normal] = {}
        offsets = self.offsets(x)
        for prediction, lines, seen in self.observed:
            predicted = prediction.at(offsets, lines, derivatives=frozenset(self.names))
            for run, one in normals(seen, predicted, self.names, self.floor).items():
                found[prediction.measured.name, run] = one
        return found

    def data(self, x: Array) -> Normal:
        """Normal equations of all data at `x` (p,)."""
        return solve.total(self.by_run(x).values(), len(self.free))

    def misfit(self, x: Array) -> float:
        """The cost of all data at `x` (p,) alone, which needs no derivatives."""
        found, offsets = 0.0, self.offsets(x)
        for prediction, lines, seen in self.observed:
            left = residual(seen, prediction.at(offsets, lines, derivatives=False), self.floor)
            found += sum(0.5 * float(np.sum(np.square(np.abs(one)))) for one in left)
        return found

    def knowledge(self, x: Array) -> tuple[Array, Array]:
        """Whitened residuals (q,) at `x` (p,) of what is known beforehand and of facts, and their derivatives (q, p)."""
        sd = np.array([one.tolerance for one in self.free])
        known = np.isfinite(sd)
        away, slope = _with_tail(x[known] / sd[known], np.array([tailed(one) for one in self.free], dtype=bool)[known])
        rows = np.eye(len(sd))[known] * (slope / sd[known])[:, None]
        still, _ = _with_tail(
            np.array([self.base[one.name] / one.tolerance for one in self.held]),
            np.array([tailed(one) for one in self.held], bool),
        )
        left, change = self._facts(x)
        return np.concatenate([away, still, left]), np.vstack([rows, np.zeros((len(still), len(sd))), change])

    def _facts(self, x: Array) -> tuple[Array, Array]:
        said = [fact.residual(self.offsets(x)) for fact in self.problem.facts]
        rows = np.array([[slopes.get(name, 0.0) for name in self.names] for _, slopes in said])
        return np.array([left for left, _ in said]), rows.reshape(len(said), len(self.names))

    def total(self, x: Array, data: Normal | None = None) -> tuple[Normal, Normal]:
        """At `x` (p,): all as one, and the `data` alone, which may be known already."""
        data = self.data(x) if data is None else data
        return data.beside(*self.knowledge(x)), data

    def chi2(self, x: Array, data: Normal) -> float:
        """Chi² of all that was read, and of facts, at `x` (p,) with its normal equations `data`."""
        (left, _), offsets, found = self._facts(x), self.offsets(x), 2 * data.cost
        for one, lines, seen in self.observed:
            if seen.unmeasured.any():
                away = residual(seen, one.at(offsets, lines, derivatives=False), self.floor)
                found -= float(np.sum(np.square(np.abs(away[..., seen.unmeasured]))))
        return found + float(left @ left)

    def size(self, x: Array) -> int:
        """Real numbers that the data leave when latent inputs are taken out, and the facts; counted at `x` (p,)."""
        offsets, found = self.offsets(x), float(len(self.problem.facts))
        for one, lines, seen in self.observed:
            if seen.unmeasured.any():
                found += float(np.sum(freedom(seen, partial(one.at, offsets, lines, derivatives=False), self.floor)))
                continue
            latent = one.at(offsets, lines[:1], derivatives=False).rows.shape[-1] if seen.inputs is None else 0
            found += seen.parts * float(np.prod(seen.values.shape[:2])) * (seen.values.shape[2] - latent)
        return round(found)


TAIL = 3.0
"""[prior sd] from which a fault is one of those that leave next to nothing: a brace that is gone, a bolt that is loose. The
density of a factor's logarithm and of a compliance falls there as a power, not as a normal one. Held by test_building.py."""

COMPLIANCES = ("m/N", "rad/(N m)")


def tailed(one: Parameter) -> bool:
    """Whether `one` is a fault of what may break altogether: a factor, or a compliance."""
    return one.kind == EFFECT and (one.logarithmic or one.unit in COMPLIANCES)


def in_the_tail(one: Parameter, offset: float) -> bool:
    """Whether next to nothing is left at `offset` of what `one` is a factor on, or stiff."""
    return tailed(one) and (-offset if one.logarithmic else offset) > TAIL * one.tolerance


def ends_of(one: Parameter, offset: float, ends: Sequence[float]) -> list[float]:
    """Values at the `ends` of an interval about `offset`; where next to nothing is left, how much is told, not its logarithm."""
    if in_the_tail(one, offset):
        return [one.value(offset) + (end - offset) * one.slope(offset) for end in ends]
    return [one.value(end) for end in ends]


def _with_tail(away: Array, has: npt.NDArray[np.bool_]) -> tuple[Array, Array]:
    """Residuals (q,) of priors that are `away` [prior sd] and their derivatives; the cost of those that `has` a tail goes on
    beyond `TAIL` with the logarithm of how far they are."""
    far = np.maximum(np.abs(away) / TAIL, 1.0)
    found = np.where(has, np.sign(away) * np.minimum(np.abs(away), TAIL) * np.sqrt(1 + 2 * np.log(far)), away)
    slope = np.where(has & (far > 1), TAIL / (far * np.maximum(np.abs(found), TAIL)), 1.0)
    return found, slope


def cost_of(problem: Problem, free: Sequence[Parameter], floor: float, base: Offsets = NOTHING, *, plain: bool = False) -> Cost:
    """The cost of `problem` in the parameters `free`; of a plain fit declared ones have narrower bounds."""
    return Cost(problem=problem, free=tuple(free), floor=floor, base=base, plain=plain)


# Evidence: how probable the data are under a model whatever its parameters, by Laplace's approximation.
#
#     log Z = -cost - 1/2 log det(S N S) ,   S = diag(tolerance)
#
# N is the matrix of second derivatives of the cost, knowledge beforehand included; S N S is 1 in every direction of which the
# data say nothing, so that a useless parameter costs nothing and one that is told pays for the width that it had before
# (MacKay, Information Theory, Inference, and Learning Algorithms, ch. 28). What is left out is the same for all models of the
# same data, lines and floor. Where an effect changes the noise, so does the normalisation of the likelihood: its ratio to that
# of the data's own noise, latent inputs marginalised, is in.


def log_evidence(cost: Cost, x: Array, whole: Normal) -> float:
    """At the minimum `x` (p,) where `whole` was found [nats], up to a constant of the data."""
    scale = np.array([one.tolerance if np.isfinite(one.tolerance) else 1.0 for one in cost.free])
    _, logdet = np.linalg.slogdet(scale[:, None] * whole.matrix * scale)
    # Of the noise at `x` against that of the data
    found = 0.0
    offsets = cost.offsets(x)
    for one, lines, seen in cost.observed:
        if one.at(offsets, lines[:1], derivatives=False).noise is None:  # then at no line
            continue
        predicted = one.at(offsets, lines, derivatives=False)
        new, old = seen.weight(cost.floor, predicted.noise), seen.weight(cost.floor)
        found += 2 * float(np.sum(np.log(new / old)))
        if seen.inputs is None:
            rows = np.broadcast_to(predicted.rows, (len(seen.runs), *predicted.rows.shape[-3:]))
            found -= _determinant(new[..., None] * rows) - _determinant(old[..., None] * rows)
    return float(-whole.cost - 0.5 * logdet + found)


def _determinant(A: ComplexArray) -> float:
    """log det(A^H A) over all lines, of A (r, m, c, k)."""
    R = np.linalg.qr(A, mode="r")
    return 2 * float(np.sum(np.log(np.abs(np.diagonal(R, axis1=-2, axis2=-1)))))


# Inputs at every line: as they are known, or estimated, and what is left of every channel by what all the others say.
#
# A latent base motion is told by accelerations and forces together: at a resonance an acceleration's own error, multiplied by
# the dynamic mass, would be a wrong force, and there the forces know better. So that no channel speaks for itself, each is
# predicted from all the others. With the whitened W A = Q R that needs no further solution (Cook & Weisberg, Residuals and
# Influence in Regression, 1982):
#
#     e_c = (y - A u)_c / (1 - h_c),   h_c = |row c of Q|²

ALONE = 1e-9
"""[share] 1 - h of a channel below which no other tells what it does. Exercised by engine/test_likelihood.py."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Left:
    """What a prediction does not explain of one run.

    Attributes
    ----------
    values : (m, j) channels less what the others and the prediction say of them: all, or those that were asked for
    inputs : (m, k) u, by all channels
    gain : (m, j, c) values = gain y; None for known inputs, where it is the identity
    """

    values: ComplexArray
    inputs: ComplexArray
    gain: ComplexArray | None


def left_of_run(
    seen: ObservedLines, rows: ComplexArray, weight: Array, run: int, asked: npt.NDArray[np.bool_] | None = None
) -> Left:
    """Of the run with index `run`, with rows (m, c, k) of it and weights (m, c), in the channels `asked` for (c,), or all.

    Raises
    ------
    CheckFailed : there is a line of which no channel can be told by the others.
    """
    y = seen.values[run]
    some = np.ones(y.shape[1], dtype=bool) if asked is None else asked
    if seen.inputs is not None:
        u = np.asarray(seen.inputs[run])
        return Left(values=(y - (rows @ u[..., None])[..., 0])[:, some], inputs=u, gain=None)
    Q, R = np.linalg.qr(weight[..., None] * rows)
    # (m, c) 1 / (1 - h)
    left = 1 - np.sum(Q.real**2 + Q.imag**2, axis=-1)
    told = left >= ALONE
    if not np.all(told.any(axis=1)):
        line = int(np.argmin(told.any(axis=1)))
        raise CheckFailed(
            f"the {Q.shape[2]} inputs cannot be told without any one of the channels at line {line + 1}, so nothing is known of "
            "them; measure with more channels, or leave that line out"
        )
    to_others = np.divide(1.0, left, out=np.zeros_like(left), where=told)[:, some]  # of one alone nothing is said
    gain = np.asarray(np.eye(y.shape[1])[some] - Q[:, some] @ Q.conj().transpose(0, 2, 1), dtype=np.complex128)
    gain *= (to_others / weight[:, some])[..., None]
    gain *= weight[:, None, :]
    try:
        u = np.linalg.solve(R, Q.conj().transpose(0, 2, 1) @ (weight * y)[..., None])[..., 0]
    except np.linalg.LinAlgError as error:
        raise CheckFailed("the channels do not tell the inputs at some line; leave that line out") from error
    return Left(values=(gain @ y[..., None])[..., 0], inputs=np.asarray(u), gain=gain)


# The root of a covariance whose parameters are of any unit.


def root(covariance: Array) -> Array:
    """(p, p) R with R R^T = `covariance`, whose parameters may stand still.

    It is taken of the correlations: beside a variance in (N/m)², what is known of a position to the micrometre is rounding.
    """
    sd = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    scale = np.where(sd > 0, sd, 1.0)
    values, vectors = np.linalg.eigh(covariance / np.outer(scale, scale))
    return np.asarray(scale[:, None] * vectors * np.sqrt(np.maximum(values, 0.0)))
