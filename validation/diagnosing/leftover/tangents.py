"""What columns would explain of a leftover, many at once: places times courses over frequency.

At the end of a fit the residual r, whitened and with latent inputs eliminated, is what tolerances and inputs have left over. To
first order the readings deviate from those of the model as drawn by r + J x, x the offsets of the fit, with covariance
1 + J T J^T where nothing is wrong, T the prior variances. Since r = (1 + J T J^T)^-1 (r + J x) at the minimum, a column e that
anything else would add is told from r alone, as in `validation.engine.screening`:

    a = e^T r / (e^T e - e^T J C J^T e),      gain = a e^T r / 2  [nats],      C = (J^T J + T^-1)^-1 .

What tolerances swallowed is counted with what they left; no tolerance needs to be undone. Where the fit stopped short of its
minimum, what its next step would still take, with the gradient g of its whole cost, is counted too: e^T r + e^T J C g.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray
from validation.diagnosing.bench import Hypothesis
from validation.diagnosing.leftover.whitened import Whitened
from validation.engine import likelihood
from validation.engine.cost import cost_of
from validation.engine.fit import FLOOR
from validation.engine.roots import root
from validation.engine.screening import Products

LEAST = 1e-4
"""Share of a column that parameters of the fit must leave; what is left of less is no straight line."""


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


def swallowing(data: Sequence[Whitened], hypothesis: Hypothesis) -> list[Swallowing]:
    """Of all data sets of `hypothesis`, with the parameters of its fit that could move."""
    fit = hypothesis.fit
    at = np.flatnonzero(np.diag(fit.covariance) > 0)
    R, free = root(fit.covariance[np.ix_(at, at)]), tuple(fit.parameters[k] for k in at)
    cost = cost_of(hypothesis.problem, free, FLOOR, fit.by_name)
    away, rows = cost.knowledge(cost.at(fit.by_name))
    acting = [[k for k, one in enumerate(free) if one.name in each.predicted.changes] for each in data]
    names = [tuple(free[k].name for k in some) for some in acting]
    moved = [_moved(one, some) for one, some in zip(data, names, strict=True)]
    gradient = rows.T @ away
    for some, V, one in zip(acting, moved, data, strict=True):
        gradient[some] -= _onto(V, one)
    slope = R.T @ gradient
    found = zip(data, names, moved, acting, strict=True)
    return [Swallowing(of=one, names=mine, moved=V, root=R[some], slope=slope) for one, mine, V, some in found]


def _onto(V: ComplexArray, of: Whitened) -> Array:
    """(p,) J^T r."""
    flat = V.reshape(-1, V.shape[-1])
    return np.asarray((flat.conj().T @ of.values.swapaxes(0, 1).ravel()).real)


def _moved(of: Whitened, names: Sequence[str]) -> ComplexArray:
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
