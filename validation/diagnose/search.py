"""Stepwise selection of effects by their evidence: screen all candidates, fit the best few, accept the best, and again.

Screening is a score test, linear in the size; fits decide. A fit starts from one of three places: where the tolerances stand;
over a coarse model-error floor, where the model is too nonlinear for the score test (`rough_fit`); and from the priors, where
tolerances have absorbed an effect and no fit reaches what the score test promised (`restarted_from_priors`). After each
accepted effect the earlier ones are tested again beside it (`backward_elimination`): one that explained a little of everything
goes when what is really missing is there, and a name may be right only beside the others.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import inf, log

import numpy as np

from geometry.errors import CheckFailed
from geometry.frames import Array
from validation.diagnose.accept import ABSURD, GoodnessOfFit, excess, goodness_of_fit
from validation.diagnose.candidates import aliases, is_resonator, reaches, screen
from validation.diagnose.diagnosis import Candidate, Screened
from validation.effects.catalogue import FAMILIES
from validation.effects.effect import INDISTINGUISHABLE_NATS, OPENED, PERIOD_STAGE, STRUCTURE, evidence_threshold
from validation.estimation.fit import BREAKDOWNS, child, nearby
from validation.estimation.likelihood import Cost, cost_of
from validation.estimation.problem import EFFECT, FITTED, Fit, Parameter, Problem
from validation.history.add import sized_by
from validation.model.model import Added
from validation.prediction.effects import name
from validation.study import Study

ROUGH_FIT_STRIDE = 3
"""[count] A rough fit takes every third line of the others. Set by the development draws of `make blind`."""

ROUGH_FIT_PART = 0.25
"""[share] of the size of an effect at which a rough fit begins, too. Set by the development draws of `make blind`."""

UNSEEN_STEP = 0.05
"""[nats] that a finished fit may cost more than where its trial stopped: the last step is taken unseen. Set by the development
draws of `make blind`."""

SIGNIFICANT = 2.0
"""[sd] from no effect at which an effect is one. Exercised by tests/validation/diagnosing/test_diagnosed.py."""

FitProgress = Callable[[float], None]


def baseline(data: Study, progress: FitProgress | None = None) -> Candidate:
    """The model as it is.

    Raises
    ------
    CheckFailed : its fit does not converge; an unconverged baseline makes any effect look decisive.
    """
    return Candidate(effects=(), fit=data.all_free(progress), problem=data.problem())


def rough_fit(data: Study, at: Candidate, added: Added) -> Fit:
    """`at` with the effect `added` as well, fitted over a coarse floor on few lines: for effects in which the model is nonlinear.

    The score test overrates these, so that the fit starts at its size and at a part of that.
    """
    problem = data.problem((*at.effects, added)).sparser(ROUGH_FIT_STRIDE)
    start = _start(data, added)
    begins = (
        [start] if is_resonator(added.named) or not start else [start, {name: ROUGH_FIT_PART * x for name, x in start.items()}]
    )
    return min((child(problem, FITTED, at.fit, begin, from_afar=True) for begin in begins), key=lambda fit: fit.cost)


def refitted(data: Study, at: Candidate, begin: Fit) -> Candidate:
    """`at` fitted again from where another fit ended, where that is cheaper."""
    found = nearby(at.problem, FITTED, begin.by_name)
    return at if found.cost >= at.fit.cost else recentred(data, replace(at, fit=found))


def finished(data: Study, at: Candidate) -> Candidate:
    """`at`, whose fit may be a trial, fitted to the end."""
    found = nearby(at.problem, FITTED, at.fit.by_name)
    return recentred(data, replace(at, fit=found)) if found.cost <= at.fit.cost + UNSEEN_STEP else at


def is_significant(of: Candidate) -> bool:
    """Whether a fitted size of the newest effect differs from that of no effect."""
    added = of.effects[-1]
    sizes = () if added.fixed or is_resonator(added.named) else added.named.fitted_sizes
    known = {one.name: (x, sd) for one, x, sd in zip(of.fit.parameters, of.fit.offsets, _spread(of.fit), strict=True)}
    found = [known[which] for size in sizes if (which := name(added.named, size.key)) in known]
    return not found or any(abs(x) > SIGNIFICANT * sd > 0 for x, sd in found)


def _spread(fit: Fit) -> Array:
    return np.asarray(np.sqrt(np.maximum(np.diag(fit.covariance), 0.0)))


def fit_with(data: Study, at: Candidate, added: Added, *, begin: Fit | None = None) -> Candidate:
    """`at` with the effect `added` as well, all sizes free; it never costs more.

    Parameters
    ----------
    begin : a rough fit of the same, from which it starts; `at` by default
    """
    effects = (*at.effects, added)
    problem = data.problem(effects)
    start = _start(data, added) if begin is None else begin.by_name
    found = child(problem, FITTED, at.fit, start)
    return recentred(data, Candidate(effects=effects, fit=found, problem=problem))


def fit_in_place(data: Study, at: Candidate, rest: Candidate, added: Added) -> Candidate:
    """`rest` with the effect `added` as well, from where `at` ended with another in its place."""
    effects = (*rest.effects, added)
    problem = data.problem(effects)
    same = {one.name for one in at.fit.parameters if (new := problem.by_name.get(one.name)) and new.kind == one.kind}
    start = {which: x for which, x in _offsets_in(problem, at.fit).items() if which in same} | _start(data, added)
    return recentred(data, Candidate(effects=effects, fit=child(problem, FITTED, rest.fit, start), problem=problem))


def _start(data: Study, added: Added) -> dict[str, float]:
    """An effect with an equation begins at its size; the fit knows where a tolerance stands already."""
    if FAMILIES[added.named.family].stage == OPENED or added.fixed:
        return {}
    keys = [size.key for size in added.named.fitted_sizes]
    parameters = {one.name: one for one in data.problem((added,)).parameters}
    return {which: parameters[which].start for key in keys if (which := name(added.named, key)) in parameters}


def recentred(data: Study, of: Candidate) -> Candidate:
    """`of` with its effects at the sizes that the fit found, from which logarithms then count."""
    effects = tuple(sized_by(one, of.fit) for one in of.effects)
    problem = data.problem(effects)
    # `fit` with its logarithms counted from the sizes that the models of `problem` have
    fit = of.fit
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


# Restart from the priors. A blade's tip that is 100 g too heavy moves its frequencies by forty of their tolerances, and the
# tolerances absorb that: from there each step to the mass needs a frequency that returns to its prior at the same time. So sizes
# from a small part of the prior sd to several times that are tried with every tolerance at its prior, and the fit starts at the
# best of them.

SIZE_OCTAVES = np.arange(-6.0, 4.0, 0.5)
"""[octave] of the prior sd: sizes at which an effect is looked at. Exercised by tests/validation/diagnosing/test_restarts.py."""

SIZE_SCAN_FLOOR = 0.2
"""[share] Model-error floor of these looks: so coarse that resonances which a tolerance still has to move do not decide.
Exercised by tests/validation/diagnosing/test_restarts.py."""


def can_restart(added: Added) -> bool:
    """Whether an effect can be fitted from the priors: it has one fitted size and is not of a pendulum."""
    swings = FAMILIES[added.named.family].stage == PERIOD_STAGE
    return not (added.fixed or swings or is_resonator(added.named)) and len(added.named.fitted_sizes) == 1


def restarted_from_priors(data: Study, at: Candidate, added: Added) -> Candidate:
    """`at` with the effect `added` as well, all tolerances restarted from their priors; it never costs more than `at`."""
    effects = (*at.effects, added)
    problem = data.problem(effects)
    (which,) = (name(added.named, size.key) for size in added.named.fitted_sizes)
    home = _declared(problem, at.fit)
    # The size of the effect `which` that comes nearest to the data, everything else at `home`
    nearest_problem = problem.sparser(ROUGH_FIT_STRIDE)
    cost = cost_of(nearest_problem, [nearest_problem.by_name[which]], SIZE_SCAN_FLOOR, home)
    nearest = min(map(float, sizes(nearest_problem.by_name[which])), key=lambda size: _cost_at(cost, size))
    begin = home | {which: nearest}
    return recentred(data, Candidate(effects=effects, fit=child(problem, FITTED, at.fit, begin, from_afar=True), problem=problem))


def tolerances_restarted(data: Study, at: Candidate) -> Candidate:
    """`at`, all tolerances restarted from their priors; it never costs more.

    A tolerance that absorbed an effect may stay in a local minimum when that is found, as of a mode with the wrong sign.
    """
    return recentred(data, replace(at, fit=child(at.problem, FITTED, at.fit, _declared(at.problem, at.fit), from_afar=True)))


def _declared(problem: Problem, fit: Fit) -> dict[str, float]:
    """Offsets of tolerances as they are declared, and of the effects as `fit` found them."""
    found = {one.name: fit.by_name[one.name] for one in fit.parameters if one.kind == EFFECT}
    return {one.name: one.start for one in problem.parameters} | found


def _cost_at(cost: Cost, size: float) -> float:
    try:
        return cost.total(np.array([size]))[0].cost
    except BREAKDOWNS:
        return inf


def sizes(of: Parameter) -> Array:
    """Offsets of `of` at which an effect is looked at, (n,), none outside its bounds."""
    steps = of.tolerance * np.exp2(SIZE_OCTAVES)
    both = np.concatenate([-steps[::-1], steps])
    return both[(both > of.low) & (both < of.high)]


@dataclass(frozen=True, eq=False, kw_only=True)
class CandidateFit:
    """A candidate and its fit.

    Attributes
    ----------
    id : of the effect
    candidate : with it
    evidence : [nats] against the candidate without it
    goodness : of the fit
    """

    id: str
    candidate: Candidate
    evidence: float
    goodness: GoodnessOfFit

    @property
    def added(self) -> Added:
        """The effect, at the size that the fit found."""
        return self.candidate.effects[-1]

    @property
    def family(self) -> str:
        """Of the effect."""
        return self.added.named.family


@dataclass(frozen=True, eq=False, kw_only=True)
class SearchStep:
    """One step forward.

    Attributes
    ----------
    at : where it began
    goodness : there
    screened : all candidates, the most promising first
    tried : those that were fitted, the most evidence first
    added : id of what was accepted; empty for nothing
    left_band : ids of resonators that a fit drove out of the band of the data
    reconsidered : id of the effect that backward elimination tested, empty of a step forward; `added` is it or replaces it
    """

    at: Candidate
    goodness: GoodnessOfFit
    screened: tuple[Screened, ...]
    tried: tuple[CandidateFit, ...]
    added: str
    left_band: tuple[str, ...] = ()
    reconsidered: str = ""


def candidate_fit(at: Candidate, there: Candidate) -> CandidateFit:
    """The fit `there` with one effect more than `at`."""
    evidence = there.fit.log_evidence - at.fit.log_evidence
    return CandidateFit(
        id=there.effects[-1].named.id, candidate=there, evidence=evidence, goodness=goodness_of_fit(there.fit, there.problem)
    )


def ranked(tried: Sequence[CandidateFit]) -> list[CandidateFit]:
    """The best fit of each candidate, the most evidence first."""
    by_id: dict[str, CandidateFit] = {}
    for one in sorted(tried, key=lambda each: -each.evidence):
        by_id.setdefault(one.id, one)
    return list(by_id.values())


def in_band(data: Study, one: CandidateFit) -> bool:
    """Whether a resonator stayed in the band of the data; outside it is a spring or a mass."""
    return not is_resonator(one.added.named) or reaches(data, one.added.named)


def is_accepted(one: CandidateFit) -> bool:
    """Whether a fit may be accepted: its evidence reaches the threshold of its family, and its size is significant."""
    return one.evidence >= evidence_threshold(one.family) and is_significant(one.candidate)


def indistinguishable(of: SearchStep) -> tuple[CandidateFit, ...]:
    """The fits of a step whose evidence cannot be told from that of its best, the best first."""
    if not of.tried:
        return ()
    best = of.tried[0]
    return tuple(
        one
        for one in of.tried
        if one.evidence >= best.evidence - INDISTINGUISHABLE_NATS and (one.goodness.null or not best.goodness.null)
    )


RIVALS = 5
"""[count] of names at most that an earlier effect is held against. Exercised by
tests/validation/diagnosing/test_backward_elimination.py."""

RIVAL_SHARE = 0.25
"""[share] of the evidence of the best that such a name must have brought. Exercised by
tests/validation/diagnosing/test_backward_elimination.py."""


def backward_elimination(
    data: Study, at: Candidate, rounds: Sequence[SearchStep], progress: Progress
) -> tuple[Candidate, tuple[SearchStep, ...]]:
    """`at` without the effects that are not needed beside the others, each of these under the name that is best there.

    Parameters
    ----------
    rounds : that led there

    Returns
    -------
    candidate : `at`, or what is better
    rounds : one of each effect that was asked; none of a single one that was found alone
    """
    known = {one.added: one for one in rounds}
    asked: list[SearchStep] = []
    for anew in (False, True):  # what changed may stand beside others than it was asked beside
        for which in _ids(at):
            if (len(at.effects) > 1 and not anew) or {*_ids(known[which].at)} != {*_ids(at)} - {which}:
                at, more = _reconsidered(data, at, known[which], progress)
                known |= {one.added: one for one in more}
                asked += more
    return at, tuple(asked)


def _ids(of: Candidate) -> tuple[str, ...]:
    return tuple(one.named.id for one in of.effects)


def _reconsidered(data: Study, at: Candidate, found: SearchStep, progress: Progress) -> tuple[Candidate, tuple[SearchStep, ...]]:
    """`at` with the effect of step `found` under its best name, and the fits of that; or without it."""
    added = next(one for one in at.effects if one.named.id == found.added)
    try:
        rest = _without(data, at, added)
    except CheckFailed:  # there is nothing to hold it against
        return at, ()
    evidence = at.fit.log_evidence - rest.fit.log_evidence
    if evidence < evidence_threshold(added.named.family):
        return rest, ()
    # `at`, the effect `added` named last
    last = replace(at, effects=(*(one for one in at.effects if one is not added), added))
    there = CandidateFit(id=found.added, candidate=last, evidence=evidence, goodness=goodness_of_fit(at.fit, at.problem))
    rivals = _earlier_rivals(found, at)
    progress(f"asking {found.added} and {len(rivals)} others once more", 0.95)
    others = [candidate_fit(rest, fit_in_place(data, at, rest, _at_sizes_found(one.added, added))) for one in rivals]
    may = [one for one in others if in_band(data, one) and (is_accepted(one) or one.evidence <= evidence)]
    tried = tuple(ranked([there, *may]))
    stands = goodness_of_fit(rest.fit, rest.problem)
    again = replace(found, at=rest, goodness=stands, tried=tried, added=tried[0].id, reconsidered=found.added)
    return at if tried[0] is there else tried[0].candidate, (again,)


def _earlier_rivals(found: SearchStep, at: Candidate) -> list[CandidateFit]:
    """Other fits of a step whose evidence was a good part of the best, of effects that `at` has not."""
    near = [one for one in found.tried if one.id not in _ids(at) and one.evidence >= RIVAL_SHARE * found.tried[0].evidence]
    return near[:RIVALS]


def _at_sizes_found(one: Added, found: Added) -> Added:
    """A resonator at another place or under another name begins at the sizes of the one that was found; others at their own."""
    same = is_resonator(one.named) and is_resonator(found.named) and one.named.values.keys() == found.named.values.keys()
    return replace(one, named=replace(one.named, values=found.named.values)) if same else one


def _without(data: Study, at: Candidate, added: Added) -> Candidate:
    """The fit of the other effects alone, from where it is with all."""
    left = tuple(one for one in at.effects if one.named.id != added.named.id)
    problem = data.problem(left)
    return recentred(data, Candidate(effects=left, fit=nearby(problem, FITTED, at.fit.by_name), problem=problem))


MOST_EFFECTS = 3
"""[count] of effects that are looked for. Set by the development draws of `make blind`."""

MOST_STEPS = 6
"""[count] of steps forward in which they are; backward elimination may take some away again. Set by the development draws of
`make blind`."""

FITS_OF_A_STEP = 6
"""[count] of candidates that are fitted in a step at most. Exercised by tests/validation/diagnosing/test_search.py."""

FITS_OF_A_FAMILY = 3
"""[count] of these of one family at most. Exercised by tests/validation/diagnosing/test_search.py."""

FITS_OF_THE_STRUCTURE = 2
"""[count] of these of the structure at least, where any promises something. Exercised by
tests/validation/diagnosing/test_search.py."""

WORTH_A_FIT = 4.0
"""[nats] that a straight line must promise for a fit. Exercised by tests/validation/diagnosing/test_search.py."""

NULL_MARGIN = 1.0
"""[nats] that it may promise less than is asked for where nothing need be missing: there a straight line is right. Exercised by
tests/validation/diagnosing/test_search.py."""

SCREENING_MARGIN = 12.0
"""[nats] behind the promise of the best at which another is not fitted, once that best is all that is needed. Set by the
development draws of `make blind`."""

SCREENING_ERROR = 0.15
"""[share] of a promise by which a straight line may err. Set by the development draws of `make blind`."""

NONLINEAR_MISFIT = 1.5
"""[chi²/dof] from which a straight line says little of the sizes, and fits come from afar. Set by the development draws of `make
blind`."""

ROUGH_FITS_FINISHED = 3
"""[count] of these rough fits that are finished. Set by the development draws of `make blind`."""

REFITS = 1
"""[count] of times that a fit is taken up again where one with a useless effect ended lower. Set by the development draws of
`make blind`."""

REPLACEMENTS = 2
"""[count] of fits in place of resonators that a fit has driven out of the band, where they are springs or masses. Exercised by
tests/validation/diagnosing/test_search.py."""

KEPT_SHARE = 0.5
"""[share] of a promise that a fit must keep lest it restart from the priors, where no fit comes up to that promise. Exercised by
tests/validation/diagnosing/test_search.py."""

RESTARTS = 3
"""[count] of fits of a step that restart from the priors. Exercised by tests/validation/diagnosing/test_search.py."""

LEAST_EXPLAINED = 0.25
"""[share] of the excess cost that an effect must explain for others to be looked for beside it. Set by the development draws of
`make blind`."""

ALIAS_FITS = 3
"""[count] of rivals that are fitted though no straight line promised them. Exercised by
tests/validation/diagnosing/test_search.py."""

ALIAS_OWN_SHARE = 0.3
"""[share] of what the best does that may be its own for another to be such a rival. Set by the development draws of `make
blind`."""

Progress = Callable[[str, float], None]


def stepwise_search(
    data: Study, base: Candidate, menu: Sequence[Added], progress: Progress
) -> tuple[Candidate, tuple[SearchStep, ...]]:
    """The candidate that explains the data of `data` with the fewest effects of `menu`, and how it was found."""
    at, again = base, REFITS
    rounds: list[SearchStep] = []
    while len(at.effects) < MOST_EFFECTS and sum(not one.reconsidered for one in rounds) < MOST_STEPS:
        one = _step(data, at, menu, progress)
        if (
            again
            and one.tried
            and not one.added
            and one.tried[0].evidence > INDISTINGUISHABLE_NATS
            and not is_significant(one.tried[0].candidate)
        ):
            at, again = refitted(data, at, one.tried[0].candidate.fit), again - 1  # none of it, but a better way down
            continue
        rounds.append(one)
        if not one.added:
            break
        found = _restarted_if_absurd(data, one.tried[0].candidate)
        explained, null = one.at.fit.cost - found.fit.cost, goodness_of_fit(found.fit, found.problem).null
        at, asked = backward_elimination(data, found, rounds, progress)
        rounds += asked
        if not null and explained < LEAST_EXPLAINED * excess(one.at.fit, one.goodness):
            break  # nothing known is most of what is wrong: the rest would be named one by one, and none of it is there
    return at, tuple(rounds)


def _step(data: Study, at: Candidate, menu: Sequence[Added], progress: Progress) -> SearchStep:
    progress(f"screening {len(menu)} effects", 0.0)
    here, found = goodness_of_fit(at.fit, at.problem), screen(data, at, menu)
    tried, gone = _fits_in_band(
        data,
        found,
        lambda some: (_rough_fits if here.misfit > NONLINEAR_MISFIT else _local_fits)(data, at, here, some, progress),
    )
    tried = _restarted_where_stuck(data, at, here, tried, found, progress)
    good = bool(tried) and is_accepted(tried[0])
    asked: set[str] = set()
    while good and tried[0].id not in asked:  # a rival that is better has rivals of its own
        rivals = [*_rivals(tried, menu, found), *(_same_resonator_elsewhere(tried) if asked else [])]
        asked.add(tried[0].id)
        progress(f"telling {tried[0].id} from {len(rivals)} others", 0.9)
        fitted = [_rival_fit(data, at, one, tried[0]) for one in rivals]
        may = [one for one in fitted if in_band(data, one) and (is_accepted(one) or one.evidence <= tried[0].evidence)]
        tried = ranked([*tried, *may])
    return SearchStep(at=at, goodness=here, screened=found, tried=tuple(tried), added=tried[0].id if good else "", left_band=gone)


def _local_fits(
    data: Study, at: Candidate, here: GoodnessOfFit, found: Sequence[Screened], progress: Progress
) -> list[CandidateFit]:
    """Fits of the best, until one is all that is needed."""
    tried: list[CandidateFit] = []
    for one in _most_promising(found):
        if _is_decided(tried, one, found):
            break
        if here.null and one.evidence < evidence_threshold(one.added.named.family) - NULL_MARGIN:
            continue
        progress(f"trying {one.id}", len(tried) / FITS_OF_A_STEP)
        tried.append(_fit_of(data, at, one.added))
    return tried


def _rough_fits(
    data: Study, at: Candidate, here: GoodnessOfFit, found: Sequence[Screened], progress: Progress
) -> list[CandidateFit]:
    """Rough fits of all that promise something, and of the best of these good ones."""
    rough, promising = [], _most_promising(found)
    for done, one in enumerate(promising):
        progress(f"trying {one.id} from afar", done / (len(promising) + ROUGH_FITS_FINISHED))
        rough.append((one.added, rough_fit(data, at, one.added)))
    rough.sort(key=lambda each: -each[1].log_evidence)
    return [_fit_of(data, at, added, begin) for added, begin in rough[:ROUGH_FITS_FINISHED]]


def _fits_in_band(
    data: Study, found: Sequence[Screened], fits: Callable[[Sequence[Screened]], list[CandidateFit]]
) -> tuple[list[CandidateFit], tuple[str, ...]]:
    """`fits` of the best, and of others in place of resonators that leave the band; and the ids of these resonators."""
    tried = fits(found)
    inside = [one for one in tried if in_band(data, one)]
    if len(inside) == len(tried):
        return inside, ()
    known = {one.id for one in tried}
    others = [one for one in found if one.id not in known and not is_resonator(one.added.named)]
    gone = tuple(one.id for one in tried if one not in inside)
    return [*inside, *fits(_most_promising(others)[:REPLACEMENTS])], gone


def _restarted_where_stuck(
    data: Study,
    at: Candidate,
    here: GoodnessOfFit,
    tried: Sequence[CandidateFit],
    found: Sequence[Screened],
    progress: Progress,
) -> list[CandidateFit]:
    """The fits, the best first; restarted from the priors where all fell short of a promise and something must be missing."""
    ranked, promised = sorted(tried, key=lambda each: -each.evidence), {one.id: one.evidence for one in found}
    if here.null or not ranked or ranked[0].goodness.null:
        return ranked
    short = [
        one for one in ranked if promised[one.id] > max(ranked[0].evidence, one.evidence / KEPT_SHARE) and can_restart(one.added)
    ]
    for one in sorted(short, key=lambda each: -promised[each.id])[:RESTARTS]:
        progress(f"trying {one.id} afresh", 0.8)
        other = candidate_fit(at, restarted_from_priors(data, at, one.added))
        ranked[ranked.index(one)] = max(one, other, key=lambda each: each.evidence)
    return sorted(ranked, key=lambda each: -each.evidence)


def _most_promising(found: Sequence[Screened]) -> list[Screened]:
    """The best, not too many of one family, some of the structure."""
    count: Counter[str] = Counter()
    chosen: list[Screened] = []
    for one in found:
        family = one.added.named.family
        if one.evidence >= WORTH_A_FIT and count[family] < FITS_OF_A_FAMILY:
            count[family] += 1
            chosen.append(one)
    best, rest = chosen[:FITS_OF_A_STEP], chosen[FITS_OF_A_STEP:]
    structural = sum(FAMILIES[one.added.named.family].side == STRUCTURE for one in best)
    more = [one for one in rest if FAMILIES[one.added.named.family].side == STRUCTURE][
        : max(FITS_OF_THE_STRUCTURE - structural, 0)
    ]
    return [*best, *more]


def _rivals(tried: Sequence[CandidateFit], menu: Sequence[Added], found: Sequence[Screened]) -> list[Added]:
    """Candidates that were not fitted and may be aliases of the best; of a resonator its like at the most promising places."""
    best, known = tried[0], {one.id for one in tried}
    others = [one for one in menu if one.named.id not in known]
    by_id = {one.id: one.added for one in found}
    if is_resonator(best.added.named):
        # in one place one oscillator may have two names
        twins = [one for one in others if is_resonator(one.named) and one.named.targets == best.added.named.targets]
        elsewhere = [one.added for one in found if one.id not in known and one.added.named.family == best.family]
        return [_at_sizes(one, best.added) for one in (*twins, *elsewhere[:ALIAS_FITS])]
    if best.added.fixed:
        return []
    near = aliases(
        best.candidate,
        best.added,
        [one for one in others if not is_resonator(one.named)],
        limit=min(INDISTINGUISHABLE_NATS / best.evidence, ALIAS_OWN_SHARE),
    )
    return [by_id[id] for id in near if id in by_id][:ALIAS_FITS]


def _same_resonator_elsewhere(tried: Sequence[CandidateFit]) -> list[Added]:
    """Resonators of the family of the best that were fitted at other places, now at the sizes of the best."""
    best = tried[0]
    same = [one for one in tried[1:] if is_resonator(one.added.named) and one.family == best.family]
    return [_at_sizes(one.added, best.added) for one in same]


def _rival_fit(data: Study, at: Candidate, added: Added, best: CandidateFit) -> CandidateFit:
    """The fit of an alias of `best`; restarted from the priors where it falls far behind."""
    found = _fit_of(data, at, added)
    if found.evidence >= KEPT_SHARE * best.evidence or not can_restart(added):
        return found
    return max(found, candidate_fit(at, restarted_from_priors(data, at, added)), key=lambda each: each.evidence)


def _at_sizes(one: Added, other: Added) -> Added:
    return replace(one, named=replace(one.named, values=other.named.values))


def _is_decided(tried: Sequence[CandidateFit], one: Screened, found: Sequence[Screened]) -> bool:
    """Whether the best fit misses nothing, and `one` promised less than it by more than a score test may err."""
    best = max(tried, key=lambda each: each.evidence, default=None)
    if best is None or not best.goodness.null:
        return False
    promised = next(each.evidence for each in found if each.id == best.id)
    return one.evidence < (1 - SCREENING_ERROR) * promised - SCREENING_MARGIN


def _fit_of(data: Study, at: Candidate, added: Added, begin: Fit | None = None) -> CandidateFit:
    return candidate_fit(at, fit_with(data, at, added, begin=begin))


def _restarted_if_absurd(data: Study, at: Candidate) -> Candidate:
    """`at`; where a tolerance stands absurdly far off, with all of them once more from where they are declared."""
    if goodness_of_fit(at.fit, at.problem).largest < ABSURD:
        return at
    home = candidate_fit(at, tolerances_restarted(data, at))
    return home.candidate if home.evidence > 0 and in_band(data, home) else at
