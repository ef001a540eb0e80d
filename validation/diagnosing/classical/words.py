"""The answer on classical measurements in sentences."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from validation.diagnosing.classical.judged import LARGE, Judged, Tried
from validation.diagnosing.classical.nouns import Beside
from validation.diagnosing.diagnosis import AMBIGUOUS, MISSING, NOTHING, SEVERAL
from validation.diagnosing.practical import said, significant
from validation.effects.catalogue import FAMILIES
from validation.pendulum_file import HONEST

PLAUSIBLE = 1.0
"""Plausible sizes up to which an effect is nothing special."""

NOTEWORTHY, RARE, FREQUENT = 1e-2, 1e-6, 0.5
"""Probabilities of a misfit: from which it is said, and below and above which no figure is."""


def answer(found: Judged, facts: Sequence[Beside]) -> str:
    """The verdict, what it rests on, and what one number cannot say."""
    parts = [_verdict(found, facts), _measured(found, facts)]
    if sum(bool(fact.period) for fact in facts) == 1:
        parts.append(HONEST)
    elif len(facts) == 1:
        parts.append("One number cannot say where a difference comes from, nor that two of them cancel.")
    return " ".join(part for part in parts if part)


def _verdict(found: Judged, facts: Sequence[Beside]) -> str:
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


def _measured(found: Judged, facts: Sequence[Beside]) -> str:
    worst = max(facts, key=lambda fact: abs(fact.sigma))
    chance = (
        ""
        if len(facts) == 1
        else f" Chi² of all {len(facts)} is {found.chi2:.3g} (by chance so much in {_often(found.probability)})."
    )
    return f"{deviation(worst)}.{chance}"


def deviation(of: Beside) -> str:
    """How far a measurement is from the model."""
    if of.period:
        how = "longer" if of.period_shift > 0 else "shorter"
        return f"The {of.quantity} is {abs(100 * of.period_shift):.2g} % {how} than the model's, {_sigmas(of)}"
    by = said(abs(of.predicted - of.measured), of.unit)
    how = "more" if of.measured > of.predicted else "less"
    return f"The {of.quantity} is {by} {how} than the model's, {_sigmas(of)}"


def _sigmas(of: Beside) -> str:
    return f"{abs(of.sigma):.1f} standard deviations of its tolerance"


def _often(probability: float) -> str:
    if probability < RARE:
        return "less than one case in a million"
    return f"one case of {1 / probability:.2g}" if probability < FREQUENT else "most cases"


def listed(alike: Sequence[Tried]) -> str:
    """Explanations with their sizes; places of one family together."""
    families: dict[str, list[Tried]] = {}
    for one in alike:
        named = one.candidate.added.named
        families.setdefault(named.family if named.family == "point-mass" else one.id, []).append(one)
    told = [sized(many[0]) if len(many) == 1 else _together(name, many) for name, many in families.items()]
    return "; ".join(told)


def _together(family: str, many: Sequence[Tried]) -> str:
    values = np.array([one.found.value for one in many])
    unit = many[0].candidate.size.unit
    low, high = said(float(values.min()), unit), said(float(values.max()), unit)
    size = low if low == high else f"{low} to {high}"
    return f"{family} at any of {len(many)} places ({size})"


def sized(one: Tried) -> str:
    """An effect with its size."""
    found, unit = one.found, one.candidate.size.unit
    return f"{one.id} of {said(found.value, unit)} ({said(found.low, unit)} to {said(found.high, unit)})"


def sentence(one: Tried) -> str:
    """What it means."""
    named = one.candidate.added.named
    return FAMILIES[named.family].sentence.format(target=named.target, targets=" and ".join(named.targets))


def needed(one: Tried, fits: bool) -> str:
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
