"""Every explanation that can be put in words, with what it would explain of a leftover, the best first."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from validation.diagnosing.bench import Hypothesis
from validation.diagnosing.leftover.courses import Course
from validation.diagnosing.leftover.places import HEARD, Place, families, heard
from validation.diagnosing.leftover.tangents import Answers, Swallowing, gains, swallowing
from validation.diagnosing.leftover.whitened import Whitened, whitened

BEST = 4
"""Explanations of one kind of place and one scope that are kept."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Explanation:
    """One place that goes with frequency in one way.

    Attributes
    ----------
    place, course : where, and how it goes with frequency
    data_set : where it acts alone; empty where it acts in all
    gain : [nats]
    size : coefficient of the course
    """

    place: Place
    course: Course
    data_set: str
    gain: float
    size: float


@dataclass(frozen=True, eq=False, kw_only=True)
class Told:
    """What one data set answers to places of one kind.

    Attributes
    ----------
    key : of the same places and courses in other data sets
    data_set : its name
    courses, places : (k,) and (q,)
    answers : (k, q)
    """

    key: str
    data_set: str
    courses: tuple[Course, ...]
    places: tuple[Place, ...]
    answers: Answers


def ranked(hypothesis: Hypothesis, data: Sequence[Whitened] | None = None) -> list[Explanation]:
    """All explanations of what `hypothesis` leaves, the best first; `data` as `whitened` gives them with derivatives."""
    offsets = {**hypothesis.problem.start, **hypothesis.fit.by_name}
    seen = whitened(hypothesis, derivatives=True) if data is None else data
    told: dict[str, list[Told]] = {}
    for one in swallowing(list(seen), hypothesis.fit):
        for each in _told(one, offsets):
            told.setdefault(each.key, []).append(each)
    found = [one for alike in told.values() for one in _explanations(alike)]
    return sorted(found, key=lambda one: -one.gain)


def _told(of: Swallowing, offsets: Mapping[str, float]) -> Iterator[Told]:
    name = of.of.name
    for family in families(of, offsets):
        kind = family.places[0].kind
        yield Told(key=kind, data_set=name, courses=family.courses, places=family.places, answers=family.answers())
    for k, (places, course, answers) in enumerate(heard(of, offsets)):
        yield Told(key=f"{HEARD} {k}", data_set=name, courses=(course,), places=places, answers=answers)


def _explanations(alike: Sequence[Told]) -> Iterator[Explanation]:
    """The best of one kind of place, in each data set alone and in all together."""
    for one in alike:
        yield from _best(one, one.places, [one.answers], one.data_set if len(alike) > 1 else "")
    if len(alike) > 1:
        places = tuple(dict.fromkeys(place for one in alike for place in one.places))
        yield from _best(alike[0], places, [_spread(one, places) for one in alike], "")


def _spread(told: Told, places: tuple[Place, ...]) -> Answers:
    """Its answers to all of `places`, none to those that are not there."""
    if told.places == places:
        return told.answers
    at, of = [places.index(place) for place in told.places], told.answers
    score, own = (np.zeros((len(of.score), len(places))) for _ in range(2))
    swallowed = np.zeros((*score.shape, of.swallowed.shape[-1]))
    score[:, at], own[:, at], swallowed[:, at] = of.score, of.own, of.swallowed
    return Answers(score=score, own=own, swallowed=swallowed)


def _best(told: Told, places: Sequence[Place], answers: Sequence[Answers], data_set: str) -> Iterator[Explanation]:
    found = gains(answers)
    for at in np.argsort(-found.gain, axis=None)[:BEST]:
        k, q = np.unravel_index(int(at), found.gain.shape)
        gain, size = float(found.gain[k, q]), float(found.size[k, q])
        yield Explanation(place=places[q], course=told.courses[k], data_set=data_set, gain=gain, size=size)
