"""Where a fit begins that would not find its way: the best place of a grid over the sizes that it cannot find from afar.

A resonator's frequency has no slope where the resonator weighs nothing, and the slope of a modulus far beside its resonance
points anywhere. So the sizes that are named take every value of a grid, a dictionary; at each place the other free parameters
take the best step of the quadratic model there, and its gain says how promising the place is. Of the most promising the true
cost decides, and the point from which it began stays where none is better.

What a resonator does grows with its mass. Such an amplitude is not on the grid: at every place it begins at next to nothing, the
quadratic model says how many times as much the data want, and what is known of its logarithm does not count, because that is no
step of a logarithm.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import product

import numpy as np
import numpy.typing as npt

from geometry.errors import BadInput
from geometry.keys import nearest
from validation.engine.cost import Cost, cost_of
from validation.engine.descent import BREAKDOWNS, Progress
from validation.engine.fit import PLAIN_FLOOR
from validation.engine.parameter import PLAIN, SENSOR
from validation.engine.prediction import Offsets
from validation.engine.problem import Problem

FINE, COARSE = 41, 9
"""Places along a single size, and along each of several."""

REACH = 2.0
"""Prior standard deviations to either side that a grid covers."""

NEXT_TO_NOTHING = -7.0
"""Offset of a small amplitude from where it stands: a thousandth."""

PROMISING = 5
"""Places whose true cost is looked at."""


def start(
    problem: Problem,
    names: Sequence[str],
    *,
    kinds: Sequence[str] = PLAIN,
    base: Offsets | None = None,
    places: Mapping[str, npt.ArrayLike] | None = None,
    amplitude: str = "",
    floor: float = PLAIN_FLOOR,
    progress: Progress | None = None,
) -> dict[str, float]:
    """Offsets of the parameters of `kinds` from which a fit finds its way.

    Parameters
    ----------
    names : of the parameters on the grid
    base : offsets from which to begin, such as a parent's solution; those of the model where nothing is said
    places : by name the offsets of the grid; evenly over `REACH` prior deviations about the base where nothing is said
    amplitude : name of a logarithmic parameter in whose value the data are linear while it is small; none by default
    progress : told the share of the work that is done, 0 to 1

    Raises
    ------
    BadInput : a name of no free parameter, or one of which nothing is known beforehand without its `places`.
    """
    tell = progress or (lambda share: None)
    cost = cost_of(problem, problem.free(kinds), floor, plain=SENSOR not in kinds)
    here = {name: x for name, x in {**problem.start, **(base or {})}.items() if name in cost.names}
    _require_known(cost, names, places or {})
    grid = list(_grid(cost, names, here, places or {}))
    found: list[tuple[float, dict[str, float]]] = []
    small = {amplitude: here[amplitude] + NEXT_TO_NOTHING} if amplitude else {}
    for done, place in enumerate(grid):
        found += _promise(_unpriced(cost, amplitude), {**here, **place, **small}, names, amplitude)
        tell((done + 1) / (len(grid) + PROMISING))
    best = sorted(found, key=lambda one: one[0])[:PROMISING]
    ends = [here, *(offsets for _, offsets in best)]
    return min(ends, key=lambda offsets: _cost(cost, offsets))


def _grid(cost: Cost, names: Sequence[str], here: Offsets, places: Mapping[str, npt.ArrayLike]) -> Iterator[dict[str, float]]:
    known = {one.name: one.tolerance for one in cost.free}
    count = FINE if len(names) == 1 else COARSE
    along = [
        np.asarray(places[name], dtype=np.float64).ravel()
        if name in places
        else here[name] + known[name] * np.linspace(-REACH, REACH, count)
        for name in names
    ]
    for values in product(*along):
        yield dict(zip(names, map(float, values), strict=True))


def _unpriced(cost: Cost, amplitude: str) -> Cost:
    """`cost` without what is known beforehand of the `amplitude`."""
    return replace(cost, free=tuple(replace(one, tolerance=np.inf) if one.name == amplitude else one for one in cost.free))


def _promise(cost: Cost, place: Offsets, names: Sequence[str], amplitude: str) -> list[tuple[float, dict[str, float]]]:
    """The cost that the quadratic model at `place` promises, and where it is; nothing where the model breaks down."""
    x = cost.at(place)
    try:
        whole, _, _ = cost.total(x)
    except BREAKDOWNS:
        return []
    moving = np.array([name not in names for name in cost.names])
    step = np.zeros(len(x))
    step[moving] = -np.linalg.lstsq(whole.matrix[np.ix_(moving, moving)], whole.gradient[moving], rcond=None)[0]
    promised = whole.cost + float(whole.gradient @ step) + 0.5 * float(step @ whole.matrix @ step)
    if amplitude:
        k = cost.names.index(amplitude)
        if step[k] <= 0:
            return []
        step[k] = np.log1p(step[k])
    there = np.clip(x + step, *cost.bounds)
    return [(promised, dict(zip(cost.names, map(float, there), strict=True)))]


def _cost(cost: Cost, offsets: Offsets) -> float:
    try:
        return cost.total(cost.at(offsets))[0].cost
    except BREAKDOWNS:
        return np.inf


def _require_known(cost: Cost, names: Sequence[str], places: Mapping[str, npt.ArrayLike]) -> None:
    known: dict[str, float] = {one.name: one.tolerance for one in cost.free}
    for name in names:
        if name not in known:
            remedy = nearest(name, known) or "Free it"
            raise BadInput(source="start", field=name, problem="is no free parameter of this problem", remedy=remedy)
        if name not in places and not np.isfinite(known[name]):
            raise BadInput(source="start", field=name, problem="nothing is known of it beforehand", remedy="Give its `places`")
