"""`diagnosed`: the whole way from a study to an answer.

Order of work ("What bit" of the catalogue): discrete mistakes, two levels, a converged baseline, screening, refits, acceptance or
"unknown", and then what would settle it.
"""

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import cache as remembered
from functools import partial
from importlib.metadata import version
from math import erfc, inf, sqrt

import numpy as np

from geometry import cache
from geometry.errors import BadInput, CheckFailed
from geometry.toml_file import nearest
from identification.campaign import Campaign
from identification.quality import NORMAL_90
from validation.compare.correlation import correlations
from validation.diagnose import candidates, diagnosis, pendulum, search
from validation.diagnose.candidate_fits import (
    CandidateFit,
    GoodnessOfFit,
    candidate_fit,
    declared,
    goodness_of_fit,
    in_band,
    is_accepted,
    ranked,
    recentred,
)
from validation.diagnose.candidates import TINY_AT
from validation.diagnose.everywhere import elsewhere, found_nodes, kind_of, with_twins, without_a_name
from validation.diagnose.landmark_search import FromAfar, line_fit
from validation.diagnose.mistakes import mistakes
from validation.diagnose.next_test import advised
from validation.diagnose.nonlinear import differing_levels, nonlinear
from validation.diagnose.search import SearchStep, first_fit, placed_from_afar, stepwise_search
from validation.diagnose.unexplained import Explanation, described, unexplained
from validation.effects import effect
from validation.effects.catalogue import FAMILIES, Named, code_of_families, parse
from validation.effects.effect import EVIDENCE_THRESHOLD, INDISTINGUISHABLE_NATS
from validation.effects.practical_units import written_as
from validation.estimation.evaluate import evaluate, folds
from validation.estimation.fit import BREAKDOWNS, COARSE, FLOOR, PLAIN_FLOOR, child, nearby, unfitted
from validation.estimation.likelihood import cost_of, ends_of
from validation.estimation.problem import EFFECT, FITTED, IDENTIFIED, Evaluation, Offsets, Problem
from validation.estimation.screening import in_the_fit
from validation.estimation.verdicts import tolerances
from validation.history.add import completed, sized_by
from validation.model.model import Added, Model, require_target, vocabulary
from validation.model.setups import above_fmd, is_stack
from validation.model.tolerance_classes import METROLOGY
from validation.output import nats, with_unit
from validation.prediction.effects import name
from validation.prediction.modal_table import TableFrequencies, TableShapes
from validation.study import Data, Options, Study, read

LEFT = 60.0
"""[nats] that something describable may gain of a model that misses nothing; of nulls the best of thousands gains 10 to 17. Set
by the development draws of `make blind`."""

LINES = 200
"""[count] of lines of all data sets together at which what is unexplained is looked at. Set by the development draws of `make
blind`."""

CHANCE = 0.05
"""[probability] that some tolerance of a sound test moves as far: below it the one that did is told. By definition."""

RAREST = 1e-6
"""[probability] that such a movement is told by, however far it is. By definition."""

RIVALS = 2
"""[count] of explanations between which a test is looked for. By definition."""

SWINGING = (1e-3, 1e-1, 1e1, 1e2)
"""[kg] of a resonator that explains a mode of a table, where a fit of it may begin. By definition."""

STRANGE = (
    "{} of the table is left out: without it all others have a partner in the model, and the data are more probable if it is "
    "none of the structure (a machine's, the mains') or of something that the model lacks; `leave_out` says so for good"
)
"""What is said of a mode without a partner."""

Progress = Callable[[str, float], None]
"""Hears what is done now, and the share of it."""


def diagnosed(
    of: Study, *, only: Sequence[str] = (), leave_out: Sequence[str] = (), progress: Progress | None = None, swung: bool = False
) -> diagnosis.Diagnosis:
    """What the model of a study is missing.

    Parameters
    ----------
    only : families or ids that are looked for beside mistakes; all where nothing is said
    leave_out : families or ids that are not, mistakes among them
    swung : whether resonators were asked for already, by modes that are left out of these data

    Raises
    ------
    BadInput : one of `only` could not act on these data.
    CheckFailed : a model that breaks down.
    """
    tell = progress or (lambda what, share: None)
    tell("looking for mistakes", 0.0)
    mistaken = [one for one in mistakes(of) if candidates.looked_for(one.named, (), leave_out)]
    # A model that makes the same mistakes as the data leaves nothing of them
    known = tuple(Added(named=one.named, fixed=True) for one in mistaken)
    right = replace(of, model=replace(of.model, effects=(*of.model.effects, *known))) if known else of
    if positions := [word for one in only for word in one.split(":") if effect.position(word) is not None]:
        right = right.ready_at(positions)
    linear = [one for one in only if FAMILIES[one.partition(":")[0]].side != effect.AMPLITUDE]
    rest, odd, price = without_strangers(of, right.model.effects)
    # Refuses what could not act, before any fit
    menu = candidates.candidates(right, only=linear, leave_out=leave_out, swinging=bool(odd) or swung) if linear else ()
    if not any(map(candidates.has_lines, (*right.made, *right.tests))):  # no straight line leads to a resonator
        menu = tuple(one for one in menu if not candidates.is_resonator(one.named))
    least = -price
    if differing := differing_levels(right):
        found = nonlinear_answer(right, differing, tell, only=only, leave_out=leave_out)
    else:
        tell("fitting the model as it is", 0.0)
        fit = right.all_free(lambda share: tell("fitting the model as it is", share))
        base = diagnosis.Candidate(effects=(), fit=fit, problem=right.problem())
        look = partial(tell, "looking everywhere on the mesh")
        every, best = found_nodes(base, lambda share: look(share / 3))
        wanted = partial(candidates.looked_for, only=only, leave_out=leave_out)
        nodes = tuple(one for one in best if wanted(one.named))
        menu = menu if only else candidates.candidates(right, leave_out=leave_out)
        named = partial(first_fit, right, base, menu, tell)
        if fitted := without_a_name(right, base, nodes, wanted, lambda share: look((1 + 2 * share) / 3), named):
            again = {one.kind for one in fitted}
            nodes = (*fitted, *(one for one in nodes if one.kind not in again))
            right = right.ready_at([one.named.target for one in fitted])
            base = diagnosis.Candidate(effects=(), fit=right.all_free(begin=fit), problem=right.problem())
            menu = menu if only else candidates.candidates(right, leave_out=leave_out)
        right, at, steps = stepwise_search(right, base, menu, tell, elsewhere if every else None, fitted)
        if odd and at.effects and goodness_of_fit(at.fit, at.problem).null:  # with these the model may have the mode
            stand = [replace(sized_by(one, at.fit), fixed=True) for one in at.effects]
            odd = without_strangers(right, (*right.model.effects, *stand))[1]
        for _, hertz in odd:
            tried = swinging(right, base, hertz, wanted)
            if tried and is_weighed(tried[0]):
                begun = replace(steps[0], tried=tried, added=tried[0].id)
                ready, end, led = stepwise_search(right, base, menu, tell, elsewhere if every else None, begun=begun)
                right, at, steps = max((right, at, steps), (ready, end, led), key=lambda one: one[1].fit.log_evidence)
            elif tried:  # a force there would swing it likewise
                least = max(least, base.fit.log_evidence + tried[0].evidence - EVIDENCE_THRESHOLD)
        unknown = right.tests and not right.made and not goodness_of_fit(at.fit, at.problem).null
        afar = FromAfar.search(right, menu, tell) if unknown else None
        placed = None
        if afar is not None and every and any(map(kind_of, afar.best.effects)):
            with suppress(CheckFailed):
                placed = placed_from_afar(right, afar, menu, tell, elsewhere)
        if placed is not None:
            right, at, more = placed
            steps, afar = (*steps, *(replace(one, screened=steps[-1].screened) for one in more)), None
        if afar is None and goodness_of_fit(at.fit, at.problem).null:
            right, at, more = with_twins(right, at, steps)
            steps = (*steps, *more)
        found = answer(right, at, steps, tell) if afar is None else answer_from_afar(right, base, steps, afar, menu, tell)
        found = replace(found, everywhere=nodes, nodes=every)
    whole = with_mistakes(of, found, mistaken) if mistaken else found
    if odd and whole.after.fitted.log_evidence < least:  # else nothing that the others say could be worth it
        names = " and ".join(name for name, _ in odd)
        tell(f"leaving out {names}", 0.0)
        with suppress(BadInput, CheckFailed):
            told = diagnosed(rest, only=only, leave_out=leave_out, progress=progress, swung=True)
            brings = max(told.after.fitted.log_evidence - price, least if least > -price else -inf)
            if told.verdict != diagnosis.UNKNOWN and brings > whole.after.fitted.log_evidence:
                return replace(told, remarks=(STRANGE.format(names), *told.remarks))
    alike = correlations(of.whole().predictions) if of.tests else ()
    said = (*whole.remarks, *(text.rstrip(".") for one in (*of.tests, *alike) for text in one.remarks))
    whole = replace(whole, correlation=alike, remarks=tuple(dict.fromkeys(said)))
    return replace(whole, only=tuple(only), settings={**whole.settings, "only": list(only), "leave_out": list(leave_out)})


def without_strangers(of: Study, effects: Sequence[Added]) -> tuple[Study, tuple[tuple[str, float], ...], float]:
    """`of` without those modes of its tables that stand in the way of all others beside a model with `effects`, these modes with
    their frequencies [Hz], and how dear that is [nats]."""
    tables = [one for one in of.tests if isinstance(one, TableFrequencies | TableShapes)]
    known = {id(one.table): (one.table, one.with_effects(effects).strangers) for one in tables}
    left = {id(one): one.without(known[id(one.table)][1]) for one in tables}
    odd = tuple((name, float(table.frequency[table.names.index(name)])) for table, names in known.values() for name in names)
    gone = {(one, name) for one in tables for name in known[id(one.table)][1]}
    held = tuple(name for name in of.hold_out if name not in {f"{one.measured.name}/{mode}" for one, mode in gone})
    price = sum(one.chance(mode) for one, mode in gone) + EVIDENCE_THRESHOLD * len(odd)
    return replace(of, tests=tuple(left.get(id(one), one) for one in of.tests), hold_out=held), odd, price


def is_weighed(one: CandidateFit) -> bool:
    """Whether the data say that a resonator, the newest effect, weighs anything: a machine swings a structure likewise."""
    mass = as_cause(one.added, one.candidate, one.evidence, one.goodness).sizes[0]
    return 2 * one.added.named.sizes[0].low < mass.low < mass.high


def swinging(study: Study, base: diagnosis.Candidate, hertz: float, wanted: Callable[[Named], bool]) -> tuple[CandidateFit, ...]:
    """Resonators beside `base` that have a mode of a table which the model has not, at its frequency, the best place first; those
    that are `wanted`.

    No straight line promises one: of next to no mass it makes no mode that a table would hold. How its mode moves the sensors
    tells the place, whatever its mass is.
    """

    def of_mass(one: Added, mass: float) -> tuple[Added, Problem]:
        added = replace(one, named=replace(one.named, values={"m": mass, "f": hertz, "zeta": TINY_AT["zeta"]}))
        return added, study.problem((*base.effects, added))

    def apart(one: Added) -> float:
        _, problem = of_mass(one, SWINGING[0])
        try:
            return cost_of(problem, [], COARSE[0], declared(problem, base.fit)).total(np.zeros(0))[0].cost
        except BREAKDOWNS:
            return inf

    found = list[CandidateFit]()
    menu = [one for one in candidates.candidates(study, swinging=True) if one.named.family == "absorber" and wanted(one.named)]
    for one in sorted(menu, key=apart)[: search.FEW]:
        rough = []
        for mass in SWINGING:
            added, problem = of_mass(one, mass)
            with suppress(CheckFailed):
                fit = child(problem, FITTED, base.fit, declared(problem, base.fit), from_afar=True)
                rough.append(recentred(study, diagnosis.Candidate(effects=(*base.effects, added), fit=fit, problem=problem)))
        if rough:
            found.append(candidate_fit(base, min(rough, key=lambda each: each.fit.cost)))
    return tuple(ranked([one for one in found if in_band(study, one) and is_accepted(one)]))


def diagnosed_once(
    study: Study, *, only: Sequence[str] = (), leave_out: Sequence[str] = (), progress: Progress | None = None
) -> diagnosis.Diagnosis:
    """What `diagnosed` says, read back where this very code has said it of the same model, data and options before.

    Whoever tested, when and where, may be written into a campaign later: it is no other data.

    Raises
    ------
    BadInput, CheckFailed : see `diagnosed`; a refusal is not kept.
    """

    def made() -> diagnosis.Diagnosis:
        return diagnosed(study, only=only, leave_out=leave_out, progress=progress)

    records = [[(name, one.digest) for name, one in each.recordings.items()] for each in study.campaigns]
    described = [
        replace(each, recordings={}, date="", place="", operator="", serial_number="", instruments=()) for each in study.campaigns
    ]
    data: object = described, records, study.said, study.hold_out
    if study.tests or study.model.own or not all(is_stack(above_fmd(one.article)) for one in study.campaigns):
        data = study.plain  # with the matrices and meshes that lie in files of their own
    asked = replace(study.asked, model="", data=(), effects_from=(), candidates=tuple(only), leave_out=tuple(leave_out))
    return cache.answer(made, "diagnosis", study.model, data, asked, code_of_families(study.asked.effects_from))


def answer(study: Study, found: diagnosis.Candidate, steps: Sequence[SearchStep], progress: Progress) -> diagnosis.Diagnosis:
    """The diagnosis that the `steps` of a search lead to, which ended at `found`."""
    base, problem = steps[0].at, found.problem

    @remembered  # a rival stands in the ranking, in its step and in its class, and the interval of a spring is dear
    def cause(one: CandidateFit) -> diagnosis.Cause:
        return as_cause(one.added, one.candidate, one.evidence, one.goodness)

    progress("looking at what is left", 0.0)
    # What is left of something unknown shows in few lines
    lines = sum(len(problem.lines_of(one)) for one in problem.predictions)
    left = unexplained(found if lines <= LINES else replace(found, problem=problem.sparser(2)))
    best, stands = best_step(found, steps), goodness_of_fit(found.fit, problem)
    last = {one.added: one for one in steps if one.added}
    same = {one.named.id: last[one.named.id].same_as(one.named.id) if one.named.id in last else () for one in found.effects}
    by_chance = stands.null and left.gain <= LEFT
    if not by_chance or not (found.fit.converged or found.effects):
        verdict = diagnosis.UNKNOWN
    elif not found.effects:
        verdict = diagnosis.NOTHING
    elif len(found.effects) > 1:
        verdict = diagnosis.SEVERAL
    else:
        names = {one.id for one in best.indistinguishable} - set(same[found.effects[0].named.id])
        verdict = diagnosis.AMBIGUOUS if len(names) > 1 else diagnosis.MISSING
    named = () if verdict == diagnosis.UNKNOWN else found.effects
    before = errors(study, base, lambda share: progress("errors of the model as it is", share))
    after = before
    if named:
        after = errors(study, found, lambda share: progress("errors with what was found", share))
    accepted = []
    for one in named:
        if len(found.effects) == 1:  # whatever was there on the way
            evidence = found.fit.log_evidence - base.fit.log_evidence
        else:
            evidence = last[one.named.id].evidence if one.named.id in last else 0.0
        alike = last[one.named.id].indistinguishable if one.named.id in last else ()
        named_cause = replace(as_cause(one, found, evidence, stands), same=same[one.named.id])
        accepted.append(diagnosis.of_a_class(named_cause, tuple(map(cause, alike)) if len(alike) > 1 else ()))
    # Tests that would tell apart what is as good as the best; where nothing is, what the catalogue knows to confirm it
    advice = diagnosis.confirming(one.named for one in found.effects) if verdict in (diagnosis.MISSING, diagnosis.SEVERAL) else ()
    if verdict == diagnosis.AMBIGUOUS:
        swings = [one.id for one in best.indistinguishable if FAMILIES[one.family].side == effect.PENDULUM]
        rivals = [one.candidate for one in best.indistinguishable[: RIVALS if study.made else None]]
        if len(swings) > 1:  # a shaker tells nothing of ropes
            advice = pendulum.advised(study, best.at, swings)
        else:
            advice = advised(study, rivals, lambda share: progress("looking for the next measurement", share))
    elif study.tests:  # places that are one name to the last digit, and those of one of several
        classes = [last[one.named.id].indistinguishable for one in named if one.named.id in last]
        parting = [advised(study, [each.candidate for each in one]) for one in classes if len(one) > 1]
        advice = (*(one for some in parting for one in some if one.gain > 0), *advice)
    unsure = "the fit of what was found did not converge: its sizes are not the last word"
    told = [unsure] if found.effects and not found.fit.converged else []
    told += search.left_of_reduction(study, found)
    known_better = found.fit.converged and study.model.tolerance_class != METROLOGY
    for moved in tolerances(found.fit)[:1] if verdict == diagnosis.NOTHING else ():
        chance = max(found.fit.tolerances * erfc(abs(moved.z) / sqrt(2)), RAREST)
        if chance < CHANCE:
            (by,), unit = written_as(moved.parameter.unit, (moved.moved,))
            told.append(
                f"the fit moved {moved.parameter.name} by {with_unit(by, unit)}, {abs(moved.z):.1f} standard deviations of what "
                f"was known, which is too little for a name; of {found.fit.tolerances} tolerances chance moves one as "
                f"far in 1 of {1 / chance:.0f} tests: measure it again"
            )
    return diagnosis.Diagnosis(
        verdict=verdict,
        text=text_of_unknown(found, best, left) if verdict == diagnosis.UNKNOWN else "",
        accepted=tuple(accepted),
        ranking=tuple(map(cause, best.tried)),
        equivalence_class=indistinguishable_ids(named, steps),
        advice=advice,
        leftover=None if by_chance else described(base),
        detectable=candidates.detectable(steps[-1].screened),
        before=before,
        after=after,
        known_better=diagnosis.KnownBetter.of(found.fit) if known_better else (),
        steps=tuple(
            diagnosis.ReportedStep(
                added=one.added,
                ranking=tuple(map(cause, one.tried)),
                misfit=one.goodness.misfit,
                price=one.goodness.prior_penalty,
                text=one.text,
            )
            for one in steps
            if one.reconsidered != one.added or not one.added
        ),
        hold_out=before.held_out_names,
        remarks=(*pendulum.contradictions(study, base, found), *study.on_several(found.effects), *told),
        settings={
            **settings(study),
            **search.SETTINGS,
            "resonators_beyond_band": candidates.BEYOND,
            "left_nats": LEFT,
            "misfit_limit": goodness_of_fit(base.fit, base.problem).limit,
            "candidates": len(steps[0].screened),
            "lines": {one.measured.name: len(base.problem.lines_of(one)) for one in base.problem.predictions},
            "parameters": len(base.fit.parameters),
        },
    )


SOUND = 2.0
"""[sd] of a sound model beyond which a landmark is said to be off. By definition."""

MOST_OFF = 4
"""[count] of landmarks of which that is said. By definition."""

BLOCKS = 4
"""[count] of blocks of frequency that are held out in turn where there is but one run. By definition."""


def parting(
    study: Study, first: diagnosis.Candidate, found: FromAfar, menu: Sequence[Added], progress: Progress
) -> tuple[diagnosis.Advice, ...]:
    """Tests that would tell apart what is alike from afar, of each effect of `first`, the fit of what was `found`."""
    made: list[diagnosis.Advice] = []
    for id in found.alike:
        rivals = [first]
        for effects in found.instead(id, menu):
            problem = study.problem(effects)
            fit = line_fit(study, effects, roughly=True) or nearby(problem, FITTED, problem.start)
            rivals.append(diagnosis.Candidate(effects=effects, fit=fit, problem=problem))
        if len(rivals) > 1:
            made += advised(study, rivals, lambda share: progress("looking for the next measurement", share))
    return tuple(one for one in made if one.gain > 0)


def answer_from_afar(
    study: Study,
    base: diagnosis.Candidate,
    steps: Sequence[SearchStep],
    found: FromAfar,
    menu: Sequence[Added],
    progress: Progress,
) -> diagnosis.Diagnosis:
    """The diagnosis that a search from afar leads to: its effects are named, and what they leave is said."""
    effects = tuple(replace(one, fixed=False) for one in found.best.effects)
    coarse = line_fit(study, found.best.effects)
    problem = study.problem(found.best.effects)
    begin = problem.start if coarse is None else coarse.by_name
    fine = nearby(problem, FITTED, begin)
    stands = goodness_of_fit(fine, problem)
    floor = COARSE[0] if coarse is not None and not stands.null else None
    fit = fine if floor is None or coarse is None else coarse
    candidate = diagnosis.Candidate(effects=found.best.effects, fit=fit, problem=problem)

    def told(of: diagnosis.Candidate, what: str) -> Evaluation:
        whole = study.whole(of.effects)
        return evaluate(
            whole,
            hold_out=study.hold_out,
            blocks=0 if folds(whole) or coarse is None else BLOCKS,
            fitted=of.fit,
            configurations=False,
            near=inf,
            floor=PLAIN_FLOOR if floor is None else floor,
            progress=lambda share: progress(what, share),
        )

    asis = base if floor is None else replace(base, fit=nearby(base.problem, FITTED, base.fit.by_name, floor=floor))
    before = told(asis, "errors of the model as it is")
    after = told(candidate, "errors with what was found")
    estimates = found.estimates()
    accepted = tuple(
        diagnosis.Cause(
            named=one.named,
            sizes=estimates[one.named.id],
            evidence=found.gains[one.named.id],
            misfit=stands.misfit,
            price=stands.prior_penalty,
            null=stands.null,
        )
        for one in effects
    )
    ranking = tuple(
        diagnosis.Cause(
            named=one.added.named,
            sizes=tuple(
                diagnosis.EffectEstimate(key=size.key, value=value, unit=size.unit, low=value, high=value)
                for size in one.added.named.sizes
                for value in (one.added.named.values[size.key],)
            ),
            evidence=one.evidence,
            misfit=one.misfit,
            price=inf,
        )
        for one in found.alone
    )
    several = [ids for ids in found.alike.values() if len(ids) > 1]
    if not stands.null:
        verdict = diagnosis.UNKNOWN
    elif len(effects) > 1:
        verdict = diagnosis.SEVERAL
    else:
        verdict = diagnosis.AMBIGUOUS if several else diagnosis.MISSING
    alike = tuple(dict.fromkeys(id for ids in (found.alike.values() if len(effects) == 1 else several) for id in ids))
    advice = () if verdict == diagnosis.UNKNOWN else parting(study, candidate, found, menu, progress)
    off = found.off(SOUND)
    words = "; ".join(f"{where} by {sd:.1f} of what a sound model may be" for where, sd in off[:MOST_OFF]) or stands.text
    left = f"Something is left. Still off: {words}."
    if (more := found.after) is not None and more.evidence > 0:
        left += f" What comes closest to that, {more.added.named.id}, brings {nats(more.evidence)} nats: too little."
    total = sum(sd**2 for _, sd in off) or 1.0
    # Gains of which nothing was known; their intervals are wider by what the data do not fit
    wider, gains = NORMAL_90 * max(np.sqrt(fit.chi2 / max(fit.degrees_of_freedom, 1)), 1.0), []
    for one, x, square in zip(fit.parameters, map(float, fit.offsets), map(float, np.diag(fit.covariance)), strict=True):
        if one.kind == IDENTIFIED and np.isinf(one.tolerance):
            low, high = (one.value(x + side * wider * np.sqrt(max(square, 0.0))) for side in (-1, 1))
            gains.append(f"{one.name}, which was not known, is {one.value(x):.4g} ({low:.4g} to {high:.4g})")
    return diagnosis.Diagnosis(
        verdict=verdict,
        text=left if verdict == diagnosis.UNKNOWN else "",
        accepted=accepted,
        ranking=ranking,
        equivalence_class=alike,
        advice=(*advice, *diagnosis.confirming(one.named for one in effects)),
        leftover=diagnosis.Leftover(
            text=left,
            looks_like="irregular",
            channels=tuple(where for where, _ in off[:1]),
            share=off[0][1] ** 2 / total if off else 0.0,
        )
        if verdict == diagnosis.UNKNOWN
        else None,
        detectable=candidates.detectable(steps[-1].screened),
        before=before,
        after=after,
        steps=(
            diagnosis.ReportedStep(
                added=" and ".join(one.named.id for one in effects),
                ranking=ranking,
                misfit=stands.misfit,
                price=stands.prior_penalty,
                text=f"from afar, chi² of {found.number:.0f} landmarks falls from {found.base.chi2:.3g} to {found.best.chi2:.3g}",
            ),
        ),
        hold_out=before.held_out_names,
        remarks=(*gains, *search.left_of_reduction(study, candidate)),
        settings={
            **settings(study),
            **search.SETTINGS,
            "landmarks": {"numbers": found.number, "variance": found.variance},
            "candidates": len(steps[0].screened),
            "lines": {one.measured.name: len(base.problem.lines_of(one)) for one in base.problem.predictions},
            "parameters": len(fit.parameters),
        },
    )


def settings(study: Study) -> Mapping[str, object]:
    """What a diagnosis rests on beside the data: which lines, by which processing, what no fit sees, and limits."""
    return {
        "version": version("massline"),
        "random_numbers": "none: the same data give the same answer",
        "method": next((one.tested.method for one in study.made), None),
        "band_hz": {
            one.measured.name: [float(one.measured.frequency[0]), float(one.measured.frequency[-1])]
            for one in study.whole().predictions
        },
        "hold_out": list(study.hold_out),
        "worth_nats": {"": EVIDENCE_THRESHOLD, **effect.WORTH_OF},
        "alike_nats": INDISTINGUISHABLE_NATS,
        "model_error_floor": FLOOR,
    }


def best_step(found: diagnosis.Candidate, steps: Sequence[SearchStep]) -> SearchStep:
    """The step that says most of what was found: of a single effect the last that took it, of several the last step forward."""
    ids = {one.named.id for one in found.effects}
    mine = [one for one in steps if one.added in ids]
    forward = [one for one in mine if not one.reconsidered]
    return (mine if len(ids) == 1 else forward or mine or steps)[-1]


def indistinguishable_ids(named: Sequence[Added], steps: Sequence[SearchStep]) -> tuple[str, ...]:
    """Ids that the data cannot tell apart; of several effects those of which each could be another."""
    found = {one.named.id for one in named}
    last = {one.added: one for one in steps if one.added in found}
    groups = [[each.id for each in one.indistinguishable] for one in last.values()]
    return tuple(dict.fromkeys(id for group in groups for id in group if len(found) == 1 or len(group) > 1))


def text_of_unknown(found: diagnosis.Candidate, best: SearchStep, left: Explanation) -> str:
    """Why no name will do for an unknown effect."""
    rest = f"{left.gain:.0f} nats are left that have no name" if left.gain > LEFT else "chance would explain what is left"
    why = goodness_of_fit(found.fit, found.problem).text or rest
    if not found.effects and not found.fit.converged:
        why = f"{found.fit.unfinished}, and no effect that was looked for explains why. Where it stopped {why}"
    if found.effects:
        return f"With {' and '.join(one.named.id for one in found.effects)}, which comes closest, {why}"
    if not best.tried:
        return f"As the model is, {why}"
    closest = best.tried[0]
    too_little = f"it is {closest.evidence:.1f} nats better, which is not enough for a name"
    return f"As the model is, {why}. With the closest, {closest.id}, {closest.goodness.text or too_little}"


def as_cause(added: Added, of: diagnosis.Candidate, evidence: float, stands: GoodnessOfFit) -> diagnosis.Cause:
    """An effect of the candidate `of`, its sizes with their 90 % intervals; that of a logarithm is lopsided.

    A size is what the data alone say: how large a fault plausibly is weighs its evidence, and would pull a larger one down.
    """
    spread = np.sqrt(np.maximum(np.diag(of.fit.covariance), 0.0))
    known = {one.name: (one, float(x), float(sd)) for one, x, sd in zip(of.fit.parameters, of.fit.offsets, spread, strict=True)}
    alone, sizes = in_the_fit(of.fit), []
    for size in added.named.sizes:
        value = added.named.values[size.key]
        low = high = value
        which = known.get(name(added.named, size.key))
        if which is not None and which[0].kind == EFFECT and not added.fixed:
            one, x, sd = which
            if one.name in alone and not size.logarithmic:  # a size known to a factor counts from where the fit ended
                x, sd = alone[one.name].estimate, alone[one.name].deviation
                value = min(max(one.value(x), size.low), size.high)
            ends = [x - NORMAL_90 * sd, x + NORMAL_90 * sd]
            if size.key in ("", "m") and (any_size := candidates.AnySize.of(of, added)) is not None:
                x, *ends = any_size.interval()
                value = min(max(one.value(x), size.low), size.high)
            every = ends_of(one, x, ends)
            low, high = sorted(min(max(end, size.low), size.high) for end in every)
        sizes.append(diagnosis.EffectEstimate(key=size.key, value=value, unit=size.unit, low=low, high=high))
    return diagnosis.Cause(
        named=added.named,
        sizes=tuple(sizes),
        evidence=evidence,
        misfit=stands.misfit,
        price=stands.prior_penalty,
        null=stands.null,
    )


def nonlinear_answer(
    study: Study,
    levels: Sequence[diagnosis.LevelDifference],
    progress: Progress,
    *,
    only: Sequence[str] = (),
    leave_out: Sequence[str] = (),
) -> diagnosis.Diagnosis:
    """Where two levels do not give the same, a linear fit fails and names nonsense: which axes depend on the level, and which
    effect that may be, of those that are looked for."""
    found = nonlinear(study, levels, lambda share: progress("two levels do not give the same", share))
    ranking = tuple(one for one in found if candidates.looked_for(one.named, only, leave_out))
    alike = tuple(
        one.id for one in ranking if one.evidence >= max(ranking[0].evidence - INDISTINGUISHABLE_NATS, EVIDENCE_THRESHOLD)
    )
    named = ranking[:1] if len(alike) == 1 else ()
    text = f"Driven along {', '.join(dict.fromkeys(one.axis for one in levels))}, two levels do not give the same"
    before = errors_without_fit(study, {})
    after = before
    if named:
        model = replace(study.model, effects=(*study.model.effects, Added(named=named[0].named, fixed=True)))
        after = errors_without_fit(replace(study, model=model), {})
    return diagnosis.Diagnosis(
        verdict=diagnosis.NONLINEAR,
        text=f"{text}: as {named[0].id} would" if named else text,
        accepted=named,
        ranking=ranking,
        equivalence_class=alike,
        levels=tuple(levels),
        before=before,
        after=after,
        advice=diagnosis.confirming(one.named for one in ranking if one.id in alike),
        hold_out=before.held_out_names,
        settings=settings(study),
    )


def with_mistakes(study: Study, found: diagnosis.Diagnosis, mistaken: Sequence[diagnosis.Cause]) -> diagnosis.Diagnosis:
    """`found`, the diagnosis without the mistakes, as one of the data of `study` as they are."""
    which, nonlinear_too = " and ".join(one.id for one in mistaken), found.verdict == diagnosis.NONLINEAR
    if nonlinear_too:
        text = f"{found.text}; beside that a mistake in the data: {which}"
    else:
        text = "" if found.verdict == diagnosis.NOTHING else f"Beside {which}: {found.text or diagnosis.headline(found)}"
    return replace(
        found,
        verdict=diagnosis.NONLINEAR if nonlinear_too else diagnosis.MISTAKE,
        text=text,
        accepted=(*mistaken, *found.accepted),
        ranking=(*mistaken, *found.ranking),
        equivalence_class=found.equivalence_class or tuple(id for one in mistaken for id in (one.id, *one.same)),
        advice=found.advice or diagnosis.confirming(one.named for one in mistaken),
        before=errors_without_fit(study, {} if nonlinear_too else found.after.fitted.by_name),
    )


# The four errors of a candidate, those of the model as it is by the evaluation that any other answer has.


def errors(study: Study, of: diagnosis.Candidate, progress: Callable[[float], None] | None = None) -> Evaluation:
    """Of the candidate `of`, whose fit is known; no configuration is held out."""
    if not of.effects:
        return study.evaluation(progress, configurations=False)
    whole = study.whole(of.effects)
    return evaluate(whole, hold_out=study.hold_out, fitted=of.fit, configurations=False, progress=progress)


def errors_without_fit(study: Study, offsets: Offsets) -> Evaluation:
    """Of the model of `study` where no fit of all tolerances makes sense: they stand at `offsets`."""
    found = unfitted(study.problem(), FITTED, offsets)
    return evaluate(study.whole(), hold_out=study.hold_out, fitted=found, configurations=False)


# What `massline diagnose` was asked, checked at the door.


OPTION = "--candidate"

FEWEST_RUNS = 2
"""[count] of runs of all campaigns together: what one teaches another must confirm. Exercised by diagnosing/test_command.py."""

OTHERWISE = {
    effect.MISTAKE: "Leave it out: mistakes are looked for in every diagnosis, before any fit",
    effect.PROCESSING: "Leave it out: `massline compare` and `massline add` try it",
    effect.PENDULUM: "Leave it out: what a swing is missing is told where its file is among DATA",
}
"""By side of the catalogue, what to do about a candidate that no fit of spectra looks for."""


def ready(asked: Options, progress: Progress | None = None) -> tuple[Model, Data]:
    """The model and the data, read, and the candidates found to be such that these data could have them.

    Raises
    ------
    BadInput : see `validation.study.read`; too few runs; a candidate that nobody knows or that acts on nothing here.
    OSError : a file cannot be read.
    """
    for text in asked.candidates:
        candidate, equals, _ = text.partition("=")
        family = candidate.partition(":")[0].strip()
        if family not in FAMILIES:
            remedy = f"{nearest(family, FAMILIES)}`massline effects` lists all of them; your own come with --effects-from DIR"
            raise BadInput(OPTION, text, f"no effect is called {family!r}", remedy)
        if equals:
            remedy = f"Write {candidate.strip()}; `massline add MODEL {text.strip()}` begins at a size"
            raise BadInput(OPTION, text, "it has a size, which is what is looked for", remedy)
        if (side := FAMILIES[family].side) in OTHERWISE:
            raise BadInput(OPTION, text, f"is of the kind {side!r}", OTHERWISE[side])
    model, data = read(asked, progress)
    if not data.tests:
        require_runs(data.campaigns)
    for text in asked.candidates:
        if ":" in text and not data.tests:
            named = parse(completed(text)[0], vocabulary(model, data.campaigns), source=OPTION)
            require_target(model, data.campaigns, named, OPTION)
    return model, data


def require_runs(campaigns: Sequence[Campaign]) -> None:
    """Refuse campaigns of which nothing can be held out, without accelerometers on an article, of which one run tells enough.

    Raises
    ------
    BadInput : fewer runs than `FEWEST_RUNS` in all.
    """
    count = sum(len(one.runs) for one in campaigns)
    if count < FEWEST_RUNS and not any(one.table.select(group="article", quantity="acceleration") for one in campaigns):
        names = ", ".join(f"{run.name} of {one.source}" for one in campaigns for run in one.runs)
        problem = f"too few: {count} in all ({names}), and what one run teaches another must confirm"
        remedy = "Name a campaign with more runs, one for each of the six axes at best, or more campaigns of the series"
        raise BadInput("DATA", "runs", problem, remedy)
