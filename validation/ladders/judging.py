"""A model held against data: the figures of a rung, and the model file with the sizes that its effects were found to have."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from validation.comparing.verdicts import expected_z2, largest_z
from validation.engine import errors, hold_out
from validation.engine.evaluate import evaluate
from validation.engine.evaluation import Evaluation, Fit, Share
from validation.engine.parameter import EFFECT, Parameter
from validation.engine.problem import Problem
from validation.ladders.identified import identified
from validation.ladders.nouns import Body, Errors, Rung, Size
from validation.models.editing import with_effect
from validation.models.model import Added, Model
from validation.prediction.applied import name

Progress = Callable[[str, float], None]
"""Hears what is done now, and the share of it."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Bench:
    """Data, ready to hold a model against them.

    Attributes
    ----------
    problem : by model, what is compared
    hold_out : names of runs, data sets and facts as the engine knows them
    article : whose inertia is identified; empty for none
    remarks : which lines of the data were left out, and why
    """

    problem: Callable[[Model], Problem]
    hold_out: tuple[str, ...] = ()
    article: str = ""
    remarks: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False, kw_only=True)
class Judged:
    """A model and what came out.

    Attributes
    ----------
    model : with the sizes that its effects were found to have
    evaluation : errors and fits; the nominal ones at those sizes
    body : identified inertia; None where there is none
    """

    model: Model
    evaluation: Evaluation
    body: Body | None


def judged(bench: Bench, model: Model, parent: Rung | None, progress: Progress | None = None) -> Judged:
    """`model` held against the data of `bench`.

    Parameters
    ----------
    parent : on the same data, of the model without its last effect: no fit costs more than its own

    Raises
    ------
    CheckFailed : a fit without a parent does not converge.
    """
    tell = progress or (lambda what, share: None)
    problem = bench.problem(model)
    began = None if parent is None else _evaluation(parent, problem)
    found = evaluate(problem, hold_out=bench.hold_out, parent=began, progress=lambda share: tell("fitting", share))
    sized = replace(model, effects=tuple(sized_by(one, found.fitted) for one in model.effects))
    after = bench.problem(sized)
    nominal, held = _nominal(after, bench.hold_out)
    whole = replace(found, nominal=nominal, held_out_nominal=held)
    body = body_of(bench, after, found.plain_fit, lambda share: tell("identifying", share))
    return Judged(model=sized, evaluation=whole, body=body)


def rung_with(rung: Rung, of: Judged) -> Rung:
    """`rung` with the figures of what was judged."""
    return replace(
        rung,
        errors=_errors(of.evaluation),
        effects={one.named.id: _sizes(one) for one in of.model.effects},
        bodies=() if of.body is None else (of.body,),
        plain_offsets=kept_offsets(of.evaluation.plain_fit),
        fitted_offsets=kept_offsets(of.evaluation.fitted),
    )


def rewritten(text: str, effects: Sequence[Added], source: str) -> str:
    """The `text` of the model file `source` with all `effects` at their sizes.

    Raises
    ------
    BadInput : its layout allows no change of one effect alone.
    """
    for one in effects:
        text = with_effect(text, one, source)
    return text


def sized_by(added: Added, fit: Fit) -> Added:
    """`added` at the size and the standard deviation that `fit` found, within what its family allows."""
    values, deviation = dict(added.named.values), {}
    spread = np.sqrt(np.diag(fit.covariance))
    found = {one.name: (one, float(x), float(sd)) for one, x, sd in zip(fit.parameters, fit.offsets, spread, strict=True)}
    for size in added.named.sizes:
        which = name(added.named, size.key)
        if not added.fixed and which in found and found[which][0].kind == EFFECT:
            one, x, sd = found[which]
            values[size.key] = min(max(one.value(x), size.low), size.high)
            deviation[size.key] = abs(one.slope(x)) * sd
    return replace(added, named=replace(added.named, values=values), deviation=deviation or added.deviation)


def _sizes(added: Added) -> tuple[Size, ...]:
    """Sizes as the rung says them; one that was not fitted has no deviation."""
    return tuple(
        Size(
            key=size.key,
            value=added.named.values[size.key],
            unit=size.unit,
            deviation=None if added.fixed else added.deviation.get(size.key),
        )
        for size in added.named.sizes
    )


def _errors(of: Evaluation) -> Errors:
    return Errors(
        nominal=of.nominal.percent,
        plain=of.plain.percent,
        held_out_nominal=None if of.held_out_nominal is None else of.held_out_nominal.percent,
        held_out=None if of.held_out is None else of.held_out.percent,
        chi2=of.fitted.chi2,
        degrees_of_freedom=of.fitted.degrees_of_freedom,
        tolerance_z2=of.fitted.tolerance_z2,
        tolerances=of.fitted.tolerances,
        log_evidence=of.fitted.log_evidence,
        expected_z2=expected_z2(of.fitted),
        largest_z=largest_z(of.fitted),
        converged=of.plain_fit.converged and of.fitted.converged,
        held_out_names=of.held_out_names,
        by_channel=dict(of.plain.by_channel),
        by_fold={} if of.held_out is None else dict(of.held_out.by_fold),
    )


def kept_offsets(fit: Fit) -> dict[str, float]:
    """Offsets from which another fit may begin; a logarithmic size of an effect will count from what the model file says."""
    return {name: x for name, x in fit.by_name.items() if not _counts_anew(_named(fit, name))}


def _named(fit: Fit, name: str) -> Parameter:
    return next(one for one in fit.parameters if one.name == name)


def _counts_anew(one: Parameter) -> bool:
    return one.kind == EFFECT and one.logarithmic and one.above == 0.0


def _evaluation(rung: Rung, problem: Problem) -> Evaluation:
    """As much of the evaluation of `rung` as a child begins with: where its fits ended."""
    nothing = Share(percent=0.0)
    return Evaluation(
        nominal=nothing,
        plain=nothing,
        held_out=None,
        held_out_nominal=None,
        plain_fit=at_offsets(rung.plain_offsets, problem),
        fitted=at_offsets(rung.fitted_offsets, problem),
    )


def at_offsets(offsets: Mapping[str, float], problem: Problem) -> Fit:
    """A fit of `problem` that ended at `offsets`, of which nothing else is known."""
    known = [one for one in problem.parameters if one.name in offsets]
    return Fit(
        parameters=tuple(known),
        offsets=np.array([offsets[one.name] for one in known]),
        covariance=np.zeros((len(known), len(known))),
        cost=np.inf,
        chi2=np.inf,
        degrees_of_freedom=0,
        tolerance_z2=0.0,
        tolerances=0,
        log_evidence=-np.inf,
        converged=True,
    )


def _nominal(problem: Problem, names: Sequence[str]) -> tuple[Share, Share | None]:
    """The errors of the model as it stands, on what is fitted and on what the held-out plain error is told of: runs, or what is
    named, no configurations."""
    apart = hold_out.named(problem, names) if names else None
    known = problem if apart is None else hold_out.without(problem, apart)
    turns = [fold for fold in hold_out.folds(problem) if not fold.configuration] if apart is None else [apart]
    fitted = [each for one in known.predictions for each in errors.squares(one, problem.start)]
    held = [
        each
        for fold in turns
        for one, lines in hold_out.held(problem, fold)
        for each in errors.squares(one, problem.start, lines, fold=fold.name)
    ]
    return errors.share(fitted), errors.share(held) if held else None


def body_of(bench: Bench, problem: Problem, plain: Fit, progress: Callable[[float], None]) -> Body | None:
    """Identified inertia of the article of a bench, by the model of `problem`, whose plain fit is `plain`; None without one."""
    if not bench.article:
        return None
    known = hold_out.without(problem, hold_out.named(problem, bench.hold_out)) if bench.hold_out else problem
    return identified(known.thinned(), bench.article, at_offsets(kept_offsets(plain), known), progress)
