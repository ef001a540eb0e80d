"""A diagnosis from weights, centres of gravity and periods alone, without any campaign.

The likelihood is that of a few Gaussian numbers with the tolerances that they have in common; an effect's size is integrated
over what is plausible of it. One period is one number: all effects of a pendulum, and the article itself, are exact aliases
there, and the answer says so, with the size that each would need and the measurement that would decide.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from geometry.errors import BadInput
from validation.diagnosing.classical import words
from validation.diagnosing.classical.advised import advised
from validation.diagnosing.classical.answering import answering
from validation.diagnosing.classical.candidates import candidates, pendulum_candidates
from validation.diagnosing.classical.contradictions import contradictions
from validation.diagnosing.classical.detectable import detectable
from validation.diagnosing.classical.judged import UNLIKELY, Judged, Tried, chance, explains, judged
from validation.diagnosing.classical.menu import period_per_inertia
from validation.diagnosing.classical.nouns import UNITS, Beside, Needed, SwingAnswer
from validation.diagnosing.classical.observed import Observed, observed
from validation.diagnosing.classical.readings import readings
from validation.diagnosing.diagnosis import AMBIGUOUS, MISSING, NOTHING, SEVERAL, UNKNOWN, Advice, Cause, Leftover, Size
from validation.effects.worth import ALIKE, WORTH
from validation.models.model import Model
from validation.prediction import swung
from validation.prediction.facts import ArticleFact, facts

__all__ = ["only_classical", "pendulum_candidates"]

Progress = Callable[[float], None]

TRYING = 0.5
"""Share of the work that is done when every effect has been tried."""

OTHERS = 15.0
"""Nats behind the best within which another explanation is worth a test that excludes it."""


STANDS_OUT = 3.0
"""Standard deviations from which a measurement is named."""


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
    against = contradictions(of, shown)
    return SwingAnswer(
        title=model.title or model.article,
        source=model.source,
        verdict=verdict.verdict,
        text=words.answer(verdict, shown),
        accepted=_accepted(verdict),
        ranking=tuple(_cause(one, verdict) for one in verdict.tried),
        equivalence_class=tuple(one.id for one in verdict.alike),
        advice=(*advised(of, _rivals(verdict), lambda share: tell(TRYING + (1 - TRYING) * share)), *_otherwise(verdict, shown)),
        leftover=_leftover(of, verdict, against),
        detectable=detectable(verdict.tried, of.covariance),
        facts=shown,
        needed=tuple(_needed(one, verdict) for one in verdict.tried),
        readings=readings(of),
        chi2=verdict.chi2,
        measurements=len(of.facts),
        remarks=(*against, *_switched_off(of, verdict)),
        settings={"threshold_nats": WORTH, "class_nats": ALIKE, "misfit_probability": UNLIKELY},
    )


def _beside(fact: ArticleFact, left: float) -> Beside:
    of_swing = fact.swing is not None
    period = float(fact.swing.pendulum.period.nominal_value) if fact.swing is not None else 0.0
    return Beside(
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


def _cause(one: Tried, of: Judged) -> Cause:
    degrees = of.measurements - (len(of.pair) if one in of.pair else 1)
    size, found = one.candidate.size, one.found
    named = replace(one.candidate.added.named, values={size.key: found.value})
    return Cause(
        named=named,
        sizes=(Size(key=size.key, value=found.value, unit=size.unit, low=found.low, high=found.high),),
        evidence=found.evidence,
        misfit=found.chi2 / max(degrees, 1),
        null=chance(found.chi2, degrees) > UNLIKELY,
    )


def _accepted(of: Judged) -> tuple[Cause, ...]:
    """Of several that cannot be told apart none."""
    chosen = of.alike if of.verdict == MISSING else of.pair if of.verdict == SEVERAL else ()
    return tuple(_cause(one, of) for one in chosen)


def _rivals(of: Judged) -> tuple[Tried, ...]:
    """What a next measurement should tell apart; where nothing is missing, what may hide."""
    if of.verdict == NOTHING:
        hidden = [one for one in of.tried if one.candidate.of_pendulum]
        return tuple(hidden or of.tried)
    if of.verdict == AMBIGUOUS:
        return of.alike
    best = of.tried[0].found.evidence if of.tried else 0.0
    return tuple(one for one in of.tried if explains(one, of.measurements) and one.found.evidence > best - OTHERS)


def _switched_off(of: Observed, verdict: Judged) -> Iterator[str]:
    """A size that a file states, and does not correct for, of what explains the measurements."""
    named = {one.candidate.added.named.family for one in (*verdict.alike, *verdict.pair)}
    for family in swung.TERMS.keys() & named:
        stated = [fact.name for fact in of.facts if fact.swing is not None and getattr(fact.swing.stated, swung.TERMS[family])]
        if stated:
            term = swung.TERMS[family].replace("_", "-")
            yield f"the {term} is stated in {', '.join(stated)} and not corrected for: [corrections] {term} = true takes it off"


def _otherwise(of: Judged, beside: Sequence[Beside]) -> tuple[Advice, ...]:
    """What can be done without a figure for it: what the catalogue says would confirm it, or once more what is odd."""
    if of.verdict in (MISSING, SEVERAL):
        return tuple(Advice(test=f"to confirm {one.id}: {one.confirmed_by}", gain=0.0) for one in _accepted(of))
    if of.verdict == UNKNOWN:
        worst = max(beside, key=lambda one: abs(one.sigma))
        return (Advice(test=f"measure the {worst.quantity} again, and note what differs from the others", gain=0.0),)
    return ()


def _needed(one: Tried, of: Judged) -> Needed:
    fits = explains(one, of.measurements)
    return Needed(
        id=one.id,
        value=one.found.best,
        unit=one.candidate.size.unit,
        plausible=one.candidate.size.plausible,
        possible=one.helps and not one.found.at_end,
        fits=fits,
        evidence=one.found.evidence,
        text=words.needed(one, fits),
    )


def _leftover(of: Observed, verdict: Judged, against: Sequence[str]) -> Leftover | None:
    """What no effect explains."""
    if verdict.verdict != UNKNOWN:
        return None
    sigma = np.abs(of.left) / of.deviation
    worst = [of.facts[k].name for k in np.argsort(-sigma) if sigma[k] > STANDS_OUT]
    where = (
        f"what is left stands in {', '.join(worst)}" if worst else "no measurement by itself stands out, all of them together do"
    )
    return Leftover(text="; ".join((where, *against)), looks_like="irregular")
