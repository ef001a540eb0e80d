"""Latent inputs eliminated in closed form, and the smoothed level of a channel: what every likelihood of lines needs.

At one line the channels read y = A u + n with inputs u that nobody knows. Whitened by W = diag(1 / sd), W A = Q R, the residual
is what no inputs explain: r = (1 - Q Q^H) W y, u = R^-1 Q^H W y.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from geometry.dynamic_mass import ComplexArray
from geometry.frames import Array

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
