"""Predictions that stand ready for a question: made once a model, in a second or few, and asked many times."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from time import perf_counter

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray
from geometry.errors import BadInput, CheckFailed
from geometry.sensors import ChannelTable
from validation.comparing.pairs import Operators, operators, through
from validation.desk.comparing import comparison
from validation.desk.desk import Desk
from validation.desk.following import Dragged
from validation.desk.held_against import ground
from validation.desk.remembered import remembering
from validation.effects.targets import Vocabulary
from validation.engine import errors
from validation.engine.descent import BREAKDOWNS
from validation.engine.errors import Squares
from validation.engine.fit import FLOOR
from validation.engine.inputs import left_of_run
from validation.engine.likelihood import observed
from validation.engine.prediction import Lines, Offsets, Predicted
from validation.engine.problem import Problem
from validation.models.model import Model
from validation.models.pairing import vocabulary
from validation.prediction.facts import ArticleFact
from validation.prediction.series import SeriesPrediction

TRIES = 3
"""Of which the quickest tells what a line costs."""

FITTED, DRAWN = "the plain fit", "the model as it stands, nothing fitted"


@dataclass(frozen=True, eq=False, kw_only=True)
class Tested:
    """One campaign that stands ready.

    Attributes
    ----------
    prediction : by the model with its effects
    operators : from channels to the dynamic mass; None where they or the runs do not tell it
    inputs : (r, n, k) base motions as all channels tell them
    entries : (n, 6, 6) predicted without anything more
    judged : runs whose plain error is told: those that are fitted
    squares : of their relative errors at every line, without anything more
    """

    prediction: SeriesPrediction
    operators: Operators | None
    inputs: ComplexArray
    entries: ComplexArray
    judged: tuple[str, ...]
    squares: tuple[Squares, ...]

    @property
    def name(self) -> str:
        """Of the campaign."""
        return self.prediction.measured.name


@dataclass(frozen=True, eq=False, kw_only=True)
class Table:
    """Predictions that stand ready; made once a model, in a second or few.

    Attributes
    ----------
    model : as it stands
    tested : the campaigns
    facts : weights and periods
    offsets : of every parameter, where the comparison left it
    at : `FITTED`, or `DRAWN` before there is a comparison
    pace : [s] that one line of a campaign costs when all is solved anew
    words : channels, places and parts that there are
    known : what fits see of the data
    dragged : effects that were asked for, ready to be asked for again
    """

    model: Model
    tested: tuple[Tested, ...]
    facts: tuple[ArticleFact, ...]
    offsets: Offsets
    at: str
    pace: float
    words: Vocabulary
    known: Problem
    dragged: dict[str, Dragged] = field(default_factory=dict)

    @property
    def campaigns(self) -> tuple[str, ...]:
        """Names."""
        return tuple(one.name for one in self.tested)


def table(of: Desk) -> Table:
    """Predictions of the data by the model as it stands, at the plain fit where there is a comparison.

    Raises
    ------
    BadInput : model or data that cannot be used.
    CheckFailed : the model breaks down as it stands.
    """
    ready, known = ground(of), comparison(of)
    offsets = {**ready.problem.start, **({} if known is None else known.offsets)}
    fitted = {one.measured.name: one.measured.runs for one in ready.fitted.predictions}
    campaigns = tuple(one.tested.campaign for one in ready.made)
    tested = tuple(_ready(remembering(one), offsets, fitted.get(one.measured.name, ())) for one in ready.made)
    return Table(
        model=ready.model,
        tested=tested,
        facts=ready.facts,
        offsets=offsets,
        at=DRAWN if known is None else FITTED,
        pace=_pace(ready.made, offsets),
        words=vocabulary(ready.model, campaigns),
        known=ready.fitted,
    )


def _pace(made: Sequence[SeriesPrediction], offsets: Offsets) -> float:
    """[s] a line, of all campaigns, solved anew, when nothing else is in the way."""
    taken = []
    for _ in range(TRIES):
        began = perf_counter()
        for one in made:
            predicted(one, offsets, None)
        taken.append(perf_counter() - began)
    return min(taken) / max(sum(len(one.measured.frequency) for one in made), 1)


def _ready(one: SeriesPrediction, offsets: Offsets, judged: tuple[str, ...]) -> Tested:
    measured, read = one.measured, predicted(one, offsets, None)
    seen = observed(measured, np.arange(len(measured.frequency), dtype=np.int64))
    weight = seen.weight(FLOOR, read.noise)
    every = (read.rows if read.rows.ndim == 3 else read.rows[run] for run in range(len(measured.runs)))
    inputs = np.stack([left_of_run(seen, rows, weight[run], run).inputs for run, rows in enumerate(every)])
    of = _operators(one)
    found = np.zeros((0, 6, 6), dtype=np.complex128)
    if of is not None:
        found = entries(of, read.rows, inputs, measured.frequency)
    squares = tuple(errors.squares(one.on(judged), offsets)) if judged else ()
    return Tested(prediction=one, operators=of, inputs=inputs, entries=found, judged=judged, squares=squares)


def _operators(one: SeriesPrediction) -> Operators | None:
    measured, campaign = one.measured, one.tested.campaign
    by_name = {channel.name: channel for channel in campaign.table.channels}
    channels = ChannelTable(channels=tuple(by_name[name] for name in measured.channels), origin=campaign.table.origin)
    weight = np.sqrt(np.mean(measured.noise**2, axis=0))
    try:
        found = operators(channels, measured.frequency, weight, campaign.gravity)
        through(found, measured.values, measured.frequency)
    except BadInput:  # the map of this campaign has no pairs either, and says why
        return None
    return found


def entries(of: Operators, rows: ComplexArray, inputs: ComplexArray, frequency: Array) -> ComplexArray:
    """(m, 6, 6) of what the channels are predicted to read, on the same way as what they read. Where all runs share their rows it
    does not matter what they were: H = R A (T A)^-1."""
    read = np.moveaxis(rows, -1, 0) if rows.ndim == 3 else (rows @ inputs[..., None])[..., 0]
    return np.asarray(through(of, read, frequency).dynamic_mass.matrix)


def predicted(one: SeriesPrediction, offsets: Offsets, lines: Lines | None) -> Predicted:
    """What the channels read at `offsets` and `lines`, all by default.

    Raises
    ------
    CheckFailed : the model breaks down there.
    """
    try:
        return one.at(offsets, lines, derivatives=False)
    except BadInput:
        raise
    except BREAKDOWNS as error:
        raise CheckFailed(f"the model of {one.measured.name} breaks down at that size: {error}") from error
