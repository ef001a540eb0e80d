"""Is something missing, and what: the verdict on classical measurements, by the rules of every diagnosis.

An effect is accepted where its evidence exceeds `WORTH` and what it leaves is what tolerances leave; where none is, two at once
are tried. All that lie within `ALIKE` of the best, and aliases of a possible size that leave as little as it does, are one class
that these data cannot tell apart.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from geometry.arrays import Array
from validation.diagnosing.classical.answering import Answering
from validation.diagnosing.classical.candidates import Candidate
from validation.diagnosing.classical.curve import Curve
from validation.diagnosing.classical.pairs import both
from validation.diagnosing.classical.weighed import Weighed, weighed
from validation.diagnosing.diagnosis import AMBIGUOUS, MISSING, NOTHING, SEVERAL, UNKNOWN
from validation.effects.worth import ALIKE, WORTH

SAME = 2.0
"""Chi² by which an alias may fit worse than the best."""

LARGE = 3.0
"""Plausible sizes up to which a size is possible."""

UNLIKELY, SURE = 1e-3, 1e-5
"""Probability of a misfit below which an explanation explains too little, and below which what nothing is worth naming for is
unknown all the same."""

NO_SIZE = 5e-3
"""Plausible sizes below which the best is none."""

PAIR, OF_PAIRS = 2, 8
"""Effects at once, and of how many, the best by themselves, pairs are tried."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Tried:
    """An effect, its answer, and what the measurements say of it."""

    answering: Answering
    found: Weighed

    @property
    def id(self) -> str:
        """``family:target``."""
        return self.answering.id

    @property
    def candidate(self) -> Candidate:
        """What it is."""
        return self.answering.candidate

    @property
    def curve(self) -> Curve:
        """What it makes of the measurements."""
        return self.answering.curve

    @property
    def helps(self) -> bool:
        """Whether any size of it is better than none."""
        return abs(self.found.best) > NO_SIZE * self.answering.plausible


@dataclass(frozen=True, eq=False, kw_only=True)
class Judged:
    """A verdict.

    Attributes
    ----------
    verdict : of `validation.diagnosing.diagnosis.VERDICTS`
    tried : all effects, the best first
    alike : those that the measurements cannot tell apart
    pair : two at once where one is not enough; empty where it is, or where no two are
    measurements : how many numbers were measured
    chi2 : of the model without them
    probability : of so large a chi2 by chance
    """

    verdict: str
    tried: tuple[Tried, ...]
    alike: tuple[Tried, ...]
    pair: tuple[Tried, ...]
    measurements: int
    chi2: float
    probability: float


def judged(answers: Sequence[Answering], left: Array, precision: Array, of_period: Array | None = None) -> Judged:
    """What measurements say of effects that give these `answers`.

    Parameters
    ----------
    left : (n,) predicted - measured, SI
    precision : (n, n) inverse of the covariance of the measured
    of_period : (n,) 1 / the moment of inertia [kg m²] that was measured by a period, 0 of any other number
    """
    tried = tuple(sorted((_tried(one, left, precision) for one in answers), key=lambda one: -one.found.evidence))
    chi2, n = float(left @ precision @ left), len(left)
    good = [one for one in tried if explains(one, n)]
    alike = tuple(one for one in good if _is_worth(good[0]) and _alike(one, good[0]))
    pair: tuple[Tried, ...] = ()
    if alike:
        verdict = MISSING if len(alike) == 1 else AMBIGUOUS
    elif chance(chi2, n) > (SURE if good else UNLIKELY):
        verdict = NOTHING
    else:
        pair = _pair(tried, left, precision, np.zeros(n) if of_period is None else of_period)
        verdict = SEVERAL if pair else UNKNOWN
    return Judged(verdict=verdict, tried=tried, alike=alike, pair=pair, measurements=n, chi2=chi2, probability=chance(chi2, n))


def _tried(one: Answering, left: Array, precision: Array) -> Tried:
    found = weighed(one.curve, one.plausible, left, precision)
    return Tried(answering=one, found=found)


def _alike(one: Tried, best: Tried) -> bool:
    """Whether an explanation is as good as the best: as probable, or an alias that does the same at a size that is possible."""
    alias = one.found.chi2 - best.found.chi2 < SAME and abs(one.found.best) <= LARGE * one.answering.plausible
    return best.found.evidence - one.found.evidence < ALIKE or alias


def _is_worth(one: Tried) -> bool:
    return one.found.evidence > WORTH


def chance(chi2: float, degrees: int) -> float:
    """Probability of a larger `chi2` by chance; 1 where nothing is left to be judged."""
    from scipy.special import chdtrc

    return float(chdtrc(degrees, chi2)) if degrees > 0 else 1.0


def explains(one: Tried, measurements: int) -> bool:
    """Whether what an effect leaves by itself is what tolerances leave."""
    return chance(one.found.chi2, measurements - 1) > UNLIKELY


def _pair(tried: Sequence[Tried], left: Array, precision: Array, of_period: Array) -> tuple[Tried, ...]:
    """The best two at once that leave what tolerances leave, each as it is beside the other; nothing where no two do."""
    found = []
    for two in combinations(tried[:OF_PAIRS], 2) if len(left) > PAIR else ():
        curves, plausible = (two[0].curve, two[1].curve), (two[0].answering.plausible, two[1].answering.plausible)
        shared = of_period * all(one.candidate.of_pendulum for one in two)
        beside = both(curves, plausible, left, precision, shared)
        if beside[0].evidence > WORTH and chance(beside[0].chi2, len(left) - PAIR) > UNLIKELY:
            found.append(tuple(replace(one, found=each) for one, each in zip(two, beside, strict=True)))
    return max(found, key=lambda pair: pair[0].found.evidence, default=())
