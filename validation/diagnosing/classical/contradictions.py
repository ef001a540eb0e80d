"""Measurements that contradict one another, whatever the model: two swings about one axis, two weights of one article."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

import numpy as np

from identification.quality import NORMAL_95
from validation.diagnosing.classical.nouns import Beside
from validation.diagnosing.classical.observed import Observed
from validation.diagnosing.practical import said
from validation.pendulum_corrections import CompoundSwing, RopeSwing
from validation.prediction.facts import ArticleFact

DISAGREE = 4.0
"""Standard deviations from which two measurements of one quantity contradict each other."""

MASS = "mass"


def contradictions(of: Observed, beside: tuple[Beside, ...]) -> tuple[str, ...]:
    """Each in a sentence."""
    return (*_of_one_quantity(of, beside), *_of_masses(of))


def _of_one_quantity(of: Observed, beside: tuple[Beside, ...]) -> Iterator[str]:
    for i, j in combinations(range(len(of.facts)), 2):
        one, other = of.facts[i], of.facts[j]
        if one.of.article != other.of.article or not np.allclose(one.weights, other.weights):
            continue
        apart = one.value - other.value
        sd = float(np.sqrt(max(of.covariance[i, i] + of.covariance[j, j] - 2 * of.covariance[i, j], 1e-300)))
        if abs(apart) > DISAGREE * sd:
            values = " and ".join(said(each.value, beside[i].unit, 4) for each in (one, other))
            yield (
                f"{one.name} and {other.name} contradict each other: {values}, "
                f"{abs(apart) / sd:.0f} standard deviations apart{_differing(one, other)}"
            )


def _differing(one: ArticleFact, other: ArticleFact) -> str:
    """In what two swings differ, as far as the file says."""
    if one.swing is None or other.swing is None:
        return ""
    differ = [name for name, (a, b) in _conditions(one, other).items() if a != b]
    return f"; they differ in {' and '.join(differ)}" if differ else "; the file says of nothing in which they differ"


def _conditions(one: ArticleFact, other: ArticleFact) -> dict[str, tuple[object, object]]:
    swings = [each.swing for each in (one, other) if each.swing is not None]
    told: list[dict[str, object]] = []
    for swing in swings:
        pendulum, said_of = swing.pendulum, swing.stated
        sizes: dict[str, object] = {"suspension": type(pendulum).__name__}
        if isinstance(pendulum, RopeSwing):
            sizes |= {"length of the ropes": pendulum.length.nominal_value}
            sizes |= {"radius": abs(pendulum.s1.nominal_value * pendulum.s2.nominal_value)}
        if isinstance(pendulum, RopeSwing | CompoundSwing):
            sizes |= {MASS: pendulum.mass.nominal_value}
        for key in ("amplitude", "damping", "rope_mass"):
            stated = getattr(said_of, key)
            sizes[key.replace("_", " ")] = None if stated is None else stated.nominal_value
        told.append(sizes)
    return {name: (told[0].get(name), told[1].get(name)) for name in {**told[0], **told[1]}}


def _of_masses(of: Observed) -> Iterator[str]:
    """A mass that a pendulum file states beside the one that was weighed."""
    weighed = [fact for fact in of.facts if fact.weights[0] == 1]
    stated = dict.fromkeys(
        (fact.of.article, each.value, each.deviation) for fact in of.facts for each in fact.spread if each.name == MASS
    )
    for fact in weighed:
        for article, value, deviation in stated:
            sd = float(np.hypot(fact.deviation, deviation))
            if article == fact.of.article and abs(fact.value - value) > DISAGREE * sd:
                yield (
                    f"{fact.name} says {said(fact.value, 'kg', 4)}, and beside it {said(value, 'kg', 4)} ± "
                    f"{said(NORMAL_95 * deviation, 'kg')} stands as the mass, {abs(fact.value - value) / sd:.0f} standard "
                    "deviations apart"
                )
