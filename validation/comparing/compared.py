"""A model compared with data: the four errors, the maps, the worst spots, and classical measurements beside it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from geometry.arrays import Array
from validation.comparing.comparison import Beside, Comparison
from validation.comparing.doubt import doubt
from validation.comparing.gathered import Data
from validation.comparing.maps import Map, Rig, mapped
from validation.comparing.modes import NamedMode, named
from validation.comparing.spots import worst
from validation.comparing.verdicts import MOST, Explained, told, tolerances
from validation.engine import hold_out as held
from validation.engine.evaluate import evaluate
from validation.engine.evaluation import Evaluation, Fit
from validation.engine.prediction import Offsets
from validation.engine.problem import Problem
from validation.engine.residuals import residuals
from validation.models.model import Model
from validation.prediction import applied
from validation.prediction.facts import ArticleFact, facts
from validation.prediction.series import SeriesPrediction, predictions

FEW = 10
"""Lines of a data set below which what is said of it is next to nothing."""

UNITS = ("kg", "m", "m", "m", *("kg m²",) * 6)
"""SI, of the quantities of `identification.classical`."""

Progress = Callable[[str, float], None]
"""Hears what is done now, and the share of it."""


def compared(
    model: Model,
    data: Data,
    hold_out: Sequence[str] = (),
    progress: Progress | None = None,
    *,
    band: tuple[float, float] | None = None,
    method: str = "full-record",
) -> Comparison:
    """`model` beside `data`.

    Parameters
    ----------
    hold_out : names of runs, campaigns and files that are predicted and never fitted; by default each run and configuration in
        turn
    band : (low, high) [Hz]; that of the campaigns by default
    method : of `identification.campaign.METHODS`

    Raises
    ------
    BadInput : data and model that do not fit each other, a name of `hold_out` that is none.
    CheckFailed : a fit that does not converge.
    """
    tell = progress or (lambda what, share: None)
    made = predictions(model, data.campaigns, band=band, method=method, progress=lambda share: tell("spectra", share))
    said = facts(model, data.classical)
    problem = Problem(made, said)
    names = meant(problem, data, hold_out)
    known = held.without(problem, held.named(problem, names)) if names else problem  # refused before minutes are spent
    evaluation = evaluate(problem, hold_out=names, progress=lambda share: tell("fitting", share))
    return of_evaluation(model, made, said, problem, known.thinned(), evaluation, lambda share: tell("maps", share))


def of_evaluation(
    model: Model,
    made: Sequence[SeriesPrediction],
    said: Sequence[ArticleFact],
    problem: Problem,
    fitted: Problem,
    evaluation: Evaluation,
    progress: Callable[[float], None],
) -> Comparison:
    """What an `evaluation` of `problem` says of `model`; `fitted` is what its fits saw."""
    maps = mapped_all(made, problem, fitted, evaluation.plain_fit, progress)
    modes = tuple(modes_of(one, {**problem.start, **evaluation.plain_fit.by_name}) for one in made)
    spots = worst(maps, modes)
    return Comparison(
        title=model.title or model.article,
        source=model.source,
        evaluation=evaluation,
        explained=explained(maps),
        errors=told(evaluation, explained(maps), max((spot.sigma for spot in spots), default=0.0)),
        absurd=tolerances(evaluation.fitted)[:MOST],
        maps=maps,
        modes=modes,
        worst=spots,
        facts=beside(said, problem, evaluation),
        effects=tuple(one.named.id for one in model.effects),
        remarks=_remarks(made, maps, evaluation),
    )


def meant(problem: Problem, data: Data, names: Sequence[str]) -> tuple[str, ...]:
    """`names` as the engine knows them: a campaign may be named by its folder, a fact by its file."""
    folders = {
        Path(one.source).resolve(): made.measured.name for one, made in zip(data.campaigns, problem.predictions, strict=True)
    }
    found: list[str] = []
    for name in names:
        of_file = [fact.name for fact in problem.facts if name in data.classical and fact.name.startswith(name)]
        found += of_file or [folders.get(Path(name).resolve(), name)]
    return tuple(found)


def mapped_all(
    made: Sequence[SeriesPrediction], problem: Problem, known: Problem, plain: Fit, progress: Callable[[float], None]
) -> tuple[Map, ...]:
    """The maps of all campaigns at the plain fit; `known` is what was fitted."""
    left = residuals(problem, plain)
    unknown = doubt(known, plain)
    found = []
    for k, one in enumerate(made):
        campaign = one.tested.campaign
        rig = Rig(table=campaign.table, gravity=campaign.gravity)
        share = _part(progress, k, len(made))
        found.append(mapped(one, {**problem.start, **plain.by_name}, unknown, left[k].inputs, rig, share))
    return tuple(found)


def explained(maps: Sequence[Map]) -> Explained:
    """What the plain error comes to by tolerances alone; known noise is no part of either."""
    return Explained(
        measurement=_percent([of.explained for of in maps]), with_modes=_percent([of.explained_with_modes for of in maps])
    )


def _percent(shares: Sequence[Array]) -> float:
    """Of all runs and lines, as `validation.engine.errors` counts them."""
    return float(100 * np.sqrt(np.mean(np.concatenate([one.ravel() ** 2 for one in shares]))))


def beside(facts: Sequence[ArticleFact], problem: Problem, evaluation: Evaluation) -> tuple[Beside, ...]:
    """Every fact, at the plain fit and of the model as it stands."""
    return tuple(_beside(fact, {**problem.start, **evaluation.plain_fit.by_name}, problem.start) for fact in facts)


def _beside(fact: ArticleFact, plain: Offsets, nominal: Offsets) -> Beside:
    sigma = fact.residual(plain)[0]
    return Beside(
        name=fact.name,
        unit=UNITS[int(np.argmax(np.abs(fact.weights)))],
        predicted=fact.value + sigma * fact.deviation,
        measured=fact.value,
        tolerance=fact.deviation,
        sigma=sigma,
        nominal_sigma=fact.residual(nominal)[0],
    )


def modes_of(prediction: SeriesPrediction, offsets: Offsets) -> tuple[NamedMode, ...]:
    """Modes by name, of the structure as the plain fit has it, its effects acting."""
    carried = prediction.tested.carried
    if carried.nuisances is None:
        return ()
    matrices, _ = carried.nuisances.at(offsets, derivatives=False)
    return named(applied.structure(matrices, {}, applied.at(prediction.effects, offsets), derivatives=False)[0])


def _remarks(made: Sequence[SeriesPrediction], maps: Sequence[Map], evaluation: Evaluation) -> tuple[str, ...]:
    tested = [one.tested for one in made]
    said = [text for one in tested for text in (*one.campaign.warnings, *one.remarks, *one.carried.standing.remarks)]
    said += [text for one in maps for text in one.remarks]
    said += [text for one in tested if (text := few(one.measured.name, len(one.measured.frequency)))]
    said += [
        _unconverged(name, of)
        for name, of in (("plain", evaluation.plain_fit), ("fitted", evaluation.fitted))
        if not of.converged
    ]
    return tuple(dict.fromkeys(text.rstrip(".") for text in said))


def few(name: str, lines: int) -> str:
    """A sentence where a data set has so few `lines` that verdicts on it mean little; else nothing."""
    if lines >= FEW:
        return ""
    have = "1 line lies" if lines == 1 else f"{lines} lines lie"
    return f"only {have} in the band of {name}: no verdict of this page rests on less than {FEW}; widen --band"


def _unconverged(name: str, of: Fit) -> str:
    return f"the {name} fit did not converge: its {len(of.parameters)} parameters still moved, and its figures are no minimum"


def _part(progress: Callable[[float], None], k: int, count: int) -> Callable[[float], None]:
    return lambda share: progress((k + share) / count)
