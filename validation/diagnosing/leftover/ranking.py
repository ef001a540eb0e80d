"""Every explanation that can be put in words, with what it would explain of a leftover, the best first."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from geometry.arrays import Array
from validation.diagnosing.bench import Hypothesis
from validation.diagnosing.leftover.axes import Loaded
from validation.diagnosing.leftover.channels import heard
from validation.diagnosing.leftover.courses import Course, resonance
from validation.diagnosing.leftover.families import families, loaded
from validation.diagnosing.leftover.places import HEARD, Family, Place
from validation.diagnosing.leftover.spanning import Spanned, spanned, spans
from validation.diagnosing.leftover.tangents import Answers, Gains, Swallowing, following, gains
from validation.engine.prediction import Offsets
from validation.engine.screening import Products

NEAR, STEPS, TIMES = 0.04, 17, (0.35, 0.6, 1.0, 1.7, 3.0)
"""Share of its frequency to either side, steps, and factors of its damping ratio, in which a resonance is looked for again."""

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
    sources : families that it is of, and where it stands in each
    """

    place: Place
    course: Course
    data_set: str
    gain: float
    size: float
    sources: tuple[tuple[Family, int], ...] = field(default=(), repr=False)


@dataclass(frozen=True, eq=False, kw_only=True)
class Told:
    """What one data set answers to places of one kind.

    Attributes
    ----------
    key : of the same places and courses in other data sets
    data_set : its name
    courses, places : (k,) and (q,)
    answers : (k, q)
    family : that answers; None where there is none for every course
    """

    key: str
    data_set: str
    courses: tuple[Course, ...]
    places: tuple[Place, ...]
    answers: Answers
    family: Family | None = None


def ranked(hypothesis: Hypothesis, data: Sequence[Swallowing]) -> list[Explanation]:
    """All explanations of what `hypothesis` leaves in its `data`, the best first."""
    offsets = {**hypothesis.problem.start, **hypothesis.fit.by_name}
    told: dict[str, list[Told]] = {}
    matrices: list[Spanned] = []
    for one in data:
        loads = loaded(one, offsets)
        matrices += [] if loads is None else [spanned(loads)]
        for each in _told(one, offsets, loads):
            told.setdefault(each.key, []).append(each)
    slope = data[0].slope
    found = [one for alike in told.values() for one in _explanations(alike, slope)]
    return sorted([*found, *_spanning(matrices, slope)], key=lambda one: -one.gain)


def _told(of: Swallowing, offsets: Offsets, loads: Loaded | None) -> Iterator[Told]:
    name = of.of.name
    for family in families(of, offsets, loads):
        key = f"{family.places[0].kind} {family.places[0].to}"
        yield Told(key=key, data_set=name, family=family, courses=family.courses, places=family.places, answers=family.answers())
    for k, (places, course, answers) in enumerate(heard(of, offsets)):
        yield Told(key=f"{HEARD} {k}", data_set=name, courses=(course,), places=places, answers=answers)


def _spanning(matrices: Sequence[Spanned], slope: Array) -> Iterator[Explanation]:
    """Of all data sets together, and of each alone."""
    for alike in (matrices, *([one] for one in matrices if len(matrices) > 1)):
        for one in spans(alike, slope):
            alone = alike[0].data_set if len(alike) < len(matrices) else ""
            yield Explanation(place=one.place, course=one.course, data_set=alone, gain=one.gain, size=one.size)


def _explanations(alike: Sequence[Told], slope: Array) -> Iterator[Explanation]:
    """The best of one kind of place, in each data set alone and in all together."""
    for one in alike:
        yield from _best([one], one.places, gains([one.answers], slope), one.data_set if len(alike) > 1 else "")
    if len(alike) > 1:
        places = tuple(dict.fromkeys(place for one in alike for place in one.places))
        yield from _best(alike, places, gains([_spread(one, places) for one in alike], slope), "")


def _spread(told: Told, places: tuple[Place, ...]) -> Answers:
    """Its answers to all of `places`, none to those that are not there."""
    if told.places == places:
        return told.answers
    at, of = [places.index(place) for place in told.places], told.answers
    score, own = (np.zeros((len(of.score), len(places))) for _ in range(2))
    swallowed = np.zeros((*score.shape, of.swallowed.shape[-1]))
    score[:, at], own[:, at], swallowed[:, at] = of.score, of.own, of.swallowed
    return Answers(score=score, own=own, swallowed=swallowed)


def _best(alike: Sequence[Told], places: Sequence[Place], found: Gains, data_set: str) -> Iterator[Explanation]:
    courses = alike[0].courses
    for at in np.argsort(-found.gain, axis=None)[:BEST]:
        k, q = (int(one) for one in np.unravel_index(int(at), found.gain.shape))
        yield Explanation(
            place=places[q],
            course=courses[k],
            data_set=data_set,
            gain=float(found.gain[k, q]),
            size=float(found.size[k, q]),
            sources=tuple((one.family, one.places.index(places[q])) for one in alike if one.family and places[q] in one.places),
        )


def refined(one: Explanation) -> Explanation:
    """A resonance at its own frequency and damping, not at that of the grid; anything else as it is."""
    f, zeta = one.course.frequency, one.course.ratio
    if f is None or zeta is None or not one.sources:
        return one
    tried = [resonance(float(f * (1 + step)), zeta * times) for step in np.linspace(-NEAR, NEAR, STEPS) for times in TIMES]
    found = gains([_following(family, q, tried) for family, q in one.sources], one.sources[0][0].slope)
    best = int(np.argmax(found.gain[:, 0]))
    return replace(one, course=tried[best], gain=float(found.gain[best, 0]), size=float(found.size[best, 0]))


def _following(family: Family, q: int, courses: Sequence[Course]) -> Answers:
    of, omega = family.products, 2 * np.pi * family.products.frequency
    alone = Products(
        frequency=of.frequency,
        names=of.names[q : q + 1],
        residual=of.residual[:, q : q + 1],
        others=of.others[:, q : q + 1],
        square=of.square[:, q : q + 1],
    )
    return following(alone, np.stack([course.of(omega) for course in courses]), family.root)
