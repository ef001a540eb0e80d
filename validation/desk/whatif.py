"""What if: the predicted curves of one entry with an effect at any size, while a slider is dragged.

Nothing is fitted: every other parameter stands where the comparison left it, so that what moves is the effect alone. It is an
illustration of its size and no "after" of adding it; `validation.desk.climbing.added` fits.

The prediction itself is asked (`validation.prediction.series`), no table of it. Released, at every line of the data; dragged, at
as many lines as `BUDGET` allows, those where most happens first. What makes that quick: effects on channels leave the structure
solved, and an effect that is dragged is a parameter of a prediction that stays.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from time import perf_counter

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray
from geometry.errors import BadInput, CheckFailed
from geometry.sensors import ChannelTable
from validation.comparing.pairs import Operators, operators, through
from validation.desk.comparing import comparison
from validation.desk.desk import Desk
from validation.desk.held_against import ground
from validation.desk.remembered import remembering
from validation.effects.catalogue import FAMILIES
from validation.effects.family import AMPLITUDE, BODY_STAGE, CHANNEL_STAGE, PROCESSING
from validation.effects.identifiers import Named, parse
from validation.effects.reach import acts
from validation.effects.targets import Vocabulary
from validation.engine import errors
from validation.engine.descent import BREAKDOWNS
from validation.engine.errors import Squares
from validation.engine.fit import FLOOR
from validation.engine.inputs import left_of_run
from validation.engine.likelihood import observed
from validation.engine.parameter import Parameter
from validation.engine.prediction import Lines, Offsets, Predicted
from validation.engine.thinning import chosen
from validation.models.model import Added, Model
from validation.models.pairing import vocabulary
from validation.pictures.curves import unit
from validation.prediction import applied
from validation.prediction.facts import ArticleFact
from validation.prediction.series import SeriesPrediction

BUDGET = 0.06
"""[s] of predictions while dragging; curves and errors come on top of it, and the page has to draw them."""

FEWEST = 40
"""Lines of a campaign, whatever they cost."""

EVERY = 8
"""While dragging the plain error is told at every so many lines, whatever happens there."""

TRIES = 3
"""Of which the quickest tells what a line costs."""

KEPT = 6
"""Effects whose predictions stay."""

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
    """

    model: Model
    tested: tuple[Tested, ...]
    facts: tuple[ArticleFact, ...]
    offsets: Offsets
    at: str
    pace: float
    words: Vocabulary
    _tried: dict[str, tuple[SeriesPrediction, ...]] = field(default_factory=dict)

    @property
    def campaigns(self) -> tuple[str, ...]:
        """Names."""
        return tuple(one.name for one in self.tested)


@dataclass(frozen=True, eq=False, kw_only=True)
class Trace:
    """The predicted entry of one campaign.

    Attributes
    ----------
    campaign : data set
    frequency : (n,) [Hz], all lines of the campaign
    before, after : (n,) complex, without and with the effect, in `unit`; between lines that were not asked for `after` goes with
        `before`
    matrix : (n, 6, 6) with the effect, all entries, about F
    unit : kg, kg m or kg m²
    reached : whether the effect acts on this campaign at all
    """

    campaign: str
    frequency: Array
    before: ComplexArray
    after: ComplexArray
    matrix: ComplexArray
    unit: str
    reached: bool


@dataclass(frozen=True, eq=False, kw_only=True)
class WhatIf:
    """What an effect of that size would do.

    Attributes
    ----------
    written : the effect with its size
    traces : one a campaign that tells a dynamic mass
    plain_percent : plain error with it, of the runs that are fitted; nothing refitted
    before_percent : the same without it, at the same lines
    facts : by name of a weighing or period, (before, after) in standard deviations
    exact : whether every line was computed
    """

    written: str
    traces: tuple[Trace, ...]
    plain_percent: float
    before_percent: float
    facts: Mapping[str, tuple[float, float]]
    exact: bool


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
    )


def _pace(made: Sequence[SeriesPrediction], offsets: Offsets) -> float:
    """[s] a line, of all campaigns, solved anew, when nothing else is in the way."""
    taken = []
    for _ in range(TRIES):
        began = perf_counter()
        for one in made:
            _predicted(one, offsets, None)
        taken.append(perf_counter() - began)
    return min(taken) / max(sum(len(one.measured.frequency) for one in made), 1)


def _ready(one: SeriesPrediction, offsets: Offsets, judged: tuple[str, ...]) -> Tested:
    measured, predicted = one.measured, _predicted(one, offsets, None)
    seen = observed(measured, np.arange(len(measured.frequency), dtype=np.int64))
    weight = seen.weight(FLOOR, predicted.noise)
    every = (predicted.rows if predicted.rows.ndim == 3 else predicted.rows[run] for run in range(len(measured.runs)))
    inputs = np.stack([left_of_run(seen, rows, weight[run], run).inputs for run, rows in enumerate(every)])
    of = _operators(one)
    entries = np.zeros((0, 6, 6), dtype=np.complex128)
    if of is not None:
        entries = _entries(of, predicted.rows, inputs, measured.frequency)
    squares = tuple(errors.squares(one.on(judged), offsets)) if judged else ()
    return Tested(prediction=one, operators=of, inputs=inputs, entries=entries, judged=judged, squares=squares)


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


def _entries(of: Operators, rows: ComplexArray, inputs: ComplexArray, frequency: Array) -> ComplexArray:
    """(m, 6, 6) of what the channels are predicted to read, on the same way as what they read. Where all runs share their rows it
    does not matter what they were: H = R A (T A)^-1."""
    read = np.moveaxis(rows, -1, 0) if rows.ndim == 3 else (rows @ inputs[..., None])[..., 0]
    return np.asarray(through(of, read, frequency).dynamic_mass.matrix)


def what_if(of: Table, effect: str, load: int, motion: int, *, exact: bool = True) -> WhatIf:
    """The entry with `effect` (``ID=VALUE``, ``ID=key:number,...``) in the model.

    Parameters
    ----------
    load, motion : the entry shown, 0 to 5
    exact : every line, as `validation.prediction` has it (when a slider is released); else as many as `BUDGET` allows

    Raises
    ------
    BadInput : no such effect, a size that is no physics.
    CheckFailed : the model breaks down at that size.
    """
    named = parse(effect, of.words, source="what if")
    asked = [_asked(of, k, named, exact=exact) for k in range(len(of.tested))]
    before = [each for one in asked for each in one.before]
    after = [each for one in asked for each in (one.after if one.reached else one.before)]
    return WhatIf(
        written=str(named),
        traces=tuple(_trace(one, load, motion) for one in asked if one.tested.operators is not None),
        plain_percent=errors.share(after).percent,
        before_percent=errors.share(before).percent,
        facts=_facts(of, named),
        exact=all(len(one.lines) == len(one.tested.prediction.measured.frequency) for one in asked),
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class _Asked:
    """One campaign of one question: at which lines, what is read there with the effect, and what that leaves of the data.

    `rows` is None and `after` empty where the effect does not reach it.
    """

    tested: Tested
    lines: Lines
    rows: ComplexArray | None
    before: list[Squares]
    after: list[Squares]

    @property
    def reached(self) -> bool:
        return self.rows is not None


def _asked(of: Table, number: int, named: Named, *, exact: bool) -> _Asked:
    one = of.tested[number]
    measured, there = one.prediction.measured, one.prediction.tested.carried.standing.there
    every = np.arange(len(measured.frequency), dtype=np.int64)
    lines = every if exact else _lines(of, one, named)
    judged = every if exact else every[::EVERY]
    before = [replace(each, values=each.values[judged]) for each in one.squares]
    if not acts(named, replace(there, channels=measured.channels)):
        return _Asked(tested=one, lines=lines, rows=None, before=before, after=[])
    prediction, offsets = _with_effect(of, number, named, exact=exact)
    rows = _predicted(prediction, offsets, lines).rows
    after = errors.squares(prediction.on(one.judged), offsets, judged) if one.judged else []
    return _Asked(tested=one, lines=lines, rows=rows, before=before, after=after)


def _lines(of: Table, one: Tested, named: Named) -> Lines:
    """As many as can be afforded, where most happens."""
    runs = len(one.prediction.measured.runs) if _by_run(named) else 1
    afforded = int(BUDGET / (of.pace * len(of.tested) * runs))
    return chosen(one.prediction.measured, at_most=max(afforded, FEWEST))


def _by_run(named: Named) -> bool:
    """Whether every run is predicted by itself, since the effect asks how it was driven."""
    family = FAMILIES[named.family]
    return family.side in (AMPLITUDE, PROCESSING) and family.stage in (BODY_STAGE, CHANNEL_STAGE)


def _with_effect(of: Table, number: int, named: Named, *, exact: bool) -> tuple[SeriesPrediction, Offsets]:
    """A prediction of one campaign with the effect, and the offsets at which it has that size."""
    kept = _tried(of, named)[number]  # also when it is not asked yet: the next word is that of a slider
    if not exact and (moved := _moved(kept, named)) is not None:
        return kept, {**of.offsets, **moved}
    return of.tested[number].prediction.with_effects(_with(of.model, named, fixed=True)), of.offsets


def _tried(of: Table, named: Named) -> tuple[SeriesPrediction, ...]:
    """Predictions with the effect free, kept while it is dragged."""
    if named.id not in of._tried:
        if len(of._tried) >= KEPT:
            of._tried.pop(next(iter(of._tried)))
        effects = _with(of.model, named, fixed=False)
        of._tried[named.id] = tuple(one.prediction.with_effects(effects) for one in of.tested)
    return of._tried[named.id]


def _with(model: Model, named: Named, *, fixed: bool) -> tuple[Added, ...]:
    """The effects of `model` and `named`, in its place where it is among them."""
    added, others = Added(named=named, fixed=fixed), model.effects
    if any(one.named.id == named.id for one in others):
        return tuple(added if one.named.id == named.id else one for one in others)
    return (*others, added)


def _moved(kept: SeriesPrediction, named: Named) -> dict[str, float] | None:
    """Offsets that move the parameters of an effect to the sizes of `named`; None where one of them is no parameter."""
    known: dict[str, Parameter] = {one.name: one for one in kept.parameters}
    wanted = {applied.name(named, key): value for key, value in named.values.items()}
    if not wanted or not set(wanted) <= set(known):
        return None
    return {name: known[name].offset(value) for name, value in wanted.items()}


def _predicted(one: SeriesPrediction, offsets: Offsets, lines: Lines | None) -> Predicted:
    try:
        return one.at(offsets, lines, derivatives=False)
    except BadInput:
        raise
    except BREAKDOWNS as error:
        raise CheckFailed(f"the model of {one.measured.name} breaks down at that size: {error}") from error


def _trace(asked: _Asked, load: int, motion: int) -> Trace:
    one, lines = asked.tested, asked.lines
    before = matrix = one.entries
    frequency = one.prediction.measured.frequency
    if asked.rows is not None and one.operators is not None:
        some = Operators(motion=one.operators.motion[lines], load=one.operators.load[lines])
        matrix = _entries(some, asked.rows, one.inputs[:, lines], frequency[lines])
        matrix = matrix if len(lines) == len(frequency) else _between(frequency, lines, before, matrix)
    return Trace(
        campaign=one.name,
        frequency=frequency,
        before=before[:, load, motion],
        after=matrix[:, load, motion],
        matrix=matrix,
        unit=unit(load, motion),
        reached=asked.reached,
    )


def _between(frequency: Array, lines: Lines, before: ComplexArray, after: ComplexArray) -> ComplexArray:
    """(n, 6, 6) what is `after` (m, 6, 6) at `lines`; between them `before` times a factor that goes straight."""
    at = before[lines]
    factor = np.where(at == 0, 1.0, after / np.where(at == 0, 1.0, at))
    right = np.clip(np.searchsorted(lines, np.arange(len(frequency))), 1, len(lines) - 1)
    first, last = frequency[lines[right - 1]], frequency[lines[right]]
    share = np.clip((frequency - first) / (last - first), 0.0, 1.0)[:, None, None]
    found = before * ((1 - share) * factor[right - 1] + share * factor[right])
    found[lines] = after
    return np.asarray(found)


def _facts(of: Table, named: Named) -> dict[str, tuple[float, float]]:
    effects = _with(of.model, named, fixed=True)
    return {one.name: (one.residual(of.offsets)[0], one.with_effects(effects).residual(of.offsets)[0]) for one in of.facts}
