"""Effects with what they make of the measurements, ready to be weighed; those of the article that move nothing are left out."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from validation.diagnosing.classical.candidates import Candidate
from validation.diagnosing.classical.curve import Curve, curve
from validation.diagnosing.classical.observed import Observed, shifted

ANSWERS = 0.1
"""Standard deviations that a plausible size of an effect must move some measurement by, to be looked at at all."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Answering:
    """An effect and its answer."""

    candidate: Candidate
    curve: Curve

    @property
    def id(self) -> str:
        """``family:target``."""
        return self.candidate.id

    @property
    def plausible(self) -> float:
        """Standard deviation of its size beforehand, SI."""
        return self.candidate.size.plausible


def answering(
    of: Observed, candidates: Sequence[Candidate], progress: Callable[[float], None] | None = None
) -> tuple[Answering, ...]:
    """Those of `candidates` that move the measurements `of`, and all of the pendulum."""
    return tuple(_answering(of, candidates, progress or (lambda share: None)))


def _answering(of: Observed, candidates: Sequence[Candidate], tell: Callable[[float], None]) -> Iterator[Answering]:
    for k, candidate in enumerate(candidates, start=1):
        answer = curve(partial(shifted, of, candidate.added), candidate.low, candidate.high)
        one = Answering(candidate=candidate, curve=answer)
        if candidate.of_pendulum or _moves(one, of):
            yield one
        tell(k / len(candidates))


def _moves(one: Answering, of: Observed) -> bool:
    """Whether a plausible size of it moves anything; of one that has either sign, the two of them apart."""
    size = min(one.plausible, one.curve.high)
    if one.curve.low >= 0:
        moved = one.curve.at(np.array([size]))
    else:
        size = min(size, -one.curve.low)
        moved = np.diff(one.curve.at(np.array([-size, size])), axis=0) / 2
    return bool(np.max(np.abs(moved) / of.deviation) > ANSWERS)
