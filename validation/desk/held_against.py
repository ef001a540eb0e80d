"""The model of a desk held against its data as a rung of its ladder, and the comparison that such a rung tells.

Comparing, diagnosing and adding all begin with the same fits. They are made once, by `validation.ladders.adding.grounded`, and
stay on the ladder with the offsets at which they ended; maps and words of the comparison follow from these in seconds.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

from validation.comparing.compared import meant, of_evaluation
from validation.comparing.comparison import Comparison
from validation.comparing.gathered import Data
from validation.desk.desk import Desk
from validation.desk.recorded import made, model_of
from validation.engine import errors, hold_out
from validation.engine.errors import Squares
from validation.engine.evaluation import Evaluation, Fit, Share
from validation.engine.fit import unfitted
from validation.engine.parameter import FITTED, PLAIN
from validation.engine.prediction import Offsets
from validation.engine.problem import Problem
from validation.identifying.known import above_fmd
from validation.ladders import sources
from validation.ladders.adding import grounded
from validation.ladders.climbing import Standing, standing
from validation.ladders.judging import Bench
from validation.ladders.nouns import Conditions, Errors, Rung
from validation.models.model import Model
from validation.prediction.facts import ArticleFact, facts
from validation.prediction.series import SeriesPrediction

Progress = Callable[[str, float], None]


@dataclass(frozen=True, eq=False, kw_only=True)
class Ground:
    """What a desk compares, ready.

    Attributes
    ----------
    model : the working copy
    made : predictions by the model with its effects
    facts : what weights and periods say
    problem : all data, by that model
    bench : by any model, as the ladder wants it
    conditions : as a rung keeps them
    """

    model: Model
    made: tuple[SeriesPrediction, ...]
    facts: tuple[ArticleFact, ...]
    problem: Problem
    bench: Bench
    conditions: Conditions

    @property
    def fitted(self) -> Problem:
        """What fits see of it."""
        thinned = self.problem.thinned()
        return hold_out.without(thinned, hold_out.named(thinned, self.bench.hold_out)) if self.bench.hold_out else thinned


def ground(of: Desk, progress: Progress | None = None) -> Ground:
    """The model and the data of a desk.

    Raises
    ------
    BadInput : they cannot be used, or what is held out is none of them.
    OSError : a file cannot be read.
    """
    model, asked = model_of(of), of.asked
    series = made(of, model, progress)
    classical = tuple(path for path in asked.data if not Path(path).is_dir())
    said = facts(model, classical)  # read once: records are fitted on the way

    def problem(other: Model) -> Problem:
        own = tuple(fact.with_effects(other.effects) for fact in said)
        return Problem(tuple(one.with_effects(other.effects) for one in series), own)

    whole = problem(model)
    names = meant(whole, Data(campaigns=tuple(one.tested.campaign for one in series), classical=classical), asked.hold_out)
    if names:
        hold_out.without(whole, hold_out.named(whole, names))  # refused before minutes are spent
    return Ground(
        model=model,
        made=tuple(one for one in whole.predictions if isinstance(one, SeriesPrediction)),
        facts=said,
        problem=whole,
        bench=Bench(problem=problem, hold_out=names, article=_article(model, series)),
        conditions=Conditions(
            data=sources.sources(asked.data, of.model.parent), hold_out=names, band=asked.band, method=asked.method
        ),
    )


def rung(of: Desk, ready: Ground, progress: Progress) -> Rung:
    """The rung on which the model stands, fitted and kept where it was not yet.

    Raises
    ------
    BadInput : the working copy was changed meanwhile.
    CheckFailed : a fit does not converge.
    """
    at = standing(of.model)
    found = at.rung if at.rung is not None and at.rung.stands_on(ready.conditions) else None
    if found is None:
        found = _grounded(at, ready, progress).rung
    if found is None:
        raise RuntimeError("a rung that was kept must be the one on which the model stands")
    return found


def _grounded(at: Standing, ready: Ground, progress: Progress) -> Standing:
    def tell(what: str, share: float) -> None:
        progress(what.removeprefix("the model before: "), share)

    return grounded(at, ready.model, ready.bench, ready.conditions, tell)[0]


def comparison(ready: Ground, at: Rung, progress: Progress) -> Comparison:
    """What `validation.comparing.compared` finds, from the fits of the rung `at` instead of fits of its own.

    Raises
    ------
    CheckFailed : without some channel the others do not tell the inputs.
    ValueError : the rung has no figures.
    """
    if at.errors is None:
        raise ValueError("`at` must have figures")
    evaluation = _evaluation(ready, at, at.errors)
    return of_evaluation(
        ready.model, ready.made, ready.facts, ready.problem, ready.fitted, evaluation, lambda share: progress("maps", share)
    )


def _evaluation(ready: Ground, at: Rung, figures: Errors) -> Evaluation:
    """The errors of a rung with the fits behind them, taken where they ended; shares of fitted data are told anew."""
    known = ready.fitted
    plain, fitted = _fit(known, PLAIN, at.plain_offsets, figures), _fit(known, FITTED, at.fitted_offsets, figures)
    offsets = {**ready.problem.start, **plain.by_name}
    return Evaluation(
        nominal=errors.share(_squares(known, ready.problem.start)),
        plain=errors.share(_squares(known, offsets)),
        held_out=_share(figures.held_out, figures),
        held_out_nominal=_share(figures.held_out_nominal, None),
        plain_fit=plain,
        fitted=replace(
            fitted, chi2=figures.chi2, degrees_of_freedom=figures.degrees_of_freedom, log_evidence=figures.log_evidence
        ),
        held_out_names=figures.held_out_names,
    )


def _fit(known: Problem, kinds: tuple[str, ...], offsets: Offsets, figures: Errors) -> Fit:
    return replace(unfitted(known, kinds, offsets), converged=figures.converged)


def _squares(known: Problem, offsets: Offsets) -> list[Squares]:
    return [one for prediction in known.predictions for one in errors.squares(prediction, offsets)]


def _share(percent: float | None, figures: Errors | None) -> Share | None:
    return None if percent is None else Share(percent=percent, by_fold={} if figures is None else dict(figures.by_fold))


def _article(model: Model, series: tuple[SeriesPrediction, ...]) -> str:
    """Whose inertia is identified: the model's own article where it was tested, else the first that stood on the FMD."""
    tested = [one.tested.carried.standing.article for one in series]
    own = above_fmd(model.article)
    return own if own in tested else next((one for one in tested if one), "")
