"""What a search did: the fits of one step, and which of them was taken."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from validation.diagnosing.accepting import Standing, standing
from validation.diagnosing.bench import Bench, Hypothesis
from validation.diagnosing.dictionary import reaches
from validation.diagnosing.menu import is_resonator
from validation.diagnosing.refitting import stands_out
from validation.diagnosing.screened import Screened
from validation.effects.worth import ALIKE, worth
from validation.models.model import Added


@dataclass(frozen=True, eq=False, kw_only=True)
class Tried:
    """A candidate and its fit.

    Attributes
    ----------
    id : of the effect
    hypothesis : with it
    evidence : [nats] against the hypothesis without it
    standing : of the fit
    """

    id: str
    hypothesis: Hypothesis
    evidence: float
    standing: Standing

    @property
    def added(self) -> Added:
        """The effect, at the size that the fit found."""
        return self.hypothesis.effects[-1]

    @property
    def family(self) -> str:
        """Of the effect."""
        return self.added.named.family


@dataclass(frozen=True, eq=False, kw_only=True)
class Round:
    """One step forward.

    Attributes
    ----------
    at : where it began
    standing : there
    screened : all candidates, the most promising first
    tried : those that were fitted, the most evidence first
    added : id of what was accepted; empty for nothing
    gone : ids of resonators that a fit drove out of the band of the data
    again : id of an effect that was accepted before and asked once more; `added` is it, or stands in its place. Else empty
    """

    at: Hypothesis
    standing: Standing
    screened: tuple[Screened, ...]
    tried: tuple[Tried, ...]
    added: str
    gone: tuple[str, ...] = ()
    again: str = ""


def judged(at: Hypothesis, there: Hypothesis) -> Tried:
    """The fit `there` with one effect more than `at`."""
    evidence = there.fit.log_evidence - at.fit.log_evidence
    return Tried(id=there.effects[-1].named.id, hypothesis=there, evidence=evidence, standing=standing(there.fit, there.problem))


def ranked(tried: Sequence[Tried]) -> list[Tried]:
    """The best fit of each candidate, the most evidence first."""
    by_id: dict[str, Tried] = {}
    for one in sorted(tried, key=lambda each: -each.evidence):
        by_id.setdefault(one.id, one)
    return list(by_id.values())


def stays(bench: Bench, one: Tried) -> bool:
    """Whether a fit left the effect what it is: not a resonator so far from the data that it is a spring or a mass."""
    return not is_resonator(one.added.named) or reaches(bench, one.added.named)


def enough(one: Tried) -> bool:
    """Whether a fit may give its name: it brings what its family is asked for, and its size is more than none."""
    return one.evidence >= worth(one.family) and stands_out(one.hypothesis)


def alike(of: Round) -> tuple[Tried, ...]:
    """The explanations of a round that are as good as its best, the best first."""
    if not of.tried:
        return ()
    best = of.tried[0]
    return tuple(
        one for one in of.tried if one.evidence >= best.evidence - ALIKE and (one.standing.null or not best.standing.null)
    )
