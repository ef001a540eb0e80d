"""Which measurement would tell the explanations apart, and how surely: every test of the menu thought through for each of them.

Were explanation i true, at the size that it was found to have, the measurements made and the new one would be what it says; the
evidence of every explanation on these, without noise, is what is to be expected. The gain of a test is that of the true one
against the mean of the others, and the mean of that over the explanations, each as probable as it is now.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import chebyshev

from geometry.arrays import Array
from geometry.errors import BadInput
from identification.quality import NORMAL_95
from validation.diagnosing.classical.curve import DEGREE, Curve
from validation.diagnosing.classical.judged import Tried
from validation.diagnosing.classical.menu import Trial, menu, period_per_inertia
from validation.diagnosing.classical.observed import Observed, inverse, observed, shifted
from validation.diagnosing.classical.weighed import evidence
from validation.diagnosing.diagnosis import Advice
from validation.diagnosing.practical import said
from validation.effects.worth import ALIKE
from validation.prediction.inputs import covariance

MOST = 6
"""Explanations that are told apart at most, the best of each family first."""

SURE = 30.0
"""Nats beyond which nobody is surer."""

WORTH_WHILE = 1.0
"""Nats below which a test is not worth the work."""

NAMED = 3
"""Explanations whose answer stands in the words of a test."""


@dataclass(frozen=True, eq=False, kw_only=True)
class _Thought:
    """A test thought through.

    Attributes
    ----------
    trial : of the menu
    curves : by explanation what measurements and test say of every size
    covariance : (n, n) of measurements and test
    """

    trial: Trial
    curves: tuple[Curve, ...]
    covariance: Array


def advised(of: Observed, rivals: Sequence[Tried], progress: Callable[[float], None] | None = None) -> tuple[Advice, ...]:
    """The tests that tell `rivals` apart, the most telling first; of a single one, those that add most to its evidence."""
    if not rivals:
        return ()
    chosen = _various(rivals)[:MOST]
    now = _Thought(trial=Trial(text=""), curves=tuple(one.curve for one in chosen), covariance=np.array(of.covariance))
    before = _gains(_evidence(chosen, now))
    advice, trials = [], menu(of)
    for k, trial in enumerate(trials, start=1):
        if (one := _thought(of, chosen, trial)) is not None:
            advice.append(_advice(of, chosen, one, before))
        if progress is not None:
            progress(k / len(trials))
    return tuple(sorted((one for one in advice if one.gain > WORTH_WHILE), key=lambda one: -one.gain))


def _various(rivals: Sequence[Tried]) -> list[Tried]:
    """The best of every family first: places of one are much alike."""
    families = [one.candidate.added.named.family for one in rivals]
    first = [one for k, one in enumerate(rivals) if families[k] not in families[:k]]
    return [*first, *(one for one in rivals if one not in first)]


def _thought(of: Observed, rivals: Sequence[Tried], trial: Trial) -> _Thought | None:
    """`trial` by every one of `rivals`; None where one of them has no answer to it."""
    more = observed(trial.facts, of.own)
    try:
        curves = tuple(_longer(one, more, trial) for one in rivals)
    except (BadInput, ValueError):
        return None
    every = covariance([fact.spread for fact in (*of.facts, *trial.facts)])
    n, m = len(every), len(trial.told)
    C = np.zeros((n + m, n + m))
    C[:n, :n], C[n:, n:] = every, np.diag(np.square(list(trial.told.values())))
    return _Thought(trial=trial, curves=curves, covariance=C)


def _longer(one: Tried, more: Observed, trial: Trial) -> Curve:
    """The curve of an explanation with what it says of the test behind it."""
    points = chebyshev.chebpts1(DEGREE + 1)
    sizes = 0.5 * (one.curve.low + one.curve.high) + 0.5 * (one.curve.high - one.curve.low) * points
    family = one.candidate.added.named.family
    told = np.array([[size * (name == family) for name in trial.told] for size in sizes]).reshape(len(sizes), len(trial.told))
    values = np.concatenate([shifted(more, one.candidate.added, sizes), told], axis=1)
    coefficients = np.concatenate([one.curve.coefficients, chebyshev.chebfit(points, values, DEGREE)], axis=1)
    return Curve(low=one.curve.low, high=one.curve.high, coefficients=coefficients)


def _advice(of: Observed, rivals: Sequence[Tried], one: _Thought, before: Array) -> Advice:
    told = _evidence(rivals, one)
    now = np.array([rival.found.evidence for rival in rivals])
    share = np.exp(now - now.max())
    least = [row[k] - np.delete(row, k).max(initial=-np.inf) for k, row in enumerate(told)]
    return Advice(
        test=f"{one.trial.text}{_figures(of, rivals, one)}",
        gain=float(share @ (_gains(told) - before) / share.sum()),
        separates=tuple(rival.id for rival, apart in zip(rivals, least, strict=True) if apart > ALIKE and len(rivals) > 1),
    )


def _gains(told: Array) -> Array:
    """(k,) of every explanation, were it true: evidence against the mean of the others, `SURE` at most; alone against none."""
    if len(told) == 1:
        return np.asarray(told[0])
    others = [np.logaddexp.reduce(np.delete(row, k)) - np.log(len(row) - 1) for k, row in enumerate(told)]
    return np.asarray(np.clip(np.diag(told) - np.array(others), -SURE, SURE))


def _evidence(rivals: Sequence[Tried], of: _Thought) -> Array:
    """(k, k) were the first true, of the second, without noise."""
    precision = inverse(of.covariance)
    pairs = list(zip(rivals, of.curves, strict=True))
    told = [
        [evidence(curve, rival.answering.plausible, left, precision) for rival, curve in pairs] for left in _truths(rivals, of)
    ]
    return np.array(told)


def _truths(rivals: Sequence[Tried], of: _Thought) -> list[Array]:
    """By explanation what would be left of measurements and test by the model without it."""
    return [-curve.at(np.array([rival.found.value]))[0] for rival, curve in zip(rivals, of.curves, strict=True)]


def _figures(of: Observed, rivals: Sequence[Tried], one: _Thought) -> str:
    """By how much the new period would differ from the model's, by each of the explanations, and what tolerances see."""
    if not one.trial.facts or one.trial.facts[0].swing is None:
        return ""
    n, C = len(of.facts), one.covariance
    per = period_per_inertia(one.trial.facts[0])
    told = [f"{-per * left[n]:+.2%} if it is {rival.id}" for rival, left in zip(rivals, _truths(rivals, one), strict=True)]
    more = f" and {len(told) - NAMED} more" if len(told) > NAMED else ""
    own = float(np.sqrt(max(C[n, n] - C[n, :n] @ np.linalg.solve(C[:n, :n], C[:n, n]), 0.0)))
    seen = f"tolerances that it does not share with what was measured are ± {said(NORMAL_95 * per * own, '1')}"
    return f": its period is then off the model's by {', '.join(told[:NAMED])}{more}; {seen} of it"
