"""Effects that were found first, asked once more when others are there.

What explained a little of everything goes when what is really missing is named. And which of several names is right may show only
beside the others: a mass at the wrong place also pays for the blade that is too soft, and the right one need not.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from geometry.errors import CheckFailed
from validation.diagnosing.accepting import standing
from validation.diagnosing.bench import Bench, Hypothesis
from validation.diagnosing.menu import is_resonator
from validation.diagnosing.refitting import instead, settled
from validation.diagnosing.rounds import Round, Tried, enough, judged, ranked, stays
from validation.effects.worth import worth
from validation.engine.fit import nearby
from validation.engine.parameter import FITTED
from validation.models.model import Added

RIVALS, SHARE = 5, 0.25
"""Names at most that an effect is asked against, and share of the evidence that such a one must have brought."""

Progress = Callable[[str, float], None]


def asked_again(
    bench: Bench, at: Hypothesis, rounds: Sequence[Round], progress: Progress
) -> tuple[Hypothesis, tuple[Round, ...]]:
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
    asked: list[Round] = []
    for anew in (False, True):  # what changed may stand beside others than it was asked beside
        for which in _ids(at):
            if (len(at.effects) > 1 and not anew) or {*_ids(known[which].at)} != {*_ids(at)} - {which}:
                at, more = _one(bench, at, known[which], progress)
                known |= {one.added: one for one in more}
                asked += more
    return at, tuple(asked)


def _ids(of: Hypothesis) -> tuple[str, ...]:
    return tuple(one.named.id for one in of.effects)


def _one(bench: Bench, at: Hypothesis, found: Round, progress: Progress) -> tuple[Hypothesis, tuple[Round, ...]]:
    """`at` with the effect that a round found under its best name, and how that was asked; or without it."""
    added = next(one for one in at.effects if one.named.id == found.added)
    try:
        rest = _without(bench, at, added)
    except CheckFailed:  # there is nothing to hold it against
        return at, ()
    evidence = at.fit.log_evidence - rest.fit.log_evidence
    if evidence < worth(added.named.family):
        return rest, ()
    there = Tried(id=found.added, hypothesis=_last(at, added), evidence=evidence, standing=standing(at.fit, at.problem))
    rivals = _rivals(found, at)
    progress(f"asking {found.added} and {len(rivals)} others once more", 0.95)
    others = [judged(rest, instead(bench, at, rest, _at_home(one.added, added))) for one in rivals]
    may = [one for one in others if stays(bench, one) and (enough(one) or one.evidence <= evidence)]
    tried = tuple(ranked([there, *may]))
    stands = standing(rest.fit, rest.problem)
    again = replace(found, at=rest, standing=stands, tried=tried, added=tried[0].id, again=found.added)
    return at if tried[0] is there else tried[0].hypothesis, (again,)


def _rivals(found: Round, at: Hypothesis) -> list[Tried]:
    """What else a round tried that brought a good part of what its best did, and is not there by now."""
    near = [one for one in found.tried if one.id not in _ids(at) and one.evidence >= SHARE * found.tried[0].evidence]
    return near[:RIVALS]


def _at_home(one: Added, found: Added) -> Added:
    """A resonator at another place or under another name begins at the sizes of the one that was found; others at their own."""
    same = is_resonator(one.named) and is_resonator(found.named) and one.named.values.keys() == found.named.values.keys()
    return replace(one, named=replace(one.named, values=found.named.values)) if same else one


def _last(at: Hypothesis, added: Added) -> Hypothesis:
    """`at`, the effect `added` named last."""
    return replace(at, effects=(*(one for one in at.effects if one is not added), added))


def _without(bench: Bench, at: Hypothesis, added: Added) -> Hypothesis:
    """The fit of the other effects alone, from where it is with all."""
    left = tuple(one for one in at.effects if one.named.id != added.named.id)
    problem = bench.problem(left)
    return settled(bench, Hypothesis(effects=left, fit=nearby(problem, FITTED, at.fit.by_name), problem=problem))
