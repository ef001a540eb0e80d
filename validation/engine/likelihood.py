"""The likelihood of one data set, whatever it is of: known or latent inputs, rows that runs share or not.

At one line of one run y = A u + n. Where the inputs u are latent they are eliminated in closed form
(`identification.self_calibration.elimination`), and the derivative of the residual r = (1 - Q Q^H) W y is that of Kaufman (BIT
15, 1975), dr = -(1 - Q Q^H) W (dA) u, whose gradient is exact. Where they are known r = W (y - A u) and dr = -W (dA) u.

Noise is that of the data and a model-error floor that is proportional to the smoothed level of each channel; E|noise|² = sd² is
shared by real and imaginary part. "The likelihood" of the catalogue of effects.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray
from identification.self_calibration.elimination import SILENT, Normal, eliminated, level_of_groups, smoothed_level
from validation.engine.conveying import as_real, normal, ways
from validation.engine.measured import Measured
from validation.engine.prediction import Lines, Predicted


@dataclass(frozen=True, eq=False, kw_only=True)
class Observed:
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


def observed(measured: Measured, lines: Lines) -> Observed:
    """`measured` at `lines` (indices)."""
    return Observed(
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


def normals(seen: Observed, predicted: Predicted, free: Sequence[str], floor: float) -> dict[str, Normal]:
    """By run the normal equations in the parameters `free`; those that do not act here have no rows."""
    own = [name for name in free if name in predicted.changes]
    weight = seen.weight(floor, predicted.noise)
    at = np.array([k for k, name in enumerate(free) if name in predicted.changes], dtype=np.int64)
    common, found = ways(predicted.changes, own, seen.values.shape[2]), {}
    for run, name in enumerate(seen.runs):
        r, Q, u = _residual(_of_run(predicted.rows, run), seen, weight, run)
        if common is None:
            one = _normal(r, Q, _moved(predicted, own, run, u, weight[run]))
        else:
            one = normal(common, r, Q, u, weight[run])
        found[name] = _spread(one, at, len(free))
    return found


def whitened(
    seen: Observed, predicted: Predicted, names: Sequence[str], floor: float, run: int
) -> tuple[ComplexArray, ComplexArray]:
    """Residual (m, c) of one run, and minus its derivatives (m, c, p) by the offsets of `names`, inputs eliminated from both."""
    weight = seen.weight(floor, predicted.noise)
    r, Q, u = _residual(_of_run(predicted.rows, run), seen, weight, run)
    return r, _beside_inputs(Q, np.ascontiguousarray(_moved(predicted, names, run, u, weight[run]).transpose(1, 2, 0)))


def residual(seen: Observed, predicted: Predicted, floor: float) -> ComplexArray:
    """(r, m, c) whitened residuals."""
    weight = seen.weight(floor, predicted.noise)
    rows = (_of_run(predicted.rows, run) for run in range(len(seen.runs)))
    return np.stack([_residual(A, seen, weight, run)[0] for run, A in enumerate(rows)])


def _of_run(rows: ComplexArray, run: int) -> ComplexArray:
    return rows if rows.ndim == 3 else np.asarray(rows[run])


def _residual(A: ComplexArray, seen: Observed, weight: Array, run: int) -> tuple[ComplexArray, ComplexArray | None, ComplexArray]:
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


def _beside_inputs(Q: ComplexArray | None, V: ComplexArray) -> ComplexArray:
    return V if Q is None else V - Q @ (Q.conj().transpose(0, 2, 1) @ V)


def _normal(r: ComplexArray, Q: ComplexArray | None, V: ComplexArray) -> Normal:
    """Of one run, from its residual (m, c), from which inputs are eliminated, and V (p, m, c), from which they are not yet.

    V^H (1 - Q Q^H) V = V^H V - (Q^H V)^H (Q^H V), and Q^H r = 0: nothing as large as V needs to be made again.
    """
    flat, left = as_real(V), np.ascontiguousarray(r).ravel().view(np.float64)
    matrix = flat @ flat.T
    if Q is not None:
        along = as_real((V.transpose(1, 0, 2) @ Q.conj()).transpose(1, 0, 2))
        matrix -= along @ along.T
    return Normal(cost=0.5 * float(left @ left), gradient=-(flat @ left), matrix=matrix)


def _spread(own: Normal, at: Lines, count: int) -> Normal:
    """`own` in a vector of `count` parameters of which it knows those `at`."""
    gradient, matrix = np.zeros(count), np.zeros((count, count))
    gradient[at] = own.gradient
    matrix[np.ix_(at, at)] = own.matrix
    return Normal(cost=own.cost, gradient=gradient, matrix=matrix)


def total(found: Collection[Normal], count: int) -> Normal:
    """Several normal equations in `count` parameters as one."""
    gradient, matrix = np.zeros(count), np.zeros((count, count))
    for one in found:
        gradient += one.gradient
        matrix += one.matrix
    return Normal(cost=sum(one.cost for one in found), gradient=gradient, matrix=matrix)
