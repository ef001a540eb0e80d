"""The four errors of a model, on the data that it was fitted to and on data that it has not seen."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from validation.engine import errors
from validation.engine.descent import Progress
from validation.engine.errors import Squares
from validation.engine.evaluation import Evaluation, Fit, Share
from validation.engine.fit import PLAIN_FLOOR, fit, nearby
from validation.engine.hold_out import Fold, every_block, folds, held, named, without
from validation.engine.parameter import FITTED, PLAIN
from validation.engine.prediction import Lines, Offsets, Prediction
from validation.engine.problem import Problem
from validation.engine.refit import refitted, solved

EVEN = 3
"""Quick errors are told at every so many lines."""


def evaluate(
    problem: Problem,
    *,
    hold_out: Sequence[str] = (),
    blocks: int = 0,
    parent: Evaluation | Fit | None = None,
    fitted: Fit | None = None,
    quick: bool = False,
    progress: Progress | None = None,
) -> Evaluation:
    """The errors of a model.

    Without names each run of each data set is held out in turn, and of a series each configuration: all data are fitted, and
    every fold is predicted by a plain fit without it. What is named is held out of every fit.

    Parameters
    ----------
    hold_out : runs, data sets, configurations and facts that are predicted and never fitted
    blocks : so many blocks of frequency are held out in turn instead; 0 for none
    parent : evaluation of the model without its last effect, on the same data: no fit costs more than its own there. A `Fit` is
        that of all parameters
    fitted : the fit of all parameters, where it is known already; the plain one then begins there
    quick : whether every third line is enough, no configuration is held out, and folds are a single step away
    progress : told the share of the work that is done, 0 to 1

    Raises
    ------
    BadInput : an unknown name in `hold_out`; too many `blocks`.
    CheckFailed : a fit without a parent does not converge; without some channel the others do not tell latent inputs.
    """
    tell = progress or (lambda share: None)
    apart = named(problem, hold_out) if hold_out else None
    thinned = problem.thinned()
    known = thinned if apart is None else without(thinned, apart)
    if fitted is not None:
        plain = nearby(known, PLAIN, fitted.by_name, lambda share: tell(0.25 * share))
    else:
        plain = fit(known, PLAIN, start=_plain(parent), progress=lambda share: tell(0.25 * share))
        fitted = fit(known, FITTED, start=_fitted(parent) or plain.by_name, progress=lambda share: tell(0.25 + 0.5 * share))
    offsets = {**problem.start, **plain.by_name}
    parts: list[tuple[Fold, Offsets]]
    if apart is not None:
        parts = [(apart, offsets)]
    else:
        turns = every_block(problem, blocks) if blocks else folds(problem)
        turns = tuple(one for one in turns if not (quick and one.configuration))
        parts = _turns(thinned, plain, turns, quick, lambda share: tell(0.8 + 0.2 * share))
    runs = [part for part in parts if not part[0].configuration]
    whole = [part for part in parts if part[0].configuration]
    return Evaluation(
        nominal=errors.share(_squares(known, problem.start, quick)),
        plain=errors.share(_squares(known, offsets, quick)),
        held_out=_held_out(problem, runs, quick),
        held_out_nominal=_held_out(problem, _at(runs, problem.start), quick),
        plain_fit=plain,
        fitted=fitted,
        held_out_names=tuple(fold.name for fold, _ in parts),
        held_out_configurations=_held_out(problem, whole, quick),
        held_out_configurations_nominal=_held_out(problem, _at(whole, problem.start), quick),
    )


def _plain(parent: Evaluation | Fit | None) -> Fit | None:
    return parent.plain_fit if isinstance(parent, Evaluation) else None


def _fitted(parent: Evaluation | Fit | None) -> Fit | None:
    return parent.fitted if isinstance(parent, Evaluation) else parent


def _squares(problem: Problem, offsets: Offsets, quick: bool) -> list[Squares]:
    """Of all lines of all data sets of `problem`, fitted to or not."""
    return [one for prediction in problem.predictions for one in errors.squares(prediction, offsets, _even(prediction, quick))]


def _turns(problem: Problem, plain: Fit, turns: Sequence[Fold], quick: bool, tell: Progress) -> list[tuple[Fold, Offsets]]:
    """Every fold with the offsets of the plain fit without it."""
    if not turns:
        return []
    whole = solved(problem, plain, PLAIN_FLOOR)
    found: list[tuple[Fold, Offsets]] = []
    for done, fold in enumerate(turns):
        found.append((fold, {**problem.start, **refitted(whole, fold, quick=quick)}))
        tell((done + 1) / len(turns))
    return found


def _at(parts: Sequence[tuple[Fold, Offsets]], offsets: Offsets) -> list[tuple[Fold, Offsets]]:
    return [(fold, offsets) for fold, _ in parts]


def _held_out(problem: Problem, parts: Sequence[tuple[Fold, Offsets]], quick: bool) -> Share | None:
    """The error on what every fold holds out, at its offsets."""
    found = [
        one
        for fold, offsets in parts
        for prediction, lines in held(problem, fold)
        for one in errors.squares(prediction, offsets, _even(prediction, quick) if lines is None else lines, fold=fold.name)
    ]
    return errors.share(found) if found else None


def _even(prediction: Prediction, quick: bool) -> Lines | None:
    """Lines at which errors are told: all, or where it must be `quick` every so many, whatever happens there."""
    return np.arange(0, len(prediction.measured.frequency), EVEN, dtype=np.int64) if quick else None
