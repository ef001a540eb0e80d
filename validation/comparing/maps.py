"""Where a model fails: every channel and every load over frequency and runs, every pair of axes over frequency, every run.

All of it is told at the plain fit - tolerances of the measurement not fitted - in standard deviations of what noise, model-error
floor and those tolerances let expect, and in per cent of the level there.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array
from geometry.dynamic_mass import LEVELS, MOTIONS, ComplexArray
from geometry.errors import BadInput
from geometry.observability import LOADS, of_motions, of_resultants
from geometry.sensors import ChannelTable, resultants
from identification.self_calibration.elimination import smoothed_level
from validation.comparing.chunks import Chunk, chunks
from validation.comparing.doubt import Doubt
from validation.comparing.left_over import Deviations, combined, covariance, judged_error, left_over
from validation.comparing.pairs import Operators, Pairs, joined, lines, operators, through
from validation.engine.inputs import left_of_run
from validation.engine.likelihood import floor_of, observed
from validation.engine.measured import Measured
from validation.engine.prediction import Offsets, Prediction

LENGTHS = np.array([LEVELS["x"] / LEVELS[axis] for axis in MOTIONS])
"""(6,) [1] and [m]: moments divided by their nominal length are forces."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Map:
    """One data set: what its channels and loads read beyond what was expected.

    Attributes
    ----------
    data_set, configuration : its name and what was tested
    runs, axes : (r,) names, and what each drove
    frequency : (n,) [Hz]
    rows : (m,) names of the channels, then of the six loads where load cells tell them
    channels : how many of them are channels
    deviation : (r, n, m) complex, SI
    expected : (r, n, m) its standard deviation; infinite where nothing checks the row
    reading : (r, n, m) complex, what was expected to be read
    level : (r, n, m) of which a deviation is told in per cent
    inputs : (r, n, k) base motions or known inputs, as the channels that are not judged tell them
    misfit : (r, n) chi² per degree of freedom of all channels together, tolerances counted
    explained : (r, n) share of the judged channels' readings that the plain error is expected to be, by tolerances of the
        measurement
    explained_with_modes : (r, n) the same by what the model leaves open of its modes as well
    pairs : of the dynamic mass; None where runs or channels do not tell it
    remarks : sentences
    """

    data_set: str
    configuration: str
    runs: tuple[str, ...]
    axes: tuple[str, ...]
    frequency: Array
    rows: tuple[str, ...]
    channels: int
    deviation: ComplexArray
    expected: Array
    reading: ComplexArray
    level: Array
    inputs: ComplexArray
    misfit: Array
    explained: Array
    explained_with_modes: Array
    pairs: Pairs | None = None
    remarks: tuple[str, ...] = field(default=())

    @property
    def sigma(self) -> Array:
        """(r, n, m) deviations in standard deviations."""
        return np.asarray(np.abs(self.deviation) / self.expected)

    @property
    def percent(self) -> Array:
        """(r, n, m) deviations in per cent: of what the channel reads there, of the dynamic mass for a load."""
        return np.asarray(100 * np.abs(self.deviation) / np.maximum(self.level, np.finfo(np.float64).tiny))


@dataclass(frozen=True, eq=False, kw_only=True)
class Rig:
    """Where the channels of a data set sit.

    Attributes
    ----------
    table : with all channels of the data set
    gravity : [m/s²]
    """

    table: ChannelTable
    gravity: float


def mapped(
    prediction: Prediction,
    offsets: Offsets,
    unknown: Doubt,
    inputs: ComplexArray,
    rig: Rig | None = None,
    progress: Callable[[float], None] | None = None,
) -> Map:
    """The map of one data set.

    Parameters
    ----------
    offsets : of the plain fit
    unknown : what may be otherwise there
    inputs : (r, n, k) of the runs, with which tolerances act
    rig : of a base-excitation test; without it there are neither loads nor pairs
    """
    measured = prediction.measured
    R = None if rig is None else _resultants(measured, rig)
    of, remarks = (None, ()) if rig is None else _operators(measured, rig)
    of_modes = _of_modes(unknown)
    said, both, told = [], [], progress or (lambda share: None)
    for part in chunks(prediction, offsets, inputs, unknown):
        said.append(_of_lines(measured, part, R) | _explained(measured, part, of_modes))
        if of is not None:
            both.append(lines(of, measured.frequency, measured.values, inputs, part))
        told((part.lines[-1] + 1) / len(measured.frequency))
    found = {key: np.concatenate([one[key] for one in said], axis=1) for key in said[0]}
    return Map(
        data_set=measured.name,
        configuration=measured.configuration,
        runs=measured.runs,
        axes=measured.axes,
        frequency=measured.frequency,
        rows=(*measured.channels, *(() if R is None else LOADS)),
        channels=len(measured.channels),
        inputs=inputs,
        level=_levels(measured, found),
        pairs=joined(measured.name, measured.frequency, both) if both else None,
        remarks=remarks,
        **found,
    )


def _of_lines(measured: Measured, part: Chunk, R: Array | None) -> dict[str, Array]:
    """What a chunk says, by field of `Map`."""
    y, A, S = measured.values[:, part.lines], part.rows, covariance(part.noise, part.spread)
    known = None if measured.inputs is None else measured.inputs[:, part.lines]
    own, chi2 = left_over(y, A, S, known)
    error, spread = judged_error(y, A, S, known, measured.judged)
    loads = Deviations(value=error[..., :0], expected=np.zeros((*error.shape[:2], 0)))
    predicted = np.zeros((*error.shape[:2], 0), dtype=np.complex128)
    if R is not None:
        loads = combined(error, spread, R)
        predicted = (y[..., measured.judged] - error) @ R.T
    return {
        "deviation": np.concatenate([own.value, loads.value], axis=-1),
        "expected": np.concatenate([own.expected, loads.expected], axis=-1),
        "reading": np.concatenate([y - own.value, predicted], axis=-1),
        "misfit": chi2 / (A.shape[-2] - (A.shape[-1] if known is None else 0)),
    }


def _explained(measured: Measured, part: Chunk, of_modes: npt.NDArray[np.bool_]) -> dict[str, Array]:
    """(r, n) of the error that the engine calls plain, which knows no noise, by tolerances: without those `of_modes` and with."""
    seen, judged = observed(measured, part.lines), measured.judged
    found = []
    for run, (A, V, weight) in enumerate(zip(part.rows, part.spread, part.weight, strict=True)):
        gain = left_of_run(seen, A, weight, run).gain
        found.append(np.sum(np.abs((V if gain is None else gain @ V)[:, judged]) ** 2, axis=1))
    level = np.maximum(np.sum(np.abs(seen.values[..., judged]) ** 2, axis=-1), np.finfo(np.float64).tiny)
    squares = np.stack(found)  # (r, n, q + p)
    known, every = (np.sqrt(one.sum(axis=-1) / level) for one in (squares[..., ~of_modes], squares))
    return {"explained": known, "explained_with_modes": every}


def _of_modes(unknown: Doubt) -> npt.NDArray[np.bool_]:
    """(q + p,) which of the unknowns are what the model leaves open of modes, here or in another configuration of the series."""
    return np.array([name in unknown.of_modes for name in unknown.tolerances] + [False] * len(unknown.own), dtype=bool)


def _levels(measured: Measured, found: Mapping[str, Array]) -> Array:
    """(r, n, m): of a channel that of the model-error floor; of a load all six of its run, predicted or measured, the greater.

    Moments count divided by their nominal length.
    """
    level, of_loads = floor_of(measured), slice(len(measured.channels), None)
    predicted = found["reading"][..., of_loads]
    if not predicted.shape[-1]:
        return level
    loads = (predicted, predicted + found["deviation"][..., of_loads])
    power = np.maximum(*(smoothed_level(measured.frequency, one / LENGTHS) for one in loads))
    together = np.sqrt(np.sum(power**2, axis=-1, keepdims=True))
    return np.concatenate([level, together * LENGTHS], axis=-1)


def _resultants(measured: Measured, rig: Rig) -> Array | None:
    """(6, f) the loads about F from the judged channels; None where they do not tell all six."""
    names = [name for name, judged in zip(measured.channels, measured.judged, strict=True) if judged]
    table = _table(rig, names)
    return resultants(table.channels, table.origin) if of_resultants(table).complete else None


def _table(rig: Rig, names: Collection[str]) -> ChannelTable:
    by_name = {one.name: one for one in rig.table.channels}
    return ChannelTable(channels=tuple(by_name[name] for name in names), origin=rig.table.origin)


def _operators(measured: Measured, rig: Rig) -> tuple[Operators | None, tuple[str, ...]]:
    """From channels to the dynamic mass; or None, and why there is none."""
    table = _table(rig, measured.channels)
    seen = any(of_motions(table, (group,)).complete for group in ("cover", "table"))
    if not (seen and of_resultants(table).complete):
        return None, (f"{measured.name}: its channels do not tell six motions and six loads, so no dynamic mass is measured",)
    weight = np.sqrt(np.mean(measured.noise**2, axis=0))
    of = operators(table, measured.frequency, weight, rig.gravity)
    try:
        through(of, measured.values, measured.frequency)
    except BadInput as error:
        return None, (f"{measured.name}: no dynamic mass is measured, {error.problem}",)
    return of, ()
