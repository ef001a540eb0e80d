"""Candidates and their fits: with one effect more, from where tolerances stand or from their priors, and how good a fit is."""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from math import inf, log, sqrt

import numpy as np

from geometry.errors import CheckFailed
from validation.diagnose.candidates import is_resonator, looked_up, sizes
from validation.diagnose.diagnosis import SIGNIFICANT, Candidate
from validation.effects.catalogue import FAMILIES
from validation.effects.effect import AT, OPENED, PERIOD_STAGE, evidence_threshold
from validation.estimation.fit import BREAKDOWNS, COARSE, FLOOR, SINGLE_PLACES, STRIDE, child, direct, nearby, start
from validation.estimation.likelihood import cost_of, freedom, observed
from validation.estimation.problem import EFFECT, FITTED, Fit, Problem
from validation.estimation.verdicts import due_misfit, expected_z2, largest_z, misfit
from validation.history.add import sized_by
from validation.model.model import Added
from validation.prediction.effects import name
from validation.study import Study

# When a fit counts as that of a model that misses nothing: limits set from sound tests, as docs/diagnosis-proven-blind.md tells.


SCATTER = 3.0
"""[sd] that chi² per degree of freedom of a null may lie above what noise alone predicts: scatter of chi² and of the noise
estimate. The model-error floor is a bound that nulls do not use: they read 0.97 to 1.01 of the noise. Set by the development
draws of `make blind`, held by test_search.py."""

UNLIKELY = 1e-4
"""[probability] of a sum of z² below which the tolerances pay for something that is missing. Set by the development draws of
`make blind`, held by test_search.py."""

ABSURD = 4.8
"""[sd] of one tolerance, of some four hundred, that is no chance. Held by test_search.py."""


@dataclass(frozen=True, kw_only=True)
class GoodnessOfFit:
    """How a fit stands against those of nulls.

    Attributes
    ----------
    misfit : chi² per degree of freedom
    limit : up to which it is that of a null
    prior_penalty : sum of z² of the tolerances over what is due
    largest : |z| of the tolerance that moved farthest
    likely : probability of such a sum of z², where nothing is wrong
    """

    misfit: float
    limit: float
    prior_penalty: float
    largest: float
    likely: float

    @property
    def null(self) -> bool:
        """Whether nothing more need be missing."""
        return self.misfit <= self.limit and self.likely >= UNLIKELY and self.largest < ABSURD

    @property
    def text(self) -> str:
        """Why not, in words; empty where nothing more need be missing."""
        said = []
        if self.misfit > self.limit:
            said.append(f"chi² per degree of freedom is {self.misfit:.3g}, in a sound laboratory below {self.limit:.2g}")
        if self.likely < UNLIKELY:
            said.append(f"the prior penalty of the tolerances is {self.prior_penalty:.3g} times what is due")
        if self.largest >= ABSURD:
            said.append(f"a tolerance is moved by {self.largest:.1f} of its standard deviations")
        return "; ".join(said)

    def excess(self, fit: Fit) -> float:
        """[nats] How much the cost of a fit lies above that of a null."""
        chi2, z2 = fit.chi2 - self.limit * fit.degrees_of_freedom, fit.tolerance_z2 - expected_z2(fit)
        return 0.5 * (max(chi2, 0.0) + max(z2, 0.0))


def goodness_of_fit(fit: Fit, problem: Problem) -> GoodnessOfFit:
    """Of a `fit` of all tolerances of `problem`.

    Noise alone would come to a chi² per degree of freedom of its share s of the variance that the likelihood allows for. Noise is
    an estimate of relative variance v at a line, and its inverse is on average larger than that of what is estimated: by s v, to
    second order. Where a class of laboratories admits a discrepancy of the model, it takes its share of the rest: the limit is
    what data replicated from the fit would come to, mean and `SCATTER` (A. Gelman, X.-L. Meng and H. Stern, Statistica Sinica 6,
    1996, 733).
    """
    from scipy.special import chdtrc

    shares, counts, sums, tiny = [], [], [], np.finfo(np.float64).tiny
    for one in problem.predictions:
        seen = observed(one.measured, lines := problem.lines_of(one))
        noise = np.square(seen.noise)
        s = noise / np.maximum(noise + np.square(FLOOR * seen.floor), tiny)
        count = freedom(seen, partial(one.at, fit.by_name, lines, derivatives=False), FLOOR)
        shares.append((s * (1 + s * one.measured.noise_scatter**2) + one.measured.discrepancy * (1 - s)).ravel())
        counts.append(count.ravel())
        sums.append(float(np.sum(count * s)))
    spreads = np.array([one.measured.noise_spread for one in problem.predictions])
    sd = float(np.linalg.norm(spreads * np.array(sums)) / max(np.array(sums).sum(), tiny))
    weights = np.maximum(np.concatenate(counts), tiny)  # inputs that nobody measured may take all
    due, share = max(expected_z2(fit), 1.0), float(np.average(np.concatenate(shares), weights=weights))
    left = 1.0 if (own := due_misfit(fit, problem, as_read=False)) is None else min(max(own, 0.0) / share, 1.0)
    return GoodnessOfFit(
        misfit=misfit(fit),
        limit=share * (left + SCATTER * sqrt(2 * left / max(fit.degrees_of_freedom, 1) + (left * sd) ** 2)),
        prior_penalty=fit.tolerance_z2 / due,
        largest=largest_z(fit),
        likely=float(chdtrc(due, fit.tolerance_z2)),
    )


def is_significant(of: Candidate) -> bool:
    """Whether a fitted size of the newest effect differs from that of no effect: by its deviation or, since a reading that turns
    over is flat where it ends, by what no effect would cost."""
    added, fit = of.effects[-1], of.fit
    sizes = () if added.fixed or is_resonator(added.named) else added.named.fitted_sizes
    deviation = dict(zip(fit.by_name, np.sqrt(np.maximum(np.diag(fit.covariance), 0.0)), strict=True))
    known = [(which, size.null) for size in sizes if (which := name(added.named, size.key)) in deviation]
    none = {which: of.problem.by_name[which].offset(null) for which, null in known}
    if not none or any(abs(fit.by_name[which] - x) > SIGNIFICANT * deviation[which] > 0 for which, x in none.items()):
        return True
    cost = cost_of(of.problem, fit.parameters, FLOOR, fit.by_name).holding(none)
    with suppress(CheckFailed):
        return direct(cost, cost.base, lambda share: None).whole.cost - fit.cost > 0.5 * SIGNIFICANT**2
    return False


def fit_with(data: Study, at: Candidate, added: Added, *, begin: Fit | None = None, worth: float = inf) -> Candidate:
    """`at` with the effect `added` as well, all sizes free; it never costs more.

    Parameters
    ----------
    begin : a rough fit of the same, from which it starts; `at` by default
    worth : cost below which it matters
    """
    effects = (*at.effects, added)
    problem = data.problem(effects)
    start = beginning(data, added) if begin is None else begin.by_name
    found = child(problem, FITTED, at.fit, start, worth=worth)
    return recentred(data, Candidate(effects=effects, fit=found, problem=problem))


def beginning(data: Study, added: Added) -> dict[str, float]:
    """An effect with an equation begins at its size; the fit knows where a tolerance stands already."""
    if FAMILIES[added.named.family].stage == OPENED or added.fixed:
        return {}
    keys = [size.key for size in added.named.fitted_sizes]
    parameters = {one.name: one for one in data.problem((added,)).parameters}
    return {which: parameters[which].start for key in keys if (which := name(added.named, key)) in parameters}


def recentred(data: Study, of: Candidate) -> Candidate:
    """`of` with its effects at the sizes that the fit found, from which logarithms then count."""
    effects, fit = tuple(sized_by(one, of.fit) for one in of.effects), of.fit
    problem = data.problem(effects)
    parameters = tuple(problem.by_name[one.name] for one in fit.parameters)
    counted_from = replace(fit, parameters=parameters, offsets=np.array(list(_offsets_in(problem, fit).values())))
    return Candidate(effects=effects, fit=counted_from, problem=problem)


def _offsets_in(problem: Problem, fit: Fit) -> dict[str, float]:
    """Offsets of `fit` of what `problem` has, its logarithms counted from there."""
    found = {}
    for old, x in zip(fit.parameters, fit.offsets, strict=True):
        if (new := problem.by_name.get(old.name)) is not None:
            found[old.name] = float(x) + (log(old.nominal / new.nominal) if new.logarithmic else 0.0)
    return found


# Restart from the priors. A blade's tip that is 100 g too heavy moves frequencies by forty tolerances, which absorb that:
# from there each step to the mass needs a frequency that returns. So sizes are tried with every tolerance at its prior.


def can_restart(added: Added) -> bool:
    """Whether an effect can be fitted from the priors: it has one fitted size and is not of a pendulum."""
    swings = FAMILIES[added.named.family].stage == PERIOD_STAGE
    return not (added.fixed or swings) and len(added.named.fitted_sizes) == 1


def restarted_from_priors(data: Study, at: Candidate, added: Added | None = None, *, worth: float = inf) -> Candidate:
    """`at`, with the effect `added` as well where one is given, all tolerances restarted from their priors; it never costs more.

    A tolerance that absorbed an effect may stay in a local minimum when that is found. `worth` as in `fit_with`.
    """
    if added is None:
        home = declared(at.problem, at.fit)
        return recentred(data, replace(at, fit=child(at.problem, FITTED, at.fit, home, from_afar=True)))
    effects = (*at.effects, added)
    problem = data.problem(effects)
    which, *others = (name(added.named, size.key) for size in added.named.fitted_sizes)
    home, coarse = declared(problem, at.fit), problem.sparser(STRIDE)
    if others:  # of a resonator: its frequency anywhere in the band
        low, high = np.log(looked_up(data))
        places = {others[0]: np.linspace(low, high, SINGLE_PLACES) - np.log(added.named.values["f"])}
        begin = home | start(coarse, others[:1], base=home, places=places, amplitude=which, floor=COARSE[0])
    else:
        cost = cost_of(coarse, [coarse.by_name[which]], COARSE[0], home)

        def looked(size: float) -> float:
            try:
                return cost.total(np.array([size]))[0].cost
            except BREAKDOWNS:
                return inf

        begin = home | {which: min(map(float, sizes(coarse.by_name[which])), key=looked)}
    found = child(problem, FITTED, at.fit, begin, from_afar=True, worth=worth)
    return recentred(data, Candidate(effects=effects, fit=found, problem=problem))


SAME_NATS = 0.05
"""[nats] within which two fits are one: they end a tenth of a deviation, 0.005, from their minimum. Held by test_search.py."""


@dataclass(frozen=True, eq=False, kw_only=True)
class CandidateFit:
    """A candidate and its fit.

    Attributes
    ----------
    id : of the effect
    candidate : with it
    evidence : [nats] against the candidate without it
    goodness : of the fit
    looked : [nats] that it cost to have looked for its place, which has no name; what is named first must be better by that, too
    """

    id: str
    candidate: Candidate
    evidence: float
    goodness: GoodnessOfFit
    looked: float = 0.0

    @property
    def added(self) -> Added:
        """The effect, at the size that the fit found."""
        return self.candidate.effects[-1]

    @property
    def family(self) -> str:
        """Of the effect."""
        return self.added.named.family


def candidate_fit(at: Candidate, there: Candidate) -> CandidateFit:
    """The fit `there` with one effect more than `at`."""
    evidence = there.fit.log_evidence - at.fit.log_evidence
    return CandidateFit(
        id=there.effects[-1].named.id, candidate=there, evidence=evidence, goodness=goodness_of_fit(there.fit, there.problem)
    )


def ranked(tried: Sequence[CandidateFit]) -> list[CandidateFit]:
    """The best fit of each candidate, the most evidence first once it has paid what was looked; ties by name, not by rounding,
    and by that of a place before its coordinates."""
    by_id = {one.id: one for one in sorted(tried, key=lambda each: each.evidence)}
    paid = {id: one.evidence - one.looked for id, one in by_id.items()}
    best = max(by_id.values(), key=lambda one: paid[one.id], default=None)
    ties = {id for id, one in by_id.items() if best is not None and abs(one.evidence - best.evidence) < SAME_NATS}
    return sorted(by_id.values(), key=lambda one: (-inf, AT in one.id, one.id) if one.id in ties else (-paid[one.id], False, ""))


def in_band(data: Study, one: CandidateFit) -> bool:
    """Whether a resonator stayed where the data are; far below them it is a spring to the ground, far above a mass."""
    if not is_resonator(one.added.named):
        return True
    low, high = looked_up(data)
    return low <= one.added.named.values["f"] <= high


def is_accepted(one: CandidateFit) -> bool:
    """Whether a fit may be accepted: its evidence reaches the threshold of its family, and its size is significant."""
    return one.evidence >= evidence_threshold(one.family) and is_significant(one.candidate)


def declared(problem: Problem, fit: Fit) -> dict[str, float]:
    """Offsets of tolerances as they are declared, and of the effects as `fit` found them."""
    kept = (one.name for one in fit.parameters if one.kind == EFFECT)
    return {one.name: one.start for one in problem.parameters} | {one: fit.by_name[one] for one in kept}


def over(ready: Study, data: Study, of: Candidate) -> Candidate:
    """`of` the study `data`, fitted from where it stands over what coordinates `ready` has more."""
    if ready is data:
        return of
    problem = ready.problem(of.effects)
    try:
        fit = nearby(problem, FITTED, of.fit.by_name)
    except CheckFailed:  # over more coordinates the model breaks down there
        fit = nearby(problem, FITTED, declared(problem, of.fit))
    return recentred(ready, replace(of, fit=fit, problem=problem))


def fit_in_place(data: Study, at: Candidate, rest: Candidate, added: Added, *, worth: float = inf) -> Candidate:
    """`rest` with the effect `added` as well, from where `at` ended with another in its place; `worth` as in `fit_with`."""
    effects = (*rest.effects, added)
    problem = data.problem(effects)
    same = {one.name for one in at.fit.parameters if (new := problem.by_name.get(one.name)) and new.kind == one.kind}
    start = {which: x for which, x in _offsets_in(problem, at.fit).items() if which in same} | beginning(data, added)
    found = child(problem, FITTED, rest.fit, start, worth=worth)
    return recentred(data, Candidate(effects=effects, fit=found, problem=problem))
