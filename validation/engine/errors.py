"""Errors in per cent of what the judged channels read, inputs estimated from the others (`validation.engine.inputs`).

Of one line of one run the error is |f - f_predicted| / |f| over the judged channels; of many it is the root of the mean
square. That of one channel is its share, |f_c - f_c predicted| / |f|: squares of the channels add to the square of the whole.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from geometry.errors import CheckFailed
from validation.engine.descent import BREAKDOWNS
from validation.engine.evaluation import Share
from validation.engine.inputs import left_of_run
from validation.engine.likelihood import observed
from validation.engine.prediction import Lines, Offsets, Predicted, Prediction

FLOOR = 0.0015
"""Model-error floor in the weights by which inputs are estimated."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Squares:
    """Squares of the relative errors of one run.

    Attributes
    ----------
    data_set, run : whose they are
    channels : (j,) names of the judged ones
    values : (m, j) of every line
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
    CheckFailed : the channels that are not judged do not tell the inputs; the model breaks down.
    """
    measured = prediction.measured
    chosen = np.arange(len(measured.frequency), dtype=np.int64) if lines is None else lines
    predicted = _predicted(prediction, offsets, chosen)
    seen, judged = observed(measured, chosen), measured.judged
    weight, found = seen.weight(FLOOR, predicted.noise), []
    for k, run in enumerate(measured.runs):
        rows = predicted.rows if predicted.rows.ndim == 3 else predicted.rows[k]
        left = left_of_run(seen, rows, judged, weight[k], k).values[:, judged]
        level = np.sum(np.abs(seen.values[k][:, judged]) ** 2, axis=1, keepdims=True)
        values = np.abs(left) ** 2 / np.maximum(level, np.finfo(np.float64).tiny)
        names = tuple(name for name, one in zip(measured.channels, judged, strict=True) if one)
        found.append(Squares(data_set=measured.name, run=run, channels=names, values=values, fold=fold))
    return found


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
    return 100 * float(np.sqrt(np.mean(np.concatenate([one.sum(axis=1) for one in values])))) if values else 0.0


def _by_channel(found: Sequence[Squares]) -> dict[str, float]:
    """Over the runs in which each channel is."""
    named = ((name, one.values[:, [k]]) for one in found for k, name in enumerate(one.channels))
    return _grouped(named)


def _grouped(named: Iterable[tuple[str, Array]]) -> dict[str, float]:
    groups: dict[str, list[Array]] = {}
    for name, values in named:
        groups.setdefault(name, []).append(values)
    return {name: _percent(values) for name, values in groups.items()}
