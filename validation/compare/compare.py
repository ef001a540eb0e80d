"""`Comparison`: all that `massline compare` shows, whichever way it is shown - on paper, as JSON, in pictures."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from geometry.dynamic_mass import MOTIONS
from geometry.frames import Array
from geometry.inertia import LOADS
from validation.compare.maps import Map, NamedMode, Rig, doubt, mapped, named
from validation.compare.spots import Spot, text, worst
from validation.estimation.evaluate import residuals
from validation.estimation.problem import Evaluation, Fit, Offsets, Problem, Share
from validation.estimation.verdicts import (
    TOLERANCES_NAMED,
    ExplainedError,
    StatedError,
    Tolerance,
    expected_z2,
    misfit,
    told,
    tolerances,
)
from validation.output import derived, entry, plain_unit, to_json, unwritten
from validation.prediction import effects
from validation.prediction.classical_facts import ArticleFact
from validation.prediction.series import SeriesPrediction
from validation.study import Study


@dataclass(frozen=True, kw_only=True)
class FactComparison:
    """One number of a classical measurement beside what the model says.

    Attributes
    ----------
    name : where it comes from and what it is
    unit : SI
    predicted, measured, tolerance : at the plain fit, in `unit`; the last is one standard deviation
    sigma : (predicted - measured) / standard deviation, after the plain fit
    nominal_sigma : the same of the model as it stands
    """

    name: str
    sigma: float
    nominal_sigma: float
    unit: str = entry(write=plain_unit)
    predicted: float
    measured: float
    tolerance: float


@dataclass(frozen=True, kw_only=True)
class WorstPair:
    """A pair of axes of one campaign, where it is worst.

    Attributes
    ----------
    data_set : the campaign
    load, motion : indices in the order of `MOTIONS`
    frequency : [Hz] of the peak
    sigma, percent : there
    """

    data_set: str = entry("campaign")
    load: int = entry(write=LOADS.__getitem__)
    motion: int = entry(write=MOTIONS.__getitem__)
    frequency: float = entry("frequency_hz", unit="Hz")
    sigma: float
    percent: float


@dataclass(frozen=True, eq=False, kw_only=True)
class Comparison:
    """A model and data, compared.

    Attributes
    ----------
    title : of the model
    source : its file
    evaluation : the four errors and the fits behind them
    explained : what tolerances let expect of the plain error
    errors : the four errors in words
    absurd : the tolerances that the fit moved farthest, most absurd first
    maps : one a data set
    modes : of each data set's configuration
    worst : the worst spots, worst first
    facts : classical measurements
    effects : ids of the effects that are in the model
    remarks : sentences: what was assumed, what is missing
    """

    source: str = entry("model")
    title: str
    effects: tuple[str, ...] = ()
    evaluation: Evaluation = unwritten()
    explained: ExplainedError = unwritten()
    errors: tuple[StatedError, ...]
    absurd: tuple[Tolerance, ...] = entry("absurd_tolerances")
    maps: tuple[Map, ...] = unwritten()
    modes: tuple[tuple[NamedMode, ...], ...] = unwritten()
    worst: tuple[Spot, ...] = unwritten()
    facts: tuple[FactComparison, ...] = entry("classical", default=())
    remarks: tuple[str, ...] = entry("warnings", default=())

    @property
    def data_sets(self) -> tuple[str, ...]:
        """Names, in order."""
        return tuple(one.data_set for one in self.maps)

    @property
    @derived("", before="errors")
    def figures(self) -> dict[str, Any]:
        """The figures of the four errors by their keys in JSON."""
        of = self.evaluation
        others = ("held_out", "held_out_nominal", "held_out_configurations", "held_out_configurations_nominal")
        shares: dict[str, Share | None] = {name: getattr(of, name) for name in others}
        return {
            "plain_error_percent": of.plain.percent,
            "fitted_chi2_per_dof": misfit(of.fitted),
            "tolerance_z2": of.fitted.tolerance_z2,
            "worst": [to_json(one) | {"text": text(one, len(self.maps))} for one in self.worst],
            "nominal_error_percent": of.nominal.percent,
            **{f"{name}_error_percent": None if one is None else one.percent for name, one in shares.items()},
            "held_out": of.held_out_names,
            "explained_error_percent": self.explained.measurement,
            "explained_error_with_modes_percent": self.explained.with_modes,
            "tolerances": of.fitted.tolerances,
            "tolerance_z2_expected": expected_z2(of.fitted),
            "evidence_nats": of.fitted.log_evidence,
            "converged": of.plain_fit.converged and of.fitted.converged,
        }

    @property
    @derived("error_percent", before="absurd_tolerances")
    def shares(self) -> dict[str, Share | None]:
        """Where three of the errors come from."""
        return {"nominal": self.evaluation.nominal, "plain": self.evaluation.plain, "held_out": self.evaluation.held_out}

    @property
    @derived("", before="classical")
    def details(self) -> dict[str, Any]:
        """Parameters, worst pairs and maps by their keys in JSON; of a map without its lines, which the pictures show."""
        of = self.evaluation
        return {
            "parameters": {"plain": of.plain_fit.by_parameter, "fitted": of.fitted.by_parameter},
            "worst_pairs": worst_pairs(self.maps, WRITTEN_PAIRS),
            "maps": [_map_json(one, modes) for one, modes in zip(self.maps, self.modes, strict=True)],
        }


def _map_json(of: Map, modes: Sequence[NamedMode]) -> dict[str, Any]:
    """A map without its lines: every row's peak in every run."""
    sigma = of.sigma
    return {
        "campaign": of.data_set,
        "article": of.configuration,
        "runs": of.runs,
        "channels": of.rows,
        "frequency_band_hz": of.frequency[[0, -1]],
        "peak_sigma": sigma.max(axis=1),
        "peak_frequency_hz": of.frequency[sigma.argmax(axis=1)],
        "rms_sigma": np.sqrt(np.mean(sigma**2, axis=1)),
        "chi2_per_dof_by_run": of.misfit.mean(axis=1),
        "pairs_peak_sigma": None if of.pairs is None else of.pairs.sigma.max(axis=0),
        "pairs_peak_percent": None if of.pairs is None else of.pairs.percent.max(axis=0),
        "modes": modes,
    }


def worst_pairs(maps: Sequence[Map], count: int) -> tuple[WorstPair, ...]:
    """The `count` pairs of axes with the greatest peak in sigmas, of all campaigns together, worst first."""
    found = []
    for of in (one.pairs for one in maps if one.pairs is not None):
        sigma, percent = of.sigma, of.percent
        for i, j in np.ndindex(6, 6):
            line = int(np.argmax(sigma[:, i, j]))
            found.append(
                WorstPair(
                    data_set=of.campaign,
                    load=i,
                    motion=j,
                    frequency=float(of.frequency[line]),
                    sigma=float(sigma[line, i, j]),
                    percent=float(percent[line, i, j]),
                )
            )
    return tuple(sorted(found, key=lambda pair: -pair.sigma)[:count])


# A model compared with data: the four errors, the maps, the worst spots, and classical measurements beside it.


WRITTEN_PAIRS = 10
"""Worst pairs of axes that JSON has."""

FEW = 10
"""Lines of a data set below which what is said of it is next to nothing."""

UNITS = ("kg", "m", "m", "m", *("kg m²",) * 6)
"""SI, of the quantities of `identification.request`."""

Progress = Callable[[str, float], None]
"""Hears what is done now, and the share of it."""


def compared(study: Study, progress: Progress | None = None) -> Comparison:
    """The model of a `study` beside its data.

    Raises
    ------
    CheckFailed : a fit that does not converge.
    """
    tell = progress or (lambda what, share: None)
    evaluation = study.evaluation(lambda share: tell("fitting", share))
    return of_evaluation(study, study.known().thinned(), evaluation, lambda share: tell("maps", share))


def of_evaluation(study: Study, fitted: Problem, evaluation: Evaluation, progress: Callable[[float], None]) -> Comparison:
    """What an `evaluation` of a `study` says of its model; `fitted` is what its fits saw."""
    model, made, problem = study.model, study.predictions, study.whole()
    maps = mapped_all(made, problem, fitted, evaluation.plain_fit, progress)
    modes = tuple(modes_of(one, {**problem.start, **evaluation.plain_fit.by_name}) for one in made)
    spots = worst(maps, modes)
    said = tuple(fact.with_effects(model.effects) for fact in study.said)
    return Comparison(
        title=model.title or model.article,
        source=model.source,
        evaluation=evaluation,
        explained=explained(maps),
        errors=told(evaluation, explained(maps), max((spot.sigma for spot in spots), default=0.0)),
        absurd=tolerances(evaluation.fitted)[:TOLERANCES_NAMED],
        maps=maps,
        modes=modes,
        worst=spots,
        facts=beside(said, problem, evaluation),
        effects=tuple(one.named.id for one in model.effects),
        remarks=_remarks(made, maps, evaluation),
    )


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


def explained(maps: Sequence[Map]) -> ExplainedError:
    """What the plain error comes to by tolerances alone; known noise is no part of either."""
    return ExplainedError(
        measurement=_percent([of.explained for of in maps]), with_modes=_percent([of.explained_with_modes for of in maps])
    )


def _percent(shares: Sequence[Array]) -> float:
    """Of all runs and lines, as `validation.estimation.evaluate` counts them."""
    return float(100 * np.sqrt(np.mean(np.concatenate([one.ravel() ** 2 for one in shares]))))


def beside(facts: Sequence[ArticleFact], problem: Problem, evaluation: Evaluation) -> tuple[FactComparison, ...]:
    """Every fact, at the plain fit and of the model as it stands."""
    return tuple(_beside(fact, {**problem.start, **evaluation.plain_fit.by_name}, problem.start) for fact in facts)


def _beside(fact: ArticleFact, plain: Offsets, nominal: Offsets) -> FactComparison:
    sigma = fact.residual(plain)[0]
    return FactComparison(
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
    return named(effects.structure(matrices, {}, effects.at(prediction.effects, offsets), derivatives=False)[0])


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
