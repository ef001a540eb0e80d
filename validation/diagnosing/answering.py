"""From the hypothesis that a search ended at to the answer: verdict, causes, class, errors before and after."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from identification.quality import NORMAL_90
from validation.diagnosing import stated, swinging
from validation.diagnosing.accepting import standing
from validation.diagnosing.advisor.advised import advised
from validation.diagnosing.against_facts import contradictions
from validation.diagnosing.bench import Bench, Hypothesis
from validation.diagnosing.confirming import confirming
from validation.diagnosing.detecting import detectable
from validation.diagnosing.diagnosis import (
    AMBIGUOUS,
    MISSING,
    NOTHING,
    SEVERAL,
    UNKNOWN,
    Advice,
    Cause,
    Diagnosis,
    Size,
    Step,
)
from validation.diagnosing.errors import errors
from validation.diagnosing.leftover.described import described, unexplained
from validation.diagnosing.leftover.ranking import Explanation
from validation.diagnosing.rounds import Round, Tried, alike
from validation.effects.catalogue import FAMILIES
from validation.effects.family import PENDULUM
from validation.effects.worth import worth
from validation.engine.parameter import EFFECT
from validation.models.model import Added
from validation.prediction.applied import name

LEFT = 60.0
"""[nats] that a describable leftover may gain of a model that misses nothing; of nulls the best of thousands gains 10 to 17."""

LINES = 200
"""Lines of all data sets together at which a leftover is looked at."""

RIVALS = 2
"""Explanations between which a test is looked for."""

Progress = Callable[[str, float], None]


def answer(bench: Bench, base: Hypothesis, found: Hypothesis, rounds: Sequence[Round], progress: Progress) -> Diagnosis:
    """The diagnosis that the `rounds` from `base` to `found` lead to."""
    progress("looking at what is left", 0.0)
    left = unexplained(_sparse(found))
    verdict = _verdict(found, rounds, left)
    named = () if verdict == UNKNOWN else found.effects
    best = _best(found, rounds)
    before = errors(bench, base, lambda share: progress("errors of the model as it is", share))
    after = before
    if named:
        after = errors(bench, found, lambda share: progress("errors with what was found", share))
    return Diagnosis(
        verdict=verdict,
        text=_text(verdict, found, best, left),
        accepted=tuple(_accepted(one, base, found, rounds) for one in named),
        ranking=tuple(_cause(one) for one in best.tried),
        equivalence_class=_alike(named, rounds),
        advice=_advice(bench, verdict, best, found, lambda share: progress("looking for the next measurement", share)),
        leftover=described(base) if verdict == UNKNOWN else None,
        detectable=detectable(rounds[-1].screened),
        before=before,
        after=after,
        steps=tuple(_step(one) for one in rounds if one.again != one.added or not one.added),
        hold_out=before.held_out_names,
        remarks=(*contradictions(bench, base, found), *_unfinished(found)),
        settings=_settings(bench, rounds),
    )


def _sparse(of: Hypothesis) -> Hypothesis:
    """`of` with half of its lines where there are many: what is left of something unknown shows in few."""
    lines = sum(len(of.problem.lines_of(one)) for one in of.problem.predictions)
    return of if lines <= LINES else replace(of, problem=of.problem.sparser(2))


def _verdict(found: Hypothesis, rounds: Sequence[Round], left: Explanation) -> str:
    if not standing(found.fit, found.problem).null or left.gain > LEFT:
        return UNKNOWN
    if not found.effects:
        return NOTHING
    if len(found.effects) > 1:
        return SEVERAL
    return AMBIGUOUS if len(alike(_best(found, rounds))) > 1 else MISSING


def _best(found: Hypothesis, rounds: Sequence[Round]) -> Round:
    """The round that says most of what was found: of a single effect the last that took it, of several the last step forward."""
    ids = {one.named.id for one in found.effects}
    mine = [one for one in rounds if one.added in ids]
    forward = [one for one in mine if not one.again]
    return (mine if len(ids) == 1 else forward or mine or rounds)[-1]


def _unfinished(found: Hypothesis) -> tuple[str, ...]:
    return () if found.fit.converged else ("the fit of what was found did not converge: its sizes are not the last word",)


def _alike(named: Sequence[Added], rounds: Sequence[Round]) -> tuple[str, ...]:
    """Ids that the data cannot tell apart; of several effects those of which each could be another."""
    found = {one.named.id for one in named}
    last = {one.added: one for one in rounds if one.added in found}
    groups = [[each.id for each in alike(one)] for one in last.values()]
    return tuple(dict.fromkeys(id for group in groups for id in group if len(found) == 1 or len(group) > 1))


def _advice(bench: Bench, verdict: str, best: Round, found: Hypothesis, progress: Callable[[float], None]) -> tuple[Advice, ...]:
    """Tests that would tell apart what is as good as the best; where nothing is, what the catalogue knows to confirm it."""
    if verdict == AMBIGUOUS:
        swings = [one.id for one in alike(best) if FAMILIES[one.hypothesis.effects[-1].named.family].side == PENDULUM]
        if len(swings) > 1:  # a shaker tells nothing of ropes
            return swinging.advised(bench, best.at, swings)
        return advised(bench, [one.hypothesis for one in alike(best)[:RIVALS]], progress)
    return confirming(one.named for one in found.effects) if verdict in (MISSING, SEVERAL) else ()


def _text(verdict: str, found: Hypothesis, best: Round, left: Explanation) -> str:
    """What the sentence of the verdict does not say: of an unknown effect why no name will do."""
    if verdict != UNKNOWN:
        return ""
    why = standing(found.fit, found.problem).text or f"{left.gain:.0f} nats are left that have no name"
    if found.effects:
        return f"With {' and '.join(one.named.id for one in found.effects)}, which comes closest, {why}"
    if not best.tried:
        return f"As the model is, {why}"
    closest = best.tried[0]
    return f"As the model is, {why}. With the closest, {closest.id}, {closest.standing.text or _too_little(closest)}"


def _too_little(one: Tried) -> str:
    return f"it is {one.evidence:.1f} nats better, which is not enough for a name"


def _accepted(added: Added, base: Hypothesis, found: Hypothesis, rounds: Sequence[Round]) -> Cause:
    evidence = next((one.tried[0].evidence for one in reversed(rounds) if one.added == added.named.id), 0.0)
    if len(found.effects) == 1:  # whatever was there on the way
        evidence = found.fit.log_evidence - base.fit.log_evidence
    of = standing(found.fit, found.problem)
    return Cause(
        named=added.named,
        sizes=sizes(added, found),
        evidence=evidence,
        misfit=of.misfit,
        price=of.price,
        null=of.null,
    )


def _cause(one: Tried) -> Cause:
    added = one.hypothesis.effects[-1]
    return Cause(
        named=added.named,
        sizes=sizes(added, one.hypothesis),
        evidence=one.evidence,
        misfit=one.standing.misfit,
        price=one.standing.price,
        null=one.standing.null,
    )


def sizes(added: Added, of: Hypothesis) -> tuple[Size, ...]:
    """The sizes of an effect of the hypothesis `of`, with their 90 % intervals; that of a logarithm is lopsided."""
    spread = np.sqrt(np.maximum(np.diag(of.fit.covariance), 0.0))
    found = {one.name: (one, float(x), float(sd)) for one, x, sd in zip(of.fit.parameters, of.fit.offsets, spread, strict=True)}
    made = []
    for size in added.named.sizes:
        value = added.named.values[size.key]
        low = high = value
        which = found.get(name(added.named, size.key))
        if which is not None and which[0].kind == EFFECT and not added.fixed:
            one, x, sd = which
            ends = sorted((one.value(x - NORMAL_90 * sd), one.value(x + NORMAL_90 * sd)))
            low, high = (min(max(end, size.low), size.high) for end in ends)
        made.append(Size(key=size.key, value=value, unit=size.unit, low=low, high=high))
    return tuple(made)


def _step(one: Round) -> Step:
    return Step(
        added=one.added,
        ranking=tuple(_cause(each) for each in one.tried),
        misfit=one.standing.misfit,
        price=one.standing.price,
        text=_why(one),
    )


def _why(one: Round) -> str:
    if one.again:
        beside = f"beside {' and '.join(each.named.id for each in one.at.effects)}" if one.at.effects else "alone"
        worse = next(each.evidence for each in one.tried if each.id == one.again)
        return f"{one.added} brings {one.tried[0].evidence:.1f} nats {beside}, and {one.again} only {worse:.1f}"
    if one.added:
        return f"{one.added} brings {one.tried[0].evidence:.1f} nats, where {worth(one.tried[0].family):g} are asked for"
    if not one.tried:
        return _no_fit(one)
    asked = worth(one.tried[0].family)
    return f"the best, {one.tried[0].id}, brings {one.tried[0].evidence:.1f} nats, where {asked:g} are asked for"


def _no_fit(one: Round) -> str:
    """Why nothing was fitted, or nothing that was is left."""
    if one.gone:
        return f"a fit drives {', '.join(one.gone)} out of the band of the data, and no other kind of effect is worth a fit"
    if not one.screened:
        return "there is no candidate"
    best = one.screened[0]
    promised, asked = max(best.evidence, 0.0), worth(best.added.named.family)
    return f"no candidate is worth a fit: {best.id} promises most, {promised:.1f} nats, where {asked:g} are asked for"


def _settings(bench: Bench, rounds: Sequence[Round]) -> Mapping[str, object]:
    problem = rounds[0].at.problem
    return {
        **stated.of_bench(bench),
        **stated.of_search(),
        "left_nats": LEFT,
        "misfit_limit": standing(rounds[0].at.fit, problem).limit,
        "candidates": len(rounds[0].screened),
        "lines": {one.measured.name: len(problem.lines_of(one)) for one in problem.predictions},
        "parameters": len(rounds[0].at.fit.parameters),
    }
