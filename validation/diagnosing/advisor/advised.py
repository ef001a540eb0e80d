"""`advised`: which test of the menu would tell explanations apart, with the evidence that it is expected to give.

Every test of the menu is forecast by a straight line, which takes a tenth of a second; the best are then gone through as a fit
would, until enough of them keep what they promise.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from validation.diagnosing.advisor.comparing import either, told
from validation.diagnosing.advisor.following import following
from validation.diagnosing.advisor.imagined import imagined
from validation.diagnosing.advisor.knowledge import Knowledge, knowledge
from validation.diagnosing.advisor.menu import menu
from validation.diagnosing.advisor.offer import Offer
from validation.diagnosing.advisor.planned import Planned, template
from validation.diagnosing.bench import Bench, Hypothesis
from validation.diagnosing.diagnosis import Advice
from validation.effects.catalogue import FAMILIES
from validation.effects.worth import ALIKE
from validation.engine.descent import BREAKDOWNS
from validation.models.model import Added

DECIDED = 20.0
"""Nats beyond which more decide no more: then the quicker test comes first."""

AT_MOST = 3
"""Tests that are named."""

TRIED = 6
"""Tests that are gone through at most."""

CERTAIN = 0.95
"""Probability of one of two explanations from which nobody asks what the test would read by the other."""

LOOKING = 0.6
"""Share of the work that the forecast of the whole menu is."""

Progress = Callable[[float], None]


@dataclass(frozen=True, eq=False, kw_only=True)
class Forecast:
    """What is expected of one test.

    Attributes
    ----------
    offer : the test
    gains : by other explanation, nats between it and the first
    """

    offer: Offer
    gains: tuple[float, ...]

    @property
    def apart(self) -> tuple[int, ...]:
        """Which of the others it tells from the first."""
        return tuple(k for k, gain in enumerate(self.gains) if gain >= ALIKE)

    @property
    def gain(self) -> float:
        """Of those that it tells apart, the least; else the most of all."""
        return min((self.gains[k] for k in self.apart), default=max(self.gains))

    @property
    def rank(self) -> tuple[float, float, float, float]:
        """The smaller the better: how many it tells apart, how surely, how quickly."""
        return -len(self.apart), -min(self.gain, DECIDED), self.offer.hours, -self.gain


def advised(bench: Bench, rivals: Sequence[Hypothesis], progress: Progress | None = None) -> tuple[Advice, ...]:
    """Tests that would tell `rivals` apart, the best first.

    Parameters
    ----------
    rivals : explanations of the data of `bench`, the best first; of a single one, tests that would confirm it are looked for

    Returns
    -------
    those from which `ALIKE` nats or more are expected between the first and at least one other. First come those that
    tell most of them apart, then those of more evidence, up to `DECIDED`, then the quicker ones. Where there is none, one of gain
    0 says so.
    """
    tell = progress or (lambda share: None)
    if len(rivals) == 1:
        return _confirming(bench, rivals[0], tell)
    first, *others = (knowledge(one) for one in rivals)
    own = suspected(rivals)
    return chosen(bench, first, others, [worded(one) for one in own], _all(own), tell)


def _confirming(bench: Bench, one: Hypothesis, progress: Progress) -> tuple[Advice, ...]:
    """Tests that would tell a single explanation from nothing, and from what it could be mistaken for."""
    if not one.effects:
        return ()
    others = imagined(bench, one)
    effects = tuple(added for each in others for added in each.known.effects if added.named.id == each.id)
    names = [one.effects[-1].named.id, *(each.id for each in others)]
    return chosen(bench, knowledge(one), [each.known for each in others], names, (one.effects[-1], *effects), progress)


def chosen(
    bench: Bench,
    first: Knowledge,
    others: Sequence[Knowledge],
    names: Sequence[str],
    effects: Sequence[Added],
    progress: Progress,
) -> tuple[Advice, ...]:
    """The best tests between `first` and `others`, whose `names` stand in the advice; `effects` are those that are in doubt."""
    offers = tuple(menu([template(one, first) for one in bench.made], effects, bench.facts(first.effects)))
    looked = []
    for k, offer in enumerate(offers):
        looked.append(_looked(offer, first, others))
        progress(LOOKING * (k + 1) / len(offers))
    ranked = sorted((one for one in looked if one is not None), key=lambda one: one.rank)
    useful = _kept(ranked, first, others, lambda share: progress(LOOKING + (1 - LOOKING) * share))
    return tuple(_advice(one, names) for one in useful if one.apart) or (_none(useful, effects, names),)


def _looked(offer: Offer, first: Knowledge, others: Sequence[Knowledge]) -> Forecast | None:
    """What a straight line expects; None where a model breaks down in the test."""
    try:
        return Forecast(offer=offer, gains=told(offer, first, others))
    except BREAKDOWNS:
        return None


def _kept(ranked: Sequence[Forecast], first: Knowledge, others: Sequence[Knowledge], progress: Progress) -> list[Forecast]:
    """The best of each kind, gone through; in the end the best of all first, though it tell nothing apart."""
    kept: dict[str, Forecast] = {}
    tried = 0
    for one in ranked:
        enough = sum(bool(each.apart) for each in kept.values()) >= AT_MOST or tried >= TRIED
        if enough or (kept and not one.apart):
            break
        if one.offer.kind not in kept:
            found = _followed(one, first, others)
            tried += 1
            progress(tried / TRIED)
            kept |= {} if found is None else {one.offer.kind: found}
    return sorted(kept.values(), key=lambda one: one.rank)


def _followed(one: Forecast, first: Knowledge, others: Sequence[Knowledge]) -> Forecast | None:
    """The forecast as a fit would see it; of other measurements than campaigns it is that already."""
    test = one.offer.test
    if test is None:
        return one
    try:
        return replace(one, gains=tuple(_between(test, one.offer, first, other) for other in others))
    except BREAKDOWNS:
        return None


def _between(test: Planned, offer: Offer, first: Knowledge, other: Knowledge) -> float:
    probability = first.odds(other)
    here = following(test, offer, first, other)
    return here if probability > CERTAIN else either(probability, here, following(test, offer, other, first))


def _advice(one: Forecast, names: Sequence[str]) -> Advice:
    separates = (names[0], *(names[1 + k] for k in one.apart))
    return Advice(test=one.offer.words, gain=one.gain, separates=separates, hours=one.offer.hours)


def _none(tried: Sequence[Forecast], effects: Sequence[Added], names: Sequence[str]) -> Advice:
    """That no test helps, which comes nearest, and what the catalogue knows of a laboratory."""
    apart = f"no test of the menu is expected to tell {_listed(names)} apart"
    nearest = f"; the nearest to it, with {tried[0].gain:.1f} nats: {_small(tried[0].offer.words)}" if tried else ""
    ways = dict.fromkeys(FAMILIES[one.named.family].confirmed_by for one in effects)
    said = "; ".join(way for way in ways if way)
    return Advice(test=f"{apart}{nearest}{'. What would: ' + said if said else ''}", gain=0.0)


def suspected(rivals: Sequence[Hypothesis]) -> list[tuple[Added, ...]]:
    """Of every hypothesis the effects that not all of them have."""
    common = set.intersection(*({one.named.id for one in rival.effects} for rival in rivals)) if len(rivals) > 1 else set()
    return [tuple(one for one in rival.effects if one.named.id not in common) for rival in rivals]


def worded(effects: Sequence[Added]) -> str:
    """Effects by their ids."""
    return " with ".join(one.named.id for one in effects) or "nothing"


def _all(own: Sequence[Sequence[Added]]) -> tuple[Added, ...]:
    return tuple({one.named.id: one for effects in own for one in effects}.values())


def _listed(names: Sequence[str]) -> str:
    return " and ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)


def _small(words: str) -> str:
    return words[:1].lower() + words[1:]
