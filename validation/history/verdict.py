"""What data say of an effect that is added: whether they tell it from others, and what its size and the inertia are worth."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import isfinite

import numpy as np
import numpy.typing as npt

from geometry.frames import Array
from geometry.inertia import PARAMETERS
from identification.quality import NORMAL_95
from identification.request import jacobian, quantities
from identification.rigid_body import BASIS
from identification.self_calibration.solve import CLOSE, inverse
from validation.effects.catalogue import Named
from validation.estimation import problem as estimation
from validation.estimation.fit import child, floor_of
from validation.estimation.likelihood import cost_of
from validation.estimation.verdicts import ABSURD, costly
from validation.history.history import Body, Version, VersionSize
from validation.model.model import Added
from validation.output import nats, odds, with_unit
from validation.prediction import effects
from validation.prediction.series import SeriesPrediction
from validation.prediction.tangents import full
from validation.study import Study

# Whether the data can tell an effect from those that the model has already: the direction of the Fisher matrix says.
#
# Whitened derivatives of what the channels read, and of classical results, are the columns of J; N = J^T J is the Fisher matrix
# of these data. What is left of an effect's column when the columns of the others are projected out,
#
#     S_cc = N_cc - N_co N_oo^+ N_oc ,        share = S_cc / N_cc ,
#
# is what only it can explain. Where nothing is left, it and a mixture of the others, N_oo^+ N_oc of each, do the same to every
# channel at every line: no fit can share out a fault between them, knowledge beforehand does. Of an effect with several sizes it
# is the largest share over all their mixtures.


SAME_RESPONSE = 1e-6
"""Share of the square of what an effect does that others must leave to it: a thousandth of what it does to the channels."""

NOTICED = 1e-3
"""Standard deviations that a plausible fault must move all data together for the effect to act on them at all."""

TAKES_PART = 0.02
"""Share of what the effect does from which a member of the mixture is named."""

RANK = 1e-13
"""Relative singular value below which a direction of the others is itself none."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Alias:
    """An effect that others imitate.

    Attributes
    ----------
    id : of the effect
    share : of the square of what it does that only it can explain
    size : of the effect, in the unit of its first parameter, to which the mixture belongs
    unit : its unit
    mixture : by the names of the others, which size of each does the same, in `units`
    units : by name
    effects : those of the mixture that are effects of the model
    """

    id: str
    share: float
    size: float
    unit: str
    mixture: Mapping[str, float]
    units: Mapping[str, str]
    effects: tuple[str, ...]

    @property
    def text(self) -> str:
        """The direction in words."""
        same = ", ".join(f"{name} {with_unit(f'{size:+.3g}', self.units[name])}" for name, size in self.mixture.items())
        return f"{self.id} {with_unit(f'{self.size:+.3g}', self.unit)} does to these data what {same} does"


def noticed(problem: estimation.Problem, names: Sequence[str]) -> float:
    """How many standard deviations a plausible fault in the parameters `names` moves all data together; 0 where none acts."""
    free = [one for one in problem.parameters if one.name in names]
    if not free:
        return 0.0
    N = _fisher(problem, free)
    scale = np.array([one.tolerance for one in free])
    return float(np.sqrt(np.linalg.eigvalsh(scale[:, None] * N * scale)[-1]))


def alias(problem: estimation.Problem, id: str, names: Sequence[str]) -> Alias | None:
    """The mixture of effects, and of what a laboratory must identify, that does what the parameters `names` of `id` do, if any.

    Derivatives are those where the model stands.
    """
    others = [
        one for one in problem.parameters if one.kind in (estimation.EFFECT, estimation.IDENTIFIED) and one.name not in names
    ]
    own = [one for one in problem.parameters if one.name in names]
    if not own or not others:
        return None
    free, c = [*own, *others], len(own)
    matrix = _fisher(problem, free)
    scale = np.sqrt(np.maximum(np.diag(matrix), np.finfo(np.float64).tiny))
    N = matrix / np.outer(scale, scale)
    mixed = np.linalg.pinv(N[c:, c:], rcond=RANK, hermitian=True) @ N[c:, :c]
    # The largest share of N_cc that is left, and its direction
    values, vectors = np.linalg.eigh(N[:c, :c])
    kept = values > 1e-12 * values[-1]
    root = vectors[:, kept] / np.sqrt(values[kept])
    shares, directions = np.linalg.eigh(root.T @ (N[:c, :c] - N[:c, c:] @ mixed) @ root)
    if shares[-1] > SAME_RESPONSE:
        return None
    direction = root @ directions[:, -1]
    weight = mixed @ direction
    # In the units of the parameters, at a tenth of a plausible fault of the effect
    of_own, of_others = direction / scale[:c], weight / scale[c:]
    first = int(np.argmax(np.abs(of_own) / [one.tolerance for one in own]))
    tenth = 0.1 * own[first].tolerance / of_own[first]
    part = np.abs(weight) > TAKES_PART * np.abs(weight).max()
    mixture = {
        one.name: float(tenth * x * one.slope(one.start)) for one, x, named in zip(others, of_others, part, strict=True) if named
    }
    return Alias(
        id=id,
        share=float(max(shares[-1], 0.0)),
        size=float(tenth * of_own[first] * own[first].slope(own[first].start)),
        unit=own[first].unit,
        mixture=mixture,
        units={one.name: one.unit for one in free},
        effects=tuple(one.name for one in others if one.kind == estimation.EFFECT and one.name in mixture),
    )


def _fisher(problem: estimation.Problem, free: Sequence[estimation.Parameter]) -> Array:
    """(p, p) of data and facts where the model stands, knowledge beforehand left out."""
    cost = cost_of(problem, free, floor_of(estimation.PLAIN), plain=True)
    x = cost.at({})
    _, rows = cost.knowledge(x)
    facts = rows[len(rows) - len(problem.facts) :]
    return np.asarray(cost.data(x).matrix + facts.T @ facts)


# What an estimate is worth when tolerances were not fitted but are there: consider covariance.
#
# Parameters i are estimated with the tolerances t at zero, by the normal equations N = J^T W J of data, knowledge beforehand of
# i included. To first order the estimate answers to a tolerance by
#
#     G = d x_i / d t = -N_ii^-1 N_it ,        C = N_ii^-1 + G S_t G^T ,    S_t = diag(tolerance²)
#
# so that its covariance C is what noise and knowledge beforehand leave, and what tolerances that nobody fitted add (Schmidt
# 1966; Tapley, Schutz and Born, Statistical Orbit Determination, 2004, 6.3). Without any tolerance, C would be N_ii^-1.


def of_fit(problem: estimation.Problem, found: estimation.Fit, kinds: Sequence[str]) -> tuple[tuple[str, ...], Array]:
    """Names (i,) of the parameters of `kinds` that the fit `found` of `problem` estimated, and their covariance (i, i)."""
    free = problem.free(estimation.FITTED)
    cost = cost_of(problem, free, floor_of(kinds), plain=estimation.SENSOR not in kinds)
    at = {one.name: 0.0 for one in free if one.kind not in kinds} | found.by_name
    whole, _ = cost.total(cost.at(at))
    estimated = np.array([one.kind in kinds for one in free])
    names = tuple(one.name for one in free if one.kind in kinds)
    return names, covariance(whole.matrix, estimated, np.array([one.tolerance for one in free]))


def covariance(normal: Array, estimated: npt.NDArray[np.bool_], tolerance: Array) -> Array:
    """(i, i) covariance of the parameters that were `estimated`, in their order.

    Parameters
    ----------
    normal : (k, k) normal equations of data and of what is known beforehand of the estimated ones
    estimated : (k,) which of them were; the others stood at zero
    tolerance : (k,) standard deviation of those that were not
    """
    of_noise = inverse(normal[np.ix_(estimated, estimated)])
    answered = of_noise @ normal[np.ix_(estimated, ~estimated)] * tolerance[~estimated]
    return np.asarray(of_noise + answered @ answered.T)


# What the data say of an article's inertia when its ten parameters are free beside what the plain fit frees.
#
# The ten are those of the effect `rigid-inertia`, of one article of the series at a time: the others, drawn and weighed, tell
# the FMD from it. Participation and coupling of its modes are free too, within what the model leaves open of them. Tolerances of
# the measurement are not fitted; their share of the interval is propagated, as above. The reference is the model's own inertia
# with its effects, at the sizes of the model file.


FAMILY = "rigid-inertia"


def body_of(study: Study, plain: estimation.Fit, progress: Callable[[float], None]) -> Body | None:
    """Inertia of the article of a `study` from its data, what stands on the FMD; None without one, and where no data set has it.

    In the place of the `plain` fit of the model this one never costs more.
    """
    if not study.article or not any(one.table.select(group="fmd") for one in study.campaigns):  # no force tells no inertia
        return None
    known = study.known()
    problem = known.thinned()
    predictions: list[estimation.Prediction] = []
    of = None
    for one in problem.predictions:
        if isinstance(one, SeriesPrediction) and one.tested.carried.standing.article == study.article:
            there = {each.named.id for each in one.effects}
            ten = (Named(family=FAMILY, targets=(name,), values={"": 0.0}) for name in PARAMETERS)
            of = one.with_effects((*one.effects, *(Added(named=each) for each in ten if each.id not in there)))
            predictions.append(of)
        else:
            predictions.append(one)
    if of is None:
        return None
    freed = replace(problem, predictions=tuple(predictions))
    # Data that tell little of ten parameters are seen in print within a tenth of a standard deviation
    found = child(freed, estimation.IDENTIFYING, at_offsets(kept_offsets(plain), known), {}, close=CLOSE / 10)
    progress(1.0)
    names, C = of_fit(freed, found, estimation.IDENTIFYING)
    ten_found, slopes = inertia(of, {**freed.start, **found.by_name})
    J = np.stack([slopes.get(name, np.zeros(10)) for name in names], axis=1)
    through = jacobian(ten_found) @ J
    reference, _ = inertia(of, freed.start)
    return Body(
        article=study.article,
        values=quantities(ten_found),
        deviation=np.sqrt(np.einsum("ij,jk,ik->i", through, C, through)),
        converged=found.converged,
        reference=quantities(reference),
    )


def inertia(prediction: SeriesPrediction, offsets: estimation.Offsets) -> tuple[Array, dict[str, Array]]:
    """Ten parameters of what stands on the FMD about its own origin, with its effects at `offsets`, and their derivatives (10,).

    What an effect adds that no rigid body has, such as a mass that follows one axis only, counts as the rigid body nearest to it.
    """
    nuisances = prediction.tested.carried.nuisances
    if nuisances is None:
        raise ValueError("`prediction` must be of an article, found an FMD alone")
    drawn, _ = nuisances.at(offsets, derivatives=False)
    made, tangents = effects.structure(drawn, {}, effects.at(prediction.effects, offsets))
    return _nearest(made.mass), {name: _nearest(full(one, "mass", len(made.mass))) for name, one in tangents.items()}


def _nearest(mass: Array) -> Array:
    """(10,) of the rigid body whose mass matrix is nearest to the base's share of `mass`."""
    basis = BASIS.reshape(10, 36).T
    return np.asarray(np.linalg.lstsq(basis, mass[:6, :6].ravel(), rcond=None)[0])


def kept_offsets(fit: estimation.Fit) -> dict[str, float]:
    """Offsets from which another fit may begin; a logarithmic size of an effect will count from what the model file says."""
    anew = {one.name for one in fit.parameters if one.kind == estimation.EFFECT and one.logarithmic and one.above == 0.0}
    return {name: x for name, x in fit.by_name.items() if name not in anew}


def at_offsets(offsets: Mapping[str, float], problem: estimation.Problem) -> estimation.Fit:
    """A fit of `problem` that ended at `offsets`, of which nothing else is known."""
    known = [one for one in problem.parameters if one.name in offsets]
    return estimation.Fit(
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


# What is to be thought of an effect that was added: is it worth a parameter, does it hold elsewhere, is it a fault at all.


FALLS = 0.02
"""Share of an error by which it must change for us to say so."""


def is_worth_adding(rung: Version) -> bool:
    """Whether the evidence speaks for the effect of `rung`."""
    return rung.gain is not None and rung.gain > rung.asked_gain


def verdict(before: Version, after: Version, tolerances: Mapping[str, float], nulls: Mapping[str, float]) -> Iterator[str]:
    """Sentences about the effect that leads from `before` to `after`; none where one of them has no figures.

    Parameters
    ----------
    tolerances : by key of its sizes, what a careful laboratory or the model admits of it, one standard deviation; 0 for nothing
    nulls : by key, the size at which there is no effect
    """
    old, new = before.errors, after.errors
    if old is None or new is None:
        return
    if not (old.converged and new.converged):
        yield "A fit did not converge: none of these figures is the last word."
    if not all(body.converged for body in after.bodies):
        yield "The fit of the identified inertia did not converge: its figures are not the last word."
    gain, asked = after.gain, after.asked_gain
    said = "" if gain is None else nats(abs(gain)).lstrip("+")
    if gain is None or not isfinite(gain):
        yield "Evidence cannot be compared: the rung before stands on other data."
    elif gain > asked:
        yield f"It is worth a parameter: the evidence rises by {said} nats, odds of {odds(gain)}, where {asked:g} are asked for."
    else:
        told = f"{'falls' if gain < 0 else 'rises'} by {said} nats, where a rise of {asked:g} is asked for"
        yield f"It is not worth a parameter: the evidence {told}."
    yield f"The plain error {_change(old.plain, new.plain)} on the data it was fitted to."
    # The channel that gained most, where others hide it in the whole
    known = [name for name in new.by_channel if name in old.by_channel]
    gained = {name: old.by_channel[name] ** 2 - new.by_channel[name] ** 2 for name in known}
    best = max(gained, key=lambda name: gained[name], default="")
    if best and new.by_channel[best] < (1 - FALLS) * old.by_channel[best]:
        was, now = percent(old.by_channel[best]), percent(new.by_channel[best])
        yield f"Of its channels {best} gains most: {was} before and {now} after."
    if old.held_out is None or new.held_out is None:
        yield "No data were left for checking, so that nothing says whether it holds elsewhere."
    else:
        yield f"It {_change(old.held_out, new.held_out)} on data used only for checking."
        known = [name for name in new.by_fold if name in old.by_fold]
        fell = [name for name in known if new.by_fold[name] < (1 - FALLS) * old.by_fold[name]]
        rose = [name for name in known if new.by_fold[name] > (1 + FALLS) * old.by_fold[name]]
        if rose and len(known) > 1:
            worst = max(rose, key=lambda name: new.by_fold[name] / old.by_fold[name])
            told = f"most of all {worst}: {percent(old.by_fold[worst])} before and {percent(new.by_fold[worst])} after"
            yield f"Of {len(known)} that were left out of the fit in turn {len(fell)} fell and {len(rose)} rose, {told}."
        if new.plain < (1 - FALLS) * old.plain and new.held_out > (1 + FALLS) * old.held_out:
            yield "What it explains here it does not explain there: it fits the data, not the structure."
    for size in after.effects.get(after.effect, ()):
        yield _size(size, tolerances.get(size.key, 0.0), nulls.get(size.key, 0.0))
    # Judged as `massline compare` judges it
    if new.tolerances and costly(new.tolerance_z2, new.due_z2, new.largest_z or 0.0):
        many = f"sum z² {new.tolerance_z2:.3g}, where about {new.due_z2:.0f} is due"
        most = "" if new.largest_z is None or new.largest_z < ABSURD else f", one moved by {new.largest_z:.1f} of its deviations"
        yield f"The prior penalty of the tolerances stays too high, {many}{most}: something else is wrong, however good chi² is."


def _change(old: float, new: float) -> str:
    if new < (1 - FALLS) * old:
        return f"falls from {percent(old)} to {percent(new)}"
    if new > (1 + FALLS) * old:
        return f"rises from {percent(old)} to {percent(new)}"
    return f"does not fall ({percent(old)} before and {percent(new)} after)"


def _size(size: VersionSize, tolerance: float, null: float) -> str:
    name, u = f"Its {size.key}" if size.key else "Its size", with_unit("", size.unit)
    if size.deviation is None:
        return f"{name} was given, not fitted: {size.value:.4g}{u}."
    off, half = abs(size.value - null), NORMAL_95 * size.deviation
    told = f"{name}, {size.value:.4g} ± {half:.2g}{u} (95 %),"
    admitted = f"within its tolerance of {tolerance:.2g}{u}, one standard deviation"
    if size.deviation == 0:
        return f"{name} ends at the bound of what its family allows, {size.value:.4g}{u}: the data want it beyond."
    if tolerance > 0 and off <= NORMAL_95 * tolerance:
        return f"{told} lies {admitted}: it is no fault."
    if tolerance > 0 and off - half <= NORMAL_95 * tolerance:
        return f"{told} may yet lie {admitted}."
    if off <= half:
        return f"{told} cannot be told from no effect."
    return f"{name} is {size.value:.4g} ± {half:.2g}{u} (95 %)."


def percent(value: float | None) -> str:
    """An error with three digits."""
    return "–" if value is None else f"{value:.3g} %"


def sentence(text: str) -> str:
    """`text` with a capital and one full stop."""
    return f"{text[:1].upper()}{text[1:].rstrip('.')}."
