"""A diagnosis from weights, centres of gravity and periods alone, without any campaign.

The likelihood is that of a few Gaussian numbers with the tolerances that they have in common; an effect's size is integrated
over what is plausible of it. One period is one number: all effects of a pendulum, and the article itself, are exact aliases
there, and the answer says so, with the size that each would need and the measurement that would decide.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from geometry.errors import BadInput
from geometry.inertia import PARAMETERS
from identification.self_calibration.solve import inverse
from validation.classical.pendulum import HONEST
from validation.diagnose.classical import (
    LARGE,
    UNITS,
    UNLIKELY,
    ClassicalCandidate,
    ClassicalCandidateFit,
    ClassicalVerdict,
    MeasurementComparison,
    Needed,
    ObservedFacts,
    SwingAnswer,
    Weighed,
    answering,
    candidates,
    chance,
    contradicting_measurements,
    curve,
    detectable,
    explains,
    inverse_covariance,
    judged,
    observed,
    pendulum_candidates,
    readings,
    shifted,
    weighed,
)
from validation.diagnose.classical_tests import advised_measurements, period_per_inertia
from validation.diagnose.diagnosis import (
    AMBIGUOUS,
    MISSING,
    NOTHING,
    SEVERAL,
    UNKNOWN,
    Advice,
    Candidate,
    Cause,
    EffectEstimate,
    Leftover,
)
from validation.effects.catalogue import FAMILIES, Named
from validation.effects.effect import EVIDENCE_THRESHOLD, INDISTINGUISHABLE_NATS
from validation.effects.practical_units import said, significant
from validation.estimation.fit import FLOOR
from validation.estimation.likelihood import cost_of
from validation.estimation.problem import Problem
from validation.model.model import Added, Model
from validation.prediction import classical_facts
from validation.prediction.classical_facts import WEIGHED, ArticleFact, facts
from validation.study import Study

# The answer on classical measurements in sentences.


PLAUSIBLE = 1.0
"""[prior sd] up to which an effect is nothing special. Exercised by tests/validation/diagnosing/test_swings.py."""

NOTEWORTHY = 1e-2
"""[probability] of a misfit below which it is said. Exercised by tests/validation/diagnosing/test_swings.py."""

RARE = 1e-6
"""[probability] of a misfit below which no figure is said. Exercised by tests/validation/diagnosing/test_swings.py."""

FREQUENT = 0.5
"""[probability] of a misfit above which no figure is said. Exercised by tests/validation/diagnosing/test_swings.py."""


def answer(found: ClassicalVerdict, facts: Sequence[MeasurementComparison]) -> str:
    """The verdict, what it rests on, and what one number cannot say."""
    parts = [_verdict(found, facts), _measured(found, facts)]
    if sum(bool(fact.period) for fact in facts) == 1:
        parts.append(HONEST)
    elif len(facts) == 1:
        parts.append("One number cannot say where a difference comes from, nor that two of them cancel.")
    return " ".join(part for part in parts if part)


def _verdict(found: ClassicalVerdict, facts: Sequence[MeasurementComparison]) -> str:
    if found.verdict == NOTHING and found.probability < NOTEWORTHY:
        return "Nothing can be named at this data's resolution, though the model does not fit well."
    if found.verdict == NOTHING:
        return "Nothing is missing at this data's resolution."
    if found.verdict == MISSING:
        (one,) = found.alike
        return f"This is missing: {sized(one)}, {one.found.evidence:.0f} nats. {sentence(one)}"
    if found.verdict == AMBIGUOUS:
        return (
            f"Something is missing, and these measurements cannot tell what. Each of these explains them: {listed(found.alike)}."
        )
    if found.verdict == SEVERAL:
        return (
            f"Two things are missing: {' and '.join(map(sized, found.pair))}. No one effect by itself explains the measurements."
        )
    return "Something is missing, and no effect that is known here explains the measurements, alone or in pairs."


def _measured(found: ClassicalVerdict, facts: Sequence[MeasurementComparison]) -> str:
    worst = max(facts, key=lambda fact: abs(fact.sigma))
    chance = (
        ""
        if len(facts) == 1
        else f" Chi² of all {len(facts)} is {found.chi2:.3g} (by chance so much in {_often(found.probability)})."
    )
    return f"{deviation(worst)}.{chance}"


def deviation(of: MeasurementComparison) -> str:
    """How far a measurement is from the model."""
    if of.period:
        how = "longer" if of.period_shift > 0 else "shorter"
        return f"The {of.quantity} is {abs(100 * of.period_shift):.2g} % {how} than the model's, {_sigmas(of)}"
    by = said(abs(of.predicted - of.measured), of.unit)
    how = "more" if of.measured > of.predicted else "less"
    return f"The {of.quantity} is {by} {how} than the model's, {_sigmas(of)}"


def _sigmas(of: MeasurementComparison) -> str:
    return f"{abs(of.sigma):.1f} standard deviations of its tolerance"


def _often(probability: float) -> str:
    if probability < RARE:
        return "less than one case in a million"
    return f"one case of {1 / probability:.2g}" if probability < FREQUENT else "most cases"


def listed(alike: Sequence[ClassicalCandidateFit]) -> str:
    """Explanations with their sizes; places of one family together."""
    families: dict[str, list[ClassicalCandidateFit]] = {}
    for one in alike:
        named = one.candidate.added.named
        families.setdefault(named.family if named.family == "point-mass" else one.id, []).append(one)
    told = [sized(many[0]) if len(many) == 1 else _together(name, many) for name, many in families.items()]
    return "; ".join(told)


def _together(family: str, many: Sequence[ClassicalCandidateFit]) -> str:
    values = np.array([one.found.value for one in many])
    unit = many[0].candidate.size.unit
    low, high = said(float(values.min()), unit), said(float(values.max()), unit)
    size = low if low == high else f"{low} to {high}"
    return f"{family} at any of {len(many)} places ({size})"


def sized(one: ClassicalCandidateFit) -> str:
    """An effect with its size."""
    found, unit = one.found, one.candidate.size.unit
    return f"{one.id} of {said(found.value, unit)} ({said(found.low, unit)} to {said(found.high, unit)})"


def sentence(one: ClassicalCandidateFit) -> str:
    """What it means."""
    named = one.candidate.added.named
    return FAMILIES[named.family].sentence.format(target=named.target, targets=" and ".join(named.targets))


def needed(one: ClassicalCandidateFit, fits: bool) -> str:
    """The size that an effect would need, and what is to be thought of it."""
    unit, plausible = one.candidate.size.unit, one.candidate.size.plausible
    size, times = one.found.best, abs(one.found.best) / plausible
    if not one.helps:
        return "moves the measurements the other way, whatever its size"
    if one.found.at_end:
        return f"more than {said(abs(size), unit)}, beyond anything plausible ({said(plausible, unit)})"
    if not fits:
        return f"{said(size, unit)} fits best, and leaves chi² {one.found.chi2:.3g}: no explanation by itself"
    thought = "plausible" if times <= PLAUSIBLE else "large, but possible" if times <= LARGE else "hardly plausible"
    return f"{said(size, unit)}, {significant(times, 2)} times what is plausible: {thought}"


Progress = Callable[[float], None]

TRYING = 0.5
"""[share] of the work that is done when every effect has been tried; progress bar only. By definition."""

OTHERS = 15.0
"""[nats] behind the best within which another explanation is worth a test that excludes it. Exercised by
tests/validation/diagnosing/test_swings.py."""


STANDS_OUT = 3.0
"""[sd] from which a measurement is named. Exercised by tests/validation/diagnosing/test_swings.py."""


def only_classical(
    model: Model, files: Sequence[str], progress: Progress | None = None, *, only: Sequence[str] = ()
) -> SwingAnswer:
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
        raise BadInput(source=", ".join(files), problem=problem, remedy="Name a weighing, cog or pendulum file")
    tell = progress or (lambda share: None)
    of = observed(found, model.effects)
    answers = answering(of, candidates(found, model.effects, only), lambda share: tell(TRYING * share))
    verdict = judged(answers, of.left, of.precision, of.of_period)
    shown = tuple(_beside(fact, left) for fact, left in zip(of.facts, of.left, strict=True))
    against = contradicting_measurements(of, shown)
    return SwingAnswer(
        title=model.title or model.article,
        source=model.source,
        verdict=verdict.verdict,
        text=answer(verdict, shown),
        accepted=_accepted(verdict),
        ranking=tuple(_cause(one, verdict) for one in verdict.tried),
        equivalence_class=tuple(one.id for one in verdict.alike),
        advice=(
            *advised_measurements(of, _rivals(verdict), lambda share: tell(TRYING + (1 - TRYING) * share)),
            *_otherwise(verdict, shown),
        ),
        leftover=_leftover(of, verdict, against),
        detectable=detectable(verdict.tried, of.covariance),
        facts=shown,
        needed=tuple(_needed(one, verdict) for one in verdict.tried),
        readings=readings(of),
        chi2=verdict.chi2,
        measurements=len(of.facts),
        remarks=(*against, *_switched_off(of, verdict)),
        settings={"threshold_nats": EVIDENCE_THRESHOLD, "class_nats": INDISTINGUISHABLE_NATS, "misfit_probability": UNLIKELY},
    )


def _beside(fact: ArticleFact, left: float) -> MeasurementComparison:
    of_swing = fact.swing is not None
    period = float(fact.swing.pendulum.period.nominal_value) if fact.swing is not None else 0.0
    return MeasurementComparison(
        name=fact.name,
        quantity=fact.name.rpartition(": ")[2],
        predicted=fact.value + float(left),
        measured=fact.value,
        deviation=fact.deviation,
        unit=UNITS[int(np.argmax(np.abs(fact.weights)))],
        sigma=float(left) / fact.deviation,
        period=period,
        period_shift=-float(left) * period_per_inertia(fact) if of_swing else 0.0,
    )


def _cause(one: ClassicalCandidateFit, of: ClassicalVerdict) -> Cause:
    degrees = of.measurements - (len(of.pair) if one in of.pair else 1)
    size, found = one.candidate.size, one.found
    named = replace(one.candidate.added.named, values={size.key: found.value})
    return Cause(
        named=named,
        sizes=(EffectEstimate(key=size.key, value=found.value, unit=size.unit, low=found.low, high=found.high),),
        evidence=found.evidence,
        misfit=found.chi2 / max(degrees, 1),
        null=chance(found.chi2, degrees) > UNLIKELY,
    )


def _accepted(of: ClassicalVerdict) -> tuple[Cause, ...]:
    """Of several that cannot be told apart none."""
    chosen = of.alike if of.verdict == MISSING else of.pair if of.verdict == SEVERAL else ()
    return tuple(_cause(one, of) for one in chosen)


def _rivals(of: ClassicalVerdict) -> tuple[ClassicalCandidateFit, ...]:
    """What a next measurement should tell apart; where nothing is missing, what may hide."""
    if of.verdict == NOTHING:
        hidden = [one for one in of.tried if one.candidate.of_pendulum]
        return tuple(hidden or of.tried)
    if of.verdict == AMBIGUOUS:
        return of.alike
    best = of.tried[0].found.evidence if of.tried else 0.0
    return tuple(one for one in of.tried if explains(one, of.measurements) and one.found.evidence > best - OTHERS)


def _switched_off(of: ObservedFacts, verdict: ClassicalVerdict) -> Iterator[str]:
    """A size that a file states, and does not correct for, of what explains the measurements."""
    named = {one.candidate.added.named.family for one in (*verdict.alike, *verdict.pair)}
    for family in classical_facts.TERMS.keys() & named:
        stated = [
            fact.name for fact in of.facts if fact.swing is not None and getattr(fact.swing.stated, classical_facts.TERMS[family])
        ]
        if stated:
            term = classical_facts.TERMS[family].replace("_", "-")
            yield f"the {term} is stated in {', '.join(stated)} and not corrected for: [corrections] {term} = true takes it off"


def _otherwise(of: ClassicalVerdict, beside: Sequence[MeasurementComparison]) -> tuple[Advice, ...]:
    """What can be done without a figure for it: what the catalogue says would confirm it, or once more what is odd."""
    if of.verdict in (MISSING, SEVERAL):
        return tuple(Advice(test=f"to confirm {one.id}: {one.confirmed_by}", gain=0.0) for one in _accepted(of))
    if of.verdict == UNKNOWN:
        worst = max(beside, key=lambda one: abs(one.sigma))
        return (Advice(test=f"measure the {worst.quantity} again, and note what differs from the others", gain=0.0),)
    return ()


def _needed(one: ClassicalCandidateFit, of: ClassicalVerdict) -> Needed:
    fits = explains(one, of.measurements)
    return Needed(
        id=one.id,
        value=one.found.best,
        unit=one.candidate.size.unit,
        plausible=one.candidate.size.plausible,
        possible=one.helps and not one.found.at_end,
        fits=fits,
        evidence=one.found.evidence,
        text=needed(one, fits),
    )


def _leftover(of: ObservedFacts, verdict: ClassicalVerdict, against: Sequence[str]) -> Leftover | None:
    """What no effect explains."""
    if verdict.verdict != UNKNOWN:
        return None
    sigma = np.abs(of.left) / of.deviation
    worst = [of.facts[k].name for k in np.argsort(-sigma) if sigma[k] > STANDS_OUT]
    where = (
        f"what is left stands in {', '.join(worst)}" if worst else "no measurement by itself stands out, all of them together do"
    )
    return Leftover(text="; ".join((where, *against)), looks_like="irregular")


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

DISAGREE = 4.0
"""[sd] from which a fact and the campaigns contradict each other. Exercised by
tests/validation/diagnosing/test_facts_beside_campaigns.py."""


@dataclass(frozen=True, kw_only=True)
class Against:
    """One fact beside what the campaigns alone say of it.

    Attributes
    ----------
    name : of the fact
    measured, measured_sd : by balance, crane or pendulum, SI
    said, said_sd : by the campaigns, SI
    unit : of them
    sigma : (said - measured) / standard deviation of both
    """

    name: str
    measured: float
    measured_sd: float
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


def contradictions(data: Study, base: Candidate, found: Candidate) -> tuple[str, ...]:
    """Each fact that contradicts the campaigns by the model as it is, `base`, and whether what was `found` settles it.

    Where that model meets all facts, nothing is computed.
    """
    offsets = {**base.problem.start, **base.fit.by_name}
    if all(abs(fact.residual(offsets)[0]) < STANDS_OUT for fact in base.problem.facts):
        return ()
    odd = [one for one in against(data, base) if abs(one.sigma) > DISAGREE]
    others = [one.named.id for one in found.effects if one.named.family not in WEIGHED]
    then = {one.name: one.sigma for one in against(data, found)} if odd and others else {}
    return tuple(f"{one.text}{_settled(then.get(one.name), others)}" for one in odd)


def _settled(sigma: float | None, effects: list[str]) -> str:
    """What effects of the measurement make of a contradiction; nothing where none was found."""
    if sigma is None:
        return ""
    return f"; with {', '.join(effects)} they {'agree' if abs(sigma) < DISAGREE else 'still disagree'}"


def against(data: Study, at: Candidate) -> tuple[Against, ...]:
    """Every fact about an article that was on the shaker, beside what the campaigns alone say at the fit of `at`."""
    every = (*data.model.effects, *at.effects)
    facts = [fact for fact in data.facts(every) if isinstance(fact, ArticleFact)]
    return tuple(one for article in dict.fromkeys(fact.of.article for fact in facts) for one in _of(data, at, article, facts))


def _of(data: Study, at: Candidate, article: str, facts: list[ArticleFact]) -> Iterator[Against]:
    every = (*data.model.effects, *at.effects)
    freed = (*every, *_ten(every))
    if not any(one.tested.carried.standing.article == article for one in data.made):
        return
    made = tuple(one.with_effects(freed if one.tested.carried.standing.article == article else every) for one in data.made)
    problem = Problem(made).thinned()
    known = {one.name for one in at.fit.parameters}
    free = [one for one in problem.parameters if one.name in known or one.name.startswith(FAMILY)]
    cost = cost_of(problem, free, FLOOR, at.fit.by_name)
    x = cost.at({**{one.name: 0.0 for one in free}, **at.fit.by_name})
    whole, _, _ = cost.total(x)
    for fact in facts:
        if fact.of.article == article:
            about = {f"{FAMILY}:{name}" for name, weight in zip(PARAMETERS, fact.weights, strict=True) if weight}
            moving = [k for k, name in enumerate(cost.names) if name in known or name in about]
            C = inverse(whole.matrix[np.ix_(moving, moving)])
            y = x.copy()
            y[moving] -= C @ whole.gradient[moving]
            own = fact.with_effects(freed)
            here = {one.name: one.start for one in own.parameters} | at.fit.by_name | dict(zip(cost.names, y, strict=True))
            z, slopes = own.residual(here)
            s = np.array([slopes.get(cost.names[k], 0.0) for k in moving])
            yield _against(own, z, float(s @ C @ s))


def _ten(every: tuple[Added, ...]) -> tuple[Added, ...]:
    there = {one.named.id for one in every}
    named = (Named(family=FAMILY, targets=(name,), values={"": 0.0}) for name in PARAMETERS)
    return tuple(Added(named=one) for one in named if one.id not in there)


def _against(fact: ArticleFact, z: float, variance: float) -> Against:
    return Against(
        name=fact.name,
        measured=fact.value,
        measured_sd=fact.deviation,
        said=fact.value + z * fact.deviation,
        said_sd=float(np.sqrt(variance)) * fact.deviation,
        unit=UNITS[int(np.argmax(np.abs(fact.weights)))],
        sigma=z / float(np.sqrt(1 + variance)),
    )


# Effects of a pendulum among the candidates of a diagnosis with campaigns: what the swings among its facts say of each.
#
# The period goes with the square of an amplitude, a damping or a distance: at none a straight line sees nothing of them, and a
# fit that begins there stays there. So their evidence is the integral over their size
# (`validation.diagnose.classical`), the body being what the fit has made of it, and the fit begins at the size that it
# finds.


def of_swings(data: Study) -> tuple[Added, ...]:
    """Effects of a pendulum that could act on a swing among the facts of `data`, each at a plausible size."""
    return pendulum_candidates(_swings(data, ()))


def told(data: Study, at: Candidate, menu: Sequence[Added]) -> list[tuple[Added, Weighed]]:
    """Each of `menu`, at the size that it would have on top of the candidate `at`, with what the swings say of it."""
    every = (*data.model.effects, *at.effects)
    of = _independent(observed(_swings(data, every), every))
    wanted = {one.named.id for one in menu}
    return [_told(of, one) for one in candidates(of.facts, every) if one.id in wanted]


def advised(data: Study, at: Candidate, ids: Sequence[str]) -> tuple[Advice, ...]:
    """Measurements on swings and balances that would tell the effects `ids`, tried on top of the candidate `at`, apart."""
    every = (*data.model.effects, *at.effects)
    of = observed(_swings(data, every), every)
    answers = answering(of, [one for one in candidates(of.facts, every) if one.id in ids])
    tried = judged(answers, of.left, of.precision, of.of_period).tried
    return advised_measurements(of, [one for one in tried if one.helps])


def _told(of: ObservedFacts, one: ClassicalCandidate) -> tuple[Added, Weighed]:
    answer = curve(partial(shifted, of, one.added), one.low, one.high)
    found = weighed(answer, one.size.plausible, of.left, inverse_covariance(of.covariance))
    named = replace(one.added.named, values={one.size.key: found.value})
    return replace(one.added, named=named), found


def _independent(of: ObservedFacts) -> ObservedFacts:
    """As a fit takes them: what tolerances of swings have in common is not in it."""
    return replace(of, covariance=np.diag(np.diag(of.covariance)))


def _swings(data: Study, effects: Sequence[Added]) -> list[ArticleFact]:
    return [one for one in data.facts(effects) if isinstance(one, ArticleFact) and one.swing is not None]
