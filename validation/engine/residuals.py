"""Residuals line by line, beside the deviation that is to be expected of them.

Where inputs are not known, every channel is held against what all the others say of it, as for the plain error, so that an error
stays in the channel that has it. What is left, e = G y (`validation.engine.inputs`), is expected to scatter by noise, by the
model-error floor, and by the tolerances that were not fitted:

    sigma² = |G|² (noise² + floor²) + sum_k |G (dA/dk) u|² tolerance_k²

the diagonal of J Sigma J^T. A fault shows beyond that; what any careful laboratory has does not.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray
from identification.self_calibration.elimination import smoothed_level
from validation.engine.evaluation import Fit
from validation.engine.fit import FLOOR
from validation.engine.inputs import Left, left_of_run
from validation.engine.likelihood import observed
from validation.engine.prediction import Lines, Offsets, Predicted, Prediction
from validation.engine.problem import Problem


@dataclass(frozen=True, eq=False, kw_only=True)
class Residuals:
    """Of one data set, at the lines that were asked for.

    Attributes
    ----------
    data_set : its name
    frequency : (n,) [Hz]
    values : (r, n, c) complex, measured less predicted, SI
    sigma : (r, n, c) standard deviation to be expected of `values`, E|value|² = sigma²
    level : (r, n, c) smoothed level of the channels
    inputs : (r, n, k) as known or estimated
    """

    data_set: str
    frequency: Array
    values: ComplexArray
    sigma: Array
    level: Array
    inputs: ComplexArray


def residuals(problem: Problem, at: Fit | Offsets, *, floor: float = FLOOR, every_line: bool = True) -> tuple[Residuals, ...]:
    """Of every data set at a fit, or at `offsets` with nothing fitted.

    Parameters
    ----------
    floor : model-error floor relative to the level of a channel
    every_line : of all lines; else of those that fits of `problem` use

    Raises
    ------
    CheckFailed : without some channel the others do not tell latent inputs.
    """
    known = at.by_name if isinstance(at, Fit) else dict(at)
    fitted = set(known) if isinstance(at, Fit) else set()
    loose = {one.name: one.tolerance for one in problem.parameters if one.name not in fitted and 0 < one.tolerance < np.inf}
    offsets = {**problem.start, **known}
    return tuple(
        _of_one(one, offsets, loose, np.arange(len(one.measured.frequency)) if every_line else problem.lines_of(one), floor)
        for one in problem.predictions
    )


def _of_one(one: Prediction, offsets: Offsets, loose: dict[str, float], lines: Lines, floor: float) -> Residuals:
    measured = one.measured
    predicted, seen = one.at(offsets, lines), observed(measured, lines)
    weight = seen.weight(floor, predicted.noise)
    rows = (predicted.rows if predicted.rows.ndim == 3 else predicted.rows[run] for run in range(len(measured.runs)))
    left = [left_of_run(seen, A, weight[run], run) for run, A in enumerate(rows)]
    return Residuals(
        data_set=measured.name,
        frequency=measured.frequency[lines],
        values=np.stack([run.values for run in left]),
        sigma=np.stack([_sigma(run, predicted, weight[k], loose, k) for k, run in enumerate(left)]),
        level=smoothed_level(measured.frequency, measured.values)[:, lines],
        inputs=np.stack([run.inputs for run in left]),
    )


def _sigma(left: Left, predicted: Predicted, weight: Array, loose: dict[str, float], run: int) -> Array:
    """(m, c) of one run."""
    variance = 2 / np.square(weight)  # of both parts of a complex number
    found = variance if left.gain is None else (np.abs(left.gain) ** 2 @ variance[..., None])[..., 0]
    for name, change in predicted.changes.items():
        if name in loose:
            rows = change.rows if change.rows.ndim == 3 else change.rows[run]
            moved = rows @ left.inputs[..., None]
            channels = list(change.channels)
            if left.gain is None:
                found[:, channels] += loose[name] ** 2 * np.abs(moved[..., 0]) ** 2
            else:
                found = found + loose[name] ** 2 * np.abs((left.gain[:, :, channels] @ moved)[..., 0]) ** 2
    return np.asarray(np.sqrt(found))
