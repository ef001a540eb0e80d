"""What if: the predicted curves of one entry with an effect at any size, while a slider is dragged.

The prediction itself is asked (`validation.prediction.series`), no table of it. Released, at every line of the data and at the
plain fit with the effect at that size; dragged, at as many lines as `BUDGET` allows, those where most happens first, and what a
plain fit frees a step behind (`validation.desk.following`). What makes that quick: effects on channels leave the structure
solved, and an effect that is dragged is a parameter of a prediction that stays. The size itself is never fitted here.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray
from validation.comparing.pairs import Operators
from validation.desk.answered import Answered
from validation.desk.desk import Desk
from validation.desk.following import Dragged, seen_by_fits, settled, several_steps
from validation.desk.table import DRAWN, FITTED, Table, Tested, entries, predicted
from validation.desk.table import table as made_ready
from validation.effects.catalogue import FAMILIES
from validation.effects.family import AMPLITUDE, BODY_STAGE, CHANNEL_STAGE, PROCESSING
from validation.effects.identifiers import Named, parse
from validation.effects.reach import acts
from validation.engine import errors
from validation.engine.errors import Squares
from validation.engine.parameter import Parameter
from validation.engine.prediction import Lines, Offsets
from validation.engine.thinning import chosen
from validation.models.model import Added, Model
from validation.pictures.curves import unit
from validation.prediction import applied
from validation.prediction.bodies import require_bodies
from validation.prediction.series import SeriesPrediction

__all__ = ["DRAWN", "FITTED", "Table", "Tested", "Trace", "WhatIf", "table", "what_if"]

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


def table(of: Desk) -> Table:
    """Predictions of the data by the model as it stands, at the plain fit where there is a comparison; a second or few.

    What is there or not and looks at all lines (the bias of sweeps) is worked out here once, and is there when it is asked for.

    Raises
    ------
    BadInput : model or data that cannot be used.
    CheckFailed : the model breaks down as it stands.
    """
    found = made_ready(of)
    for family in FAMILIES.values():
        named = Named(family=family.name, values={})
        if family.side == PROCESSING and not family.targets and not family.sizes and _by_run(named):
            _asked_all(found, _dragged(found, named, follow=False))
    return found


def what_if(of: Table, effect: str, load: int, motion: int, *, exact: bool = True, follow: bool = True) -> WhatIf:
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
    question = _released(of, named, follow=follows) if exact else _dragged(of, named, follow=follows)
    asked = _asked_all(of, question)
    before = [each for one in asked for each in one.before]
    after = [each for one in asked for each in one.after]
    return WhatIf(
        written=str(named),
        traces=tuple(_trace(one, load, motion) for one in asked if one.tested.operators is not None),
        plain_percent=errors.share(after).percent,
        before_percent=errors.share(before).percent,
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


def _released(of: Table, named: Named, *, follow: bool) -> _Question:
    """Everything, and what follows settled; the effect is ready to be dragged afterwards, its first drag behind it."""
    if named.id not in of.dragged:
        _asked_all(of, _dragged(of, named, follow=follow and not _by_run(named)))
    effects = _with(of.model, named, fixed=True)
    predictions = tuple(one.prediction.with_effects(effects) for one in of.tested)
    offsets = dict(of.offsets)
    if follow:
        facts = tuple(one.with_effects(effects) for one in of.facts)
        problem = seen_by_fits(of.known, predictions, facts)
        offsets |= several_steps(problem, of.offsets) if _by_run(named) else settled(problem, of.offsets)
    return _Question(named=named, predictions=predictions, offsets=offsets, moved={}, exact=True)


def _dragged(of: Table, named: Named, *, follow: bool) -> _Question:
    """As much as can be had while somebody waits."""
    kept = _ready(of, named)
    moved = _moved(kept, named)
    if moved is None:  # a size that no fit moves: its predictions are new ones
        kept, moved = _free(of, named, fixed=True), {}
    if follow:
        kept.follow(moved)
    offsets = {**(kept.offsets if follow else of.offsets), **moved}
    return _Question(named=named, predictions=kept.predictions, offsets=offsets, moved=moved, exact=False)


def _ready(of: Table, named: Named) -> Dragged:
    """The effect as it was dragged last, kept for a while."""
    kept = of.dragged.get(named.id) or _free(of, named, fixed=False)
    kept = of.dragged.setdefault(named.id, kept)  # another thread may have been sooner
    for old in list(of.dragged)[:-KEPT]:
        of.dragged.pop(old, None)
    return kept


def _free(of: Table, named: Named, *, fixed: bool) -> Dragged:
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


def _moved(kept: Dragged, named: Named) -> dict[str, float] | None:
    """Offsets that move the parameters of an effect to the sizes of `named`; None where one of them is no parameter."""
    known: dict[str, Parameter] = kept.problem.by_name
    wanted = {applied.name(named, key): value for key, value in named.values.items()}
    if not wanted or not set(wanted) <= set(known):
        return None
    return {name: known[name].offset(value) for name, value in wanted.items()}


@dataclass(frozen=True, eq=False, kw_only=True)
class _Asked:
    """One campaign of one question: at which lines, what is read there with the effect, and what that leaves of the data."""

    tested: Tested
    lines: Lines
    rows: ComplexArray | None
    before: list[Squares]
    after: list[Squares]
    reached: bool


def _asked_all(of: Table, question: _Question) -> list[_Asked]:
    return [_asked(of, k, question) for k in range(len(of.tested))]


def _asked(of: Table, number: int, question: _Question) -> _Asked:
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
    answered = Answered(measured=measured, parameters=prediction.parameters, lines=lines, said=said)
    after = errors.squares(answered.on(one.judged), question.offsets, judged) if one.judged else []
    return _Asked(tested=one, lines=lines, rows=said.rows, before=before, after=after, reached=reached)


def _lines(of: Table, one: Tested, named: Named) -> Lines:
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


def _facts(of: Table, question: _Question) -> dict[str, tuple[float, float]]:
    effects = _with(of.model, question.named, fixed=True)
    return {one.name: (one.residual(of.offsets)[0], one.with_effects(effects).residual(question.offsets)[0]) for one in of.facts}
