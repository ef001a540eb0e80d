"""The likelihood of one data set, whatever it is of: known or latent inputs, rows that runs share or not.

At one line of one run y = A u + n. Where the inputs u are latent they are eliminated in closed form
(`identification.self_calibration.solve`), and the derivative of the residual r = (1 - Q Q^H) W y is that of Kaufman (BIT
15, 1975), dr = -(1 - Q Q^H) W (dA) u, whose gradient is exact. Where they are known r = W (y - A u) and dr = -W (dA) u.

Noise is that of the data and a model-error floor that is proportional to the smoothed level of each channel; E|noise|² = sd² is
shared by real and imaginary part. "The likelihood" of the catalogue of effects.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from geometry.dynamic_mass import ComplexArray
from geometry.frames import Array, Integers
from identification.self_calibration.solve import (
    SILENT,
    Normal,
    as_real,
    eliminated,
    level_of_groups,
    normal_equations,
    smoothed_level,
)
from validation.estimation.problem import Change, Conveyed, Lines, Measured, Predicted

# Normal equations of one run where most parameters are seen through the same few quantities, and most others in one channel.
#
# With the inputs' directions Q, the whitened rows W T of what the channels read of these j quantities, and (1 - Q Q^H) W T = O
# R, a parameter that moves the quantities by z moves the residual by O R z: of j numbers a line instead of one for every
# channel. What is left of another's V beside the inputs meets it in O^H V alone,
#
#     y = R z:    y^H y ,      y^H (O^H V) ,      V^H V - (Q^H V)^H (Q^H V) ,
#
# and of the last the products of parameters of different channels are those of Q^H V.


FEW = 24
"""[count] of parameters of several channels that go no common way up to which it is the quicker. Exercised by
tests/validation/engine/test_conveying.py."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Ways:
    """The parameters of one prediction by how channels see them, each by index.

    Attributes
    ----------
    count : of all parameters
    channels : (l,) that see the quantities
    through : (m, l, j)
    common : (a,) parameters that move the quantities
    quantities : (m, a, j, k)
    single : (b,) parameters that move one channel
    at : (b,) that channel
    rows : (b, m, k)
    others : (d,) all others
    whole : (d, m, c, k) their rows, zeros where they change nothing
    """

    count: int
    channels: Integers
    through: ComplexArray
    common: Integers
    quantities: ComplexArray
    single: Integers
    at: Integers
    rows: ComplexArray
    others: Integers
    whole: ComplexArray


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


def normal(of: Ways, r: ComplexArray, Q: ComplexArray | None, u: ComplexArray, w: Array) -> Normal:
    """Of one run, from its residual (m, c), the directions (m, c, k) of its inputs, these (m, k), and weights (m, c)."""
    O, R = _directions_beside_inputs(of, Q, w)
    y = _conveyed(of, u) @ R.transpose(0, 2, 1)
    single = w[:, of.at].T * np.sum(of.rows * u, axis=-1)
    whole = w * (of.whole @ u[..., None])[..., 0]
    met = np.concatenate([_met(O, single, of.at), _met_by_all(O, whole)])
    matrix, gradient = np.empty((of.count, of.count)), np.empty(of.count)
    common, rest = as_real(y.transpose(1, 0, 2)), as_real(met)
    apart = np.concatenate([of.single, of.others])
    matrix[np.ix_(of.common, of.common)] = common @ common.T
    matrix[np.ix_(of.common, apart)] = both = common @ rest.T
    matrix[np.ix_(apart, of.common)] = both.T
    # (b + d, b + d) the products of the parameters that go no common way
    b = len(single)
    apart_matrix = np.zeros((b + len(whole), b + len(whole)))
    one = as_real(single)
    apart_matrix[:b, :b] = (one @ one.T) * (of.at[:, None] == of.at)
    if len(whole):
        flat = as_real(whole)
        apart_matrix[b:, b:] = flat @ flat.T
        apart_matrix[b:, :b] = np.sum((whole[:, :, of.at].transpose(0, 2, 1).conj() * single).real, axis=-1)
        apart_matrix[:b, b:] = apart_matrix[b:, :b].T
    if Q is not None:
        along = as_real(np.concatenate([_met(Q, single, of.at), _met_by_all(Q, whole)]))
        apart_matrix -= along @ along.T
    matrix[np.ix_(apart, apart)] = apart_matrix
    gradient[of.common] = -(common @ as_real((O.conj().transpose(0, 2, 1) @ r[..., None])[None, ..., 0])[0])
    gradient[of.single] = -np.sum((single.conj() * r.T[of.at]).real, axis=1)
    gradient[of.others] = -np.sum((whole.conj() * r).real, axis=(1, 2))
    return Normal(cost=0.5 * float(np.sum(np.square(np.abs(r)))), gradient=gradient, matrix=matrix)


def _directions_beside_inputs(of: Ways, Q: ComplexArray | None, w: Array) -> tuple[ComplexArray, ComplexArray]:
    """O (m, c, j) and R (m, j, j)."""
    T = np.zeros((*w.shape, of.through.shape[2]), dtype=np.complex128)
    T[:, of.channels] = w[:, of.channels, None] * of.through
    O, R = np.linalg.qr(T if Q is None else T - Q @ (Q.conj().transpose(0, 2, 1) @ T))
    return np.asarray(O), np.asarray(R)


def _conveyed(of: Ways, u: ComplexArray) -> ComplexArray:
    """(m, a, j) what the common parameters move the quantities by."""
    m, a, j, k = of.quantities.shape
    return np.asarray((of.quantities.reshape(m, a * j, k) @ u[..., None]).reshape(m, a, j))


def _met(directions: ComplexArray, single: ComplexArray, at: Integers) -> ComplexArray:
    """(b, m, q) directions (m, c, q) met by what is in the one channel `at` of each."""
    return np.asarray(directions.conj().transpose(1, 0, 2)[at] * single[..., None])


def _met_by_all(directions: ComplexArray, whole: ComplexArray) -> ComplexArray:
    """(d, m, q) the same of what is in all channels (d, m, c)."""
    return np.asarray((whole.transpose(1, 0, 2) @ directions.conj()).transpose(1, 0, 2))


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
    """

    runs: tuple[str, ...]
    values: ComplexArray
    noise: Array
    floor: Array
    inputs: ComplexArray | None

    def weight(self, floor: float, noise: Array | None = None) -> Array:
        """(r, m, c) one over the standard deviation of each of real and imaginary part; `noise` in place of the data's own."""
        variance = np.square(self.noise if noise is None else noise) + np.square(floor * self.floor)
        return np.asarray(np.sqrt(2 / np.maximum(variance, np.finfo(np.float64).tiny)))


def observed(measured: Measured, lines: Lines) -> ObservedLines:
    """`measured` at `lines` (indices)."""
    return ObservedLines(
        runs=measured.runs,
        values=measured.values[:, lines],
        noise=measured.noise[:, lines],
        floor=floor_of(measured)[:, lines],
        inputs=None if measured.inputs is None else measured.inputs[:, lines],
    )


def floor_of(measured: Measured) -> Array:
    """(r, n, c) the level that a model-error floor is relative to.

    Of a channel that is nearly silent in a run it is `SILENT` of what channels read that are judged, or not judged, as it is.
    """
    level = smoothed_level(measured.frequency, measured.values)
    return np.asarray(np.hypot(level, SILENT * level_of_groups(measured.values, measured.judged)))


def size(measured: Measured, predicted: Predicted, lines: int) -> int:
    """Real numbers that are left of a data set when latent inputs are taken out."""
    runs, channels, inputs = len(measured.runs), len(measured.channels), predicted.rows.shape[-1]
    return 2 * runs * lines * (channels - (inputs if measured.inputs is None else 0))


def normals(seen: ObservedLines, predicted: Predicted, free: Sequence[str], floor: float) -> dict[str, Normal]:
    """By run the normal equations in the parameters `free`; those that do not act here have no rows."""
    own = [name for name in free if name in predicted.changes]
    weight = seen.weight(floor, predicted.noise)
    at = np.array([k for k, name in enumerate(free) if name in predicted.changes], dtype=np.int64)
    common, found = ways(predicted.changes, own, seen.values.shape[2]), {}
    for run, name in enumerate(seen.runs):
        r, Q, u = _residual(_of_run(predicted.rows, run), seen, weight, run)
        if common is None:
            one = normal_equations(r, Q, _moved(predicted, own, run, u, weight[run]))
        else:
            one = normal(common, r, Q, u, weight[run])
        found[name] = _spread(one, at, len(free))
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


def _of_run(rows: ComplexArray, run: int) -> ComplexArray:
    return rows if rows.ndim == 3 else np.asarray(rows[run])


def _residual(
    A: ComplexArray, seen: ObservedLines, weight: Array, run: int
) -> tuple[ComplexArray, ComplexArray | None, ComplexArray]:
    """Whitened residual (m, c), Q (m, c, k) of what was eliminated, and inputs (m, k) of one run."""
    y, w = seen.values[run], weight[run]
    if seen.inputs is None:
        return eliminated(A, y, w)
    u = seen.inputs[run]
    return np.asarray(w * (y - (A @ u[..., None])[..., 0])), None, np.asarray(u)


def _moved(predicted: Predicted, names: Sequence[str], run: int, u: ComplexArray, w: Array) -> ComplexArray:
    """(p, m, c) W (dA) u of one run."""
    V = np.zeros((len(names), *w.shape), dtype=np.complex128)
    for k, name in enumerate(names):
        change = predicted.changes[name]
        V[k][:, change.channels] = (_of_run(change.rows, run) @ u[..., None])[..., 0]
    V *= w
    return V


def _spread(own: Normal, at: Lines, count: int) -> Normal:
    """`own` in a vector of `count` parameters of which it knows those `at`."""
    gradient, matrix = np.zeros(count), np.zeros((count, count))
    gradient[at] = own.gradient
    matrix[np.ix_(at, at)] = own.matrix
    return Normal(cost=own.cost, gradient=gradient, matrix=matrix)
