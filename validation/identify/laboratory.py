"""What a laboratory learns of itself from campaigns of known bodies and repeated mountings."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import sqrt

import numpy as np

from geometry.errors import BadInput
from identification.campaign import Campaign
from validation.diagnose.candidate_fits import GoodnessOfFit, goodness_of_fit
from validation.estimation.fit import fit
from validation.estimation.problem import FITTED, Fit, Problem
from validation.model.learnt import ANEW, Learnt, Offset, Spread
from validation.model.model import Model
from validation.model.tolerance_classes import METROLOGY
from validation.prediction.dynamic_mass import MOUNTING
from validation.prediction.series import SeriesPrediction, predictions, supported_dynamic_mass

# All tolerances are fitted to all campaigns together. What is of the hardware - gains, delays, places and angles of pick-ups,
# cells and what they hear, the FMD - is common to them, and its posterior is what the laboratory knows now. How an article
# stands is new with every mounting: there the scatter tau of the draws is what is learnt, by its likelihood over a grid,
#
#     p(tau) ∝ prod over draws of N(x_i; 0, s_i² + tau²) · N(ln tau; ln tau_class, ln 2),
#
# x_i and s_i what the data alone say of a draw (A. Gelman et al., Bayesian Data Analysis, 2013, chapter 5). What is learnt is
# held against each campaign that was left out of it: where hardware then pays more than is due, all its standard deviations are
# widened.


HARDWARE = ("force", "accelerometer", "cell", "fmd")
"""What the names of parameters begin with that are of the hardware."""

ALONG = {"place": ("x", "y"), "height": ("z",), "turn": ("gamma",), "tilt": ("alpha", "beta")}
"""By tolerance, motions of an article that draw from it."""

TOLD = 0.9
"""[share] of its prior standard deviation below which a figure says something: a wider one is the prior again."""

Progress = Callable[[str, float], None]


@dataclass(frozen=True, kw_only=True)
class HeldOut:
    """One campaign that what was learnt from the others is held against.

    Attributes
    ----------
    campaign : its name
    misfit, limit : chi² per degree of freedom, and up to which it is that of a test without any fault
    price : sum of z² of the learnt parameters over what is due, before they were widened
    quiet : whether nothing more need be missing
    """

    campaign: str
    misfit: float
    limit: float
    price: float
    quiet: bool

    @classmethod
    def of(cls, one: SeriesPrediction, learnt: Learnt) -> "HeldOut":
        """The campaign of `one`, fitted by a laboratory that has `learnt` without it."""
        tested, known = one.tested, one.tested.model.knowing(learnt)
        carried = supported_dynamic_mass(known, tested.campaign, tested.carried.standing, one.measured.name)
        problem = Problem((replace(one, tested=replace(tested, model=known, carried=carried)),)).thinned()
        found = fit(problem, FITTED).required()
        mine = [k for k, each in enumerate(found.parameters) if each.name in learnt.offsets and each.tolerance > 0]
        prior = np.array([found.parameters[k].tolerance for k in mine])
        due = float(np.sum(1 - np.clip(np.diag(found.covariance)[mine] / prior**2, 0.0, 1.0)))
        stands = goodness_of_fit(found, problem)
        paid = float(np.sum((found.offsets[mine] / prior) ** 2))
        return cls(
            campaign=one.measured.name, misfit=stands.misfit, limit=stands.limit, price=paid / max(due, 1.0), quiet=stands.null
        )


@dataclass(frozen=True, eq=False, kw_only=True)
class LaboratoryFindings:
    """What was learnt.

    Attributes
    ----------
    learnt : the file
    held_out : by campaign; none of a single one
    widened : factor on all standard deviations of the hardware, from `held_out`
    stands : how the fit of all campaigns together stands
    """

    learnt: Learnt
    held_out: tuple[HeldOut, ...]
    widened: float
    stands: GoodnessOfFit


def laboratory(model: Model, campaigns: Sequence[Campaign], progress: Progress | None = None) -> LaboratoryFindings:
    """What `campaigns` tell of the hardware that they share, beginning with the tolerances of `model`.

    Raises
    ------
    BadInput : a model of class `metrology`, which admits nothing that could be learnt; campaigns that do not belong together.
    CheckFailed : the fit of all tolerances does not converge.
    """
    tell = progress or (lambda what, share: None)
    if model.tolerance_class == METROLOGY:
        problem = f"is {METROLOGY}, of which cells, planes and mountings are exact: nothing can be learnt of them"
        raise BadInput(model.source, "tolerances.class", problem, 'Write class = "as-delivered"')
    made = predictions(replace(model, effects=()), campaigns, progress=lambda share: tell("spectra", share))
    tell("fitting all campaigns", 0.0)
    whole = Problem(made).thinned()
    found = fit(whole, FITTED).required()
    held: list[HeldOut] = []
    for k, one in enumerate(made if len(made) > 1 else ()):
        tell(f"holding out {one.measured.name}", k / len(made))
        others = Problem(tuple(each for each in made if each is not one)).thinned()
        held.append(HeldOut.of(one, _learnt(model, others, fit(others, FITTED, start=found.by_name).required(), 1.0)))
    widened = sqrt(max(1.0, float(np.mean([one.price for one in held])))) if held else 1.0
    learnt = _learnt(model, whole, found, widened)
    return LaboratoryFindings(learnt=learnt, held_out=tuple(held), widened=widened, stands=goodness_of_fit(found, whole))


def _learnt(model: Model, of: Problem, found: Fit, widened: float) -> Learnt:
    spread = np.sqrt(np.maximum(np.diag(found.covariance), 0.0))
    by_name = {one.name: (one, float(x), float(sd)) for one, x, sd in zip(found.parameters, found.offsets, spread, strict=True)}
    offsets = {
        name: Offset(offset=x, deviation=min(widened * sd, one.tolerance), before=one.tolerance)
        for name, (one, x, sd) in by_name.items()
        if one.family.partition("-")[0] in HARDWARE and sd > 0 and np.isfinite(one.tolerance)
    }
    spreads = {}
    for row in ANEW:
        drawn = [
            by_name[name] for name in by_name if name.startswith(f"{MOUNTING}:") and name.rpartition(":")[2] in ALONG[row.name]
        ]
        told = [(x, sd, one.tolerance) for one, x, sd in drawn if 0 < sd < TOLD * one.tolerance]
        if len(told) > 1:
            spreads[row.key] = Spread.of_draws(told)
    return Learnt(
        source="",
        hardware=model.hardware or of.predictions[0].measured.hardware,
        tolerance_class=model.tolerance_class,
        campaigns=tuple(one.measured.name for one in of.predictions),
        offsets=offsets,
        spreads=spreads,
    )
