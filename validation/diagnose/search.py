"""The search: screen all candidates, fit the best few, take the one with the most evidence, and again; then backward.

A straight line finds the way and the fit decides, from one of three beginnings: where the tolerances stand; from afar, over a
coarse floor, where the model bends so that a line misleads; and afresh, where tolerances have paid for an effect and no fit keeps
what the line promised of it. Effects that were found first are asked once more when others are there, see `asked_again`.
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
from validation.effects.catalogue import FAMILIES, Named
from validation.effects.effect import INDISTINGUISHABLE_NATS, OPENED, PERIOD_STAGE, evidence_threshold
from validation.estimation.cost import Cost, cost_of
from validation.estimation.fit import BREAKDOWNS, child, nearby
from validation.estimation.problem import EFFECT, FITTED, Offsets, Parameter, Problem
from validation.estimation.result import Fit
from validation.history.add import sized_by
from validation.model.model import Added
from validation.prediction.effects import name
from validation.study import Study as FittedData

# A hypothesis fitted: all tolerances, and the effects with them.


SPARSE, PART = 3, 0.25
"""A rough fit takes every so many lines of the others, and begins at such a part of the size, too."""

SAME = 0.05
"""[nats] that a fit which ended by itself may cost more than where its trial stopped: the last step is taken unseen."""

OUT = 2.0
"""Standard deviations from no effect at which an effect is one."""

RefittingProgress = Callable[[float], None]


def baseline(bench: FittedData, progress: RefittingProgress | None = None) -> Candidate:
    """The model as it is.

    Raises
    ------
    CheckFailed : its fit does not converge; an unconverged baseline makes any effect look decisive.
    """
    return Candidate(effects=(), fit=bench.all_free(progress), problem=bench.problem())


def roughly(bench: FittedData, at: Candidate, added: Added) -> Fit:
    """`at` with the effect `added` as well, fitted from afar and on few lines: for effects that bend the model.

    A straight line overrates what bends it, so that the way begins at its size and at a part of that.
    """
    problem = bench.problem((*at.effects, added)).sparser(SPARSE)
    start = _start(bench, added)
    begins = [start] if is_resonator(added.named) or not start else [start, {name: PART * x for name, x in start.items()}]
    return min((child(problem, FITTED, at.fit, begin, from_afar=True) for begin in begins), key=lambda fit: fit.cost)


def refitted(bench: FittedData, at: Candidate, begin: Fit) -> Candidate:
    """`at` fitted again from where another fit ended, where that is cheaper."""
    found = nearby(at.problem, FITTED, begin.by_name)
    return at if found.cost >= at.fit.cost else recentred(bench, replace(at, fit=found))


def finished(bench: FittedData, at: Candidate) -> Candidate:
    """`at`, whose fit may be a trial, fitted to the end."""
    found = nearby(at.problem, FITTED, at.fit.by_name)
    return recentred(bench, replace(at, fit=found)) if found.cost <= at.fit.cost + SAME else at


def is_significant(of: Candidate) -> bool:
    """Whether the newest effect is more than none: what is fitted of it lies off the size of no effect."""
    added = of.effects[-1]
    sizes = () if added.fixed or is_resonator(added.named) else added.named.fitted_sizes
    known = {one.name: (x, sd) for one, x, sd in zip(of.fit.parameters, of.fit.offsets, _spread(of.fit), strict=True)}
    found = [known[which] for size in sizes if (which := name(added.named, size.key)) in known]
    return not found or any(abs(x) > OUT * sd > 0 for x, sd in found)


def _spread(fit: Fit) -> Array:
    return np.asarray(np.sqrt(np.maximum(np.diag(fit.covariance), 0.0)))


def refitting_refitted(bench: FittedData, at: Candidate, added: Added, *, begin: Fit | None = None) -> Candidate:
    """`at` with the effect `added` as well, all sizes free; it never costs more.

    Parameters
    ----------
    begin : a rough fit of the same, where the way begins; by default it is straight down from `at`
    """
    effects = (*at.effects, added)
    problem = bench.problem(effects)
    start = _start(bench, added) if begin is None else begin.by_name
    found = child(problem, FITTED, at.fit, start)
    return recentred(bench, Candidate(effects=effects, fit=found, problem=problem))


def instead(bench: FittedData, at: Candidate, rest: Candidate, added: Added) -> Candidate:
    """`rest` with the effect `added` as well, from where `at` ended with another in its place."""
    effects = (*rest.effects, added)
    problem = bench.problem(effects)
    same = {one.name for one in at.fit.parameters if (new := problem.by_name.get(one.name)) and new.kind == one.kind}
    start = {which: x for which, x in _in(problem, at.fit).items() if which in same} | _start(bench, added)
    return recentred(bench, Candidate(effects=effects, fit=child(problem, FITTED, rest.fit, start), problem=problem))


def _start(bench: FittedData, added: Added) -> dict[str, float]:
    """An effect with an equation begins at its size; the fit knows where a tolerance stands already."""
    if FAMILIES[added.named.family].stage == OPENED or added.fixed:
        return {}
    keys = [size.key for size in added.named.fitted_sizes]
    parameters = {one.name: one for one in bench.problem((added,)).parameters}
    return {which: parameters[which].start for key in keys if (which := name(added.named, key)) in parameters}


def recentred(bench: FittedData, of: Candidate) -> Candidate:
    """`of` with its effects at the sizes that the fit found, from which logarithms then count."""
    effects = tuple(sized_by(one, of.fit) for one in of.effects)
    problem = bench.problem(effects)
    return Candidate(effects=effects, fit=_counted_from(problem, of.fit), problem=problem)


def _counted_from(problem: Problem, fit: Fit) -> Fit:
    """`fit` with its logarithms counted from the sizes that the models of `problem` have."""
    parameters = tuple(problem.by_name[one.name] for one in fit.parameters)
    return replace(fit, parameters=parameters, offsets=np.array(list(_in(problem, fit).values())))


def _in(problem: Problem, fit: Fit) -> dict[str, float]:
    """Offsets of `fit` of what `problem` has, its logarithms counted from there."""
    found = {}
    for old, x in zip(fit.parameters, fit.offsets, strict=True):
        if (new := problem.by_name.get(old.name)) is not None:
            found[old.name] = float(x) + (log(old.nominal / new.nominal) if new.logarithmic else 0.0)
    return found


# A second way to an effect: not from where tolerances have paid for it already, but from where they are declared.
#
# A blade's tip that is 100 g too heavy moves its frequencies by forty of their tolerances, and tolerances do pay that. From
# there no step leads to the mass: each needs a frequency that goes home at the same time. So the sizes of the effect are looked
# at one by one with every tolerance at home, from a small part of what is plausible to several times that, and the fit begins at
# the one that comes nearest.


OCTAVES = np.arange(-6.0, 4.0, 0.5)
"""Powers of two of what is plausible, at which a size is looked at."""

ROUGH = 0.2
"""Model-error floor of these looks: so coarse that resonances which a tolerance still has to move do not decide."""


def can_be(added: Added) -> bool:
    """Whether there is such a way: an effect of one size that is fitted, and not of a pendulum, whose period follows a line."""
    swings = FAMILIES[added.named.family].stage == PERIOD_STAGE
    return not (added.fixed or swings or is_resonator(added.named)) and len(added.named.fitted_sizes) == 1


def restarted_from_priors(bench: FittedData, at: Candidate, added: Added) -> Candidate:
    """`at` with the effect `added` as well, tolerances from where they are declared; it never costs more than `at`."""
    effects = (*at.effects, added)
    problem = bench.problem(effects)
    (which,) = (name(added.named, size.key) for size in added.named.fitted_sizes)
    home = _home(problem, at.fit)
    begin = home | {which: _nearest(problem.sparser(SPARSE), home, which)}
    return recentred(
        bench, Candidate(effects=effects, fit=child(problem, FITTED, at.fit, begin, from_afar=True), problem=problem)
    )


def tolerances_restarted(bench: FittedData, at: Candidate) -> Candidate:
    """`at`, tolerances from where they are declared; it never costs more.

    A tolerance that paid for an effect may stay behind in a valley of its own when that is found: a mode that takes part with the
    wrong sign comes home by no small step.
    """
    return recentred(bench, replace(at, fit=child(at.problem, FITTED, at.fit, _home(at.problem, at.fit), from_afar=True)))


def _home(problem: Problem, fit: Fit) -> dict[str, float]:
    """Offsets of tolerances that are declared, and of the effects of `fit` that were found."""
    found = {one.name: fit.by_name[one.name] for one in fit.parameters if one.kind == EFFECT}
    return {one.name: one.start for one in problem.parameters} | found


def _nearest(problem: Problem, home: Offsets, which: str) -> float:
    """The size of the effect `which` that comes nearest to the data, everything else at `home`."""
    cost = cost_of(problem, [problem.by_name[which]], ROUGH, home)
    return min(map(float, sizes(problem.by_name[which])), key=lambda size: _cost(cost, size))


def _cost(cost: Cost, size: float) -> float:
    try:
        return cost.total(np.array([size]))[0].cost
    except BREAKDOWNS:
        return inf


def sizes(of: Parameter) -> Array:
    """Offsets of `of` at which an effect is looked at, (n,), none outside its bounds."""
    steps = of.tolerance * np.exp2(OCTAVES)
    both = np.concatenate([-steps[::-1], steps])
    return both[(both > of.low) & (both < of.high)]


# What a search did: the fits of one step, and which of them was taken.


@dataclass(frozen=True, eq=False, kw_only=True)
class CandidateFit:
    """A candidate and its fit.

    Attributes
    ----------
    id : of the effect
    hypothesis : with it
    evidence : [nats] against the hypothesis without it
    standing : of the fit
    """

    id: str
    hypothesis: Candidate
    evidence: float
    standing: GoodnessOfFit

    @property
    def added(self) -> Added:
        """The effect, at the size that the fit found."""
        return self.hypothesis.effects[-1]

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
    standing : there
    screened : all candidates, the most promising first
    tried : those that were fitted, the most evidence first
    added : id of what was accepted; empty for nothing
    gone : ids of resonators that a fit drove out of the band of the data
    again : id of an effect that was accepted before and asked once more; `added` is it, or stands in its place. Else empty
    """

    at: Candidate
    standing: GoodnessOfFit
    screened: tuple[Screened, ...]
    tried: tuple[CandidateFit, ...]
    added: str
    gone: tuple[str, ...] = ()
    again: str = ""


def judged(at: Candidate, there: Candidate) -> CandidateFit:
    """The fit `there` with one effect more than `at`."""
    evidence = there.fit.log_evidence - at.fit.log_evidence
    return CandidateFit(
        id=there.effects[-1].named.id, hypothesis=there, evidence=evidence, standing=goodness_of_fit(there.fit, there.problem)
    )


def ranked(tried: Sequence[CandidateFit]) -> list[CandidateFit]:
    """The best fit of each candidate, the most evidence first."""
    by_id: dict[str, CandidateFit] = {}
    for one in sorted(tried, key=lambda each: -each.evidence):
        by_id.setdefault(one.id, one)
    return list(by_id.values())


def in_band(bench: FittedData, one: CandidateFit) -> bool:
    """Whether a fit left the effect what it is: not a resonator so far from the data that it is a spring or a mass."""
    return not is_resonator(one.added.named) or reaches(bench, one.added.named)


def is_accepted(one: CandidateFit) -> bool:
    """Whether a fit may give its name: it brings what its family is asked for, and its size is more than none."""
    return one.evidence >= evidence_threshold(one.family) and is_significant(one.hypothesis)


def alike(of: SearchStep) -> tuple[CandidateFit, ...]:
    """The explanations of a round that are as good as its best, the best first."""
    if not of.tried:
        return ()
    best = of.tried[0]
    return tuple(
        one
        for one in of.tried
        if one.evidence >= best.evidence - INDISTINGUISHABLE_NATS and (one.standing.null or not best.standing.null)
    )


# Effects that were found first, asked once more when others are there.
#
# What explained a little of everything goes when what is really missing is named. And which of several names is right may show
# only beside the others: a mass at the wrong place also pays for the blade that is too soft, and the right one need not.


RIVALS, SHARE = 5, 0.25
"""Names at most that an effect is asked against, and share of the evidence that such a one must have brought."""


def backward_elimination(
    bench: FittedData, at: Candidate, rounds: Sequence[SearchStep], progress: Progress
) -> tuple[Candidate, tuple[SearchStep, ...]]:
    """`at` without the earlier effects that are not needed any more, each of the others under the name that is best beside them.

    Parameters
    ----------
    rounds : that led there

    Returns
    -------
    hypothesis : `at`, or what is better
    rounds : one of each effect that was asked; none of a single one that was found alone
    """
    known = {one.added: one for one in rounds}
    asked: list[SearchStep] = []
    for anew in (False, True):  # what changed may stand beside others than it was asked beside
        for which in _ids(at):
            if (len(at.effects) > 1 and not anew) or {*_ids(known[which].at)} != {*_ids(at)} - {which}:
                at, more = _one(bench, at, known[which], progress)
                known |= {one.added: one for one in more}
                asked += more
    return at, tuple(asked)


def _ids(of: Candidate) -> tuple[str, ...]:
    return tuple(one.named.id for one in of.effects)


def _one(bench: FittedData, at: Candidate, found: SearchStep, progress: Progress) -> tuple[Candidate, tuple[SearchStep, ...]]:
    """`at` with the effect that a round found under its best name, and how that was asked; or without it."""
    added = next(one for one in at.effects if one.named.id == found.added)
    try:
        rest = _without(bench, at, added)
    except CheckFailed:  # there is nothing to hold it against
        return at, ()
    evidence = at.fit.log_evidence - rest.fit.log_evidence
    if evidence < evidence_threshold(added.named.family):
        return rest, ()
    there = CandidateFit(
        id=found.added, hypothesis=_last(at, added), evidence=evidence, standing=goodness_of_fit(at.fit, at.problem)
    )
    rivals = _asked_again_rivals(found, at)
    progress(f"asking {found.added} and {len(rivals)} others once more", 0.95)
    others = [judged(rest, instead(bench, at, rest, _at_home(one.added, added))) for one in rivals]
    may = [one for one in others if in_band(bench, one) and (is_accepted(one) or one.evidence <= evidence)]
    tried = tuple(ranked([there, *may]))
    stands = goodness_of_fit(rest.fit, rest.problem)
    again = replace(found, at=rest, standing=stands, tried=tried, added=tried[0].id, again=found.added)
    return at if tried[0] is there else tried[0].hypothesis, (again,)


def _asked_again_rivals(found: SearchStep, at: Candidate) -> list[CandidateFit]:
    """What else a round tried that brought a good part of what its best did, and is not there by now."""
    near = [one for one in found.tried if one.id not in _ids(at) and one.evidence >= SHARE * found.tried[0].evidence]
    return near[:RIVALS]


def _at_home(one: Added, found: Added) -> Added:
    """A resonator at another place or under another name begins at the sizes of the one that was found; others at their own."""
    same = is_resonator(one.named) and is_resonator(found.named) and one.named.values.keys() == found.named.values.keys()
    return replace(one, named=replace(one.named, values=found.named.values)) if same else one


def _last(at: Candidate, added: Added) -> Candidate:
    """`at`, the effect `added` named last."""
    return replace(at, effects=(*(one for one in at.effects if one is not added), added))


def _without(bench: FittedData, at: Candidate, added: Added) -> Candidate:
    """The fit of the other effects alone, from where it is with all."""
    left = tuple(one for one in at.effects if one.named.id != added.named.id)
    problem = bench.problem(left)
    return recentred(bench, Candidate(effects=left, fit=nearby(problem, FITTED, at.fit.by_name), problem=problem))


MOST, MOST_ROUNDS = 3, 6
"""Effects that are looked for, and steps forward in which they are; some go again."""

TRIED, OF_A_FAMILY, STRUCTURAL = 6, 3, 2
"""Fits of a round at most; of one family; and of the structure at least, where any promises something."""

PROMISING = 4.0
"""[nats] that a straight line must promise for a fit."""

SHORT = 1.0
"""[nats] that it may promise less than is asked for where nothing need be missing: there a straight line is right."""

BEHIND, ERRS = 12.0, 0.15
"""[nats] behind the promise of the best, and share of it that a line may err, at which another is not worth a fit, once that
best is all that is needed."""

BENT, FINISHED = 1.5, 3
"""Chi² per degree of freedom from which a straight line says little of the sizes, and fits come from afar; and how many of these
rough fits are finished."""

AGAIN = 1
"""Times that a fit is taken up again where one with a useless effect ended lower."""

INSTEAD = 2
"""Fits at most in place of those of resonators that a fit has driven out of the band, where they are springs or masses."""

KEPT, AFRESH = 0.5, 3
"""Share of a promise that a fit must keep lest it be tried afresh, where no fit comes up to that promise; and how many are."""

LEAST = 0.25
"""Share of what is too much of cost that an effect must explain for others to be looked for beside it."""

ALIASES, FAR = 3, 0.3
"""Rivals that are fitted though no line promised them, and the greatest share of what the best does that may be its own."""

Progress = Callable[[str, float], None]


def searched(
    bench: FittedData, base: Candidate, menu: Sequence[Added], progress: Progress
) -> tuple[Candidate, tuple[SearchStep, ...]]:
    """The hypothesis that explains the data of `bench` with the fewest effects of `menu`, and how it was found."""
    at, again = base, AGAIN
    rounds: list[SearchStep] = []
    while len(at.effects) < MOST and sum(not one.again for one in rounds) < MOST_ROUNDS:
        one = _round(bench, at, menu, progress)
        if (
            again
            and one.tried
            and not one.added
            and one.tried[0].evidence > INDISTINGUISHABLE_NATS
            and not is_significant(one.tried[0].hypothesis)
        ):
            at, again = refitted(bench, at, one.tried[0].hypothesis.fit), again - 1  # none of it, but a better way down
            continue
        rounds.append(one)
        if not one.added:
            break
        found = _at_rest(bench, one.tried[0].hypothesis)
        explained, null = one.at.fit.cost - found.fit.cost, goodness_of_fit(found.fit, found.problem).null
        at, asked = backward_elimination(bench, found, rounds, progress)
        rounds += asked
        if not null and explained < LEAST * excess(one.at.fit, one.standing):
            break  # nothing known is most of what is wrong: the rest would be named one by one, and none of it is there
    return at, tuple(rounds)


def _round(bench: FittedData, at: Candidate, menu: Sequence[Added], progress: Progress) -> SearchStep:
    progress(f"screening {len(menu)} effects", 0.0)
    here, found = goodness_of_fit(at.fit, at.problem), screen(bench, at, menu)
    tried, gone = _within(
        bench, found, lambda some: (_from_afar if here.misfit > BENT else _nearby)(bench, at, here, some, progress)
    )
    tried = _unstuck(bench, at, here, tried, found, progress)
    good = bool(tried) and is_accepted(tried[0])
    asked: set[str] = set()
    while good and tried[0].id not in asked:  # a rival that is better has rivals of its own
        rivals = [*_rivals(tried, menu, found), *(_elsewhere(tried) if asked else [])]
        asked.add(tried[0].id)
        progress(f"telling {tried[0].id} from {len(rivals)} others", 0.9)
        fitted = [_as_a_rival(bench, at, one, tried[0]) for one in rivals]
        may = [one for one in fitted if in_band(bench, one) and (is_accepted(one) or one.evidence <= tried[0].evidence)]
        tried = ranked([*tried, *may])
    return SearchStep(at=at, standing=here, screened=found, tried=tuple(tried), added=tried[0].id if good else "", gone=gone)


def _nearby(
    bench: FittedData, at: Candidate, here: GoodnessOfFit, found: Sequence[Screened], progress: Progress
) -> list[CandidateFit]:
    """Fits of the best, until one is all that is needed."""
    tried: list[CandidateFit] = []
    for one in _promising(found):
        if _settled(tried, one, found):
            break
        if here.null and one.evidence < evidence_threshold(one.added.named.family) - SHORT:
            continue
        progress(f"trying {one.id}", len(tried) / TRIED)
        tried.append(_tried(bench, at, one.added))
    return tried


def _from_afar(
    bench: FittedData, at: Candidate, here: GoodnessOfFit, found: Sequence[Screened], progress: Progress
) -> list[CandidateFit]:
    """Rough fits of all that promise something, and of the best of these good ones."""
    rough, promising = [], _promising(found)
    for done, one in enumerate(promising):
        progress(f"trying {one.id} from afar", done / (len(promising) + FINISHED))
        rough.append((one.added, roughly(bench, at, one.added)))
    rough.sort(key=lambda each: -each[1].log_evidence)
    return [_tried(bench, at, added, begin) for added, begin in rough[:FINISHED]]


def _within(
    bench: FittedData, found: Sequence[Screened], fits: Callable[[Sequence[Screened]], list[CandidateFit]]
) -> tuple[list[CandidateFit], tuple[str, ...]]:
    """`fits` of the best, and of others in place of resonators that leave the band; and the ids of these resonators."""
    tried = fits(found)
    inside = [one for one in tried if in_band(bench, one)]
    if len(inside) == len(tried):
        return inside, ()
    known = {one.id for one in tried}
    others = [one for one in found if one.id not in known and not is_resonator(one.added.named)]
    gone = tuple(one.id for one in tried if one not in inside)
    return [*inside, *fits(_promising(others)[:INSTEAD])], gone


def _unstuck(
    bench: FittedData,
    at: Candidate,
    here: GoodnessOfFit,
    tried: Sequence[CandidateFit],
    found: Sequence[Screened],
    progress: Progress,
) -> list[CandidateFit]:
    """The fits, the best first; those afresh that fell far short of a promise that none kept, where something must be missing.

    Only what was fitted to the end is asked again: of fits from afar the `FINISHED` best.
    """
    ranked, promised = sorted(tried, key=lambda each: -each.evidence), {one.id: one.evidence for one in found}
    if here.null or not ranked or ranked[0].standing.null:
        return ranked
    short = [one for one in ranked if promised[one.id] > max(ranked[0].evidence, one.evidence / KEPT) and can_be(one.added)]
    for one in sorted(short, key=lambda each: -promised[each.id])[:AFRESH]:
        progress(f"trying {one.id} afresh", 0.8)
        other = judged(at, restarted_from_priors(bench, at, one.added))
        ranked[ranked.index(one)] = max(one, other, key=lambda each: each.evidence)
    return sorted(ranked, key=lambda each: -each.evidence)


def _promising(found: Sequence[Screened]) -> list[Screened]:
    """The best, not too many of one family, some of the structure."""
    from validation.effects.catalogue import FAMILIES
    from validation.effects.effect import STRUCTURE

    count: Counter[str] = Counter()
    chosen: list[Screened] = []
    for one in found:
        family = one.added.named.family
        if one.evidence >= PROMISING and count[family] < OF_A_FAMILY:
            count[family] += 1
            chosen.append(one)
    best, rest = chosen[:TRIED], chosen[TRIED:]
    structural = sum(FAMILIES[one.added.named.family].side == STRUCTURE for one in best)
    more = [one for one in rest if FAMILIES[one.added.named.family].side == STRUCTURE][: max(STRUCTURAL - structural, 0)]
    return [*best, *more]


def _rivals(tried: Sequence[CandidateFit], menu: Sequence[Added], found: Sequence[Screened]) -> list[Added]:
    """Candidates that were not fitted and may be what the best of those that were is.

    Those that can do nearly all that it does to the data; of a resonator its twin and its like at the most promising places.
    """
    best, known = tried[0], {one.id for one in tried}
    others = [one for one in menu if one.named.id not in known]
    by_id = {one.id: one.added for one in found}
    if is_resonator(best.added.named):
        twins = [one for one in others if _are_twins(one.named, best.added.named)]
        elsewhere = [one.added for one in found if one.id not in known and one.added.named.family == best.family]
        return [_at_sizes(one, best.added) for one in (*twins, *elsewhere[:ALIASES])]
    if best.added.fixed:
        return []
    near = aliases(
        best.hypothesis,
        best.added,
        [one for one in others if not is_resonator(one.named)],
        limit=min(INDISTINGUISHABLE_NATS / best.evidence, FAR),
    )
    return [by_id[id] for id in near if id in by_id][:ALIASES]


def _elsewhere(tried: Sequence[CandidateFit]) -> list[Added]:
    """Resonators of the family of the best that were fitted at other places, at its sizes: theirs came from a worse one."""
    best = tried[0]
    same = [one for one in tried[1:] if is_resonator(one.added.named) and one.family == best.family]
    return [_at_sizes(one.added, best.added) for one in same]


def _as_a_rival(bench: FittedData, at: Candidate, added: Added, best: CandidateFit) -> CandidateFit:
    """The fit of what can do nearly all that the `best` does; afresh where it does not from where tolerances have paid."""
    found = _tried(bench, at, added)
    if found.evidence >= KEPT * best.evidence or not can_be(added):
        return found
    return max(found, judged(at, restarted_from_priors(bench, at, added)), key=lambda each: each.evidence)


def _are_twins(one: Named, other: Named) -> bool:
    """Whether both are resonators in one place, which may be one oscillator under two names."""
    return is_resonator(one) and is_resonator(other) and one.targets == other.targets


def _at_sizes(one: Added, other: Added) -> Added:
    return replace(one, named=replace(one.named, values=other.named.values))


def _settled(tried: Sequence[CandidateFit], one: Screened, found: Sequence[Screened]) -> bool:
    """Whether the best of the fits is all that is needed, and `one` promised less than that did by more than a line may err."""
    best = max(tried, key=lambda each: each.evidence, default=None)
    if best is None or not best.standing.null:
        return False
    promised = next(each.evidence for each in found if each.id == best.id)
    return one.evidence < (1 - ERRS) * promised - BEHIND


def _tried(bench: FittedData, at: Candidate, added: Added, begin: Fit | None = None) -> CandidateFit:
    return judged(at, refitting_refitted(bench, at, added, begin=begin))


def _at_rest(bench: FittedData, at: Candidate) -> Candidate:
    """`at`; where a tolerance stands absurdly far off, with all of them once more from where they are declared."""
    if goodness_of_fit(at.fit, at.problem).largest < ABSURD:
        return at
    home = judged(at, tolerances_restarted(bench, at))
    return home.hypothesis if home.evidence > 0 and in_band(bench, home) else at
