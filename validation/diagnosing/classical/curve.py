"""`Curve`: what an effect makes of all measurements as a smooth function of its size."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import chebyshev

from geometry.arrays import Array
from geometry.errors import BadInput

DEGREE = 10
"""Of the polynomial; effects are of second degree in their size or near it, the error falls by an order with each."""

NARROWER, TRIES = 0.7, 12
"""How an interval shrinks whose end no pendulum and no body can have."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Curve:
    """An interpolation.

    Attributes
    ----------
    low, high : sizes between which it holds
    coefficients : (`DEGREE` + 1, n) of Chebyshev polynomials on them
    """

    low: float
    high: float
    coefficients: Array

    def at(self, sizes: Array) -> Array:
        """(k, n) what is predicted more, SI, at `sizes` (k,)."""
        scaled = (2 * np.asarray(sizes) - self.low - self.high) / (self.high - self.low)
        return np.asarray(chebyshev.chebval(scaled, self.coefficients).T)


def curve(answer: Callable[[Array], Array], low: float, high: float) -> Curve:
    """Of ``answer(sizes (k,)) -> (k, n)`` between `low` and `high`, or as near to them as `answer` goes.

    Raises
    ------
    BadInput : nothing near 0 can be answered.
    """
    for _ in range(TRIES):
        nodes = 0.5 * (low + high) + 0.5 * (high - low) * chebyshev.chebpts1(DEGREE + 1)
        try:
            values = answer(nodes)
        except (BadInput, ValueError, FloatingPointError):
            low, high = NARROWER * low, NARROWER * high
            continue
        coefficients = np.asarray(chebyshev.chebfit(chebyshev.chebpts1(DEGREE + 1), values, DEGREE), dtype=np.float64)
        return Curve(low=low, high=high, coefficients=coefficients)
    raise BadInput(
        source="pendulum",
        problem="its lengths leave no room for the smallest effect",
        remedy="Check lengths, radii and mass in the measurement file",
    )
