"""`advised`: which test of the menu would tell explanations apart, with the evidence that it is expected to give."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from validation.diagnosing.advisor.comparing import told
from validation.diagnosing.advisor.knowledge import Knowledge, knowledge
from validation.diagnosing.advisor.menu import menu
from validation.diagnosing.advisor.offer import Offer
from validation.diagnosing.advisor.planned import template
from validation.diagnosing.bench import Bench, Hypothesis
from validation.diagnosing.classes import WITHIN
from validation.diagnosing.diagnosis import Advice
from validation.effects.catalogue import FAMILIES
from validation.engine.descent import BREAKDOWNS
from validation.models.model import Added

DECIDED = 20.0
"""Nats beyond which more decide no more: then the quicker test comes first."""

AT_MOST = 5
"""Tests that are named."""

Progress = Callable[[float], None]


def advised(bench: Bench, rivals: Sequence[Hypothesis], progress: Progress | None = None) -> tuple[Advice, ...]:
    """Tests that would tell `rivals` apart, the best first.

    Parameters
    ----------
    rivals : explanations of the data of `bench`, the best first

    Returns
    -------
    those from which `WITHIN` nats or more are expected between the first and at least one other. First come those that tell most
    of them apart, then those of more evidence, up to `DECIDED`, then the quicker ones. Where there is none, one of gain 0 says
    so.
    """
    first, *others = (knowledge(one) for one in rivals)
    if not others:
        return ()
    own = suspected(rivals)
    names = [worded(one) for one in own]
    offers = tuple(menu([template(one, first) for one in bench.made], _all(own), bench.facts(first.effects)))
    found = []
    for k, offer in enumerate(offers):
        found.append(_advice(offer, first, others, names))
        if progress is not None:
            progress((k + 1) / len(offers))
    useful = sorted((one for one in found if one is not None), key=_rank)
    return tuple(useful[:AT_MOST]) or (_none(own, names),)


def suspected(rivals: Sequence[Hypothesis]) -> list[tuple[Added, ...]]:
    """Of every hypothesis the effects that not all of them have."""
    common = set.intersection(*({one.named.id for one in rival.effects} for rival in rivals)) if len(rivals) > 1 else set()
    return [tuple(one for one in rival.effects if one.named.id not in common) for rival in rivals]


def worded(effects: Sequence[Added]) -> str:
    """Effects by their ids."""
    return " with ".join(one.named.id for one in effects) or "nothing"


def _all(own: Sequence[Sequence[Added]]) -> tuple[Added, ...]:
    return tuple({one.named.id: one for effects in own for one in effects}.values())


def _advice(offer: Offer, first: Knowledge, others: Sequence[Knowledge], names: Sequence[str]) -> Advice | None:
    """What is expected of one test; None where it tells too little, or a model breaks down in it."""
    try:
        gains = told(offer, first, others)
    except BREAKDOWNS:
        return None
    apart = [k for k, gain in enumerate(gains) if gain >= WITHIN]
    if not apart:
        return None
    separates = (names[0], *(names[1 + k] for k in apart))
    return Advice(test=offer.words, gain=float(min(gains[k] for k in apart)), separates=separates, hours=offer.hours)


def _rank(one: Advice) -> tuple[float, float, float, float]:
    return -len(one.separates), -min(one.gain, DECIDED), one.hours, -one.gain


def _none(own: Sequence[Sequence[Added]], names: Sequence[str]) -> Advice:
    """That no test helps, and what the catalogue knows of a laboratory."""
    ways = dict.fromkeys(FAMILIES[one.named.family].confirmed_by for effects in own for one in effects)
    said = "; ".join(way for way in ways if way)
    return Advice(test=f"no test of the menu tells {_listed(names)} apart{': ' + said if said else ''}", gain=0.0)


def _listed(names: Sequence[str]) -> str:
    return " and ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)
