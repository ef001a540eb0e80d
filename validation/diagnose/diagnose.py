"""`diagnosed`: the whole way from a study to an answer.

Order of work ("What bit" of the catalogue): discrete mistakes, two levels, a converged baseline, screening, refits, acceptance or
"unknown", and then what would settle it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from importlib.metadata import version

import numpy as np

from geometry.errors import BadInput
from geometry.toml_file import nearest
from identification.campaign import Campaign
from identification.quality import NORMAL_90
from validation.diagnose import accept, pendulum, search
from validation.diagnose import candidates as diagnose_candidates
from validation.diagnose.accept import errors, errors_without_fit, goodness_of_fit
from validation.diagnose.candidates import candidates, detectable, looked_for
from validation.diagnose.diagnosis import (
    AMBIGUOUS,
    MISSING,
    NONLINEAR,
    NOTHING,
    SEVERAL,
    UNKNOWN,
    Advice,
    Candidate,
    Cause,
    Diagnosis,
    EffectEstimate,
    LevelDifference,
    ReportedStep,
    confirming,
)
from validation.diagnose.mistakes import mistakes, with_mistakes, without_mistakes
from validation.diagnose.next_test import advised
from validation.diagnose.nonlinear import differing_levels, nonlinear
from validation.diagnose.pendulum import contradictions
from validation.diagnose.search import CandidateFit, SearchStep, baseline, finished, indistinguishable, stepwise_search
from validation.diagnose.unexplained import Explanation, described, unexplained
from validation.effects.catalogue import FAMILIES, parse
from validation.effects.effect import (
    AMPLITUDE,
    EVIDENCE_THRESHOLD,
    INDISTINGUISHABLE_NATS,
    MISTAKE,
    PENDULUM,
    PROCESSING,
    WORTH_OF,
    evidence_threshold,
)
from validation.estimation.fit import FLOOR
from validation.estimation.problem import EFFECT
from validation.history.add import completed
from validation.model.model import Added, Model, require_target, vocabulary
from validation.prediction.effects import name
from validation.study import Data, Options, Study, read

# What a diagnosis rests on beside the data: limits, lines, band and what was asked, for its settings.


def of_bench(bench: Study) -> Mapping[str, object]:
    """Of the data: which lines, by which processing, and what no fit sees."""
    return {
        "version": version("massline"),
        "random_numbers": "none: the same data give the same answer",
        "method": bench.made[0].tested.method,
        "band_hz": {
            one.measured.name: [float(one.measured.frequency[0]), float(one.measured.frequency[-1])] for one in bench.made
        },
        "hold_out": list(bench.hold_out),
        "worth_nats": {"": EVIDENCE_THRESHOLD, **WORTH_OF},
        "alike_nats": INDISTINGUISHABLE_NATS,
        "model_error_floor": FLOOR,
    }


def of_search() -> Mapping[str, object]:
    """Of the search: what is fitted, and when it ends."""
    return {
        "unlikely": accept.UNLIKELY,
        "absurd_z": accept.ABSURD,
        "promising_nats": search.WORTH_A_FIT,
        "short_nats": search.NULL_MARGIN,
        "tried_at_most": search.FITS_OF_A_STEP,
        "effects_at_most": search.MOST_EFFECTS,
        "bent_chi2_per_dof": search.NONLINEAR_MISFIT,
        "least_share_of_excess": search.LEAST_EXPLAINED,
        "kept_share_of_promise": search.KEPT_SHARE,
        "afresh_at_most": search.RESTARTS,
        "afresh_octaves": [float(search.SIZE_OCTAVES[0]), float(search.SIZE_OCTAVES[-1])],
        "afresh_floor": search.SIZE_SCAN_FLOOR,
        "asked_again_at_most": search.RIVALS,
        "asked_again_share": search.RIVAL_SHARE,
        "instead_of_resonators_at_most": search.REPLACEMENTS,
        "resonators_beyond_band": diagnose_candidates.BEYOND,
    }


def of_question(only: Sequence[str], leave_out: Sequence[str]) -> Mapping[str, object]:
    """What was looked for; all of the catalogue that these data can show where nothing is said."""
    return {"only": list(only), "leave_out": list(leave_out)}


# From the hypothesis that a search ended at to the answer: verdict, causes, class, errors before and after.


LEFT = 60.0
"""[nats] that something describable may gain of a model that misses nothing; of nulls the best of thousands gains 10 to 17.
Set by the development draws of `make blind`."""

LINES = 200
"""[count] of lines of all data sets together at which what is unexplained is looked at. Set by the development draws of `make
blind`."""

RIVALS = 2
"""[count] of explanations between which a test is looked for. By definition."""


def answer(bench: Study, base: Candidate, found: Candidate, rounds: Sequence[SearchStep], progress: Progress) -> Diagnosis:
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
        steps=tuple(_step(one) for one in rounds if one.reconsidered != one.added or not one.added),
        hold_out=before.held_out_names,
        remarks=(*contradictions(bench, base, found), *_unfinished(found)),
        settings=_settings(bench, rounds),
    )


def _sparse(of: Candidate) -> Candidate:
    """`of` with half of its lines where there are many: what is left of something unknown shows in few."""
    lines = sum(len(of.problem.lines_of(one)) for one in of.problem.predictions)
    return of if lines <= LINES else replace(of, problem=of.problem.sparser(2))


def _verdict(found: Candidate, rounds: Sequence[SearchStep], left: Explanation) -> str:
    if not goodness_of_fit(found.fit, found.problem).null or left.gain > LEFT:
        return UNKNOWN
    if not found.effects:
        return NOTHING
    if len(found.effects) > 1:
        return SEVERAL
    return AMBIGUOUS if len(indistinguishable(_best(found, rounds))) > 1 else MISSING


def _best(found: Candidate, rounds: Sequence[SearchStep]) -> SearchStep:
    """The round that says most of what was found: of a single effect the last that took it, of several the last step forward."""
    ids = {one.named.id for one in found.effects}
    mine = [one for one in rounds if one.added in ids]
    forward = [one for one in mine if not one.reconsidered]
    return (mine if len(ids) == 1 else forward or mine or rounds)[-1]


def _unfinished(found: Candidate) -> tuple[str, ...]:
    return () if found.fit.converged else ("the fit of what was found did not converge: its sizes are not the last word",)


def _alike(named: Sequence[Added], rounds: Sequence[SearchStep]) -> tuple[str, ...]:
    """Ids that the data cannot tell apart; of several effects those of which each could be another."""
    found = {one.named.id for one in named}
    last = {one.added: one for one in rounds if one.added in found}
    groups = [[each.id for each in indistinguishable(one)] for one in last.values()]
    return tuple(dict.fromkeys(id for group in groups for id in group if len(found) == 1 or len(group) > 1))


def _advice(
    bench: Study, verdict: str, best: SearchStep, found: Candidate, progress: Callable[[float], None]
) -> tuple[Advice, ...]:
    """Tests that would tell apart what is as good as the best; where nothing is, what the catalogue knows to confirm it."""
    if verdict == AMBIGUOUS:
        swings = [one.id for one in indistinguishable(best) if FAMILIES[one.candidate.effects[-1].named.family].side == PENDULUM]
        if len(swings) > 1:  # a shaker tells nothing of ropes
            return pendulum.advised(bench, best.at, swings)
        return advised(bench, [one.candidate for one in indistinguishable(best)[:RIVALS]], progress)
    return confirming(one.named for one in found.effects) if verdict in (MISSING, SEVERAL) else ()


def _text(verdict: str, found: Candidate, best: SearchStep, left: Explanation) -> str:
    """What the sentence of the verdict does not say: of an unknown effect why no name will do."""
    if verdict != UNKNOWN:
        return ""
    why = goodness_of_fit(found.fit, found.problem).text or f"{left.gain:.0f} nats are left that have no name"
    if found.effects:
        return f"With {' and '.join(one.named.id for one in found.effects)}, which comes closest, {why}"
    if not best.tried:
        return f"As the model is, {why}"
    closest = best.tried[0]
    return f"As the model is, {why}. With the closest, {closest.id}, {closest.goodness.text or _too_little(closest)}"


def _too_little(one: CandidateFit) -> str:
    return f"it is {one.evidence:.1f} nats better, which is not enough for a name"


def _accepted(added: Added, base: Candidate, found: Candidate, rounds: Sequence[SearchStep]) -> Cause:
    evidence = next((one.tried[0].evidence for one in reversed(rounds) if one.added == added.named.id), 0.0)
    if len(found.effects) == 1:  # whatever was there on the way
        evidence = found.fit.log_evidence - base.fit.log_evidence
    of = goodness_of_fit(found.fit, found.problem)
    return Cause(
        named=added.named,
        sizes=sizes(added, found),
        evidence=evidence,
        misfit=of.misfit,
        price=of.prior_penalty,
        null=of.null,
    )


def _cause(one: CandidateFit) -> Cause:
    added = one.candidate.effects[-1]
    return Cause(
        named=added.named,
        sizes=sizes(added, one.candidate),
        evidence=one.evidence,
        misfit=one.goodness.misfit,
        price=one.goodness.prior_penalty,
        null=one.goodness.null,
    )


def sizes(added: Added, of: Candidate) -> tuple[EffectEstimate, ...]:
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
        made.append(EffectEstimate(key=size.key, value=value, unit=size.unit, low=low, high=high))
    return tuple(made)


def _step(one: SearchStep) -> ReportedStep:
    return ReportedStep(
        added=one.added,
        ranking=tuple(_cause(each) for each in one.tried),
        misfit=one.goodness.misfit,
        price=one.goodness.prior_penalty,
        text=_why(one),
    )


def _why(one: SearchStep) -> str:
    if one.reconsidered:
        beside = f"beside {' and '.join(each.named.id for each in one.at.effects)}" if one.at.effects else "alone"
        worse = next(each.evidence for each in one.tried if each.id == one.reconsidered)
        return f"{one.added} brings {one.tried[0].evidence:.1f} nats {beside}, and {one.reconsidered} only {worse:.1f}"
    if one.added:
        asked = evidence_threshold(one.tried[0].family)
        return f"{one.added} brings {one.tried[0].evidence:.1f} nats, where {asked:g} are asked for"
    if not one.tried:
        return _no_fit(one)
    asked = evidence_threshold(one.tried[0].family)
    return f"the best, {one.tried[0].id}, brings {one.tried[0].evidence:.1f} nats, where {asked:g} are asked for"


def _no_fit(one: SearchStep) -> str:
    """Why nothing was fitted, or nothing that was is left."""
    if one.left_band:
        return f"a fit drives {', '.join(one.left_band)} out of the band of the data, and no other kind of effect is worth a fit"
    if not one.screened:
        return "there is no candidate"
    best = one.screened[0]
    promised, asked = max(best.evidence, 0.0), evidence_threshold(best.added.named.family)
    return f"no candidate is worth a fit: {best.id} promises most, {promised:.1f} nats, where {asked:g} are asked for"


def _settings(bench: Study, rounds: Sequence[SearchStep]) -> Mapping[str, object]:
    problem = rounds[0].at.problem
    return {
        **of_bench(bench),
        **of_search(),
        "left_nats": LEFT,
        "misfit_limit": goodness_of_fit(rounds[0].at.fit, problem).limit,
        "candidates": len(rounds[0].screened),
        "lines": {one.measured.name: len(problem.lines_of(one)) for one in problem.predictions},
        "parameters": len(rounds[0].at.fit.parameters),
    }


# The answer where two levels do not give the same: a linear fit of such data fails, and names nonsense.


def nonlinear_answer(
    bench: Study,
    levels: Sequence[LevelDifference],
    progress: Progress,
    *,
    only: Sequence[str] = (),
    leave_out: Sequence[str] = (),
) -> Diagnosis:
    """Which axes depend on the level, and which effect that may be, of those that are looked for."""
    found = nonlinear(bench, levels, lambda share: progress("two levels do not give the same", share))
    ranking = tuple(one for one in found if looked_for(one.named, only, leave_out))
    alike = tuple(
        one.id for one in ranking if one.evidence >= max(ranking[0].evidence - INDISTINGUISHABLE_NATS, EVIDENCE_THRESHOLD)
    )
    named = ranking[:1] if len(alike) == 1 else ()
    before = errors_without_fit(bench, {})
    after = before
    if named:
        model = replace(bench.model, effects=(*bench.model.effects, Added(named=named[0].named, fixed=True)))
        after = errors_without_fit(replace(bench, model=model), {})
    return Diagnosis(
        verdict=NONLINEAR,
        text=_unequal_text(levels, named),
        accepted=named,
        ranking=ranking,
        equivalence_class=alike,
        levels=tuple(levels),
        before=before,
        after=after,
        advice=confirming(one.named for one in ranking if one.id in alike),
        hold_out=before.held_out_names,
        settings=of_bench(bench),
    )


def _unequal_text(levels: Sequence[LevelDifference], named: Sequence[Cause]) -> str:
    axes = ", ".join(dict.fromkeys(one.axis for one in levels))
    said = f"Driven along {axes}, two levels do not give the same"
    if named:
        said += f": as {named[0].id} would"
    return said


Progress = Callable[[str, float], None]
"""Hears what is done now, and the share of it."""


def diagnosed(
    of: Study, *, only: Sequence[str] = (), leave_out: Sequence[str] = (), progress: Progress | None = None
) -> Diagnosis:
    """What the model of a bench is missing.

    Parameters
    ----------
    only : families or ids that are looked for beside mistakes; all where nothing is said
    leave_out : families or ids that are not, mistakes among them

    Raises
    ------
    BadInput : one of `only` could not act on these data.
    CheckFailed : the baseline does not converge.
    """
    tell = progress or (lambda what, share: None)
    tell("looking for mistakes", 0.0)
    mistaken = [one for one in mistakes(of) if looked_for(one.named, (), leave_out)]
    right = without_mistakes(of, mistaken) if mistaken else of
    found = _linear_or_not(right, only, leave_out, tell)
    whole = with_mistakes(of, found, mistaken) if mistaken else found
    return replace(whole, only=tuple(only), settings={**whole.settings, **of_question(only, leave_out)})


def _linear_or_not(right: Study, only: Sequence[str], leave_out: Sequence[str], tell: Progress) -> Diagnosis:
    """The diagnosis of data without mistakes: what two levels say, and where they say the same what a search finds."""
    linear = [one for one in only if FAMILIES[one.partition(":")[0]].side != AMPLITUDE]
    menu = candidates(right, only=linear, leave_out=leave_out) if linear or not only else ()
    if differing := differing_levels(right):
        return nonlinear_answer(right, differing, tell, only=only, leave_out=leave_out)
    tell("fitting the model as it is", 0.0)
    base = baseline(right, lambda share: tell("fitting the model as it is", share))
    found, rounds = stepwise_search(right, base, menu, tell)
    found = finished(right, found) if found.effects else found
    return answer(right, rounds[0].at, found, rounds, tell)


# What `massline diagnose` was asked, checked at the door.


OPTION = "--candidate"

FEWEST_RUNS = 2
"""[count] of runs of all campaigns together: what one teaches another must confirm. Exercised by
tests/validation/diagnosing/command/test_bad_input.py."""

OTHERWISE = {
    MISTAKE: "Leave it out: mistakes are looked for in every diagnosis, before any fit",
    PROCESSING: "Leave it out: `massline compare` and `massline add` try it",
    PENDULUM: "Leave it out: what a swing is missing is told where its file is among DATA",
}
"""By side of the catalogue, what to do about a candidate that no fit of spectra looks for."""


def ready(asked: Options, progress: Callable[[str, float], None] | None = None) -> tuple[Model, Data]:
    """The model and the data, read, and the candidates found to be such that these data could have them.

    Raises
    ------
    BadInput : see `validation.study.read`; too few runs; a candidate that nobody knows or that acts on nothing here.
    OSError : a file cannot be read.
    """
    for text in asked.candidates:
        _require_family(text)
    model, data = read(asked, progress)
    require_runs(data.campaigns)
    for text in asked.candidates:
        _require_here(text, model, data.campaigns)
    return model, data


def require_runs(campaigns: Sequence[Campaign]) -> None:
    """Refuse a series of which nothing can be held out.

    Raises
    ------
    BadInput : fewer runs than `FEWEST_RUNS` in all.
    """
    count = sum(len(one.runs) for one in campaigns)
    if count < FEWEST_RUNS:
        names = ", ".join(f"{run.name} of {one.source}" for one in campaigns for run in one.runs)
        raise BadInput(
            source="DATA",
            field="runs",
            problem=f"too few: {count} in all ({names}), and what one run teaches another must confirm",
            remedy="Name a campaign with more runs, one for each of the six axes at best, or more campaigns of the series",
        )


def _require_family(text: str) -> None:
    """Refuse what is no effect of the catalogue, has a size, or is not looked for by fits."""
    name, equals, _ = text.partition("=")
    family = name.partition(":")[0].strip()
    if family not in FAMILIES:
        remedy = f"{nearest(family, FAMILIES)}`massline effects` lists all of them; your own come with --effects-from DIR"
        raise BadInput(source=OPTION, field=text, problem=f"no effect is called {family!r}", remedy=remedy)
    if equals:
        remedy = f"Write {name.strip()}; `massline add MODEL {text.strip()}` begins at a size"
        raise BadInput(source=OPTION, field=text, problem="it has a size, which is what is looked for", remedy=remedy)
    if (side := FAMILIES[family].side) in OTHERWISE:
        raise BadInput(source=OPTION, field=text, problem=f"is of the kind {side!r}", remedy=OTHERWISE[side])


def _require_here(text: str, model: Model, campaigns: Sequence[Campaign]) -> None:
    """Refuse a target that these `campaigns` do not have."""
    if ":" in text:
        named = parse(completed(text)[0], vocabulary(model, campaigns), source=OPTION)
        require_target(model, campaigns, named, OPTION)


def of_levels(asked: Options) -> tuple[str, ...]:
    """The candidates that only two levels show."""
    return tuple(text for text in asked.candidates if FAMILIES[text.partition(":")[0].strip()].side == AMPLITUDE)
