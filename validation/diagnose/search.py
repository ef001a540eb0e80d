"""Stepwise selection of effects by their evidence: screen all candidates, fit the best few, accept the best, and again.

Screening is a score test, linear in the size; fits decide. A fit starts from one of three places: where the tolerances stand;
over a coarse model-error floor, where the model is too nonlinear for the score test (`_rough_fits`); and from the priors, where
tolerances have absorbed an effect and no fit reaches what the score test promised (`restarted_from_priors`). After each
accepted effect the earlier ones are tested again beside it (`backward_elimination`): one that explained a little of everything
goes when what is really missing is there, and a name may be right only beside the others.
"""

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from math import inf
from types import MappingProxyType

import numpy as np

from geometry.errors import CheckFailed
from validation.diagnose.candidate_fits import (
    ABSURD,
    SAME_NATS,
    UNLIKELY,
    CandidateFit,
    GoodnessOfFit,
    beginning,
    can_restart,
    candidate_fit,
    declared,
    fit_in_place,
    fit_with,
    goodness_of_fit,
    in_band,
    is_accepted,
    is_significant,
    over,
    ranked,
    recentred,
    restarted_from_priors,
)
from validation.diagnose.candidates import SIZE_OCTAVES, TINY_AT, aliases, is_resonator, screen, screened_resonators
from validation.diagnose.diagnosis import Candidate, FoundNode, Screened
from validation.diagnose.landmark_search import DistantView, FromAfar
from validation.diagnose.reduction_errors import swinging_with
from validation.effects.catalogue import FAMILIES
from validation.effects.effect import INDISTINGUISHABLE_NATS, STRUCTURE, evidence_threshold, position
from validation.estimation.fit import BREAKDOWNS, COARSE, FLOOR, ROUGHLY, STRIDE, child, nearby
from validation.estimation.likelihood import cost_of
from validation.estimation.problem import FITTED, Fit, Offsets, Problem
from validation.estimation.verdicts import MISFIT
from validation.model.model import Added
from validation.output import nats, odds
from validation.prediction.effects import name
from validation.prediction.landmarks import Landmark
from validation.study import Study

FROM_AFAR = 0.25
"""[share] of the plausible, or of what a straight line says, at which a search from afar begins. Held by test_search.py."""


def step_from_afar(data: Study, at: Candidate, menu: Sequence[Added], progress: "Progress") -> "SearchStep":
    """The step from `at`, which did not converge, to the effect that comes nearest to the data and converges: of the structure,
    or of sensors and methods of which no tolerance is in the fit.

    What drove tolerances so far that no fit ends is seen from where they are declared: by landmarks where these alone are far
    off, else over a floor of `COARSE` on few lines, where each effect begins at a part of what is plausible.
    """
    asked = [one for one in menu if seen_from_afar(one)]
    others = [one for one in menu if can_restart(one) and not seen_from_afar(one) and one.named.id not in at.fit.by_name]
    progress("looking from afar for what keeps the model from converging", 0.0)
    view = DistantView(marks=() if data.made else Landmark.of_tests(data.predictions))
    far = bool(view.marks) and view.far
    by_lines = _nearest_by_lines(data, at, others if far else [*asked, *others], progress)[:FEW]
    nearest: list[tuple[float, Added, dict[str, float]]] = [(fit.cost, added, fit.by_name) for added, fit in by_lines]
    by_landmarks = view.nearest(asked, FITS_OF_A_STEP)[:FEW] if far else ()
    nearest += [(0.5 * one.chi2, one.effects[0], {}) for one in by_landmarks]
    tried, least = list[CandidateFit](), inf
    for cost, added, begin in nearest:
        if any(one.goodness.null for one in tried) and cost > least + INDISTINGUISHABLE_NATS:
            continue
        least = cost
        progress(f"trying {added.named.id} from afar", 0.9)
        effects, ready = (*at.effects, added), data
        with suppress(CheckFailed):  # where part of it swings freely it is asked on the coordinates that there are
            ready = data.over(partial(swinging_with, effects=effects))
        problem = ready.problem(effects)
        whole = child(problem, FITTED, at.fit, declared(problem, at.fit) | begin, from_afar=True)
        if whole.converged:
            tried.append(candidate_fit(at, recentred(ready, Candidate(effects=effects, fit=whole, problem=problem))))
    tried, here = ranked(tried), goodness_of_fit(at.fit, at.problem)
    best = tried[0].id if tried and is_accepted(tried[0]) else ""
    screened = screen(data, at, menu) if best else ()  # from where no fit ended any parameter would look decisive
    return SearchStep(at=at, goodness=here, screened=screened, tried=tuple(tried), added=best)


def seen_from_afar(added: Added) -> bool:
    """Whether it is an effect of the structure that has one size."""
    return FAMILIES[added.named.family].side == STRUCTURE and can_restart(added)


def _nearest_by_lines(data: Study, at: Candidate, asked: Sequence[Added], progress: "Progress") -> list[tuple[Added, Fit]]:
    """Those `asked` and their rough fits, the best first, from where tolerances are declared and a part of what is plausible."""
    if not asked:
        return []

    def begins(added: Added, problem: Problem) -> list[Offsets]:
        (which,) = (name(added.named, size.key) for size in added.named.fitted_sizes)
        size = problem.by_name[which]
        return [{which: x} for x in (FROM_AFAR * size.tolerance, -FROM_AFAR * size.tolerance) if size.low < x < size.high]

    rough = partial(child, floor=COARSE[1], close=ROUGHLY)
    without = rough(at.problem.sparser(STRIDE), FITTED, at.fit, declared(at.problem, at.fit))
    return _along_few_lines(data, replace(at, fit=without), asked, begins, rough, progress)


Begins = Callable[[Added, Problem], Sequence[Offsets]]  # of the fits of an effect, the newest of a problem


def _along_few_lines(
    data: Study, at: Candidate, asked: Sequence[Added], begins: Begins, rough: Callable[..., Fit], progress: "Progress"
) -> list[tuple[Added, Fit]]:
    """Every effect beside `at` with its `rough` fit along few lines from the better of where it begins, the best effect first."""
    found = list[tuple[Added, Fit]]()
    for done, added in enumerate(asked):
        progress(f"trying {added.named.id} along few lines", done / len(asked))
        problem = data.problem((*at.effects, added)).sparser(STRIDE)
        rivals = [fit.cost for k, (_, fit) in enumerate(found) if fit.sound or k == FEW - 1]
        enough = min(rivals, default=inf) + SCREENING_MARGIN
        fits = [rough(problem, FITTED, at.fit, begin, worth=enough) for begin in begins(added, problem)]
        found += [(added, fit) for fit in sorted(fits, key=lambda fit: fit.cost)[:1]]
        found.sort(key=lambda one: -one[1].log_evidence)
    return found


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

    @property
    def indistinguishable(self) -> tuple[CandidateFit, ...]:
        """The fits whose evidence cannot be told from that of the best, the best first."""
        best = self.tried[0] if self.tried else None
        return tuple(
            one
            for one in self.tried
            if best is not None
            and one.evidence >= best.evidence - INDISTINGUISHABLE_NATS
            and (one.goodness.null or not best.goodness.null)
        )

    @property
    def evidence(self) -> float:
        """[nats] of what was added, against a fit without it that goes to its end where it was given up on the way."""
        rest, brought = self.at, self.tried[0].evidence
        with suppress(CheckFailed):
            if not rest.fit.converged:
                whole = nearby(rest.problem, FITTED, rest.fit.by_name)
                brought -= max(whole.log_evidence - rest.fit.log_evidence, 0.0)
        return brought

    def same_as(self, id: str) -> tuple[str, ...]:
        """Ids that explain these data to the last digit as `id` does, which is then one name for all of them."""
        mine = next((one for one in self.tried if one.id == id), None)
        near = () if mine is None else [one for one in self.tried if abs(one.evidence - mine.evidence) < SAME_NATS]
        return tuple(one.id for one in near if one.id != id)

    @property
    def text(self) -> str:
        """Why something was accepted, or nothing."""
        if not self.tried:
            if self.left_band:
                gone = ", ".join(self.left_band)
                return f"a fit drives {gone} out of the band of the data, and no other kind of effect is worth a fit"
            if not self.screened:
                return "there is no candidate" if self.at.fit.converged else "no candidate makes the fit converge"
            best = self.screened[0]
            promised, asked = max(best.evidence, 0.0), evidence_threshold(best.added.named.family)
            return f"no candidate is worth a fit: {best.id} promises most, {nats(promised)} nats, where {asked:g} are asked for"
        first = self.tried[0]
        if self.reconsidered:
            beside = f"beside {' and '.join(_ids(self.at))}" if self.at.effects else "alone"
            worse = next(each.evidence for each in self.tried if each.id == self.reconsidered)
            return f"{self.added} brings {nats(first.evidence)} nats {beside}, and {self.reconsidered} only {nats(worse)}"
        which = self.added or f"the best, {first.id},"
        brings = f"{which} brings {nats(first.evidence)} nats, odds of {odds(first.evidence)}"
        return f"{brings}, where {evidence_threshold(first.family):g} are asked for"


def worth(at: Candidate, tried: Sequence[CandidateFit]) -> float:
    """Cost below which one more fit of an effect beside `at` would matter beside those that were `tried`.

    What a fit takes off the cost is more than its evidence. One that cannot be within `SCREENING_MARGIN` of a best that is all
    that is needed, or bring `GOOD_PART` of another one, is neither the best nor a rival of it.
    """
    best = max(tried, key=lambda one: one.evidence, default=None)
    if best is None:
        return inf
    return at.fit.cost - (best.evidence - SCREENING_MARGIN if best.goodness.null else GOOD_PART * best.evidence)


Elsewhere = Callable[[Study, Candidate, Candidate], tuple[tuple[Study, Added, float], ...]]
"""As `validation.diagnose.everywhere.elsewhere`: where on a mesh an effect may explain most beside the others."""

MOVES = 4
"""[count] of moves of an effect on a mesh before rivals are asked, and of fits at a node alone. Held by test_everywhere.py."""


def backward_elimination(
    data: Study,
    at: Candidate,
    rounds: Sequence[SearchStep],
    progress: "Progress",
    elsewhere: Elsewhere | None = None,
    *,
    by_name: bool = True,
) -> tuple[Study, Candidate, tuple[SearchStep, ...]]:
    """`at` without the effects that are not needed beside the others, each of these under the name and at the place that is best
    there.

    Parameters
    ----------
    rounds : that led there
    by_name : whether other names are asked, not places alone

    Returns
    -------
    data : with the places that have no name
    candidate : `at`, or what is better
    rounds : one of each effect that was asked; none of a single one that was found alone and stays where it is
    """
    known = {one.added: one for one in rounds}
    asked: list[SearchStep] = []
    for anew in (False, True):  # what changed may stand beside others than it was asked beside
        for which in _ids(at):
            found = known[which]
            stays = {*_ids(found.at)} == {*_ids(at)} - {which}
            alone = stays and len(at.effects) < 2
            if stays and (anew or (alone and elsewhere is None)):
                continue
            added = next(one for one in at.effects if one.named.id == which)
            left = tuple(one for one in at.effects if one is not added)
            problem = data.problem(left)
            asks = evidence_threshold(added.named.family)
            try:
                enough = at.fit.cost + asks + SCREENING_MARGIN
                fit = found.at.fit if alone else nearby(problem, FITTED, at.fit.by_name, worth=enough)
            except CheckFailed:  # there is nothing to hold it against
                continue
            rest = recentred(data, Candidate(effects=left, fit=fit, problem=problem))
            evidence = at.fit.log_evidence - rest.fit.log_evidence
            if evidence < asks:
                at = rest
                continue
            last = replace(at, effects=(*left, added))
            looked = next((one.looked for one in found.tried if one.id == which), 0.0)
            there = replace(candidate_fit(rest, last), looked=looked)
            others = found.tried if by_name and not alone else ()
            near = [one for one in others if one.id not in _ids(at) and one.evidence >= GOOD_PART * found.tried[0].evidence]
            progress(f"asking {which} and {len(near[:FITS_OF_A_STEP])} others once more", 0.95)
            study, moved = _moved(data, rest, there, elsewhere)
            tried = [there, *(() if moved is there else (moved,))]
            for one in near[:FITS_OF_A_STEP]:
                again = _at_sizes(one.added, added)
                rival = candidate_fit(rest, fit_in_place(data, at, rest, again, worth=worth(rest, tried)))
                if in_band(data, rival) and (is_accepted(rival) or rival.evidence <= evidence):
                    tried.append(rival)
            tried = ranked(tried)
            best = tried[0]
            if alone and best is there:
                continue
            if alone:  # the others were fitted beside the same
                tried = [best, *(one for one in ranked([*found.tried, *tried]) if one.id != best.id)]
            stands = goodness_of_fit(rest.fit, rest.problem)
            led = replace(found, at=rest, goodness=stands, tried=tuple(tried), added=best.id, reconsidered=which)
            at = at if best is there else best.candidate
            data = study if best is moved else data
            known[led.added] = led
            asked.append(led)
    return data, at, tuple(asked)


def _moved(data: Study, rest: Candidate, there: CandidateFit, elsewhere: Elsewhere | None) -> tuple[Study, CandidateFit]:
    """`there`, whose newest effect stands beside `rest`, at the place on a mesh that is best, and the study with that."""
    end = there
    for _ in range(MOVES):
        found = elsewhere(data, rest, end.candidate) if elsewhere else ()
        if not found:
            break
        ready = found[0][0]  # all are held against each other over the same coordinates
        try:
            rest, here = (over(ready, data, one) for one in (rest, end.candidate))
        except CheckFailed:  # over more coordinates the model breaks down wherever it begins
            break
        brought = candidate_fit(rest, here).evidence
        fits = list[tuple[CandidateFit, float]]()
        for _, added, cost in found:
            enough = rest.fit.cost - brought - cost
            ways = [fit_in_place(ready, here, rest, added, worth=enough)]
            if end.goodness.largest >= ABSURD:  # from where tolerances pay for a wrong place no step may lead to the right one
                ways.append(restarted_from_priors(ready, rest, added, worth=enough))
            fits += [(candidate_fit(rest, each), cost) for each in ways]
        ends = [(one.evidence - cost - brought, one) for one, cost in fits if is_accepted(one)]
        gained, best = max(ends, key=lambda one: one[0], default=(0.0, end))
        if gained <= SAME_NATS:
            break
        data, end = ready, replace(best, evidence=end.evidence + gained, looked=end.looked)
    return data, end


def _ids(of: Candidate) -> tuple[str, ...]:
    return tuple(one.named.id for one in of.effects)


MOST_EFFECTS = 3
"""[count] of effects that are looked for. Set by the development draws of `make blind`."""

FITS_OF_A_STEP = 6
"""[count] of candidates fitted, or nodes asked further, at most. Held by test_search.py."""

FEW = 3
"""[count] of these of one kind at most: of a family, rough ones that are finished, from the priors, of rivals that no straight
line promised, kinds at a place without a name and names held against it. Held by test_search.py."""

OTHERS = 2
"""[count] of these that are kept for another kind of effect. Held by test_search.py."""

GOOD_PART = 0.25
"""[share] of what the best brought that a rival of it must have brought, and of what it does that may be its own beside an alias.
Held by test_search.py."""

KNOWN_PART = 0.2
"""[share] of the excess cost that what is built upon must explain: one of a pair explained 0.21. Held by test_search.py."""

WORTH_A_FIT = 4.0
"""[nats] that a straight line must promise for a fit. Held by test_search.py."""

NULL_MARGIN = 1.0
"""[nats] that it may promise less than is asked for where nothing need be missing: there a straight line is right. Held by
test_search.py."""

SCREENING_MARGIN = 12.0
"""[nats] behind the promise of the best at which another is not fitted, once that best is all that is needed. Set by the
development draws of `make blind`."""

SCREENING_ERROR = 0.15
"""[share] of a promise by which a straight line may err. Set by the development draws of `make blind`."""

KEPT_SHARE = 0.5
"""[share] of a promise that a fit must keep lest it restart from the priors, where no fit comes up to that promise. Held by
test_search.py."""

SETTINGS: Mapping[str, object] = MappingProxyType(
    {
        "unlikely": UNLIKELY,
        "absurd_z": ABSURD,
        "promising_nats": WORTH_A_FIT,
        "short_nats": NULL_MARGIN,
        "tried_at_most": FITS_OF_A_STEP,
        "effects_at_most": MOST_EFFECTS,
        "tried_of_a_kind_at_most": FEW,
        "tried_otherwise": OTHERS,
        "bent_chi2_per_dof": MISFIT,
        "good_part": GOOD_PART,
        "kept_share_of_promise": KEPT_SHARE,
        "afresh_octaves": [float(SIZE_OCTAVES[0]), float(SIZE_OCTAVES[-1])],
    }
)
"""What is fitted, and when a search ends, by the keys of a diagnosis in JSON."""

Progress = Callable[[str, float], None]


def stepwise_search(
    data: Study,
    base: Candidate,
    menu: Sequence[Added],
    progress: Progress,
    elsewhere: Elsewhere | None = None,
    fitted: Sequence[FoundNode] = (),
    begun: SearchStep | None = None,
) -> tuple[Study, Candidate, tuple[SearchStep, ...]]:
    """The candidate that explains the data of `data` with the fewest effects of `menu`, and how it was found.

    An effect on a mesh may move to a place that has no name, which the study then has.

    Parameters
    ----------
    fitted : those of `menu` that were fitted beside `base` already: what they brought is no promise any more
    begun : the first step, where no straight line leads to it
    """
    at, again = base if begun is None else begun.tried[0].candidate, True
    rounds = [] if begun is None else [begun]
    while len(at.effects) < MOST_EFFECTS and sum(not one.reconsidered for one in rounds) < 2 * MOST_EFFECTS:
        afar, known = at is base and not base.fit.converged, fitted if at is base else ()
        one = step_from_afar(data, at, menu, progress) if afar else None
        if one is None or (known and not one.added):  # a node that was fitted may make it converge
            one = _step(data, at, menu, progress, known)
        if (
            again
            and one.tried
            and not one.added
            and one.tried[0].evidence > INDISTINGUISHABLE_NATS
            and not is_significant(one.tried[0].candidate)
        ):  # none of it, but a better way down
            lower = nearby(at.problem, FITTED, one.tried[0].candidate.fit.by_name)
            at, again = at if lower.cost >= at.fit.cost else recentred(data, replace(at, fit=lower)), False
            continue
        rounds.append(one)
        if not one.added:
            break
        found, ends = one.tried[0].candidate, []
        few = one.tried[:FEW] if elsewhere and (at.effects or not one.tried[0].goodness.null) else ()
        for each in filter(is_accepted, few):  # of the best few that which is best once all stand at their places
            led = [*rounds[:-1], replace(one, tried=(each, *(other for other in one.tried if other is not each)), added=each.id)]
            with suppress(CheckFailed):  # at the place of one the model may break down
                ready, end = reduced_anew(data, each.candidate)
                ready, end, asked = backward_elimination(ready, end, led, progress, elsewhere, by_name=False)
                ends.append((end.fit.log_evidence - over(ready, data, at).fit.log_evidence, led, ready, end, asked))
        if ends:
            _, led, data, found, asked = max(ends, key=lambda one: one[0])
            rounds = [*led, *asked]
        else:
            data, found = reduced_anew(data, found)
        if goodness_of_fit(found.fit, found.problem).largest >= ABSURD:
            home = candidate_fit(found, restarted_from_priors(data, found))
            found = home.candidate if home.evidence > 0 and in_band(data, home) else found
        explained, null = one.at.fit.cost - found.fit.cost, goodness_of_fit(found.fit, found.problem).null
        data, at, asked = backward_elimination(data, found, rounds, progress, elsewhere)
        rounds += asked
        if not null and explained < KNOWN_PART * one.goodness.excess(one.at.fit):
            break  # nothing known is most of what is wrong: the rest would be named one by one, and none of it is there
    return *_finished(data, at), tuple(rounds)


TOLD = 0.5
"""[nats] of all data by which what the coordinates of a structure say is told from what the whole structure does: one standard
deviation. By definition."""


def reduction_error(data: Study, at: Candidate) -> tuple[Study, float]:
    """`data` over coordinates that hold how the whole structures swing with the effects of `at`, and how much worse or better
    they explain the data [nats] than those that there are say: 0 where those stay.

    Raises
    ------
    CheckFailed : as `swinging_with`.
    """
    ready = data.over(partial(swinging_with, effects=at.effects))
    if (*ready.made, *ready.tests) == (*data.made, *data.tests):
        return data, 0.0
    costs = (cost_of(one.problem(at.effects), at.fit.parameters, FLOOR, at.fit.by_name) for one in (data, ready))
    try:
        before, after = (one.misfit(one.at(at.fit.by_name)) for one in costs)
    except BREAKDOWNS:  # where tolerances stand the structure has no stiffness left along what is new
        return ready, inf
    return ready, abs(after - before)


def reduced_anew(data: Study, at: Candidate) -> tuple[Study, Candidate]:
    """`at`, fitted on over coordinates of its own where data tell what those that there are err by, and the study with these."""
    with suppress(CheckFailed):  # where part of it swings freely, or the model breaks down there: what is left of it is said
        for _ in range(MOVES):
            ready, error = reduction_error(data, at)
            if error < TOLD:
                break
            data, at = ready, over(ready, data, at)
    return data, at


def left_of_reduction(data: Study, at: Candidate) -> list[str]:
    """A sentence where data tell what the coordinates of `at` err by, or nobody knows it."""
    try:
        error = reduction_error(data, at)[1]
    except CheckFailed as failed:
        return [f"how far the reduced structure is off with {' and '.join(_ids(at))} is not known: {failed}"]
    said = f"the structure as it was reduced is {nats(error)} nats off what the whole one does with {' and '.join(_ids(at))}"
    return [f"{said}: sizes are not the last word"] if error >= TOLD else []


def _finished(data: Study, at: Candidate) -> tuple[Study, Candidate]:
    """`at` fitted to its end, since it may be a trial, over the coordinates of the places that it has, and its study."""
    places = [one.named.target for one in at.effects if one.named.targets and position(one.named.target) is not None]
    with suppress(CheckFailed):  # over other coordinates a model may break down where it stands: then it stays as it is
        if {*places} - {*data.model.looked_at}:
            ready = data.ready_at(places)
            at, data = over(ready, data, at), ready
        if at.effects:
            whole = nearby(at.problem, FITTED, at.fit.by_name)
            at = recentred(data, replace(at, fit=whole)) if whole.cost <= at.fit.cost + SAME_NATS else at
    return reduced_anew(data, at)


def placed_from_afar(
    data: Study, afar: FromAfar, menu: Sequence[Added], progress: Progress, elsewhere: Elsewhere
) -> tuple[Study, Candidate, tuple[SearchStep, ...]] | None:
    """What was found from afar, beside each other at the nodes of a mesh and under the names that are best; None unless nothing
    more need be missing then, or if nothing was without.

    From afar only places that have names are looked at.
    """
    problem = data.problem(afar.best.effects)
    start = Candidate(effects=afar.best.effects, fit=nearby(problem, FITTED, problem.start), problem=problem)
    if goodness_of_fit(start.fit, problem).null:
        return None
    start, rounds = recentred(data, start), list[SearchStep]()
    for one in start.effects:
        left = tuple(each for each in start.effects if each is not one)
        problem = data.problem(left)
        rest = recentred(data, Candidate(effects=left, fit=nearby(problem, FITTED, start.fit.by_name), problem=problem))
        others = [each for each in menu if each.named.id in afar.alike[one.named.id][1:]]
        ends = [replace(start, effects=(*left, one)), *(fit_in_place(data, start, rest, each) for each in others)]
        stands, tried = goodness_of_fit(rest.fit, problem), ranked([candidate_fit(rest, each) for each in ends])
        rounds.append(SearchStep(at=rest, goodness=stands, screened=(), tried=tuple(tried), added=one.named.id))
    data, at, asked = backward_elimination(data, start, rounds, progress, elsewhere)
    data, at = _finished(data, at)
    return (data, at, (*rounds, *asked)) if goodness_of_fit(at.fit, at.problem).null else None


def first_fit(data: Study, at: Candidate, menu: Sequence[Added], progress: Progress) -> list[CandidateFit]:
    """The fit beside `at` of that effect of `menu` which promises most; none where it promises nothing, or leaves the band."""
    fits = _fits_of(goodness_of_fit(at.fit, at.problem))
    return [one for one in fits(data, at, screen(data, at, menu)[:1], progress) if in_band(data, one)]


def _fits_of(here: GoodnessOfFit) -> Callable[..., list[CandidateFit]]:
    return _rough_fits if here.misfit > MISFIT else partial(_local_fits, here=here)


def _step(data: Study, at: Candidate, menu: Sequence[Added], progress: Progress, fitted: Sequence[FoundNode] = ()) -> SearchStep:
    progress(f"screening {len(menu)} effects", 0.0)
    here, known = goodness_of_fit(at.fit, at.problem), {one.named.id: one for one in fitted}
    found = list(screen(data, at, menu))
    for k, each in enumerate(found):  # what was fitted promises no less than that fit brought, at its size
        if (node := known.get(each.id)) is not None:
            brought = max(each.evidence, node.evidence + node.looked)
            found[k] = replace(each, added=replace(each.added, named=node.named), evidence=brought, begin=node.fit)
    found.sort(key=lambda each: -each.evidence)
    tried, gone = _fits_in_band(data, found, lambda some: _fits_of(here)(data, at, some, progress), here)
    tried = _restarted_where_stuck(data, at, here, tried, found, progress)
    tried = ranked([replace(one, looked=known[one.id].looked) if one.id in known else one for one in tried])
    good = bool(tried) and is_accepted(tried[0])
    asked: set[str] = set()
    while good and tried[0].id not in asked:  # a rival that is better has rivals of its own
        rivals = _rivals(tried, menu, found, again=bool(asked))
        asked.add(tried[0].id)
        progress(f"telling {tried[0].id} from {len(rivals)} others", 0.9)
        more = []
        for one in rivals:
            rival = candidate_fit(at, fit_with(data, at, one, worth=worth(at, tried)))
            if rival.evidence < KEPT_SHARE * tried[0].evidence:
                there = candidate_fit(at, fit_in_place(data, tried[0].candidate, at, one, worth=worth(at, tried)))
                rival = max(rival, there, key=lambda each: each.evidence)
            more.append(rival)
        may = [one for one in more if in_band(data, one) and (is_accepted(one) or one.evidence <= tried[0].evidence)]
        tried = ranked([*tried, *may])
    best = tried[0].id if good else ""
    return SearchStep(at=at, goodness=here, screened=tuple(found), tried=tuple(tried), added=best, left_band=gone)


def _local_fits(
    data: Study, at: Candidate, found: Sequence[Screened], progress: Progress, *, here: GoodnessOfFit
) -> list[CandidateFit]:
    """Fits of the best, until one misses nothing and the next promised less than it by more than a score test may err."""
    tried: list[CandidateFit] = []
    promised = {one.id: one.evidence for one in found}
    for one in _most_promising(found):
        best = max(tried, key=lambda each: each.evidence, default=None)
        enough = 0.0 if best is None else (1 - SCREENING_ERROR) * promised[best.id] - SCREENING_MARGIN
        if best is not None and best.goodness.null and one.evidence < enough:
            break
        if here.null and one.evidence < evidence_threshold(one.added.named.family) - NULL_MARGIN:
            continue
        progress(f"trying {one.id}", len(tried) / FITS_OF_A_STEP)
        tried.append(candidate_fit(at, fit_with(data, at, one.added, begin=one.begin, worth=worth(at, tried))))
    return tried


def _rough_fits(data: Study, at: Candidate, found: Sequence[Screened], progress: Progress) -> list[CandidateFit]:
    """Fits of all that promise something over a coarse floor on few lines, and of the best of these good ones.

    They are for effects in which the model is nonlinear. The score test overrates these, so that a rough fit starts at its size
    and at a part of that.
    """
    promising = {one.id: one for one in _most_promising(found)}

    def begins(added: Added, problem: Problem) -> list[Offsets]:
        if (fitted := promising[added.named.id].begin) is not None:
            return [fitted.by_name]
        start = beginning(data, added)
        part = {name: FROM_AFAR * x for name, x in start.items()}
        return [start, part] if start and not is_resonator(added.named) else [start]

    asked = [one.added for one in promising.values()]
    tried: list[CandidateFit] = []
    for added, begin in _along_few_lines(data, at, asked, begins, partial(child, from_afar=True), progress)[:FEW]:
        tried.append(candidate_fit(at, fit_with(data, at, added, begin=begin, worth=worth(at, tried))))
    return tried


def _fits_in_band(
    data: Study, found: Sequence[Screened], fits: Callable[[Sequence[Screened]], list[CandidateFit]], here: GoodnessOfFit
) -> tuple[list[CandidateFit], tuple[str, ...]]:
    """`fits` of the best, and of others in place of resonators that leave the band, unless another leaves nothing of what is
    missing `here`; and the ids of these resonators."""
    tried = fits(found)
    inside = [one for one in tried if in_band(data, one)]
    gone = tuple(one.id for one in tried if one not in inside)
    if not gone or (not here.null and any(one.goodness.null for one in inside)):
        return inside, gone
    known = {one.id for one in tried}
    others = [one for one in found if one.id not in known and not is_resonator(one.added.named)]
    return [*inside, *fits(_most_promising(others)[:OTHERS])], gone


def _restarted_where_stuck(
    data: Study, at: Candidate, here: GoodnessOfFit, tried: Sequence[CandidateFit], found: Sequence[Screened], progress: Progress
) -> list[CandidateFit]:
    """The fits, the best first; restarted from the priors where all fell short of a promise and something must be missing. Where
    the best leaves nothing, what promised clearly more and kept little of it is."""
    ranked, promised = sorted(tried, key=lambda each: -each.evidence), {one.id: one.evidence for one in found}
    if here.null or not ranked:
        return ranked
    left = not ranked[0].goodness.null
    least = ranked[0].evidence + (0.0 if left else INDISTINGUISHABLE_NATS)
    able = [one for one in ranked if can_restart(one.added)]
    short = [one for one in able if promised[one.id] > max(least, one.evidence / KEPT_SHARE)]
    begins = [one.added for one in sorted(short, key=lambda each: -promised[each.id])[:FEW]]
    if left and here.largest >= ABSURD:  # from there a line promises nothing of a resonator beside what tolerances have moved
        begins += _resonators_at_home(data, at, found)[:FEW]
    if left and at.effects:  # what a straight line does not promise, as what gives at a rigid joint, is seen beside what is known
        fitted = {one.id for one in ranked} | {one.named.id for one in begins}
        asked = [one.added for one in found if one.id not in fitted and seen_from_afar(one.added)]
        begins += [added for added, _ in _nearest_by_lines(data, at, asked, progress)[:FEW]]
    for added in begins:
        progress(f"trying {added.named.id} afresh", 0.8)
        ranked.append(candidate_fit(at, restarted_from_priors(data, at, added, worth=worth(at, ranked))))
    best = {one.id: one for one in sorted(ranked, key=lambda each: each.evidence) if in_band(data, one)}
    return sorted(best.values(), key=lambda each: -each.evidence)


def _resonators_at_home(data: Study, at: Candidate, found: Sequence[Screened]) -> list[Added]:
    """Those of `found` as a straight line says of them over a coarse floor where tolerances are declared, the best first."""
    home = declared(at.problem, at.fit)
    offsets = np.array([home[one.name] for one in at.fit.parameters])
    there = replace(at, fit=replace(at.fit, offsets=offsets, covariance=np.zeros_like(at.fit.covariance)))
    menu = [replace(one.added, named=replace(one.added.named, values=TINY_AT)) for one in found if is_resonator(one.added.named)]
    return [one.added for one in sorted(screened_resonators(data, there, menu, COARSE[0]), key=lambda each: -each.evidence)]


def _most_promising(found: Sequence[Screened]) -> list[Screened]:
    """The best, not too many of one family, some of the structure."""
    count: Counter[str] = Counter()
    chosen: list[Screened] = []
    for one in found:
        family = one.added.named.family
        if one.evidence >= WORTH_A_FIT and count[family] < FEW:
            count[family] += 1
            chosen.append(one)
    best, rest = chosen[:FITS_OF_A_STEP], chosen[FITS_OF_A_STEP:]
    structural = sum(FAMILIES[one.added.named.family].side == STRUCTURE for one in best)
    more = [one for one in rest if FAMILIES[one.added.named.family].side == STRUCTURE][: max(OTHERS - structural, 0)]
    return [*best, *more]


def _rivals(
    tried: Sequence[CandidateFit], menu: Sequence[Added], found: Sequence[Screened], *, again: bool = False
) -> list[Added]:
    """Candidates that were not fitted and may be aliases of the best, beside other effects, which follow no straight line, all in
    its place; of a resonator its like at the most promising places, and `again` at its sizes those that were fitted at others."""
    best, known = tried[0], {one.id for one in tried}
    others = [one for one in menu if one.named.id not in known]
    if is_resonator(best.added.named):
        # in one place one oscillator may have two names
        twins = [one for one in others if is_resonator(one.named) and one.named.targets == best.added.named.targets]
        elsewhere = [one.added for one in found if one.id not in known and one.added.named.family == best.family]
        fitted = [one.added for one in tried[1:] if again and one.family == best.family]
        return [_at_sizes(one, best.added) for one in (*twins, *elsewhere[:FEW], *fitted)]
    if best.added.fixed:
        return []
    near = aliases(
        best.candidate,
        best.added,
        [one for one in others if not is_resonator(one.named)],
        limit=min(INDISTINGUISHABLE_NATS / best.evidence, GOOD_PART),
    )
    by_id = {one.id: one.added for one in found if one.id not in known}
    beside = len(best.candidate.effects) > 1 and FAMILIES[best.family].side == STRUCTURE
    there = [one for one in by_id.values() if beside and FAMILIES[one.named.family].side == STRUCTURE]
    here = [one for one in there if one.named.targets == best.added.named.targets and not is_resonator(one.named)]
    alike = [by_id[id] for id in near if id in by_id][:FEW]
    return [*alike, *(one for one in here[:FEW] if one not in alike)]


def _at_sizes(one: Added, other: Added) -> Added:
    """A resonator at another place or under another name begins at the sizes of the `other` one; anything else at its own."""
    same = is_resonator(one.named) and is_resonator(other.named) and one.named.values.keys() == other.named.values.keys()
    return replace(one, named=replace(one.named, values=other.named.values)) if same else one
