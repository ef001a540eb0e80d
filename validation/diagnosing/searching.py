"""The search: screen all candidates, fit the best few, take the one with the most evidence, and again; then backward.

A straight line finds the way and the fit decides, from one of three beginnings: where the tolerances stand; from afar, over a
coarse floor, where the model bends so that a line misleads; and afresh, where tolerances have paid for an effect and no fit keeps
what the line promised of it. Effects that were found first are asked once more when others are there, see `asked_again`.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import replace

from validation.diagnosing.accepting import ABSURD, Standing, excess, standing
from validation.diagnosing.afresh import afresh, can_be, rested
from validation.diagnosing.asked_again import asked_again
from validation.diagnosing.bench import Bench, Hypothesis
from validation.diagnosing.classes import aliases
from validation.diagnosing.menu import is_resonator
from validation.diagnosing.refitting import polished, refitted, roughly, stands_out
from validation.diagnosing.rounds import Round, Tried, enough, judged, ranked, stays
from validation.diagnosing.screened import Screened
from validation.diagnosing.screening import screen
from validation.effects.identifiers import Named
from validation.effects.worth import ALIKE, worth
from validation.engine.evaluation import Fit
from validation.models.model import Added

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


def searched(bench: Bench, base: Hypothesis, menu: Sequence[Added], progress: Progress) -> tuple[Hypothesis, tuple[Round, ...]]:
    """The hypothesis that explains the data of `bench` with the fewest effects of `menu`, and how it was found."""
    at, again = base, AGAIN
    rounds: list[Round] = []
    while len(at.effects) < MOST and sum(not one.again for one in rounds) < MOST_ROUNDS:
        one = _round(bench, at, menu, progress)
        if again and one.tried and not one.added and one.tried[0].evidence > ALIKE and not stands_out(one.tried[0].hypothesis):
            at, again = polished(bench, at, one.tried[0].hypothesis.fit), again - 1  # none of it, but a better way down
            continue
        rounds.append(one)
        if not one.added:
            break
        found = _at_rest(bench, one.tried[0].hypothesis)
        explained, null = one.at.fit.cost - found.fit.cost, standing(found.fit, found.problem).null
        at, asked = asked_again(bench, found, rounds, progress)
        rounds += asked
        if not null and explained < LEAST * excess(one.at.fit, one.standing):
            break  # nothing known is most of what is wrong: the rest would be named one by one, and none of it is there
    return at, tuple(rounds)


def _round(bench: Bench, at: Hypothesis, menu: Sequence[Added], progress: Progress) -> Round:
    progress(f"screening {len(menu)} effects", 0.0)
    here, found = standing(at.fit, at.problem), screen(bench, at, menu)
    tried, gone = _within(
        bench, found, lambda some: (_from_afar if here.misfit > BENT else _nearby)(bench, at, here, some, progress)
    )
    tried = _unstuck(bench, at, here, tried, found, progress)
    good = bool(tried) and enough(tried[0])
    asked: set[str] = set()
    while good and tried[0].id not in asked:  # a rival that is better has rivals of its own
        rivals = [*_rivals(tried, menu, found), *(_elsewhere(tried) if asked else [])]
        asked.add(tried[0].id)
        progress(f"telling {tried[0].id} from {len(rivals)} others", 0.9)
        fitted = [_as_a_rival(bench, at, one, tried[0]) for one in rivals]
        may = [one for one in fitted if stays(bench, one) and (enough(one) or one.evidence <= tried[0].evidence)]
        tried = ranked([*tried, *may])
    return Round(at=at, standing=here, screened=found, tried=tuple(tried), added=tried[0].id if good else "", gone=gone)


def _nearby(bench: Bench, at: Hypothesis, here: Standing, found: Sequence[Screened], progress: Progress) -> list[Tried]:
    """Fits of the best, until one is all that is needed."""
    tried: list[Tried] = []
    for one in _promising(found):
        if _settled(tried, one, found):
            break
        if here.null and one.evidence < worth(one.added.named.family) - SHORT:
            continue
        progress(f"trying {one.id}", len(tried) / TRIED)
        tried.append(_tried(bench, at, one.added))
    return tried


def _from_afar(bench: Bench, at: Hypothesis, here: Standing, found: Sequence[Screened], progress: Progress) -> list[Tried]:
    """Rough fits of all that promise something, and of the best of these good ones."""
    rough, promising = [], _promising(found)
    for done, one in enumerate(promising):
        progress(f"trying {one.id} from afar", done / (len(promising) + FINISHED))
        rough.append((one.added, roughly(bench, at, one.added)))
    rough.sort(key=lambda each: -each[1].log_evidence)
    return [_tried(bench, at, added, begin) for added, begin in rough[:FINISHED]]


def _within(
    bench: Bench, found: Sequence[Screened], fits: Callable[[Sequence[Screened]], list[Tried]]
) -> tuple[list[Tried], tuple[str, ...]]:
    """`fits` of the best, and of others in place of resonators that leave the band; and the ids of these resonators."""
    tried = fits(found)
    inside = [one for one in tried if stays(bench, one)]
    if len(inside) == len(tried):
        return inside, ()
    known = {one.id for one in tried}
    others = [one for one in found if one.id not in known and not is_resonator(one.added.named)]
    gone = tuple(one.id for one in tried if one not in inside)
    return [*inside, *fits(_promising(others)[:INSTEAD])], gone


def _unstuck(
    bench: Bench, at: Hypothesis, here: Standing, tried: Sequence[Tried], found: Sequence[Screened], progress: Progress
) -> list[Tried]:
    """The fits, the best first; those afresh that fell far short of a promise that none kept, where something must be missing.

    Only what was fitted to the end is asked again: of fits from afar the `FINISHED` best.
    """
    ranked, promised = sorted(tried, key=lambda each: -each.evidence), {one.id: one.evidence for one in found}
    if here.null or not ranked or ranked[0].standing.null:
        return ranked
    short = [one for one in ranked if promised[one.id] > max(ranked[0].evidence, one.evidence / KEPT) and can_be(one.added)]
    for one in sorted(short, key=lambda each: -promised[each.id])[:AFRESH]:
        progress(f"trying {one.id} afresh", 0.8)
        other = judged(at, afresh(bench, at, one.added))
        ranked[ranked.index(one)] = max(one, other, key=lambda each: each.evidence)
    return sorted(ranked, key=lambda each: -each.evidence)


def _promising(found: Sequence[Screened]) -> list[Screened]:
    """The best, not too many of one family, some of the structure."""
    from validation.effects.catalogue import FAMILIES
    from validation.effects.family import STRUCTURE

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


def _rivals(tried: Sequence[Tried], menu: Sequence[Added], found: Sequence[Screened]) -> list[Added]:
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
        best.hypothesis, best.added, [one for one in others if not is_resonator(one.named)], limit=min(ALIKE / best.evidence, FAR)
    )
    return [by_id[id] for id in near if id in by_id][:ALIASES]


def _elsewhere(tried: Sequence[Tried]) -> list[Added]:
    """Resonators of the family of the best that were fitted at other places, at its sizes: theirs came from a worse one."""
    best = tried[0]
    same = [one for one in tried[1:] if is_resonator(one.added.named) and one.family == best.family]
    return [_at_sizes(one.added, best.added) for one in same]


def _as_a_rival(bench: Bench, at: Hypothesis, added: Added, best: Tried) -> Tried:
    """The fit of what can do nearly all that the `best` does; afresh where it does not from where tolerances have paid."""
    found = _tried(bench, at, added)
    if found.evidence >= KEPT * best.evidence or not can_be(added):
        return found
    return max(found, judged(at, afresh(bench, at, added)), key=lambda each: each.evidence)


def _are_twins(one: Named, other: Named) -> bool:
    """Whether both are resonators in one place, which may be one oscillator under two names."""
    return is_resonator(one) and is_resonator(other) and one.targets == other.targets


def _at_sizes(one: Added, other: Added) -> Added:
    return replace(one, named=replace(one.named, values=other.named.values))


def _settled(tried: Sequence[Tried], one: Screened, found: Sequence[Screened]) -> bool:
    """Whether the best of the fits is all that is needed, and `one` promised less than that did by more than a line may err."""
    best = max(tried, key=lambda each: each.evidence, default=None)
    if best is None or not best.standing.null:
        return False
    promised = next(each.evidence for each in found if each.id == best.id)
    return one.evidence < (1 - ERRS) * promised - BEHIND


def _tried(bench: Bench, at: Hypothesis, added: Added, begin: Fit | None = None) -> Tried:
    return judged(at, refitted(bench, at, added, begin=begin))


def _at_rest(bench: Bench, at: Hypothesis) -> Hypothesis:
    """`at`; where a tolerance stands absurdly far off, with all of them once more from where they are declared."""
    if standing(at.fit, at.problem).largest < ABSURD:
        return at
    home = judged(at, rested(bench, at))
    return home.hypothesis if home.evidence > 0 and stays(bench, home) else at
