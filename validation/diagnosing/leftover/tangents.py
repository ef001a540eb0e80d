"""What every parameter of a fit can still explain, so that a leftover is told with what tolerances have swallowed of it.

At the end of a fit the residual r, whitened and with latent inputs eliminated, is what tolerances and latent inputs have left over.
To first order the readings deviate from those of the model as drawn by r + J x, x the offsets of the fit, with covariance
1 + J T J^T where nothing is wrong, T the prior variances. Since r = (1 + J T J^T)^-1 (r + J x) at the minimum, a column b that
anything else would add is told from r alone:

    a = b^T r / (b^T b - b^T J C J^T b),      gain = a b^T r / 2  [nats],      C = (J^T J + T^-1)^-1,

the covariance of the fit. What tolerances swallowed is counted with what they left; no tolerance needs to be undone.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray
from validation.diagnosing.leftover.whitened import Whitened
from validation.engine.evaluation import Fit

LEAST = 1e-4
"""Share of a column that parameters of the fit must leave for it to be told from them."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Swallowing:
    """One data set, and the parameters of the fit.

    Attributes
    ----------
    of : the data set
    names : (p,) of the parameters
    moved : (m, r, c, p) what parameters do to the whitened readings, inputs eliminated
    root : (p, p) of their covariance, C = root root^T
    """

    of: Whitened
    names: tuple[str, ...]
    moved: ComplexArray
    root: Array


@dataclass(frozen=True, eq=False, kw_only=True)
class Answers:
    """How a data set answers to columns b.

    Attributes
    ----------
    score : (..., q) b^T r
    own : (..., q) b^T b
    swallowed : (..., q, p) root^T J^T b
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


@dataclass(frozen=True, eq=False, kw_only=True)
class Pattern:
    """Columns of one data set line by line, before it is said how they go with frequency.

    Attributes
    ----------
    omega : (m,) [rad/s]
    score : (m, q) complex, b^H r
    own : (m, q) b^H b
    cross : (m, q, p) complex, b^H J
    root : (p, p)
    """

    omega: Array
    score: ComplexArray
    own: Array
    cross: ComplexArray
    root: Array

    def following(self, courses: ComplexArray) -> Answers:
        """Of the columns times each of `courses` (k, m); with k in front of every shape."""
        m, q, p = self.cross.shape
        turned = courses.conj()
        parts = np.concatenate([turned.real, -turned.imag], axis=1)  # the real part of a product, as one real product
        cross = parts @ np.concatenate([self.cross.real, self.cross.imag]).reshape(2 * m, q * p)
        return Answers(
            score=(turned @ self.score).real,
            own=np.abs(courses) ** 2 @ self.own,
            swallowed=cross.reshape(len(courses), q, p) @ self.root,
        )


def swallowing(data: Sequence[Whitened], fit: Fit) -> list[Swallowing]:
    """Of all data sets, with the parameters of `fit` that could move."""
    at = np.flatnonzero(np.diag(fit.covariance) > 0)
    values, vectors = np.linalg.eigh(fit.covariance[np.ix_(at, at)])
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    names = tuple(fit.parameters[k].name for k in at)
    return [Swallowing(of=one, names=names, moved=_moved(one, names), root=root) for one in data]


def _moved(of: Whitened, names: Sequence[str]) -> ComplexArray:
    r, m, c = of.values.shape
    V = np.zeros((m, r, c, len(names)), dtype=np.complex128)
    for k, name in enumerate(names):
        change = of.predicted.changes.get(name)
        if change is not None:
            moved = (change.rows @ of.inputs[..., None])[..., 0]
            V[:, :, change.channels, k] = moved.swapaxes(0, 1)
    V *= of.weight.swapaxes(0, 1)[..., None]
    if of.basis is not None:
        Q = of.basis.swapaxes(0, 1)
        V -= Q @ (Q.conj().swapaxes(-1, -2) @ V)
    return V


def pattern(of: Swallowing, readings: ComplexArray, channels: npt.NDArray[np.int64]) -> Pattern:
    """Of changes of the readings (r, m, c', q), SI, of the `channels` (c',) alone."""
    at, white = of.of, readings * of.of.weight[:, :, channels, None]
    b = white.transpose(1, 3, 0, 2)  # (m, q, r, c')
    m, q = b.shape[:2]
    flat = b.conj().reshape(m, q, -1)
    r = at.values[:, :, channels].transpose(1, 0, 2).reshape(m, -1, 1)
    V = of.moved[:, :, channels].reshape(m, flat.shape[2], -1)
    return Pattern(
        omega=2 * np.pi * at.frequency,
        score=(flat @ r)[..., 0],
        own=np.sum(np.abs(at.kept(white, channels)) ** 2, axis=(0, 2)),
        cross=np.asarray(flat @ V),
        root=of.root,
    )


def gains(answers: Sequence[Answers]) -> Gains:
    """Of the same columns with one coefficient in several data sets."""
    score, own = sum(one.score for one in answers), sum(one.own for one in answers)
    swallowed = sum(one.swallowed for one in answers)
    told = own - np.sum(np.square(swallowed), axis=-1)
    sure = told > LEAST * own
    size = np.where(sure, score / np.where(sure, told, 1.0), 0.0)
    return Gains(gain=0.5 * size * score, size=size)
