"""Errors in per cent of what the judged channels read, each predicted from all the others (`validation.engine.inputs`).

Of one line of one run the error is |f - f_predicted| / |f| over the judged channels; of many it is the root of the mean
square. That of one channel is its share, |f_c - f_c predicted| / |f|: squares of the channels add to the square of the whole.
Noise that is known is no error of a model: what it makes of the squares on average is taken off, so that a run that is weakly
driven counts no more than one that is not. Where noise alone explains all, the error is 0.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from geometry.errors import CheckFailed
from validation.engine.descent import BREAKDOWNS
from validation.engine.evaluation import Share
from validation.engine.inputs import Left, left_of_run
from validation.engine.likelihood import observed
from validation.engine.measured import Measured
from validation.engine.prediction import Lines, Offsets, Predicted, Prediction

FLOOR = 0.005
"""Relative error of a channel, beside its noise, in the weights by which latent inputs are estimated: tolerances of the
measurement, of some 0.3 % to 1.5 %, are not fitted here."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Squares:
    """Squares of the relative errors of one run.

    Attributes
    ----------
    data_set, run : whose they are
    channels : (j,) names of the judged ones
    values : (m, j) of every line, less what noise makes of them on average; below zero where it made less
    fold : what was held out when they were predicted; empty for data that were fitted
    """

    data_set: str
    run: str
    channels: tuple[str, ...]
    values: Array
    fold: str = ""


def squares(prediction: Prediction, offsets: Offsets, lines: Lines | None = None, *, fold: str = "") -> list[Squares]:
    """Of every run of `prediction` at `offsets` and `lines` (indices), all by default.

    Raises
    ------
    CheckFailed : without some channel the others do not tell the inputs; the model breaks down.
    """
    measured = prediction.measured
    chosen = np.arange(len(measured.frequency), dtype=np.int64) if lines is None else lines
    predicted = _predicted(prediction, offsets, chosen)
    seen, judged = observed(measured, chosen), measured.judged
    weight, noise, found = seen.weight(FLOOR, predicted.noise), _noise(measured, predicted, chosen), []
    for k, run in enumerate(measured.runs):
        rows = predicted.rows if predicted.rows.ndim == 3 else predicted.rows[k]
        left = left_of_run(seen, rows, weight[k], k)
        level = np.sum(np.abs(seen.values[k][:, judged]) ** 2, axis=1, keepdims=True)
        beyond = np.abs(left.values) ** 2 - _of_noise(left, noise[k])
        values = beyond[:, judged] / np.maximum(level, np.finfo(np.float64).tiny)
        names = tuple(name for name, one in zip(measured.channels, judged, strict=True) if one)
        found.append(Squares(data_set=measured.name, run=run, channels=names, values=values, fold=fold))
    return found


def _noise(measured: Measured, predicted: Predicted, lines: Lines) -> Array:
    """(r, m, c) variance."""
    return np.asarray(np.square(measured.noise[:, lines] if predicted.noise is None else predicted.noise))


def _of_noise(left: Left, variance: Array) -> Array:
    """(m, c) mean square of what `variance` (m, c) leaves in every channel."""
    return variance if left.gain is None else np.asarray(np.abs(left.gain) ** 2 @ variance[..., None])[..., 0]


def _predicted(prediction: Prediction, offsets: Offsets, lines: Lines) -> Predicted:
    try:
        return prediction.at(offsets, lines, derivatives=False)
    except BREAKDOWNS as error:
        raise CheckFailed(f"the model of {prediction.measured.name} breaks down: {error}") from error


def share(found: Sequence[Squares]) -> Share:
    """Squares of several runs as one error."""
    return Share(
        percent=_percent([one.values for one in found]),
        by_channel=_by_channel(found),
        by_run=_grouped((f"{one.data_set}/{one.run}", one.values) for one in found),
        by_data_set=_grouped((one.data_set, one.values) for one in found),
        by_fold=_grouped((one.fold, one.values) for one in found if one.fold),
    )


def _percent(values: Sequence[Array]) -> float:
    """Of squares (m, j) of several runs: channels add, lines and runs are averaged."""
    if not values:
        return 0.0
    return 100 * float(np.sqrt(max(np.mean(np.concatenate([one.sum(axis=1) for one in values])), 0.0)))


def _by_channel(found: Sequence[Squares]) -> dict[str, float]:
    """Over the runs in which each channel is."""
    named = ((name, one.values[:, [k]]) for one in found for k, name in enumerate(one.channels))
    return _grouped(named)


def _grouped(named: Iterable[tuple[str, Array]]) -> dict[str, float]:
    groups: dict[str, list[Array]] = {}
    for name, values in named:
        groups.setdefault(name, []).append(values)
    return {name: _percent(values) for name, values in groups.items()}
