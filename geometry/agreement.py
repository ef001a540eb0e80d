"""Do inertias that were found by different routes agree, and what were they allowed to differ by?"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from geometry.arrays import Array, frozen
from geometry.inertia import PARAMETERS, UNITS, Inertia

ROUNDING = 1e-9
"""What exact routes may differ by, relative to the size of the body."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Agreement:
    """Whether the routes agree.

    Attributes
    ----------
    agree : every difference lies within its tolerance
    text : the verdict in a sentence
    difference : (10,) between the two routes that differ most, order and units of `PARAMETERS`, about the article's origin
    tolerance : (10,) what was allowed between these two
    excess : largest ratio of a difference to its tolerance; at most 1 when they agree
    """

    agree: bool
    text: str
    difference: Array
    tolerance: Array
    excess: float


def held_together(inertias: Mapping[str, Inertia], allowed: Mapping[str, Array]) -> Agreement:
    """The verdict on two or more routes: that of the pair which differs most, relative to what it may.

    Parameters
    ----------
    inertias : by route, all about the same origin
    allowed : by route, (10,) what it may be off by; a pair may differ by the larger of the two
    """
    verdicts = (
        _judged(f"{a} and {b}", np.abs(inertias[a].parameters - inertias[b].parameters), np.maximum(allowed[a], allowed[b]))
        for a, b in combinations(inertias, 2)
    )
    return max(verdicts, key=lambda verdict: verdict.excess)


def single(text: str) -> Agreement:
    """The verdict on one route, which nothing can contradict; `text` says why there is no other."""
    nothing = frozen(np.zeros(10), (10,), "nothing")
    return Agreement(agree=True, text=text, difference=nothing, tolerance=nothing, excess=0.0)


def rounding(inertia: Inertia) -> Array:
    """What exact routes may differ by: `ROUNDING` of each of the ten parameters about the origin (10,).

    The size of a parameter is that for a body of this mass and this radius of gyration about the origin.
    """
    radius = np.sqrt(np.trace(inertia.about(np.zeros(3)).tensor) / (2 * inertia.mass))
    return np.asarray(ROUNDING * inertia.mass * radius ** np.array([0, 1, 1, 1, 2, 2, 2, 2, 2, 2]))


def missing_mass(mass: float, reach: Array) -> Array:
    """What `mass` [kg], missing anywhere up to `reach` (3,) [m] from the origin takes off each parameter at most; (10,)."""
    x, y, z = reach
    return mass * np.array([1, x, y, z, y * y + z * z, x * x + z * z, x * x + y * y, x * y, x * z, y * z])


def _judged(pair: str, difference: Array, tolerance: Array) -> Agreement:
    ratio = difference / tolerance
    k = int(np.argmax(ratio))
    agree = bool(ratio[k] <= 1)
    relation = "agree" if agree else "disagree"
    what = f"{PARAMETERS[k]} about the origin"
    text = f"{pair} {relation}: {what} differs by {difference[k]:.2e} {UNITS[k]}, {tolerance[k]:.2e} {UNITS[k]} allowed"
    return Agreement(
        agree=agree,
        text=text,
        difference=frozen(difference, (10,), "difference"),
        tolerance=frozen(tolerance, (10,), "tolerance"),
        excess=float(ratio[k]),
    )
