"""`DynamicMass`: the frequency-dependent sibling of `Inertia`, the 6x6 matrix between base acceleration and interface force.

It is the *blocked* dynamic mass: all six base motions are prescribed, and column j is the interface load for a unit
acceleration of base motion j with the other five held at zero. The dynamic mass of a body that is driven along one axis and free
in the others is another one. Loads are those of the table *on* the article, so that a rigid body has H = +M at every frequency.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np
import numpy.typing as npt

from geometry.frames import Array, freeze, frozen, rigid_transformation_6

ComplexArray = npt.NDArray[np.complex128]

MOTIONS = ("x", "y", "z", "alpha", "beta", "gamma")
"""Order of base motions (columns) and of interface loads (rows: forces along x, y, z and moments about them)."""

SIGNS = ("x", "y", "z", "α", "β", "γ")
"""The same as pages write them."""

LEVELS: Mapping[str, float] = MappingProxyType(dict(zip(MOTIONS, (2.5, 2.5, 2.5, 3.0, 3.0, 6.0), strict=True)))
"""Nominal acceleration of the base in the paper's sweeps, by axis in the order of `MOTIONS` [m/s², rad/s²] (paper, section 4)."""


@dataclass(frozen=True, eq=False, kw_only=True)
class DynamicMass:
    """Blocked dynamic mass about `reference_point`.

    Attributes
    ----------
    frequency : (n,) [Hz], ascending, not negative
    matrix : (n, 6, 6) complex, order of `MOTIONS`; [kg] between translations, [kg m] mixed, [kg m²] between rotations
    reference_point : (3,) [m], in the article's frame

    Source: paper Eqs. 8 to 11.
    """

    frequency: Array
    matrix: ComplexArray
    reference_point: Array = field(default_factory=lambda: np.zeros(3))

    def __post_init__(self) -> None:
        frequency = np.asarray(self.frequency, dtype=np.float64)
        object.__setattr__(self, "frequency", frozen(frequency, (frequency.size,), "frequency"))
        object.__setattr__(self, "matrix", frozen(self.matrix, (frequency.size, 6, 6), "matrix", np.complex128))
        freeze(self, reference_point=(3,))
        if frequency.size and (frequency[0] < 0 or np.any(np.diff(frequency) <= 0)):
            raise ValueError("`frequency` must ascend and not be negative")

    def about(self, point: npt.ArrayLike) -> "DynamicMass":
        """The same dynamic mass about another reference point (3,) [m] of the same frame: ``T^T H T``, T from Eq. 3.

        T gives the six motions of the old reference point from those of the new one, which moves rigidly with it.
        """
        new = np.asarray(point, dtype=np.float64)
        T = rigid_transformation_6(self.reference_point - new)
        return DynamicMass(frequency=self.frequency, matrix=T.T @ self.matrix @ T, reference_point=new)
