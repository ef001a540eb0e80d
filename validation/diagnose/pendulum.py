"""A diagnosis from weights, centres of gravity and periods alone, without any campaign.

The likelihood is that of a few Gaussian numbers with the tolerances that they have in common; an effect's size is integrated
over what is plausible of it. One period is one number: all effects of a pendulum, and the article itself, are exact aliases
there, and the answer says so, with the size that each would need and the measurement that would decide.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from geometry.errors import BadInput
from geometry.inertia import PARAMETERS
from identification.self_calibration.solve import inverse
from validation.classical.pendulum import HONEST
from validation.diagnose import classical, diagnosis
from validation.diagnose.classical_tests import advised_measurements, period_per_inertia
from validation.effects.catalogue import FAMILIES, Named
from validation.effects.effect import EVIDENCE_THRESHOLD, INDISTINGUISHABLE_NATS
from validation.effects.practical_units import said
from validation.estimation.fit import FLOOR
from validation.estimation.likelihood import cost_of
from validation.estimation.problem import Problem
from validation.estimation.verdicts import UNLIKELY
from validation.model.model import Added, Model
from validation.prediction import classical_facts
from validation.prediction.classical_facts import WEIGHED, ArticleFact, facts
from validation.study import Study

# The answer on classical measurements in sentences.


NOTHING_MISSING = "Nothing is missing at this data's resolution."  # which a headline has said already

NOTEWORTHY = 1e-2
"""[probability] of a misfit below which it is said. Exercised by test_classical.py."""

RARE = 1e-6
"""[probability] of a misfit below which no figure is said. Exercised by test_classical.py."""

FREQUENT = 0.5
"""[probability] of a misfit above which no figure is said. Exercised by test_classical.py."""


def answer(found: classical.ClassicalVerdict, facts: Sequence[diagnosis.MeasurementComparison]) -> str:
    """The verdict, what it rests on, and what one number cannot say."""
    text = "Something is missing, and no effect that is known here explains the measurements, alone or in pairs."
    if found.verdict == diagnosis.NOTHING:
        text = NOTHING_MISSING
        if found.probability < NOTEWORTHY:
            text = "Nothing can be named at this data's resolution, though the model does not fit well."
    elif found.verdict == diagnosis.MISSING:
        (one,) = found.alike
        named = one.candidate.added.named
        meaning = FAMILIES[named.family].sentence.format(target=named.target, targets=" and ".join(named.targets))
        text = f"This is missing: {sized(one)}, {one.found.evidence:.0f} nats. {meaning}"
    elif found.verdict == diagnosis.AMBIGUOUS:
        # Places of one family together
        families: dict[str, list[classical.ClassicalCandidateFit]] = {}
        for one in found.alike:
            named = one.candidate.added.named
            families.setdefault(named.family if named.family == "point-mass" else one.id, []).append(one)
        sizes = []
        for family, many in families.items():
            values, unit = [one.found.value for one in many], many[0].candidate.size.unit
            low, high = said(float(min(values)), unit), said(float(max(values)), unit)
            places = f"{family} at any of {len(many)} places ({low if low == high else f'{low} to {high}'})"
            sizes.append(places if len(many) > 1 else sized(many[0]))
        told = "; ".join(sizes)
        text = f"Something is missing, and these measurements cannot tell what. Each of these explains them: {told}."
    elif found.verdict == diagnosis.SEVERAL:
        pair = " and ".join(map(sized, found.pair))
        text = f"Two things are missing: {pair}. No one effect by itself explains the measurements."
    # How far the worst measurement is from the model
    worst = max(facts, key=lambda fact: abs(fact.sigma))
    if worst.period:
        by, how = f"{abs(100 * worst.period_shift):.2g} %", "longer" if worst.period_shift > 0 else "shorter"
    else:
        by, how = said(abs(worst.predicted - worst.measured), worst.unit), "more" if worst.measured > worst.predicted else "less"
    text += f" The {worst.quantity} is {by} {how} than the model's, {abs(worst.sigma):.1f} standard deviations of its tolerance."
    if len(facts) > 1:
        often = f"one case of {1 / found.probability:.2g}" if RARE <= found.probability < FREQUENT else "most cases"
        often = "less than one case in a million" if found.probability < RARE else often
        text += f" Chi² of all {len(facts)} is {found.chi2:.3g}; chance comes to as much in {often}."
    if sum(bool(fact.period) for fact in facts) == 1:
        return f"{text} {HONEST}"
    return (
        f"{text} One number cannot say where a difference comes from, nor that two of them cancel." if len(facts) == 1 else text
    )


def sized(one: classical.ClassicalCandidateFit) -> str:
    """An effect with its size."""
    found, unit = one.found, one.candidate.size.unit
    return f"{one.id} of {said(found.value, unit)} ({said(found.low, unit)} to {said(found.high, unit)})"


TRYING = 0.5
"""[share] of the work that is done when every effect has been tried; progress bar only. By definition."""

OTHERS = 15.0
"""[nats] behind the best within which another explanation is worth a test that excludes it. Exercised by test_classical.py."""


STANDS_OUT = 3.0
"""[sd] from which a measurement is named. Exercised by test_classical.py."""


def only_classical(
    model: Model, files: Sequence[str], progress: Callable[[float], None] | None = None, *, only: Sequence[str] = ()
) -> diagnosis.SwingAnswer:
    """What `model` is missing, by the measurement `files` alone.

    Parameters
    ----------
    progress : told the share of the work that is done, 0 to 1
    only : families or ids that are looked for; all where nothing is said

    Raises
    ------
    BadInput : a file that cannot be used, or a result without tolerance.
    """
    found = facts(model, files)
    if not found:
        problem = "they say nothing of mass, centre of gravity or inertia"
        raise BadInput(", ".join(files), "", problem, "Name a weighing, cog or pendulum file")
    tell = progress or (lambda share: None)
    of = classical.observed(found, model.effects)
    answers = classical.answering(of, classical.candidates(found, model.effects, only), lambda share: tell(TRYING * share))
    verdict = classical.judged(answers, of.left, of.precision, of.of_period)
    shown = tuple(
        diagnosis.MeasurementComparison(
            name=fact.name,
            quantity=fact.name.rpartition(": ")[2],
            predicted=fact.value + float(left),
            measured=fact.value,
            deviation=fact.deviation,
            unit=_unit(fact),
            sigma=float(left) / fact.deviation,
            period=0.0 if fact.swing is None else float(fact.swing.pendulum.period.nominal_value),
            period_shift=0.0 if fact.swing is None else -float(left) * period_per_inertia(fact),
        )
        for fact, left in zip(of.facts, of.left, strict=True)
    )
    # What a next measurement should tell apart; where nothing is missing, what may hide
    best = verdict.tried[0].found.evidence if verdict.tried else 0.0
    hidden = tuple(one for one in verdict.tried if one.candidate.of_pendulum)
    near = tuple(one for one in verdict.tried if classical.explains(one, len(of.facts)) and one.found.evidence > best - OTHERS)
    rivals = {diagnosis.NOTHING: hidden or verdict.tried, diagnosis.AMBIGUOUS: verdict.alike}.get(verdict.verdict, near)
    advice = advised_measurements(of, rivals, lambda share: tell(TRYING + (1 - TRYING) * share))
    # What can be done without a figure for it: what the catalogue says would confirm it, or once more what is odd
    chosen = {diagnosis.MISSING: verdict.alike, diagnosis.SEVERAL: verdict.pair}.get(verdict.verdict, ())
    accepted = tuple(_cause(one, verdict) for one in chosen)
    advice += tuple(diagnosis.Advice(test=f"to confirm {one.id}: {one.confirmed_by}", gain=0.0) for one in accepted)
    against, leftover = of.contradictions([one.unit for one in shown]), None
    if verdict.verdict == diagnosis.UNKNOWN:
        worst = max(shown, key=lambda one: abs(one.sigma))
        advice += (diagnosis.Advice(test=f"measure the {worst.quantity} again, and note what differs from the others", gain=0.0),)
        sigma = np.abs(of.left) / of.deviation
        odd = ", ".join(of.facts[k].name for k in np.argsort(-sigma) if sigma[k] > STANDS_OUT)
        where = f"what is left stands in {odd}" if odd else "no measurement by itself stands out, all of them together do"
        leftover = diagnosis.Leftover(text="; ".join((where, *against)), looks_like="irregular")
    # A size that a file states, and does not correct for, of what explains the measurements
    remarks, named = list(against), {one.candidate.added.named.family for one in (*verdict.alike, *verdict.pair)}
    for family in classical_facts.TERMS.keys() & named:
        key = classical_facts.TERMS[family]
        stated = ", ".join(fact.name for fact in of.facts if fact.swing is not None and getattr(fact.swing.stated, key))
        term = key.replace("_", "-")
        if stated:
            remarks.append(f"the {term} is stated in {stated} and not corrected for: [corrections] {term} = true takes it off")
    return diagnosis.SwingAnswer(
        title=model.title or model.article,
        source=model.source,
        verdict=verdict.verdict,
        text=answer(verdict, shown),
        accepted=accepted,
        ranking=tuple(_cause(one, verdict) for one in verdict.tried),
        equivalence_class=tuple(one.id for one in verdict.alike),
        advice=advice,
        leftover=leftover,
        detectable=classical.detectable(verdict.tried, of.covariance),
        facts=shown,
        needed=tuple(one.needed(len(of.facts)) for one in verdict.tried),
        readings=of.readings,
        chi2=verdict.chi2,
        measurements=len(of.facts),
        remarks=tuple(remarks),
        settings={"threshold_nats": EVIDENCE_THRESHOLD, "class_nats": INDISTINGUISHABLE_NATS, "misfit_probability": UNLIKELY},
    )


def _unit(of: ArticleFact) -> str:
    return classical.UNITS[int(np.argmax(np.abs(of.weights)))]


def _cause(one: classical.ClassicalCandidateFit, of: classical.ClassicalVerdict) -> diagnosis.Cause:
    degrees = of.measurements - (len(of.pair) if one in of.pair else 1)
    size, found = one.candidate.size, one.found
    named = replace(one.candidate.added.named, values={size.key: found.value})
    return diagnosis.Cause(
        named=named,
        sizes=(diagnosis.EffectEstimate(key=size.key, value=found.value, unit=size.unit, low=found.low, high=found.high),),
        evidence=found.evidence,
        misfit=found.chi2 / max(degrees, 1),
        null=classical.chance(found.chi2, degrees) > UNLIKELY,
    )


# Do weights and periods agree with the campaigns? What the spectra alone say of each number, beside what was measured.
#
# At a fit the facts are left out, the one parameter of the article that a fact is about is freed, the rest of it being as the
# model has it, and one step of Gauss and Newton made: with N and g of everything that is free,
#
#     x = -N^-1 g ,      z = r(x) / sqrt(1 + s^T N^-1 s) ,
#
# r being the fact's (predicted - measured) / sd there and s its derivatives: how many standard deviations of both together lie
# between what the balance says and what the shaker says.


FAMILY = "rigid-inertia"


@dataclass(frozen=True, kw_only=True)
class Against:
    """One fact beside what the campaigns alone say of it.

    Attributes
    ----------
    name : of the fact
    measured : by balance, crane or pendulum, SI
    said, said_sd : by the campaigns, SI
    unit : of them
    sigma : (said - measured) / standard deviation of both
    """

    name: str
    measured: float
    said: float
    said_sd: float
    unit: str
    sigma: float

    @property
    def text(self) -> str:
        """In words."""
        away, told = abs(self.said - self.measured), said(self.said_sd, self.unit)
        return (
            f"{self.name} and the campaigns disagree by {said(away, self.unit)}, {abs(self.sigma):.0f} sigma: measured is "
            f"{said(self.measured, self.unit, 4)}, the campaigns alone say {said(self.said, self.unit, 4)} ± {told}"
        )


def contradictions(data: Study, base: diagnosis.Candidate, found: diagnosis.Candidate) -> tuple[str, ...]:
    """Each fact that contradicts the campaigns by the model as it is, `base`, and whether what was `found` settles it.

    Where that model meets all facts, nothing is computed.
    """
    offsets = {**base.problem.start, **base.fit.by_name}
    if all(abs(fact.residual(offsets)[0]) < STANDS_OUT for fact in base.problem.facts):
        return ()
    odd = [one for one in against(data, base) if abs(one.sigma) > classical.DISAGREE]
    others = [one.named.id for one in found.effects if one.named.family not in WEIGHED]
    then = {one.name: one.sigma for one in against(data, found)} if odd and others else {}
    told = []
    for one in odd:
        agree = "agree" if abs(then.get(one.name, 0.0)) < classical.DISAGREE else "still disagree"
        told.append(f"{one.text}; with {', '.join(others)} they {agree}" if one.name in then else one.text)
    return tuple(told)


def against(data: Study, at: diagnosis.Candidate) -> tuple[Against, ...]:
    """Every fact about an article that was on the shaker, beside what the campaigns alone say at the fit of `at`."""
    every = (*data.model.effects, *at.effects)
    there, body = (
        {one.named.id for one in every},
        [Named(family=FAMILY, targets=(name,), values={"": 0.0}) for name in PARAMETERS],
    )
    freed = (*every, *(Added(named=one) for one in body if one.id not in there))
    facts, found = [fact for fact in data.facts(every) if isinstance(fact, ArticleFact)], []
    for article in dict.fromkeys(fact.of.article for fact in facts):
        if not any(one.tested.carried.standing.article == article for one in data.made):
            continue
        made = tuple(one.with_effects(freed if one.tested.carried.standing.article == article else every) for one in data.made)
        problem = Problem(made).thinned()
        known = {one.name for one in at.fit.parameters}
        free = [one for one in problem.parameters if one.name in known or one.name.startswith(FAMILY)]
        cost = cost_of(problem, free, FLOOR, at.fit.by_name)
        x = cost.at({**{one.name: 0.0 for one in free}, **at.fit.by_name})
        whole, _ = cost.total(x)
        for fact in (one for one in facts if one.of.article == article):
            about = {f"{FAMILY}:{name}" for name, weight in zip(PARAMETERS, fact.weights, strict=True) if weight}
            moving = [k for k, name in enumerate(cost.names) if name in known or name in about]
            C = inverse(whole.matrix[np.ix_(moving, moving)])
            y = x.copy()
            y[moving] -= C @ whole.gradient[moving]
            own = fact.with_effects(freed)
            here = {one.name: one.start for one in own.parameters} | at.fit.by_name | dict(zip(cost.names, y, strict=True))
            z, slopes = own.residual(here)
            s = np.array([slopes.get(cost.names[k], 0.0) for k in moving])
            variance = float(s @ C @ s)
            found.append(
                Against(
                    name=own.name,
                    measured=own.value,
                    said=own.value + z * own.deviation,
                    said_sd=float(np.sqrt(variance)) * own.deviation,
                    unit=_unit(own),
                    sigma=z / float(np.sqrt(1 + variance)),
                )
            )
    return tuple(found)


# Effects of a pendulum among the candidates of a diagnosis with campaigns: what the swings among its facts say of each.
#
# The period goes with the square of an amplitude, a damping or a distance: at none a straight line sees nothing of them, and a
# fit that begins there stays there. So their evidence is the integral over their size (`validation.diagnose.classical`), the body
# being what the fit has made of it, and the fit begins at the size that it finds.


def told(data: Study, at: diagnosis.Candidate, menu: Sequence[Added]) -> list[tuple[Added, classical.Weighed]]:
    """Each of `menu`, at the size that it would have on top of the candidate `at`, with what the swings say of it."""
    every = (*data.model.effects, *at.effects)
    of = classical.observed(swings(data, every), every)
    C = np.diag(np.diag(of.covariance))  # as a fit takes them: what tolerances of swings have in common is not in it
    wanted, found = {one.named.id for one in menu}, []
    for one in classical.candidates(of.facts, every):
        if one.id in wanted:
            answer = classical.curve(partial(classical.shifted, of, one.added), one.low, one.high)
            size = classical.weighed(answer, one.size.plausible, of.left, classical.inverse_covariance(C))
            named = replace(one.added.named, values={one.size.key: size.value})
            found.append((replace(one.added, named=named), size))
    return found


def advised(data: Study, at: diagnosis.Candidate, ids: Sequence[str]) -> tuple[diagnosis.Advice, ...]:
    """Measurements on swings and balances that would tell the effects `ids`, tried on top of the candidate `at`, apart."""
    every = (*data.model.effects, *at.effects)
    of = classical.observed(swings(data, every), every)
    answers = classical.answering(of, [one for one in classical.candidates(of.facts, every) if one.id in ids])
    tried = classical.judged(answers, of.left, of.precision, of.of_period).tried
    return advised_measurements(of, [one for one in tried if one.helps])


def swings(data: Study, effects: Sequence[Added]) -> list[ArticleFact]:
    """Those among the facts of `data`, by its model with `effects`."""
    return [one for one in data.facts(effects) if isinstance(one, ArticleFact) and one.swing is not None]
