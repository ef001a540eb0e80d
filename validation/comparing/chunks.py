"""A prediction with its tolerances, some lines at a time: what every channel reads, and by how much what was not fitted
may move it.

All tangents of a series on all lines are more than a laptop holds; a chunk of lines is soon done and forgotten.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray
from validation.comparing.doubt import Doubt
from validation.engine import errors
from validation.engine.fit import FLOOR
from validation.engine.likelihood import observed
from validation.engine.prediction import Lines, Offsets, Predicted, Prediction

TOGETHER = 48
"""Lines of a chunk."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Chunk:
    """Some lines of a prediction.

    Attributes
    ----------
    lines : (n,) indices
    rows : (r, n, c, k) what the channels read for a unit of every input
    noise : (r, n, c) standard deviation by noise and model-error floor
    weight : (r, n, c) by which the plain error tells inputs
    spread : (r, n, c, q) what one standard deviation of everything that is not known does to the readings, SI
    """

    lines: Lines
    rows: ComplexArray
    noise: Array
    weight: Array
    spread: ComplexArray


def chunks(prediction: Prediction, offsets: Offsets, inputs: ComplexArray, unknown: Doubt) -> Iterator[Chunk]:
    """The lines of `prediction` at `offsets`, in order.

    Parameters
    ----------
    inputs : (r, n, k) of the runs, which turn a tolerance into a reading
    unknown : what may be otherwise
    """
    measured = prediction.measured
    count = len(measured.frequency)
    for first in range(0, count, TOGETHER):
        lines = np.arange(first, min(first + TOGETHER, count), dtype=np.int64)
        found, u = prediction.at(offsets, lines), inputs[:, lines]
        shape = (len(u), *found.rows.shape[-3:])
        seen = observed(measured, lines)
        weight = seen.weight(FLOOR, found.noise)  # of the real and of the imaginary part
        yield Chunk(
            lines=lines,
            rows=np.broadcast_to(found.rows, shape),
            noise=np.sqrt(2) / weight,
            weight=seen.weight(errors.FLOOR, found.noise),
            spread=_spread(found, u, unknown),
        )


def _spread(found: Predicted, u: ComplexArray, unknown: Doubt) -> ComplexArray:
    """(r, n, c, q + p): tolerances with what the fit made of them, then what the fit itself does not know."""
    tolerances = np.array(list(unknown.tolerances.values()))
    direct = _readings(found, u, tuple(unknown.tolerances)) * tolerances
    of_fit = _readings(found, u, unknown.fitted)
    return np.concatenate([direct + of_fit @ unknown.answer, of_fit @ unknown.own], axis=-1)


def _readings(found: Predicted, u: ComplexArray, names: Sequence[str]) -> ComplexArray:
    """(r, n, c, len(names)) d readings / d offset."""
    readings = np.zeros((*u.shape[:2], found.rows.shape[-2], len(names)), dtype=np.complex128)
    for k, name in enumerate(names):
        change = found.changes.get(name)
        if change is not None:
            readings[:, :, list(change.channels), k] = (change.rows @ u[..., None])[..., 0]
    return readings
