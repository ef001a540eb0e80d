"""Inputs at every line: as they are known, or estimated from the channels that are not judged, and what is left of the data then.

A base motion is measured by accelerations; forces are then predicted from it and compared. So an error of a force stays in that
force, and none of it is explained away by a motion that nobody measured.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray
from geometry.errors import CheckFailed
from validation.engine.likelihood import Observed


@dataclass(frozen=True, eq=False, kw_only=True)
class Left:
    """What a prediction does not explain of one run.

    Attributes
    ----------
    values : (m, c) y - A u
    inputs : (m, k) u
    gain : (m, c, c) values = gain y; None for known inputs, where it is the identity
    """

    values: ComplexArray
    inputs: ComplexArray
    gain: ComplexArray | None


def left_of_run(seen: Observed, rows: ComplexArray, judged: npt.NDArray[np.bool_], weight: Array, run: int) -> Left:
    """Of the run with index `run`, with rows (m, c, k) of it and weights (m, c).

    Raises
    ------
    CheckFailed : the channels that are not judged do not tell the inputs.
    """
    y = seen.values[run]
    if seen.inputs is not None:
        u = np.asarray(seen.inputs[run])
        return Left(values=y - (rows @ u[..., None])[..., 0], inputs=u, gain=None)
    to_inputs = _inverse(rows[:, ~judged], weight[:, ~judged])
    u = (to_inputs @ y[:, ~judged, None])[..., 0]
    gain = np.zeros((*y.shape, y.shape[1]), dtype=np.complex128)
    gain[:, :, ~judged] = -rows @ to_inputs
    gain += np.eye(y.shape[1])
    return Left(values=y - (rows @ u[..., None])[..., 0], inputs=u, gain=gain)


def _inverse(A: ComplexArray, w: Array) -> ComplexArray:
    """(m, k, s) that gives the inputs of least weighted squares from the s channels that tell them."""
    if A.shape[1] < A.shape[2]:
        raise CheckFailed(
            f"{A.shape[2]} latent inputs cannot be told from {A.shape[1]} channels that are not judged; "
            "judge fewer channels, or state the inputs"
        )
    Q, R = np.linalg.qr(w[..., None] * A)
    try:
        return np.asarray(np.linalg.solve(R, Q.conj().transpose(0, 2, 1) * w[:, None, :]))
    except np.linalg.LinAlgError as error:
        raise CheckFailed("the channels that are not judged do not tell the inputs at some line; leave that line out") from error
