"""What the data say of an article's inertia when its ten parameters are free beside what the plain fit frees.

The ten are those of the effect `rigid-inertia`, of one article of the series at a time: the others, drawn and weighed, tell the
FMD from it. Participation and coupling of its modes are free too, within what the model leaves open of them. Tolerances of the
measurement are not fitted; their share of the interval is propagated (`validation.ladders.considered`). The reference is the
model's own inertia with its effects, at the sizes of the model file.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from geometry.arrays import Array
from geometry.inertia import PARAMETERS
from identification.classical import jacobian, quantities
from identification.self_calibration.structure import ten_matrices
from validation.effects.identifiers import Named
from validation.engine.evaluation import Fit
from validation.engine.fit import fit
from validation.engine.parameter import IDENTIFYING
from validation.engine.prediction import Offsets, Prediction
from validation.engine.problem import Problem
from validation.ladders import considered
from validation.ladders.nouns import Body
from validation.models.model import Added
from validation.prediction import applied
from validation.prediction.series import SeriesPrediction
from validation.prediction.tangent import full

FAMILY = "rigid-inertia"


def identified(problem: Problem, article: str, plain: Fit, progress: Callable[[float], None] | None = None) -> Body | None:
    """Inertia of `article` from the data of `problem`; None where no data set has it.

    Parameters
    ----------
    problem : whose predictions are `SeriesPrediction`
    article : what stands on the FMD
    plain : the plain fit of the model, in whose place this one never costs more
    """
    freed, of = _freed(problem, article)
    if of is None:
        return None
    found = fit(freed, IDENTIFYING, start=plain, progress=progress)
    offsets = {**freed.start, **found.by_name}
    names, C = considered.of_fit(freed, found, IDENTIFYING)
    ten, slopes = inertia(of, offsets)
    J = np.stack([slopes.get(name, np.zeros(10)) for name in names], axis=1)
    through = jacobian(ten) @ J
    reference, _ = inertia(of, freed.start)
    return Body(
        article=article,
        values=quantities(ten),
        deviation=np.sqrt(np.einsum("ij,jk,ik->i", through, C, through)),
        converged=found.converged,
        reference=quantities(reference),
    )


def inertia(prediction: SeriesPrediction, offsets: Offsets) -> tuple[Array, dict[str, Array]]:
    """Ten parameters of what stands on the FMD about its own origin, with its effects at `offsets`, and their derivatives (10,).

    What an effect adds that no rigid body has, such as a mass that follows one axis only, counts as the rigid body nearest to it.
    """
    nuisances = prediction.tested.carried.nuisances
    if nuisances is None:
        raise ValueError("`prediction` must be of an article, found an FMD alone")
    drawn, _ = nuisances.at(offsets, derivatives=False)
    made, tangents = applied.structure(drawn, {}, applied.at(prediction.effects, offsets))
    return _nearest(made.mass), {name: _nearest(full(one, "mass", len(made.mass))) for name, one in tangents.items()}


def _nearest(mass: Array) -> Array:
    """(10,) of the rigid body whose mass matrix is nearest to the base's share of `mass`."""
    basis = ten_matrices().reshape(10, 36).T
    return np.asarray(np.linalg.lstsq(basis, mass[:6, :6].ravel(), rcond=None)[0])


def _freed(problem: Problem, article: str) -> tuple[Problem, SeriesPrediction | None]:
    """`problem` with the ten parameters of `article` free, and a prediction that has it."""
    predictions: list[Prediction] = []
    found = None
    for one in problem.predictions:
        if isinstance(one, SeriesPrediction) and one.tested.carried.standing.article == article:
            found = one.with_effects(_with_ten(one.effects))
            predictions.append(found)
        else:
            predictions.append(one)
    return replace(problem, predictions=tuple(predictions)), found


def _with_ten(effects: Sequence[Added]) -> tuple[Added, ...]:
    """`effects` and what they lack of the ten."""
    there = {one.named.id for one in effects}
    ten = (Named(family=FAMILY, targets=(name,), values={"": 0.0}) for name in PARAMETERS)
    return (*effects, *(Added(named=one) for one in ten if one.id not in there))
