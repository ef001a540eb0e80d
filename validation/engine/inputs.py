"""Inputs at every line: as they are known, or estimated, and what is left of every channel by what all the others say.

A latent base motion is told by accelerations and forces together: at a resonance an acceleration's own error, multiplied by the
dynamic mass, would be a wrong force, and there the forces know better. So that no channel speaks for itself, each is predicted
from all the others. With the whitened W A = Q R that needs no further solution (Cook & Weisberg, Residuals and Influence in
Regression, 1982):

    e_c = (y - A u)_c / (1 - h_c),   h_c = |row c of Q|²
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray
from geometry.errors import CheckFailed
from validation.engine.likelihood import Observed

ALONE = 1e-9
"""1 - h of a channel below which no other tells what it does."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Left:
    """What a prediction does not explain of one run.

    Attributes
    ----------
    values : (m, c) every channel less what the others and the prediction say of it
    inputs : (m, k) u, by all channels
    gain : (m, c, c) values = gain y; None for known inputs, where it is the identity
    """

    values: ComplexArray
    inputs: ComplexArray
    gain: ComplexArray | None


def left_of_run(seen: Observed, rows: ComplexArray, weight: Array, run: int) -> Left:
    """Of the run with index `run`, with rows (m, c, k) of it and weights (m, c).

    Raises
    ------
    CheckFailed : without some channel the others do not tell the inputs.
    """
    y = seen.values[run]
    if seen.inputs is not None:
        u = np.asarray(seen.inputs[run])
        return Left(values=y - (rows @ u[..., None])[..., 0], inputs=u, gain=None)
    Q, R = np.linalg.qr(weight[..., None] * rows)
    to_others = _others(Q)
    whitened = to_others[..., None] * (np.eye(y.shape[1]) - Q @ Q.conj().transpose(0, 2, 1))
    gain = np.asarray(whitened * weight[:, None, :] / weight[:, :, None], dtype=np.complex128)
    return Left(values=(gain @ y[..., None])[..., 0], inputs=_inputs(Q, R, weight * y), gain=gain)


def _others(Q: ComplexArray) -> Array:
    """(m, c) 1 / (1 - h)."""
    left = 1 - np.sum(np.abs(Q) ** 2, axis=-1)
    if np.any(left < ALONE):
        line, channel = np.argwhere(left < ALONE)[0]
        raise CheckFailed(
            f"the {Q.shape[2]} inputs cannot be told without channel {channel + 1} at line {line + 1}, so nothing is "
            "known of it; measure with more channels, or leave that line out"
        )
    return np.asarray(1 / left)


def _inputs(Q: ComplexArray, R: ComplexArray, white: ComplexArray) -> ComplexArray:
    try:
        return np.asarray(np.linalg.solve(R, Q.conj().transpose(0, 2, 1) @ white[..., None]))[..., 0]
    except np.linalg.LinAlgError as error:
        raise CheckFailed("the channels do not tell the inputs at some line; leave that line out") from error
