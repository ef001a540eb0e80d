"""What is told: all figures of the page, worked out once."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from geometry.errors import BadInput
from geometry.frames import Array
from table_2_parts.exact import Refined, recorded, refined
from table_2_parts.inference import Explanation, Found, covariance, everything, misfit
from table_2_parts.menu import MENU, entropy, information
from table_2_parts.published import DEVIATIONS
from table_2_parts.ways import STOPS, Way, answer, exact, ways
from validation.effects.catalogue import Named
from validation.effects.effect import COVER, FMD

SCALES = (1.0, 2.0, 3.0)
"""Factors on all tolerances: how careless the laboratory may have been."""

REFERENCES = (0.5, 1.0, 2.0)
"""[%], [mm] standard deviations of the reference."""

ASKED = 40
"""Explanations among which a measurement is to decide."""

SHOWN = 6
"""Single effects that are shown."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Alone:
    """Tolerances alone, by the way that does best.

    Attributes
    ----------
    way : it
    chi2 : of seven numbers
    probability : that chance does as badly
    scatter : (7,) standard deviations by the tolerances
    """

    way: Way
    chi2: float
    probability: float
    scatter: Array


@dataclass(frozen=True, eq=False, kw_only=True)
class Story:
    """All that is told.

    Attributes
    ----------
    elastic : by band, (7,) what elasticity that is not taken off makes, and the same a quarter turn from the reference
    alone : by factor on the tolerances and whether Clumod was turned
    mistake : the polarity or swap of channels that comes nearest, its chi² of seven numbers, and how many were tried
    singles : one effect with elasticity, Clumod as the reference has it; the most probable of each family
    found : with tolerances as they are
    pairs, triples, unturned : the best explanations of two and of three faults, and without the quarter turn, refined
    turn : the quarter turn alone, refined
    turned : posterior of the quarter turn, of two faults at most, by (factor on tolerances, error of the reference)
    doubt : [nats] entropy of the explanations among which the menu is to decide
    share : of the posterior that these have
    menu : [nats] information of each measurement on which explanation holds
    records : by name of an explanation (7,) from records; empty where nothing was simulated
    """

    elastic: Mapping[float, tuple[Array, Array]]
    alone: Mapping[tuple[float, bool], Alone]
    mistake: tuple[str, float, int]
    singles: tuple[Refined, ...]
    found: Found
    pairs: tuple[Refined, ...]
    triples: tuple[Refined, ...]
    unturned: tuple[Refined, ...]
    turn: Refined
    turned: Mapping[tuple[float, float], float]
    doubt: float
    share: float
    menu: Mapping[str, float]
    records: Mapping[str, Array]

    @property
    def leading(self) -> tuple[Refined, ...]:
        """All that are shown."""
        return (self.turn, *self.pairs, *self.triples, *self.unturned)


def told(*, records: bool = False) -> Story:
    """Everything, and with `records` two explanations in the time domain."""
    found = everything()
    pairs, triples, unturned, turn = (tuple(map(refined, chosen)) for chosen in _leading(found))
    asked = found.best(ASKED)
    probability = np.exp([one.log_posterior - found.total for one in asked])
    settings = {*((scale, 1.0) for scale in SCALES), *((1.0, reference) for reference in REFERENCES)}
    return Story(
        elastic={stop: (_nominal(stop, turned=False), _nominal(stop, turned=True)) for stop in STOPS},
        alone={(scale, turned): _alone(scale, turned=turned) for scale in SCALES for turned in (False, True)},
        mistake=_mistake(),
        singles=_singles(found),
        found=found,
        pairs=pairs,
        triples=triples,
        unturned=unturned,
        turn=turn[0],
        turned={of: _turned(everything(*of, most=2)) for of in sorted(settings)},
        doubt=entropy(probability / probability.sum()),
        share=float(probability.sum()),
        menu={name: information(asked, probability / probability.sum(), one) for name, one in MENU.items()},
        records={title(one.of): recorded(one) for one in (pairs[0], unturned[0])} if records else {},
    )


def title(of: Explanation) -> str:
    """What was wrong, in ids."""
    return " + ".join(of.names) or "tolerances alone"


def _leading(found: Found) -> tuple[tuple[Explanation, ...], ...]:
    """Of the quarter turn and one more fault, of it and two more, without it, and of it alone."""
    return (
        found.best(3, lambda one: one.chosen.shape[1] == 1 and one.of.way.turned),
        found.best(2, lambda one: one.chosen.shape[1] == 2 and one.of.way.turned),
        found.best(1, lambda one: not one.of.way.turned),
        found.best(1, lambda one: one.chosen.shape[1] == 0 and one.of.way.turned),
    )


def _mistake() -> tuple[str, float, int]:
    """Every wrong sign and every exchange of two alike channels, read in the band that elasticity fits best."""
    way = Way(stop=5.0)
    signs = [Named(family="polarity", targets=(one,), values={}) for one in (*COVER, *FMD)]
    swaps = [Named(family="channel-swap", targets=two, values={}) for of in (COVER, FMD) for two in combinations(of, 2)]
    V, found = covariance(answer(way)), dict[str, float]()
    for one in (*signs, *swaps):
        with suppress(BadInput):  # some leave no six motions that could be read
            off = DEVIATIONS - exact(way, [one])
            found[one.id] = float(off @ np.linalg.solve(V, off))
    name = min(found, key=lambda key: (round(found[key], 6), key))  # plugs opposite each other tie but for rounding
    return name, found[name], len(signs) + len(swaps)


def _singles(found: Found) -> tuple[Refined, ...]:
    """Of each family the most probable effect, by itself, the axes right; the best families first."""
    every = found.best(10_000, lambda one: one.chosen.shape[1] == 1 and not one.of.way.turned)
    families: dict[str, Explanation] = {}
    for one in every:
        families.setdefault(one.faults[0].named.family, one)
    return tuple(refined(one) for one in list(families.values())[:SHOWN])


def _nominal(stop: float, *, turned: bool) -> Array:
    return answer(Way(stop=stop, turned=turned)).nominal


def _alone(scale: float, *, turned: bool) -> Alone:
    from scipy.stats import chi2

    best = min(ways(turned), key=lambda way: misfit(answer(way), scale))
    off, of = misfit(answer(best), scale), answer(best)
    scatter = scale * np.sqrt(np.sum(of.tolerances**2, axis=1))
    return Alone(way=best, chi2=off, probability=float(chi2.sf(off, 7)), scatter=scatter)


def _turned(found: Found) -> float:
    return float(found.of_ways(lambda way: way.turned)[True])
