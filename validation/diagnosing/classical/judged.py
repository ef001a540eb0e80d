"""Is something missing, and what: the verdict on classical measurements, by the rules of every diagnosis.

An effect is accepted while its evidence exceeds `WORTH` and what it leaves is what tolerances leave; where none does, two at once
are tried. All that lie within `ALIKE` of the best, and leave as little, are one class that these data cannot tell apart.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from geometry.arrays import Array
from validation.diagnosing.classical.candidates import Candidate
from validation.diagnosing.classical.curve import Curve, curve
from validation.diagnosing.classical.observed import Observed, shifted
from validation.diagnosing.classical.pairs import both
from validation.diagnosing.classical.weighed import Weighed, weighed
from validation.diagnosing.diagnosis import AMBIGUOUS, MISSING, NOTHING, SEVERAL, UNKNOWN
from validation.ladders.verdict import WORTH

ALIKE = 5.0
"""Nats of evidence within which two explanations are not told apart."""

UNLIKELY, SURE = 1e-3, 1e-5
"""Probability of a misfit below which an explanation explains too little, and below which what nothing is worth naming for is
unknown all the same."""

ANSWERS = 0.1
"""Standard deviations that a plausible size of an effect must move some measurement by, to be looked at at all."""

NO_SIZE = 5e-3
"""Plausible sizes below which the best is none."""

PAIR, OF_PAIRS = 2, 8
"""Effects at once, and of how many, the best by themselves, pairs are tried."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Tried:
    """An effect, its answer, and what the measurements say of it."""

    candidate: Candidate
    curve: Curve
    found: Weighed

    @property
    def id(self) -> str:
        """``family:target``."""
        return self.candidate.id

    @property
    def helps(self) -> bool:
        """Whether any size of it is better than none."""
        return abs(self.found.best) > NO_SIZE * self.candidate.size.plausible


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


def judged(of: Observed, candidates: Sequence[Candidate], progress: Callable[[float], None] | None = None) -> Judged:
    """What `of` says of `candidates`."""
    precision = of.precision
    tried = sorted(_all_tried(of, candidates, precision, progress), key=lambda one: -one.found.evidence)
    chi2, n = float(of.left @ precision @ of.left), len(of.left)
    good = [one for one in tried if explains(one, n)]
    best = good[0] if good else None
    pair: tuple[Tried, ...] = ()
    alike: list[Tried] = []
    if best is not None and best.found.evidence > WORTH:
        alike = [one for one in good if best.found.evidence - one.found.evidence < ALIKE]
        verdict = MISSING if len(alike) == 1 else AMBIGUOUS
    elif chance(chi2, n) > (SURE if good else UNLIKELY):
        verdict = NOTHING
    else:
        pair = _pair(tried, of.left, precision)
        verdict = SEVERAL if pair else UNKNOWN
    return Judged(
        verdict=verdict,
        tried=tuple(tried),
        alike=tuple(alike),
        pair=pair,
        measurements=n,
        chi2=chi2,
        probability=chance(chi2, n),
    )


def tried(of: Observed, candidate: Candidate, precision: Array) -> Tried:
    """`candidate` beside the measurements."""
    answer = curve(lambda sizes: shifted(of, candidate.added, sizes), candidate.low, candidate.high)
    return Tried(candidate=candidate, curve=answer, found=weighed(answer, candidate.size.plausible, of.left, precision))


def chance(chi2: float, degrees: int) -> float:
    """Probability of a larger `chi2` by chance; 1 where nothing is left to be judged."""
    from scipy.special import chdtrc

    return float(chdtrc(degrees, chi2)) if degrees > 0 else 1.0


def _all_tried(
    of: Observed, candidates: Sequence[Candidate], precision: Array, progress: Callable[[float], None] | None
) -> Iterator[Tried]:
    for k, each in enumerate(candidates, start=1):
        if _answers(one := tried(of, each, precision), of):
            yield one
        if progress is not None:
            progress(k / len(candidates))


def _answers(one: Tried, of: Observed) -> bool:
    """Whether a plausible size of it moves anything; of one that has either sign, the two of them apart."""
    size = min(one.candidate.size.plausible, one.curve.high)
    if one.curve.low >= 0:
        moved = one.curve.at(np.array([size]))
    else:
        size = min(size, -one.curve.low)
        moved = np.diff(one.curve.at(np.array([-size, size])), axis=0) / 2
    return bool(np.max(np.abs(moved) / of.deviation) > ANSWERS)


def explains(one: Tried, measurements: int) -> bool:
    """Whether what an effect leaves by itself is what tolerances leave."""
    return chance(one.found.chi2, measurements - 1) > UNLIKELY


def _pair(tried: Sequence[Tried], left: Array, precision: Array) -> tuple[Tried, ...]:
    """The best two at once that leave what tolerances leave, each as it is beside the other; nothing where no two do."""
    found = []
    for two in combinations(tried[:OF_PAIRS], 2) if len(left) > PAIR else ():
        curves, plausible = (two[0].curve, two[1].curve), (two[0].candidate.size.plausible, two[1].candidate.size.plausible)
        beside = both(curves, plausible, left, precision)
        if beside[0].evidence > WORTH and chance(beside[0].chi2, len(left) - PAIR) > UNLIKELY:
            found.append(tuple(replace(one, found=each) for one, each in zip(two, beside, strict=True)))
    return max(found, key=lambda pair: pair[0].found.evidence, default=())
