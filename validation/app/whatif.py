"""What if: the predicted curves with an effect at any size, while a slider is dragged.

The prediction itself is asked (`validation.prediction.series`), no table of it. Released, at every line of the data and at the
plain fit with the effect at that size; dragged, at as many lines as `BUDGET` allows, those where most happens first, and what a
plain fit frees a step behind (`validation.app.whatif`). What makes that quick: effects on channels leave the structure
solved, and an effect that is dragged is a parameter of a prediction that stays. The size itself is never fitted here.
"""

from collections import OrderedDict
from collections.abc import Hashable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from itertools import product
from threading import Lock
from time import perf_counter
from types import MappingProxyType
from typing import Any, cast

import numpy as np

from geometry.dynamic_mass import ComplexArray
from geometry.errors import BadInput, CheckFailed
from geometry.frames import Array
from geometry.sensors import ChannelTable
from validation.app.session import Session
from validation.compare.maps import Operators, operators, through
from validation.effects import effect as effect_types
from validation.effects import practical_units
from validation.effects.catalogue import FAMILIES, Named, acts, parse
from validation.estimation import evaluate
from validation.estimation.evaluate import Squares
from validation.estimation.fit import BREAKDOWNS, FLOOR, PLAIN_FLOOR, nearby
from validation.estimation.likelihood import cost_of, left_of_run, observed
from validation.estimation.problem import PLAIN, Lines, Measured, Offsets, Parameter, Predicted, Problem, Wanted, chosen
from validation.history.add import FIRST_GUESS
from validation.model.model import Added, Model
from validation.prediction import classical_facts, dynamic_mass, effects
from validation.prediction.classical_facts import ArticleFact, require_bodies
from validation.prediction.dynamic_mass import BaseDrive, SupportedDynamicMass, Tangents
from validation.prediction.series import SeriesPrediction
from validation.prediction.structure_tests import StructurePrediction
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

    def on(self, runs: Sequence[str]) -> "SampledPrediction":
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

    def __init__(self, predictions: tuple[StructurePrediction, ...], problem: Problem, offsets: Offsets) -> None:
        self.predictions, self.offsets = predictions, dict(offsets)
        self.cost = cost_of(problem.sparser(STEP), problem.free(PLAIN), PLAIN_FLOOR, plain=True)

    def follow(self, moved: Mapping[str, float]) -> None:
        """One step towards the plain fit with the effect at the offsets `moved`, in bounds; none where a model breaks down."""
        free = tuple(one for one in self.cost.free if one.name not in moved)
        cost = replace(self.cost, free=free, base={**self.offsets, **moved})
        low, high = cost.bounds
        x = np.clip(cost.at(self.offsets), low, high)
        with suppress(*BREAKDOWNS):
            whole = cost.total(x)[0]
            there = np.clip(x - np.linalg.solve(whole.matrix, whole.gradient), low, high)
            self.offsets = {**self.offsets, **dict(zip(cost.names, map(float, there), strict=True))}


# What the load cells carry, remembered: an effect on a channel need not have the structure solved again.


MOST = 24
"""Dynamic masses that are kept, of some 0.3 MB each."""


class Remembering:
    """A `Carried` that answers the same question once; the answer is the very same. Several threads may ask."""

    def __init__(self, of: SupportedDynamicMass) -> None:
        self._of = of
        own = () if of.nuisances is None else of.nuisances.parameters
        self._names = (*(one.name for one in (*own, *of.mounted)), *dynamic_mass.NAMES)
        self._known: OrderedDict[Hashable, ComplexArray] = OrderedDict()
        self._changing = Lock()

    def __getattr__(self, name: str) -> Any:
        return getattr(self._of, name)

    def at(
        self, offsets: Offsets, effects: Sequence[Added], frequency: Array, drive: BaseDrive, *, derivatives: bool, **more: Any
    ) -> tuple[ComplexArray, Tangents]:
        """As `Carried.at`; derivatives, what was solved already and accelerometers on the article are not remembered."""
        if derivatives or any(more.values()):
            return self._of.at(offsets, effects, frequency, drive, derivatives=derivatives, **more)
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

    def _key(self, offsets: Offsets, effects: Sequence[Added], frequency: Array, drive: BaseDrive) -> Hashable:
        """All that the answer depends on."""
        acting = [
            one.named
            for one in effects
            if FAMILIES[one.named.family].stage in (effect_types.STRUCTURE_STAGE, effect_types.BODY_STAGE)
        ]
        driven: Hashable = None
        if any(FAMILIES[one.family].stage == effect_types.BODY_STAGE for one in acting):
            driven = (drive.amplitude.tobytes(), drive.sweep_rate, drive.block)
        sizes = tuple((one.id, tuple(one.values.items())) for one in acting)
        return (sizes, driven, tuple(offsets.get(name, 0.0) for name in self._names), frequency.tobytes())


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
    operators : from channels to the dynamic mass; None where they or the runs do not tell it, and of a test by itself
    inputs : (r, n, k) base motions as all channels tell them
    entries : (n, 6, 6) predicted without anything more; of a test by itself what it reads, (n, r, c)
    judged : runs whose plain error is told: those that are fitted
    squares : of their relative errors at every line, without anything more
    """

    prediction: StructurePrediction
    operators: Operators | None
    inputs: ComplexArray
    entries: ComplexArray
    judged: tuple[str, ...]
    squares: tuple[Squares, ...]

    @classmethod
    def of(cls, one: StructurePrediction, offsets: Offsets, judged: tuple[str, ...]) -> "ReadyCampaign":
        """`one` made ready at `offsets`, with what its cells carry remembered for whatever is made of it."""
        if not isinstance(one, SeriesPrediction):
            rows, inputs = predicted(one, offsets, None).rows, one.measured.inputs
            squares = tuple(evaluate.squares(one.on(judged), offsets)) if judged else ()
            known = np.ones((*one.measured.values.shape[:2], 1), dtype=np.complex128) if inputs is None else inputs
            return cls(prediction=one, operators=None, inputs=known, entries=_by_line(rows), judged=judged, squares=squares)
        carried = cast(SupportedDynamicMass, Remembering(one.tested.carried))
        one = replace(one, tested=replace(one.tested, carried=carried))
        measured, read, campaign = one.measured, predicted(one, offsets, None), one.tested.campaign
        seen = observed(measured, np.arange(len(measured.frequency), dtype=np.int64))
        weight = seen.weight(FLOOR, read.noise)
        every = (read.rows if read.rows.ndim == 3 else read.rows[run] for run in range(len(measured.runs)))
        inputs = np.stack([left_of_run(seen, rows, weight[run], run).inputs for run, rows in enumerate(every)])
        by_name = {channel.name: channel for channel in campaign.table.channels}
        channels = ChannelTable(channels=tuple(by_name[name] for name in measured.channels), origin=campaign.table.origin)
        found: Operators | None = None
        matrices = np.zeros((0, 6, 6), dtype=np.complex128)
        with suppress(BadInput):  # the map of this campaign has no pairs either, and says why
            told = operators(channels, measured.frequency, np.sqrt(np.mean(measured.noise**2, axis=0)), campaign.gravity)
            through(told, measured.values, measured.frequency)
            found = told
        if found is not None:
            matrices = entries(found, read.rows, inputs, measured.frequency)
        squares = tuple(evaluate.squares(one.on(judged), offsets)) if judged else ()
        return cls(prediction=one, operators=found, inputs=inputs, entries=matrices, judged=judged, squares=squares)

    def curves(self, rows: ComplexArray, lines: Lines) -> ComplexArray:
        """`entries` of what is predicted, `rows`, at `lines` (m,)."""
        if self.operators is None:
            return _by_line(rows)
        some = Operators(motion=self.operators.motion[lines], load=self.operators.load[lines])
        return entries(some, rows, self.inputs[:, lines], self.prediction.measured.frequency[lines])

    @property
    def name(self) -> str:
        """Of the campaign."""
        return self.prediction.measured.name

    def feels(self, named: Named) -> bool:
        """Whether the effect acts on this campaign at all."""
        return acts(named, self.prediction.there)


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
    pace : [s] that one line of a campaign costs, curves and all, when all is solved anew
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
    words: effect_types.Vocabulary
    known: Problem
    dragged: dict[str, Dragged] = field(default_factory=dict)

    @property
    def campaigns(self) -> tuple[str, ...]:
        """Names."""
        return tuple(one.name for one in self.tested)

    def with_effect(self, named: Named, *, fixed: bool) -> tuple[Added, ...]:
        """The effects of the model and `named`, in its place where it is among them."""
        added, others = Added(named=named, fixed=fixed), self.model.effects
        if any(one.named.id == named.id for one in others):
            return tuple(added if one.named.id == named.id else one for one in others)
        return (*others, added)

    def predictions(self, named: Named, *, fixed: bool) -> tuple[tuple[StructurePrediction, ...], Problem]:
        """With the effect, and what fits see of them; facts only those that the fits know already."""
        effects = self.with_effect(named, fixed=fixed)
        predictions = tuple(one.prediction.with_effects(effects) for one in self.tested)
        by_name = {one.measured.name: one for one in predictions}
        some = tuple(by_name[one.measured.name].on(one.measured.runs) for one in self.known.predictions)
        kept = {one.name for one in self.known.facts}
        facts = tuple(one.with_effects(effects) for one in self.facts if one.name in kept)
        return predictions, Problem(some, facts, lines=self.known.lines)

    def drag(self, named: Named, *, follow: bool) -> "_Question":
        """What is asked while somebody waits: as much as can be had."""

        def ready(*, fixed: bool) -> Dragged:
            return Dragged(*self.predictions(named, fixed=fixed), self.offsets)

        # The effect as it was dragged last, kept for a while
        kept = self.dragged.get(named.id) or ready(fixed=False)
        kept = self.dragged.setdefault(named.id, kept)  # another thread may have been sooner
        for old in list(self.dragged)[:-KEPT]:
            self.dragged.pop(old, None)
        # Offsets that move the parameters of the effect to its sizes
        known: dict[str, Parameter] = kept.cost.problem.by_name
        wanted = {effects.name(named, key): value for key, value in named.values.items()}
        if wanted and set(wanted) <= set(known):
            moved = {name: known[name].offset(value) for name, value in wanted.items()}
        else:  # a size that no fit moves: its predictions are new ones
            kept, moved = ready(fixed=True), {}
        if follow:
            kept.follow(moved)
        offsets = {**(kept.offsets if follow else self.offsets), **moved}
        return _Question(named=named, predictions=kept.predictions, offsets=offsets, moved=moved, exact=False)

    def asked(self, question: "_Question") -> "list[_Asked]":
        """The answers of all campaigns."""
        found = []
        for one, prediction in zip(self.tested, question.predictions, strict=True):
            measured = one.prediction.measured
            every = np.arange(len(measured.frequency), dtype=np.int64)
            judged = lines = every
            if not question.exact:
                # As many lines as can be afforded, where most happens
                runs = len(measured.runs) if _by_run(question.named) else 1
                afforded = int(BUDGET / (self.pace * len(self.tested) * runs))
                judged = every[::EVERY]
                lines = np.union1d(judged, chosen(measured, at_most=max(afforded, FEWEST)))
            before = [replace(each, values=each.values[judged]) for each in one.squares]
            reached = one.feels(question.named)
            if not reached and all(question.offsets.get(name) == value for name, value in self.offsets.items()):
                found.append(_Asked(tested=one, lines=lines, rows=None, before=before, after=before, reached=False))
                continue
            said = predicted(prediction, question.offsets, lines)
            answered = SampledPrediction(measured=measured, parameters=prediction.parameters, lines=lines, said=said)
            after = evaluate.squares(answered.on(one.judged), question.offsets, judged) if one.judged else []
            found.append(_Asked(tested=one, lines=lines, rows=said.rows, before=before, after=after, reached=reached))
        return found


def entries(of: Operators, rows: ComplexArray, inputs: ComplexArray, frequency: Array) -> ComplexArray:
    """(m, 6, 6) of what the channels are predicted to read, on the same way as what they read. Where all runs share their rows it
    does not matter what they were: H = R A (T A)^-1."""
    read = np.moveaxis(rows, -1, 0) if rows.ndim == 3 else (rows @ inputs[..., None])[..., 0]
    return np.asarray(through(of, read, frequency).dynamic_mass.matrix)


def _by_line(rows: ComplexArray) -> ComplexArray:
    """Readings (r, n, c, 1) of a test by itself, lines first."""
    return np.asarray(rows[..., 0].swapaxes(0, 1))


def predicted(one: StructurePrediction, offsets: Offsets, lines: Lines | None) -> Predicted:
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
"""[s] of predictions and curves while dragging; errors and what follows come on top of it, and the page has to draw them."""

FEWEST = 40
"""Lines of a campaign, whatever they cost."""

EVERY = 12
"""While dragging the plain error is told at every so many lines, whatever happens there."""

KEPT = 6
"""Effects whose predictions stay."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Trace:
    """What is predicted of one campaign.

    Attributes
    ----------
    campaign : data set
    frequency : (n,) [Hz], all lines of the campaign
    matrix : (n, 6, 6) with the effect, all entries, about F [kg, kg m, kg m²]; of a test by itself (n, r, c), by run and channel;
        between lines that were not asked for it goes with that of the model
    reached : whether the effect acts on this campaign at all
    """

    campaign: str
    frequency: Array
    matrix: ComplexArray
    reached: bool


@dataclass(frozen=True, eq=False, kw_only=True)
class WhatIf:
    """What an effect of that size would do.

    Attributes
    ----------
    written : the effect with its size
    traces : one a campaign that tells a dynamic mass, and one a test by itself
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


def table(of: Session, positions: Sequence[str] = ()) -> ReadyPredictions:
    """Predictions of the data by the model as it stands, at the plain fit where there is a comparison; a second or few.

    They are ready for effects at `positions`, places without a name that are written as coordinates, too.

    What is there or not and looks at all lines (the bias of sweeps) is worked out here once, and is there when it is asked for.

    Raises
    ------
    BadInput : model or data that cannot be used.
    CheckFailed : the model breaks down as it stands.
    """
    study, known = of.study().ready_at(positions), of.comparison()
    made, whole = study.predictions, study.problem()
    offsets = {**study.whole().start, **({} if known is None else known.offsets)}
    fitted = {one.measured.name: one.measured.runs for one in whole.predictions}
    tested = tuple(ReadyCampaign.of(one, offsets, fitted.get(one.measured.name, ())) for one in made)
    taken = []  # [s] what all lines cost, solved anew, when nothing else is in the way
    for _ in range(TRIES):
        began = perf_counter()
        for one, ready in zip(made, tested, strict=True):
            ready.curves(predicted(one, offsets, None).rows, np.arange(len(one.measured.frequency)))
        taken.append(perf_counter() - began)
    found = ReadyPredictions(
        model=study.model,
        tested=tested,
        facts=tuple(one.with_effects(study.model.effects) for one in study.said),
        offsets=offsets,
        at=DRAWN if known is None else FITTED,
        pace=min(taken) / max(sum(len(one.measured.frequency) for one in made), 1),
        words=study.words,
        known=whole,
    )
    for family in FAMILIES.values():
        named = Named(family=family.name, values={})
        if family.side == effect_types.PROCESSING and not family.targets and not family.sizes and _by_run(named):
            found.asked(found.drag(named, follow=False))
    return found


def what_if(of: ReadyPredictions, effect: str, *, exact: bool = True, follow: bool = True) -> WhatIf:
    """What is predicted with `effect` (``ID=VALUE``, ``ID=key:number,...``) in the model.

    Parameters
    ----------
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
    effects = of.with_effect(named, fixed=True)
    every = [one.prediction for one in of.tested]
    require_bodies(
        replace(of.model, effects=effects), [one.tested.campaign for one in every if isinstance(one, SeriesPrediction)]
    )
    follows = follow and of.at == FITTED and (exact or not _by_run(named))
    if exact:
        # Everything, and what follows settled; the effect is ready to be dragged afterwards, its first drag behind it
        if named.id not in of.dragged:
            of.asked(of.drag(named, follow=follows and not _by_run(named)))
        predictions, problem = of.predictions(named, fixed=True)
        offsets = dict(of.offsets)
        if follows and _by_run(named):
            followed = Dragged(predictions, problem, offsets)
            for _ in range(STEPS):
                followed.follow({})
            offsets = followed.offsets
        elif follows:
            offsets |= nearby(problem, PLAIN, offsets).by_name
        question = _Question(named=named, predictions=predictions, offsets=offsets, moved={}, exact=True)
    else:
        question = of.drag(named, follow=follows)
    asked = of.asked(question)
    return WhatIf(
        written=str(named),
        traces=tuple(one.trace() for one in asked if len(one.tested.entries)),
        plain_percent=evaluate.share([each for one in asked for each in one.after]).percent,
        before_percent=evaluate.share([each for one in asked for each in one.before]).percent,
        facts={
            one.name: (one.residual(of.offsets)[0], one.with_effects(effects).residual(question.offsets)[0]) for one in of.facts
        },
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
    predictions: tuple[StructurePrediction, ...]
    offsets: Offsets
    moved: Mapping[str, float]
    exact: bool


@dataclass(frozen=True, eq=False, kw_only=True)
class _Asked:
    """One campaign of one question: at which lines, what is read there with the effect, and what that leaves of the data.

    `rows` is None where nothing changes here.
    """

    tested: ReadyCampaign
    lines: Lines
    rows: ComplexArray | None
    before: list[Squares]
    after: list[Squares]
    reached: bool

    def trace(self) -> Trace:
        """Its curves."""
        one, lines = self.tested, self.lines
        before = matrix = one.entries
        frequency = one.prediction.measured.frequency
        if self.rows is not None:
            matrix = one.curves(self.rows, lines)
            if len(lines) < len(frequency):
                # Between the lines that were asked for it is `before` times a factor that goes straight
                at = before[lines]
                factor = np.where(at == 0, 1.0, matrix / np.where(at == 0, 1.0, at))
                right = np.clip(np.searchsorted(lines, np.arange(len(frequency))), 1, len(lines) - 1)
                first, last = frequency[lines[right - 1]], frequency[lines[right]]
                share = np.clip((frequency - first) / (last - first), 0.0, 1.0)[:, None, None]
                between = before * ((1 - share) * factor[right - 1] + share * factor[right])
                between[lines] = matrix
                matrix = np.asarray(between)
        return Trace(campaign=one.name, frequency=frequency, matrix=matrix, reached=self.reached)


def _by_run(named: Named) -> bool:
    """Whether every run is predicted by itself, since the effect asks how it was driven."""
    family = FAMILIES[named.family]
    return family.side in (effect_types.AMPLITUDE, effect_types.PROCESSING) and family.stage in (
        effect_types.BODY_STAGE,
        effect_types.CHANNEL_STAGE,
    )


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
    asked = tuple(Added(named=one) for one in every if FAMILIES[one.family].stage == effect_types.OPENED)
    opened = [{each.name for each in one.prediction.with_effects(asked).parameters} for one in of.tested]
    found = []
    for named in every:
        family = FAMILIES[named.family]
        there = tuple(
            one.name
            for one, names in zip(of.tested, opened, strict=True)
            if family.stage != effect_types.PERIOD_STAGE
            and (family.stage != effect_types.OPENED or named.id in names)
            and one.feels(named)
        )
        if not there and not any(fact.swing is not None and classical_facts.acts(named, fact.swing) for fact in of.facts):
            continue
        typical = parse(examples(family)[0]).values
        one = TrialEffect(
            id=named.id,
            family=family.name,
            side=family.side,
            what=family.what,
            sliders=tuple(_slider(family, size, named.values[size.key], typical.get(size.key)) for size in named.sizes),
            campaigns=there,
            in_model=any(one.named.id == named.id for one in of.model.effects),
        )
        found.append(one)
    return tuple(found)


def _everywhere(of: ReadyPredictions, family: effect_types.Family) -> Iterator[Named]:
    """The family at each of its targets here, at its start; a pair of channels once."""
    alike = len(set(family.targets)) < len(family.targets)
    typical = parse(examples(family)[0]).values
    for targets in product(*(of.words.legal(kind) or () for kind in family.targets)):
        if alike and targets != tuple(sorted(set(targets))):
            continue
        known = next((one.named for one in of.model.effects if one.named.id == ":".join((family.name, *targets))), None)
        values = {}
        for size in family.sizes_at(targets):
            # No effect, where that is a size; else the least of the slider, or of a resonator one that is likely
            likely = typical.get(size.key)
            if size.low <= size.null <= size.high and not (size.logarithmic and size.null <= 0):
                values[size.key] = size.null if size.default is None or size.whole else size.default
            elif size.key or size.null > size.high:
                values[size.key] = _centre(size, likely)
            else:
                values[size.key] = ends(size, likely)[0]
        yield known or Named(family=family.name, targets=targets, values=values)


def _centre(size: effect_types.SizeSpec, typical: float | None) -> float:
    return size.default or typical or FIRST_GUESS.get(size.key, 1.0)


def _slider(family: effect_types.Family, size: effect_types.SizeSpec, start: float, typical: float | None) -> Slider:
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


def ends(size: effect_types.SizeSpec, typical: float | None) -> tuple[float, float, bool]:
    """Ends of a slider, SI, and whether it is one of factors; `typical` is a size that is likely, if one is known."""
    if size.whole:
        return size.low, size.high, False
    if size.low > 0:
        middle = size.null if size.low <= size.null <= size.high else _centre(size, typical)
        reach = NARROW if size.key == "f" else WIDE
        return max(size.low, middle / reach), min(size.high, middle * reach), True
    reach = FAR * (size.plausible or _centre(size, typical))
    return max(size.low, size.null - reach), min(size.high, size.null + reach), False
