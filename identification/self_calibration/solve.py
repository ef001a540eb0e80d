"""Least squares of lines with latent inputs: inputs eliminated, normal equations, Levenberg-Marquardt with priors.

At one line the channels read y = A u + n with inputs u that nobody knows. Whitened by W = diag(1 / sd), W A = Q R, the residual
is what no inputs explain: r = (1 - Q Q^H) W y, u = R^-1 Q^H W y. With V = W (dA) u its derivative is -(1 - Q Q^H) V.

Data and priors add: cost, gradient and matrix of every campaign, and half the square of whitened knowledge. The damped equations
are scaled by the diagonal of the matrix (Marquardt 1963), so units do not matter. The iteration ends when the Newton decrement
sqrt(g^T N^-1 g) - how many standard deviations the step still is - falls below `CLOSE`. Where parameters have bounds, every step
is that of the quadratic model within them, so that what stops at a bound is made up for by the others at once.
"""

from collections.abc import Callable, Collection
from dataclasses import dataclass
from math import prod
from typing import Any

import numpy as np
import numpy.typing as npt

from geometry.dynamic_mass import ComplexArray
from geometry.frames import Array, Integers

SMOOTHED = 0.2
"""[Hz] to either side over which the level of a channel is averaged."""

SILENT = 1 / 15
"""Share of what channels of its quantity read at which a channel counts as silent: its floor falls no lower. With the model-error
floor of 0.15 % that is 1e-4 of them; a channel that reads nothing would otherwise be trusted without bound."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Normal:
    """Half the sum of squares of residuals, its gradient (k,) and J^T J (k, k)."""

    cost: float
    gradient: Array
    matrix: Array

    def beside(self, away: Array, rows: Array) -> "Normal":
        """The same and residuals `away` (q,) of derivatives `rows` (q, k)."""
        cost = self.cost + 0.5 * float(away @ away)
        return Normal(cost=cost, gradient=self.gradient + rows.T @ away, matrix=self.matrix + rows.T @ rows)


def eliminated(A: ComplexArray, y: ComplexArray, w: Array) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
    """Whitened residual (n, c), Q (n, c, k) and inputs (n, k) of A (n, c, k), y (n, c) and w (n, c), one over the deviation.

    Raises
    ------
    numpy.linalg.LinAlgError : the channels do not tell the inputs at a line.
    """
    Q, R = np.linalg.qr(w[..., None] * A)
    white = (w * y)[..., None]
    b = Q.conj().transpose(0, 2, 1) @ white
    return np.asarray(white - Q @ b)[..., 0], np.asarray(Q), np.asarray(np.linalg.solve(R, b))[..., 0]


def as_real(V: ComplexArray) -> Array:
    """(p, ...) complex as (p, 2 ...) real."""
    return np.asarray(np.ascontiguousarray(V).reshape(len(V), prod(V.shape[1:])).view(np.float64))


def normal_equations(r: ComplexArray, Q: ComplexArray | None, V: ComplexArray) -> Normal:
    """Of one run, from its residual (m, c), from which inputs are eliminated, and V (p, m, c), from which they are not yet.

    V^H (1 - Q Q^H) V = V^H V - (Q^H V)^H (Q^H V), and Q^H r = 0: nothing as large as V needs to be made again.
    """
    flat, left = as_real(V), np.ascontiguousarray(r).ravel().view(np.float64)
    matrix = flat @ flat.T
    if Q is not None:
        along = as_real((V.transpose(1, 0, 2) @ Q.conj()).transpose(1, 0, 2))
        matrix -= along @ along.T
    return Normal(cost=0.5 * float(left @ left), gradient=-(flat @ left), matrix=matrix)


# Normal equations of one run where most parameters are seen through the same few quantities, and most others in one channel.
#
# With the inputs' directions Q and whitened rows W T of what the channels read of these j quantities, B = (1 - Q Q^H) W T, a
# parameter that moves the quantities by z moves the residual by B z: of j numbers a line instead of one for every channel. What
# is left of another's V beside the inputs meets it in B^H V alone,
#
#     z^H (B^H B) z ,      z^H (B^H V) ,      V^H V - (Q^H V)^H (Q^H V) ,
#
# and of the last the products of parameters of different channels are those of Q^H V.


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


def normal_by_ways(of: Ways, r: ComplexArray, Q: ComplexArray | None, u: ComplexArray, w: Array) -> Normal:
    """Of one run, from its residual (m, c), the directions (m, c, k) of its inputs, these (m, k), and weights (m, c)."""
    # B (m, c, j), what the quantities do beside the inputs, and z (m, a, j), what the common parameters move them by
    T = np.zeros((*w.shape, of.through.shape[2]), dtype=np.complex128)
    T[:, of.channels] = w[:, of.channels, None] * of.through
    B = T if Q is None else T - Q @ (Q.conj().transpose(0, 2, 1) @ T)
    m, a, j, k = of.quantities.shape
    z = (of.quantities.reshape(m, a * j, k) @ u[..., None]).reshape(m, a, j)
    single = w[:, of.at].T * np.einsum("bmk,mk->bm", of.rows, u)
    whole = w * (of.whole @ u[..., None])[..., 0]
    met = np.concatenate([_met(B, single, of.at), _met_by_all(B, whole)])
    matrix, gradient = np.empty((of.count, of.count)), np.empty(of.count)
    across = z @ (B.conj().transpose(0, 2, 1) @ B).transpose(0, 2, 1)
    common, rest = as_real(z.transpose(1, 0, 2)), as_real(met)
    apart = np.concatenate([of.single, of.others])
    matrix[np.ix_(of.common, of.common)] = common @ as_real(across.transpose(1, 0, 2)).T
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
        for channel in np.unique(of.at):
            own = np.flatnonzero(of.at == channel)
            apart_matrix[b:, own] = as_real(whole[:, :, channel]) @ one[own].T
        apart_matrix[:b, b:] = apart_matrix[b:, :b].T
    if Q is not None:
        along = as_real(np.concatenate([_met(Q, single, of.at), _met_by_all(Q, whole)]))
        apart_matrix -= along @ along.T
    matrix[np.ix_(apart, apart)] = apart_matrix
    gradient[of.common] = -(common @ as_real((B.conj().transpose(0, 2, 1) @ r[..., None])[None, ..., 0])[0])
    gradient[of.single] = -np.sum((single.conj() * r.T[of.at]).real, axis=1)
    gradient[of.others] = -np.sum((whole.conj() * r).real, axis=(1, 2))
    return Normal(cost=0.5 * float(np.sum(np.square(np.abs(r)))), gradient=gradient, matrix=matrix)


def _met(directions: ComplexArray, single: ComplexArray, at: Integers) -> ComplexArray:
    """(b, m, q) directions (m, c, q) met by what is in the one channel `at` of each."""
    return np.asarray(directions.conj().transpose(1, 0, 2)[at] * single[..., None])


def _met_by_all(directions: ComplexArray, whole: ComplexArray) -> ComplexArray:
    """(d, m, q) the same of what is in all channels (d, m, c)."""
    return np.asarray((whole.transpose(1, 0, 2) @ directions.conj()).transpose(1, 0, 2))


def total(found: Collection[Normal], count: int) -> Normal:
    """Several normal equations in `count` parameters as one."""
    gradient, matrix = np.zeros(count), np.zeros((count, count))
    for one in found:
        gradient += one.gradient
        matrix += one.matrix
    return Normal(cost=sum(one.cost for one in found), gradient=gradient, matrix=matrix)


def smoothed_level(frequency: Array, values: ComplexArray) -> Array:
    """(r, n, c) root mean square of `values` (r, n, c) over the lines of `frequency` (n,) within `SMOOTHED` of each line."""
    power = np.cumsum(np.square(np.abs(values)), axis=1)
    power = np.concatenate([np.zeros_like(power[:, :1]), power], axis=1)
    low = np.searchsorted(frequency, frequency - SMOOTHED * (1 + 1e-9))
    high = np.searchsorted(frequency, frequency + SMOOTHED * (1 + 1e-9), side="right")
    return np.asarray(np.sqrt((power[:, high] - power[:, low]) / (high - low)[:, None]))


def level_of_groups(values: ComplexArray, groups: npt.NDArray[Any]) -> Array:
    """(c,) what channels of the group (c,) of each channel read: the median of their rms over the runs, at the median line."""
    by_channel = np.median(np.sqrt(np.mean(np.square(np.abs(values)), axis=0)), axis=0)
    return np.array([np.median(by_channel[groups == one]) for one in groups])


CLOSE = 0.1
"""Standard deviations that the step may be which is taken last, unseen: it leaves less."""

NOTHING = 0.3
"""Gain in cost of an accepted step below which the fit is no better: three quarters of a standard deviation."""

EVERYTHING = slice(None)

MOST = 60
"""Evaluations before the iteration is given up."""

HOPE = 10.0
"""Times what the quadratic model still expects, or what the last step gained, that a fit gains along the worst valley seen.
Exercised by self_calibration/test_likelihood.py."""

LEAST, HOPELESS = 1e-6, 1e12
"""Damping with which the iteration begins, and with which it is given up."""

TINY = float(np.finfo(np.float64).tiny)

WORTH_IT = 1e-4
"""Share of the expected gain from which a step is taken."""

Knowledge = Callable[[Array], tuple[Array, Array]]
"""Whitened residuals (p,) at x (k,), and their derivatives (p, k)."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Solution:
    """Where the iteration ended.

    Attributes
    ----------
    x : (k,)
    seen : (k,) where it was evaluated last; `x` may be one short step further
    normal : data and priors together, at `seen`
    data : of the data alone
    converged : whether it ended by itself
    decrement : length of the next step [standard deviations]
    evaluations : of the normal equations
    """

    x: Array
    seen: Array
    normal: Normal
    data: Normal
    converged: bool
    decrement: float
    evaluations: int

    def beyond_hope(self, worth: float) -> bool:
        """Whether `HOPE` times what the quadratic model expects still leaves it above a cost of `worth`."""
        return self.normal.cost - 0.5 * HOPE * self.decrement**2 > worth


def minimise(
    data: Callable[[Array], Normal],
    start: Array,
    knowledge: Knowledge,
    *,
    close: float = CLOSE,
    most: int = MOST,
    size: int = 0,
    asked: slice = EVERYTHING,
    bounds: tuple[Array, Array] | None = None,
    progress: Callable[[float], None] | None = None,
    cost: Callable[[Array], float] | None = None,
    worth: float = np.inf,
) -> Solution:
    """The minimum of the cost of `data` and of half the square of the whitened `knowledge`, from `start` (k,).

    `bounds` are the least and the greatest x (k,), between which `start` lies; none by default.
    Where the data, of `size` real numbers, do not fit, standard deviations are larger than they are stated, and so is `close`.
    `cost` is that of `data` alone to the last digit, where it is made sooner than the equations: once a step was refused, others
    are asked for it first until one is taken, and the equations of those that are refused are never made.
    `worth` is the total cost that the minimum must lie below: it is given up once steps gain next to nothing, or a `HOPE`-th of
    the way there, and the quadratic model promises as little.
    Once steps gain next to nothing, only the parameters `asked` for count: others may creep in a valley where they say the same.
    """
    room = bounds or (np.full(len(start), -np.inf), np.full(len(start), np.inf))
    here = _place(data(start), start, knowledge, room)
    damping, growth, evaluation, gained, refused = LEAST, 4.0, 1, np.inf, False

    def lies_too_high(x: Array, expected: float) -> bool:
        left, _ = knowledge(x)
        return cost is not None and not here.total.cost - (cost(x) + 0.5 * float(left @ left)) > WORTH_IT * expected

    while evaluation < most and damping < HOPELESS:
        if progress is not None:
            progress(min(evaluation / 15, 0.99))
        if here.decrement < close * excess(here.data, size):
            return _solution(here, here.x + here.step(0.0), True, evaluation)
        if gained < NOTHING and here.length(asked) < close * excess(here.data, size):
            return _solution(here, here.x, True, evaluation)
        idle = gained < NOTHING or HOPE * gained < here.total.cost - worth
        if idle and (given_up := _solution(here, here.x, False, evaluation)).beyond_hope(worth):
            return given_up
        step = here.step(damping)
        evaluation += 1
        try:
            if refused and lies_too_high(here.x + step, here.expected(step)):
                there = None
            else:
                found = data(here.x + step)
                there = _place(found, here.x + step, knowledge, room) if np.isfinite(found.cost) else None
        except (np.linalg.LinAlgError, ValueError, FloatingPointError):  # the model breaks down there
            there = None
        ratio = -1.0 if there is None else (here.total.cost - there.total.cost) / here.expected(step)
        if there is not None and ratio > WORTH_IT:
            gained = here.total.cost - there.total.cost
            here, damping, growth, refused = there, damping * max(0.02, 1 - (2 * ratio - 1) ** 3), 4.0, False
        else:
            damping, growth, refused = max(damping, LEAST) * growth, 2 * growth, True
    return _solution(here, here.x, False, evaluation)


@dataclass(frozen=True, eq=False, kw_only=True)
class _Place:
    """The cost to second order at x, factorised once for whatever damping: total matrix = S^-1 V diag(values) V^T S^-1."""

    x: Array
    data: Normal
    total: Normal
    scale: Array
    values: Array
    vectors: Array
    room: tuple[Array, Array]

    def step(self, damping: float) -> Array:
        """The damped step (k,), within the bounds."""
        turned = self.vectors.T @ (self.scale * self.total.gradient)
        step = np.asarray(-self.scale * (self.vectors @ (turned / (self.values + damping))))
        low, high = self.room[0] - self.x, self.room[1] - self.x
        return step if np.all((step >= low) & (step <= high)) else self._stopped(damping, low, high)

    def _stopped(self, damping: float, low: Array, high: Array) -> Array:
        """The damped step (k,) that lies between `low` and `high` (k,) and gains most: linear least squares with bounds.

        What would leave its bounds stops at them until nothing does; then the one that its bound holds back most is let go, again
        and again, while there is one (Stark & Parker, Bounded-Variable Least-Squares, Computational Statistics 10, 1995).
        """
        N = (self.vectors * (self.values + damping)) @ self.vectors.T
        force, walls = self.scale * self.total.gradient, np.array([low, high]) / self.scale
        step, free, settled = np.zeros(len(low)), np.ones(len(low), dtype=bool), False
        for _ in range(4 * len(low)):
            wanted = step.copy()
            wanted[free] -= np.linalg.solve(N[np.ix_(free, free)], (force + N @ step)[free])
            there = np.clip(wanted, *walls)
            beyond = free & (there != wanted)
            if not beyond.any():
                step, settled = wanted, True
                slope = force + N @ step
                # Above 0 where it would rather go back
                held = np.where(free | (low == high), 0.0, np.where(step >= walls[1], slope, -slope))
                if held.max() <= len(low) * np.finfo(np.float64).eps * np.abs(force).max():
                    break
                free[np.argmax(held)] = True
            elif settled:  # up to the bound that is met first
                share = np.where(beyond, (there - step) / np.where(beyond, wanted - step, 1.0), np.inf)
                step = np.clip(step + share.min() * (wanted - step), *walls)
                free &= share > share.min()
                step[~free] = np.where(np.abs(step - walls[0]) < np.abs(step - walls[1]), *walls)[~free]
            else:
                step, free = np.where(beyond, there, step), free & ~beyond
        return np.asarray(np.clip(self.scale * step, low, high))

    def expected(self, step: Array) -> float:
        """What the quadratic model says that `step` gains."""
        return -float(self.total.gradient @ step) - 0.5 * float(step @ self.total.matrix @ step)

    def length(self, of: slice) -> float:
        """Of the undamped step in the parameters `of`, in their own standard deviations with all others free."""
        root = self.scale[of, None] * self.vectors[of] / np.sqrt(self.values)
        step, C = self.step(0.0)[of], root @ root.T
        unit = np.sqrt(np.diag(C))
        return float(np.sqrt(step / unit @ np.linalg.solve(C / np.outer(unit, unit), step / unit)))

    @property
    def decrement(self) -> float:
        """Length of the undamped step [standard deviations]."""
        return float(np.sqrt(max(2 * self.expected(self.step(0.0)), 0.0)))


def _place(data: Normal, x: Array, knowledge: Knowledge, room: tuple[Array, Array]) -> _Place:
    total = data.beside(*knowledge(x))
    scale, values, vectors = _factorised(total.matrix)
    return _Place(x=x, data=data, total=total, scale=scale, values=values, vectors=vectors, room=room)


def _solution(at: _Place, x: Array, converged: bool, evaluations: int) -> Solution:
    decrement = at.decrement
    return Solution(
        x=x, seen=at.x, normal=at.total, data=at.data, converged=converged, decrement=decrement, evaluations=evaluations
    )


def inverse(matrix: Array) -> Array:
    """The inverse of a symmetric positive matrix whose units differ; directions that nothing determines get a huge variance."""
    scale, values, vectors = _factorised(matrix)
    return np.asarray(scale[:, None] * ((vectors / values) @ vectors.T) * scale)


def _factorised(matrix: Array) -> tuple[Array, Array, Array]:
    """Scale (k,) that brings the diagonal to 1, eigenvalues (k,) and -vectors (k, k) of what is scaled; none below rounding."""
    scale = 1 / np.sqrt(np.maximum(np.abs(np.diag(matrix)), TINY))  # rounding may leave one below zero
    values, vectors = np.linalg.eigh(scale[:, None] * matrix * scale)
    return scale, np.maximum(values, values[-1] * len(matrix) * np.finfo(np.float64).eps), vectors


def excess(data: Normal, size: int) -> float:
    """How many times the residuals of so many numbers exceed what they should be, at least 1."""
    return max(1.0, float(np.sqrt(2 * data.cost / size))) if size else 1.0
