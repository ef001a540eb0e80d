"""Whitened residuals of a fitted hypothesis, data set by data set, with the share of every channel that inputs leave free."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray
from identification.self_calibration.elimination import eliminated
from validation.diagnosing.bench import Hypothesis
from validation.engine.fit import FLOOR
from validation.engine.likelihood import Observed, observed
from validation.engine.prediction import Lines, Predicted, Prediction, Wanted


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
    seen: Observed
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


def whitened(of: Hypothesis, *, derivatives: Wanted = False) -> Iterator[Whitened]:
    """Every data set of `of` at the lines of its fit."""
    offsets = {**of.problem.start, **of.fit.by_name}
    for one in of.problem.predictions:
        lines = of.problem.lines_of(one)
        seen, predicted = observed(one.measured, lines), one.at(offsets, lines, derivatives=derivatives)
        yield _whitened(one, lines, seen, predicted)


def _whitened(one: Prediction, lines: Lines, seen: Observed, predicted: Predicted) -> Whitened:
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
