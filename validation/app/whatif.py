"""What if: the predicted curves of one entry with an effect at any size, while a slider is dragged.

The prediction itself is asked (`validation.prediction.series`), no table of it. Released, at every line of the data and at the
plain fit with the effect at that size; dragged, at as many lines as `BUDGET` allows, those where most happens first, and what a
plain fit frees a step behind (`validation.app.whatif`). What makes that quick: effects on channels leave the structure
solved, and an effect that is dragged is a parameter of a prediction that stays. The size itself is never fitted here.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Collection, Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import product
from math import inf
from threading import Lock
from time import perf_counter
from types import MappingProxyType
from typing import Any, cast

import numpy as np

from geometry.dynamic_mass import ComplexArray
from geometry.errors import BadInput, CheckFailed
from geometry.frames import Array
from geometry.sensors import ChannelTable
from validation.app.session import Session, comparing_comparison, diagnosing_diagnosis, study_of
from validation.compare.maps import Operators, operators, through
from validation.diagnose.diagnosis import Advice
from validation.effects import practical_units
from validation.effects.catalogue import FAMILIES, Named, acts, parse
from validation.effects.effect import (
    AMPLITUDE,
    BODY_STAGE,
    CHANNEL_STAGE,
    OPENED,
    PERIOD_STAGE,
    PROCESSING,
    STRUCTURE_STAGE,
    Family,
    SizeSpec,
    Vocabulary,
)
from validation.estimation import evaluate
from validation.estimation.cost import cost_of, left_of_run
from validation.estimation.evaluate import Squares
from validation.estimation.fit import BREAKDOWNS, FLOOR, PLAIN_FLOOR, nearby
from validation.estimation.likelihood import observed
from validation.estimation.problem import PLAIN, Fact, Lines, Measured, Offsets, Parameter, Predicted, Problem, Wanted, chosen
from validation.history.add import FIRST_GUESS, completed
from validation.model.model import Added, Model, vocabulary
from validation.prediction import classical_facts, dynamic_mass, effects
from validation.prediction.classical_facts import ArticleFact, require_bodies
from validation.prediction.dynamic_mass import BaseDrive, SupportedDynamicMass, Tangents
from validation.prediction.series import SeriesPrediction
from validation.report.charts.style import unit
from validation.report.effects import examples

# A prediction that was asked already: what else wants to know it need not ask again.


@dataclass(frozen=True, eq=False, kw_only=True)
class SampledPrediction:
    """What a `Prediction` said at some lines; it is one itself, at any of these lines and without derivatives.

    Attributes
    ----------
    measured : the data
    parameters : of the prediction
    lines : (m,) indices that were asked for, ascending
    said : there
    """

    measured: Measured
    parameters: tuple[Parameter, ...]
    lines: Lines
    said: Predicted

    def on(self, runs: Sequence[str]) -> SampledPrediction:
        """Of the runs named alone."""
        kept = [k for k, run in enumerate(self.measured.runs) if run in runs]
        rows, noise = self.said.rows, self.said.noise
        said = Predicted(rows=rows if rows.ndim == 3 else rows[kept], noise=None if noise is None else noise[kept])
        return SampledPrediction(measured=self.measured.on(runs), parameters=self.parameters, lines=self.lines, said=said)

    def at(self, offsets: Offsets, lines: Lines | None = None, *, derivatives: Wanted = True) -> Predicted:
        """At the `lines` (indices), which were asked for; `offsets` are those of then.

        Raises
        ------
        ValueError : a line that was not asked for, or derivatives.
        """
        asked = np.arange(len(self.measured.frequency), dtype=np.int64) if lines is None else lines
        if derivatives or not np.isin(asked, self.lines).all():
            raise ValueError("derivatives and other lines are to be asked of the prediction itself")
        at, noise = np.searchsorted(self.lines, asked), self.said.noise
        rows = self.said.rows[at] if self.said.rows.ndim == 3 else self.said.rows[:, at]
        return Predicted(rows=rows, noise=None if noise is None else noise[:, at])


# What a plain fit frees, following an effect: the FMD's inertia and what else is declared, at every size that is tried.
#
# Where the comparison ended, the FMD has taken up what it could of a fault. An effect that is put into the model beside that
# counts twice: the right one would seem to make things worse. So the parameters of the plain fit go with it: by one step of
# Gauss and Newton from where they stood last while a slider is dragged, to the minimum when it is released.


STEP = 4
"""While dragging, of the lines of fits every so many."""

STEPS = 3
"""Where every run is predicted by itself, and a fit would take as many times as long as there are runs."""


class Dragged:
    """An effect that is dragged: its predictions with it free, what fits see of them, and where their parameters stood last."""

    def __init__(self, predictions: tuple[SeriesPrediction, ...], problem: Problem, offsets: Offsets) -> None:
        self.predictions, self.problem, self.offsets = predictions, problem.sparser(STEP), dict(offsets)

    def follow(self, moved: Mapping[str, float]) -> None:
        """One step towards the plain fit with the effect at the offsets `moved`; none where the model breaks down there."""
        self.offsets = {**self.offsets, **stepped(self.problem, self.offsets, moved)}


def seen_by_fits(known: Problem, predictions: Sequence[SeriesPrediction], facts: Sequence[Fact]) -> Problem:
    """`predictions` on the runs and lines of `known`, and its facts of those that are given by name."""
    by_name = {one.measured.name: one for one in predictions}
    some = tuple(by_name[one.measured.name].on(one.measured.runs) for one in known.predictions)
    kept = {one.name for one in known.facts}
    return Problem(some, tuple(one for one in facts if one.name in kept), lines=known.lines)


def stepped(problem: Problem, offsets: Offsets, moved: Mapping[str, float]) -> dict[str, float]:
    """Offsets of what a plain fit frees one step further, within their bounds, the parameters `moved` standing where they are."""
    free = tuple(one for one in problem.free(PLAIN) if one.name not in moved)
    others = {name: value for name, value in offsets.items() if name not in {one.name for one in free}}
    cost = cost_of(problem, free, PLAIN_FLOOR, {**others, **moved}, plain=True)
    low, high = cost.bounds
    x = np.clip(cost.at(offsets), low, high)
    try:
        whole = cost.total(x)[0]
        there = np.clip(x - np.linalg.solve(whole.matrix, whole.gradient), low, high)
    except BREAKDOWNS:
        return {}
    return dict(zip(cost.names, map(float, there), strict=True))


def settled(problem: Problem, offsets: Offsets) -> dict[str, float]:
    """Offsets of the plain fit of `problem`, from nearby.

    Raises
    ------
    CheckFailed : the model breaks down where it begins.
    """
    return nearby(problem, PLAIN, offsets).by_name


def several_steps(problem: Problem, offsets: Offsets) -> dict[str, float]:
    """The same by a few steps on some of the lines."""
    sparse, there = problem.sparser(STEP), dict(offsets)
    for _ in range(STEPS):
        there |= stepped(sparse, there, {})
    return there


# What the load cells carry, remembered: an effect on a channel need not have the structure solved again.


MOST = 24
"""Dynamic masses that are kept, of some 0.3 MB each."""


class Remembering:
    """A `Carried` that answers the same question once; the answer is the very same. Several threads may ask."""

    def __init__(self, of: SupportedDynamicMass) -> None:
        self.standing, self.moving, self.exact, self.nuisances = of.standing, of.moving, of.exact, of.nuisances
        self._of = of
        own = () if of.nuisances is None else of.nuisances.parameters
        self._names = (*(one.name for one in own), *dynamic_mass.names())
        self._known: OrderedDict[Hashable, ComplexArray] = OrderedDict()
        self._changing = Lock()

    def at(
        self, offsets: Offsets, effects: Sequence[Added], frequency: Array, drive: BaseDrive, *, derivatives: bool
    ) -> tuple[ComplexArray, Tangents]:
        """As `Carried.at`; derivatives are not remembered."""
        if derivatives:
            return self._of.at(offsets, effects, frequency, drive, derivatives=True)
        key = self._key(offsets, effects, frequency, drive)
        with self._changing:
            found = self._known.pop(key, None)
        if found is None:
            found = self._of.at(offsets, effects, frequency, drive, derivatives=False)[0]
        with self._changing:
            self._known[key] = found
            while len(self._known) > MOST:
                self._known.popitem(last=False)
        return found, {}

    def moved(self, offsets: Offsets, effects: Sequence[Added], frequency: Array) -> dict[str, tuple[ComplexArray, ComplexArray]]:
        """As `Carried.moved`."""
        return self._of.moved(offsets, effects, frequency)

    def _key(self, offsets: Offsets, effects: Sequence[Added], frequency: Array, drive: BaseDrive) -> Hashable:
        """All that the answer depends on."""
        acting = [one.named for one in effects if FAMILIES[one.named.family].stage in (STRUCTURE_STAGE, BODY_STAGE)]
        driven: Hashable = None
        if any(FAMILIES[one.family].stage == BODY_STAGE for one in acting):
            driven = (drive.amplitude.tobytes(), drive.sweep_rate, drive.block)
        sizes = tuple((one.id, tuple(one.values.items())) for one in acting)
        return (sizes, driven, tuple(offsets.get(name, 0.0) for name in self._names), frequency.tobytes())


def remembering(of: SeriesPrediction) -> SeriesPrediction:
    """`of` with what its cells carry remembered, for it and for whatever is made of it."""
    return replace(of, tested=replace(of.tested, carried=cast(SupportedDynamicMass, Remembering(of.tested.carried))))


# Predictions that stand ready for a question: made once a model, in a second or few, and asked many times.


TRIES = 3
"""Of which the quickest tells what a line costs."""

FITTED, DRAWN = "the plain fit", "the model as it stands, nothing fitted"


@dataclass(frozen=True, eq=False, kw_only=True)
class ReadyCampaign:
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
class ReadyPredictions:
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
    tested: tuple[ReadyCampaign, ...]
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


def desk_table(of: Session) -> ReadyPredictions:
    """Predictions of the data by the model as it stands, at the plain fit where there is a comparison.

    Raises
    ------
    BadInput : model or data that cannot be used.
    CheckFailed : the model breaks down as it stands.
    """
    ready, known = study_of(of), comparing_comparison(of)
    made, whole = ready.predictions, ready.problem()
    offsets = {**ready.whole().start, **({} if known is None else known.offsets)}
    fitted = {one.measured.name: one.measured.runs for one in whole.predictions}
    campaigns = tuple(one.tested.campaign for one in made)
    tested = tuple(_desk_ready(remembering(one), offsets, fitted.get(one.measured.name, ())) for one in made)
    return ReadyPredictions(
        model=ready.model,
        tested=tested,
        facts=tuple(one.with_effects(ready.model.effects) for one in ready.said),
        offsets=offsets,
        at=DRAWN if known is None else FITTED,
        pace=_pace(made, offsets),
        words=vocabulary(ready.model, campaigns),
        known=whole,
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


def _desk_ready(one: SeriesPrediction, offsets: Offsets, judged: tuple[str, ...]) -> ReadyCampaign:
    measured, read = one.measured, predicted(one, offsets, None)
    seen = observed(measured, np.arange(len(measured.frequency), dtype=np.int64))
    weight = seen.weight(FLOOR, read.noise)
    every = (read.rows if read.rows.ndim == 3 else read.rows[run] for run in range(len(measured.runs)))
    inputs = np.stack([left_of_run(seen, rows, weight[run], run).inputs for run, rows in enumerate(every)])
    of = _operators(one)
    found = np.zeros((0, 6, 6), dtype=np.complex128)
    if of is not None:
        found = entries(of, read.rows, inputs, measured.frequency)
    squares = tuple(evaluate.squares(one.on(judged), offsets)) if judged else ()
    return ReadyCampaign(prediction=one, operators=of, inputs=inputs, entries=found, judged=judged, squares=squares)


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


BUDGET = 0.03
"""[s] of predictions while dragging; curves and errors come on top of it, and the page has to draw them."""

FEWEST = 40
"""Lines of a campaign, whatever they cost."""

EVERY = 12
"""While dragging the plain error is told at every so many lines, whatever happens there."""

KEPT = 6
"""Effects whose predictions stay."""


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
    plain_percent : plain error with it, of the runs that are fitted
    before_percent : the same without it, at the same lines
    facts : by name of a weighing or period, (before, after) in standard deviations
    exact : whether every line was computed, and what follows settled
    followed : whether what a plain fit frees went with it; else nothing was fitted
    offsets : of every parameter but those of the effect, at which this was predicted
    """

    written: str
    traces: tuple[Trace, ...]
    plain_percent: float
    before_percent: float
    facts: Mapping[str, tuple[float, float]]
    exact: bool
    followed: bool
    offsets: Offsets


def table(of: Session) -> ReadyPredictions:
    """Predictions of the data by the model as it stands, at the plain fit where there is a comparison; a second or few.

    What is there or not and looks at all lines (the bias of sweeps) is worked out here once, and is there when it is asked for.

    Raises
    ------
    BadInput : model or data that cannot be used.
    CheckFailed : the model breaks down as it stands.
    """
    found = desk_table(of)
    for family in FAMILIES.values():
        named = Named(family=family.name, values={})
        if family.side == PROCESSING and not family.targets and not family.sizes and _by_run(named):
            _asked_all(found, _dragged(found, named, follow=False))
    return found


def what_if(of: ReadyPredictions, effect: str, load: int, motion: int, *, exact: bool = True, follow: bool = True) -> WhatIf:
    """The entry with `effect` (``ID=VALUE``, ``ID=key:number,...``) in the model.

    Parameters
    ----------
    load, motion : the entry shown, 0 to 5
    exact : every line, as `validation.prediction` has it (when a slider is released, a second or so); else as many as `BUDGET`
        allows
    follow : whether what a plain fit frees goes with the effect, as it would if that were added. Nothing does before there is a
        comparison, nor while an effect is dragged that every run feels otherwise

    Raises
    ------
    BadInput : no such effect, a size that is no physics, a mass that leaves no body.
    CheckFailed : the model breaks down at that size.
    """
    named = parse(effect, of.words, source="what if")
    campaigns = [one.prediction.tested.campaign for one in of.tested]
    require_bodies(replace(of.model, effects=_with(of.model, named, fixed=True)), campaigns)
    follows = follow and of.at == FITTED and (exact or not _by_run(named))
    if exact:
        # Everything, and what follows settled; the effect is ready to be dragged afterwards, its first drag behind it
        if named.id not in of.dragged:
            _asked_all(of, _dragged(of, named, follow=follows and not _by_run(named)))
        effects = _with(of.model, named, fixed=True)
        predictions = tuple(one.prediction.with_effects(effects) for one in of.tested)
        offsets = dict(of.offsets)
        if follows:
            facts = tuple(one.with_effects(effects) for one in of.facts)
            problem = seen_by_fits(of.known, predictions, facts)
            offsets |= several_steps(problem, of.offsets) if _by_run(named) else settled(problem, of.offsets)
        question = _Question(named=named, predictions=predictions, offsets=offsets, moved={}, exact=True)
    else:
        question = _dragged(of, named, follow=follows)
    asked = _asked_all(of, question)
    before = [each for one in asked for each in one.before]
    after = [each for one in asked for each in one.after]
    return WhatIf(
        written=str(named),
        traces=tuple(_trace(one, load, motion) for one in asked if one.tested.operators is not None),
        plain_percent=evaluate.share(after).percent,
        before_percent=evaluate.share(before).percent,
        facts=_facts(of, question),
        exact=all(len(one.lines) == len(one.tested.prediction.measured.frequency) for one in asked),
        followed=follows,
        offsets={name: value for name, value in question.offsets.items() if name not in question.moved},
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class _Question:
    """Predictions with the effect, the offsets at which it has its size and all others stand, and how much is asked of them.

    `moved` are those of the effect, none where its size is in the predictions.
    """

    named: Named
    predictions: tuple[SeriesPrediction, ...]
    offsets: Offsets
    moved: Mapping[str, float]
    exact: bool


def _dragged(of: ReadyPredictions, named: Named, *, follow: bool) -> _Question:
    """As much as can be had while somebody waits."""
    # The effect as it was dragged last, kept for a while
    kept = of.dragged.get(named.id) or _free(of, named, fixed=False)
    kept = of.dragged.setdefault(named.id, kept)  # another thread may have been sooner
    for old in list(of.dragged)[:-KEPT]:
        of.dragged.pop(old, None)
    # Offsets that move the parameters of an effect to the sizes of `named`; None where one of them is no parameter
    known: dict[str, Parameter] = kept.problem.by_name
    wanted = {effects.name(named, key): value for key, value in named.values.items()}
    if not wanted or not set(wanted) <= set(known):
        moved = None
    else:
        moved = {name: known[name].offset(value) for name, value in wanted.items()}
    if moved is None:  # a size that no fit moves: its predictions are new ones
        kept, moved = _free(of, named, fixed=True), {}
    if follow:
        kept.follow(moved)
    offsets = {**(kept.offsets if follow else of.offsets), **moved}
    return _Question(named=named, predictions=kept.predictions, offsets=offsets, moved=moved, exact=False)


def _free(of: ReadyPredictions, named: Named, *, fixed: bool) -> Dragged:
    effects = _with(of.model, named, fixed=fixed)
    predictions = tuple(one.prediction.with_effects(effects) for one in of.tested)
    facts = tuple(one.with_effects(effects) for one in of.facts)
    return Dragged(predictions, seen_by_fits(of.known, predictions, facts), of.offsets)


def _with(model: Model, named: Named, *, fixed: bool) -> tuple[Added, ...]:
    """The effects of `model` and `named`, in its place where it is among them."""
    added, others = Added(named=named, fixed=fixed), model.effects
    if any(one.named.id == named.id for one in others):
        return tuple(added if one.named.id == named.id else one for one in others)
    return (*others, added)


@dataclass(frozen=True, eq=False, kw_only=True)
class _Asked:
    """One campaign of one question: at which lines, what is read there with the effect, and what that leaves of the data."""

    tested: ReadyCampaign
    lines: Lines
    rows: ComplexArray | None
    before: list[Squares]
    after: list[Squares]
    reached: bool


def _asked_all(of: ReadyPredictions, question: _Question) -> list[_Asked]:
    return [_asked(of, k, question) for k in range(len(of.tested))]


def _asked(of: ReadyPredictions, number: int, question: _Question) -> _Asked:
    """`rows` is None where nothing changes here."""
    one = of.tested[number]
    measured, there = one.prediction.measured, one.prediction.tested.carried.standing.there
    every = np.arange(len(measured.frequency), dtype=np.int64)
    judged = every if question.exact else every[::EVERY]
    lines = every if question.exact else np.union1d(judged, _lines(of, one, question.named))
    before = [replace(each, values=each.values[judged]) for each in one.squares]
    reached = acts(question.named, replace(there, channels=measured.channels))
    if not reached and all(question.offsets.get(name) == value for name, value in of.offsets.items()):
        return _Asked(tested=one, lines=lines, rows=None, before=before, after=before, reached=False)
    prediction = question.predictions[number]
    said = predicted(prediction, question.offsets, lines)
    answered = SampledPrediction(measured=measured, parameters=prediction.parameters, lines=lines, said=said)
    after = evaluate.squares(answered.on(one.judged), question.offsets, judged) if one.judged else []
    return _Asked(tested=one, lines=lines, rows=said.rows, before=before, after=after, reached=reached)


def _lines(of: ReadyPredictions, one: ReadyCampaign, named: Named) -> Lines:
    """As many as can be afforded, where most happens."""
    runs = len(one.prediction.measured.runs) if _by_run(named) else 1
    afforded = int(BUDGET / (of.pace * len(of.tested) * runs))
    return chosen(one.prediction.measured, at_most=max(afforded, FEWEST))


def _by_run(named: Named) -> bool:
    """Whether every run is predicted by itself, since the effect asks how it was driven."""
    family = FAMILIES[named.family]
    return family.side in (AMPLITUDE, PROCESSING) and family.stage in (BODY_STAGE, CHANNEL_STAGE)


def _trace(asked: _Asked, load: int, motion: int) -> Trace:
    one, lines = asked.tested, asked.lines
    before = matrix = one.entries
    frequency = one.prediction.measured.frequency
    if asked.rows is not None and one.operators is not None:
        some = Operators(motion=one.operators.motion[lines], load=one.operators.load[lines])
        matrix = entries(some, asked.rows, one.inputs[:, lines], frequency[lines])
        if len(lines) == len(frequency):
            matrix = matrix
        else:
            # (n, 6, 6) what is `matrix` (m, 6, 6) at `lines`; between them `before` times a factor that goes straight
            at = before[lines]
            factor = np.where(at == 0, 1.0, matrix / np.where(at == 0, 1.0, at))
            right = np.clip(np.searchsorted(lines, np.arange(len(frequency))), 1, len(lines) - 1)
            first, last = frequency[lines[right - 1]], frequency[lines[right]]
            share = np.clip((frequency - first) / (last - first), 0.0, 1.0)[:, None, None]
            found = before * ((1 - share) * factor[right - 1] + share * factor[right])
            found[lines] = matrix
            matrix = np.asarray(found)
    return Trace(
        campaign=one.name,
        frequency=frequency,
        before=before[:, load, motion],
        after=matrix[:, load, motion],
        matrix=matrix,
        unit=unit(load, motion),
        reached=asked.reached,
    )


def _facts(of: ReadyPredictions, question: _Question) -> dict[str, tuple[float, float]]:
    effects = _with(of.model, question.named, fixed=True)
    return {one.name: (one.residual(of.offsets)[0], one.with_effects(effects).residual(question.offsets)[0]) for one in of.facts}


# One effect explained to a person: what it means, how large it is, what it is mistaken for, and what would tell.


@dataclass(frozen=True, kw_only=True)
class Shown:
    """One size of an effect.

    Attributes
    ----------
    key : empty for the one that stands alone
    value, low, high : SI; the last two a 90 % interval, equal to the value where it was not fitted
    unit : SI; "1" for a ratio
    text : value and interval as a laboratory says them: "+7.93 % (+7.69 to +8.17)"
    """

    key: str
    value: float
    low: float
    high: float
    unit: str
    text: str


@dataclass(frozen=True, eq=False, kw_only=True)
class EffectExplanation:
    """One effect, for somebody who never heard of it.

    Attributes
    ----------
    id : ``family:target``
    written : with its size, as `massline add` takes it
    what : in a few words
    text : what it means here
    equation, reference : of the catalogue
    sizes : as the diagnosis found them; none of one that it did not try
    evidence : [nats]; None where it was not tried, or beyond all numbers
    aliases : ids that these data cannot tell from it
    mistaken_for : ids or families that look like it
    confirmed_by : what would confirm it in the laboratory
    separating : measurements that would tell it from its aliases, the best first, in words
    note : what the data say of it beyond its size
    """

    id: str
    written: str
    what: str
    text: str
    equation: str
    reference: str
    sizes: tuple[Shown, ...]
    evidence: float | None
    aliases: tuple[str, ...]
    mistaken_for: tuple[str, ...]
    confirmed_by: str
    separating: tuple[str, ...]
    note: str


def explained(of: Session, effect: str) -> EffectExplanation:
    """`effect` (an id, or with its size) as the diagnosis and the catalogue speak of it. Its curves: `whatif.what_if`.

    Raises
    ------
    BadInput : no such effect, with the nearest.
    """
    named = parse(completed(effect)[0], Vocabulary(accelerometers=None, forces=None, places=None, parts=None), source="effect")
    family, found = FAMILIES[named.family], diagnosing_diagnosis(of) or {}
    # What a diagnosis says of an effect: as it was accepted, else as it was ranked
    id = named.id
    every = (*found.get("accepted", ()), *found.get("ranking", ()))
    nothing: Mapping[str, Any] = {}
    tried = next((one for one in every if one["id"] == id), nothing)
    # Whether a piece of advice tells `named.id` from others; one that names nobody is about all
    return EffectExplanation(
        id=named.id,
        written=str(tried.get("written", effect)),
        what=family.what,
        text=family.sentence.format(target=named.target, targets=" and ".join(named.targets)),
        equation=family.equation,
        reference=family.reference,
        sizes=tuple(_shown(named.family, one) for one in tried.get("values", ())),
        evidence=tried.get("evidence_nats"),
        aliases=_aliases(found, named),
        mistaken_for=family.mistaken_for,
        confirmed_by=family.confirmed_by,
        separating=tuple(_advice(one) for one in found.get("advice", ()) if not one["separates"] or named.id in one["separates"]),
        note=str(tried.get("note") or ""),
    )


def _shown(family: str, one: Mapping[str, Any]) -> Shown:
    key, value, unit, (low, high) = one["key"], one["value"], one["unit"], one["interval90"]
    (middle, least, most), shown = practical_units.written(family, key, unit, (value, low, high))
    text = practical_units.with_unit(middle, shown) + (f" ({least} to {most})" if low < high else "")
    return Shown(key=key, value=value, low=low, high=high, unit=unit, text=text)


def _aliases(found: Mapping[str, Any], named: Named) -> tuple[str, ...]:
    alike = found.get("equivalence_class", ())
    return tuple(id for id in alike if id != named.id) if named.id in alike else ()


def _advice(one: Mapping[str, Any]) -> str:
    gain, hours = one["expected_evidence_nats"], one["hours"]
    return Advice(
        test=one["test"], gain=inf if gain is None else gain, separates=tuple(one["separates"]), hours=hours or 0.0
    ).text


# Every effect of the catalogue that reaches these data, and the sliders that move it.
#
# What is looked for by a diagnosis is its own list (`validation.diagnose.candidates`); mistakes, noise, and what depends on the
# level or on how spectra are made come beside it here: everything that changes what is read, or how surely.


NONE: Mapping[str, float] = MappingProxyType({})

FAR = 5.0
"""Plausible faults from no effect to the end of a slider."""

WIDE, NARROW = 100.0, 10.0
"""Factors below and above where a size is likely, that is known to a factor; of a frequency."""

WORDS = {"m": "mass", "f": "frequency", "zeta": "damping ratio", "z": "height", "mass": "mass of what slips"}
"""Of sizes that do not stand alone, by key."""


@dataclass(frozen=True, kw_only=True)
class Slider:
    """One size of an effect.

    Attributes
    ----------
    key : as in ``key:number``; empty for the one that stands alone
    label : what it is, in words
    unit : SI; "1" for a ratio
    low, high : ends of the slider, SI, within what the catalogue allows
    start : where it begins: no effect where that is a size, else a size that is likely
    null : the size at which there is no effect; None where the slider does not reach one
    logarithmic : whether equal steps are equal factors; then `low` is above zero
    whole : a switch between `low` and `high`
    shown_unit, per_si : in which it reads best on the whole slider, and how many of it are one SI unit
    """

    key: str
    label: str
    unit: str
    low: float
    high: float
    start: float
    null: float | None
    logarithmic: bool
    whole: bool
    shown_unit: str
    per_si: float


@dataclass(frozen=True, eq=False, kw_only=True)
class TrialEffect:
    """An effect that can be tried.

    Attributes
    ----------
    id : ``family:target``
    family, side : of the catalogue; sides are its headings
    what : in a few words
    sliders : none of a mistake that is there or not
    campaigns : names of those that it reaches; none of one that moves the period of a swing alone
    in_model : whether the model has it already; its sliders begin at its size
    """

    id: str
    family: str
    side: str
    what: str
    sliders: tuple[Slider, ...]
    campaigns: tuple[str, ...]
    in_model: bool

    def written(self, sizes: Mapping[str, float] = NONE) -> str:
        """The effect at `sizes` by key, as `validation.app.whatif.what_if` takes it; where none are said at its start."""
        values = {one.key: sizes.get(one.key, one.start) for one in self.sliders}
        return str(Named(family=self.family, targets=tuple(self.id.split(":")[1:]), values=values))


def reaching(of: ReadyPredictions) -> tuple[TrialEffect, ...]:
    """All that act on these data, in the order of the catalogue; those of the model are among them."""
    every = [named for family in FAMILIES.values() for named in _everywhere(of, family)]
    asked = tuple(Added(named=one) for one in every if FAMILIES[one.family].stage == OPENED)
    opened = [{each.name for each in one.prediction.with_effects(asked).parameters} for one in of.tested]
    found = []
    for named in every:
        there = tuple(one.name for one, names in zip(of.tested, opened, strict=True) if _reaches(named, one, names))
        if there or any(fact.swing is not None and classical_facts.acts(named, fact.swing) for fact in of.facts):
            found.append(_effect(of, named, there))
    return tuple(found)


def _everywhere(of: ReadyPredictions, family: Family) -> Iterator[Named]:
    """The family at each of its targets here, at its start; a pair of channels once."""
    for targets in product(*(of.words.legal(kind) or () for kind in family.targets)):
        alike = len(set(family.targets)) < len(family.targets)
        if not alike or targets == tuple(sorted(set(targets))):
            known = next((one.named for one in of.model.effects if one.named.id == ":".join((family.name, *targets))), None)
            typical = parse(examples(family)[0]).values
            values = {}
            for size in family.sizes_at(targets):
                # No effect, where that is a size; else the least of the slider, or of a resonator one that is likely
                start_typical = typical.get(size.key)
                if size.low <= size.null <= size.high and not (size.logarithmic and size.null <= 0):
                    values[size.key] = size.null if size.default is None or size.whole else size.default
                else:
                    if size.key or size.null > size.high:
                        values[size.key] = _centre(size, start_typical)
                    else:
                        values[size.key] = ends(size, start_typical)[0]
            yield known or Named(family=family.name, targets=targets, values=values)


def _reaches(named: Named, one: ReadyCampaign, opened: Collection[str]) -> bool:
    family, there = FAMILIES[named.family], one.prediction.tested.carried.standing.there
    if family.stage == PERIOD_STAGE or (family.stage == OPENED and named.id not in opened):
        return False
    return acts(named, replace(there, channels=one.prediction.measured.channels))


def _effect(of: ReadyPredictions, named: Named, there: tuple[str, ...]) -> TrialEffect:
    family = FAMILIES[named.family]
    typical = parse(examples(family)[0]).values
    return TrialEffect(
        id=named.id,
        family=family.name,
        side=family.side,
        what=family.what,
        sliders=tuple(_slider(family, size, named.values[size.key], typical.get(size.key)) for size in named.sizes),
        campaigns=there,
        in_model=any(one.named.id == named.id for one in of.model.effects),
    )


def _centre(size: SizeSpec, typical: float | None) -> float:
    return size.default or typical or FIRST_GUESS.get(size.key, 1.0)


def _slider(family: Family, size: SizeSpec, start: float, typical: float | None) -> Slider:
    low, high, logarithmic = ends(size, typical)
    shown = practical_units.scale(size.unit, high / 20, ratio=practical_units.is_ratio(family.name, size.key))
    return Slider(
        key=size.key,
        label=WORDS.get(size.key, family.what),
        unit=size.unit,
        low=min(low, start),
        high=max(high, start),
        start=start,
        null=size.null if min(low, start) <= size.null <= max(high, start) else None,
        logarithmic=logarithmic,
        whole=size.whole,
        shown_unit=shown.unit,
        per_si=shown.per_si,
    )


def ends(size: SizeSpec, typical: float | None) -> tuple[float, float, bool]:
    """Ends of a slider, SI, and whether it is one of factors; `typical` is a size that is likely, if one is known."""
    if size.whole:
        return size.low, size.high, False
    if size.low > 0:
        middle = size.null if size.low <= size.null <= size.high else _centre(size, typical)
        reach = NARROW if size.key == "f" else WIDE
        return max(size.low, middle / reach), min(size.high, middle * reach), True
    reach = FAR * (size.plausible or _centre(size, typical))
    return max(size.low, size.null - reach), min(size.high, size.null + reach), False
