"""The paper's Table 2 as seven numbers, and how sure each of them is taken to be.

The reference is a finite-element model whose own error nobody printed. Table 1 sets the same kind of model beside weighing and
pendulum: 0.36 % in mass, 0.3 mm in height, up to 1.03 % in moments of inertia. So 1 % and 1 mm are assumed here, one standard
deviation each, independent; to that comes the rounding of the printed digits, which matters for 0.75 kg m² against 0.77.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from geometry import routes
from geometry.articles import built_in
from geometry.frames import Array
from geometry.inertia import Inertia

NAMES = ("mass", "CoG x", "CoG y", "CoG z", "Θxx", "Θyy", "Θzz")
UNITS = ("%", "mm", "mm", "mm", "%", "%", "%")

DEVIATIONS = np.array([2.94, 0.39, -5.45, 13.01, 2.18, 15.50, -2.60])
"""(7,) in `UNITS`, identified less reference, as printed."""

REFERENCE = 1.0
"""Standard deviation of the reference, assumed: per cent of mass and moments, millimetres of the centre of gravity."""

PRINTED = np.array([32.95, np.inf, np.inf, np.inf, 6.42, 6.00, 0.77])
"""(7,) what per cents are of; millimetres are printed to 0.01, as good as exact."""


def deviation_of_reading(reference: float = REFERENCE) -> Array:
    """(7,) standard deviation of each number of Table 2 by the reference and by rounding of two printed figures to 0.01."""
    rounding = 100 * np.sqrt(2) * (0.01 / np.sqrt(12)) / PRINTED
    return np.asarray(np.hypot(reference, rounding))


@lru_cache(maxsize=1)
def clumod() -> Inertia:
    """Clumod with one blade as it was reconstructed, about its own origin: the reference of Table 2 to the printed digit."""
    return routes.inertia(built_in("clumod-1"))


def seven(found: Inertia) -> Array:
    """(7,) deviations in `UNITS` of an identified Clumod, in its own frame, from the reference."""
    true = clumod()
    share = 100 * np.concatenate([[found.mass / true.mass], found.moments_cog / true.moments_cog]) - 100
    return np.asarray(np.concatenate([share[:1], 1e3 * (found.cog - true.cog), share[1:]]))
