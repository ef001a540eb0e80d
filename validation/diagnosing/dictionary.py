"""Resonators of every frequency: a dictionary over frequency and damping, by products that one derivative gives.

While its mass m is small, a resonator on a coordinate adds to the dynamic mass, times what a mass held there would add,

    m s(omega) ,        s = (omega_a² + 2 i zeta omega_a omega) / (omega_a² - omega² + 2 i zeta omega_a omega) :

one column does for all frequencies.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from math import sqrt

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray
from validation.diagnosing.bench import Bench, Hypothesis
from validation.diagnosing.menu import TINY, TINY_AT
from validation.diagnosing.screened import Screened
from validation.effects.identifiers import Named
from validation.engine.screening import Screen, Told, screened
from validation.models.model import Added

DAMPING = (0.005, 0.02, 0.08)

BEYOND = 1.15
"""Factor by which the dictionary goes beyond the band at either end."""

PER_OCTAVE = 24

OCCAM = 4.0
"""[nats] that three sizes which are known to a factor cost at least, where the data tell them well."""


ALIKE = 0.02
"""Share of what a resonator does that the model's modes must leave to it: where they do as it does, a straight line lies."""


def looked_up(bench: Bench, at: Hypothesis, menu: Sequence[Added]) -> list[Screened]:
    """Each resonator of `menu` at its best frequency and damping."""
    problem = bench.problem((*at.effects, *menu))
    names = {f"{one.named.id}[m]": one for one in menu}
    of = screened(problem, at.fit, [name for name in names if name in problem.by_name])
    frequency = _frequencies(of)
    places = [(float(f), zeta) for zeta in DAMPING for f in frequency]
    by_set = {k: np.stack([_shape(one.frequency, f, zeta) for f, zeta in places]) for k, one in enumerate(of.products)}
    return [found for name, one in names.items() if (found := _best(of, name, one, places, by_set)) is not None]


def smallest_mass(told: Told, evidence: float) -> float:
    """[kg] whose expected evidence is `evidence` [nats], by what the data tell of next to none; infinite for nothing."""
    return TINY * sqrt(2 * (evidence + OCCAM)) * told.deviation


def reaches(bench: Bench, named: Named) -> bool:
    """Whether `named` resonates where the data of `bench` are; far below them it is a spring to the ground, far above a mass."""
    low, high = _band(one.measured.frequency for one in bench.made)
    return low <= named.values["f"] <= high


def _best(
    of: Screen, name: str, added: Added, places: Sequence[tuple[float, float]], shapes: dict[int, ComplexArray]
) -> Screened | None:
    if not any(name in one.names for one in of.products):
        return None
    told = of.shapes(name, shapes)
    sound = [one.estimate > 0 and one.share > ALIKE for one in told]
    gains = np.array([0.5 * one.estimate**2 * one.information if good else 0.0 for one, good in zip(told, sound, strict=True)])
    best = int(np.argmax(gains))
    f, zeta = places[best]
    mass = max(TINY * told[best].estimate, TINY)  # the offset is that of ln m, at the mass TINY
    named = replace(added.named, values={"m": mass, "f": f, "zeta": zeta})
    usual = int(np.argsort([one.information for one in told])[len(told) // 2])
    return Screened(
        added=replace(added, named=named),
        evidence=float(gains[best]) - OCCAM,
        told=told[best],
        plausible=np.inf,
        usual=told[usual],
    )


def _frequencies(of: Screen) -> Array:
    low, high = _band(one.frequency for one in of.products)
    return np.geomspace(low, high, max(int(PER_OCTAVE * np.log2(high / low)), 2))


def _band(frequencies: Iterable[Array]) -> tuple[float, float]:
    known = tuple(frequencies)
    return min(float(one[0]) for one in known) / BEYOND, max(float(one[-1]) for one in known) * BEYOND


def _answer(frequency: Array, own: float, zeta: float) -> ComplexArray:
    spring = own**2 + 2j * zeta * own * frequency
    return np.asarray(spring / (spring - frequency**2))


def _shape(frequency: Array, own: float, zeta: float) -> ComplexArray:
    """The answer of a resonator over that of those of the menu, (m,)."""
    return np.asarray(_answer(frequency, own, zeta) / _answer(frequency, TINY_AT["f"], TINY_AT["zeta"]))
