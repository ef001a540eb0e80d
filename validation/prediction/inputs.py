"""What the tolerances of several facts have in common: one rope measured once is wrong by the same in every swing on it.

A tolerance that swings share does not blur what tells them apart. Inputs of one file are one where they were read once (the mass,
gravity, the torsion rod). A length that is written with the same figure and the same tolerance in several swings, or a mass in
several files, counts as one measurement too; times and readings of a balance are each a new one.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from geometry.arrays import Array
from identification.quality import NORMAL_95

if TYPE_CHECKING:
    from uncertainties import UFloat

MEASURED_ONCE = (
    *("mass", "gravity", "rope length", "s1", "s2", "radius", "arm", "position of rope 1", "position of rope 2"),
    *(f"position of the CoG ({axis})" for axis in "xyz"),
    *("known inertia", "rod mass", "rod length", "rod diameter", "period with the known rod"),
)
"""Names of inputs that are one measurement wherever they are written alike."""


@dataclass(frozen=True, kw_only=True)
class Input:
    """One input of a measurement.

    Attributes
    ----------
    name : as in budgets
    value, deviation : SI, and its standard deviation
    reading : what tells it from another one that is written alike; None for what is one measurement then
    """

    name: str
    value: float
    deviation: float
    reading: Hashable = None


Spread = Mapping[Input, float]
"""By input what one standard deviation of it makes of a result, signed, in the unit of the result."""


def spread(value: UFloat) -> Spread:
    """By input what it makes of `value`, of which tolerances are half-widths of 95 % intervals."""
    found: dict[Input, float] = {}
    for variable, slope in value.derivatives.items():
        one = _input(variable)
        found[one] = found.get(one, 0.0) + float(slope) * one.deviation
    return {one: part for one, part in found.items() if part}


def covariance(spreads: Sequence[Spread]) -> Array:
    """(n, n) of results with these `spreads`."""
    every = list(dict.fromkeys(one for each in spreads for one in each))
    parts = np.array([[each.get(one, 0.0) for one in every] for each in spreads]).reshape(len(spreads), len(every))
    return np.asarray(parts @ parts.T)


def _input(variable: object) -> Input:
    name, value = str(getattr(variable, "tag", "")), float(variable.nominal_value)  # type: ignore[attr-defined]
    sd = float(variable.std_dev) / NORMAL_95  # type: ignore[attr-defined]
    return Input(name=name, value=value, deviation=sd, reading=None if name in MEASURED_ONCE else variable)
