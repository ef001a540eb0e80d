"""`Structure`: stiffness and mass of a discretised article on a moving base, however it was made.

Beams, solid elements and a user's own matrices all end here; modes, reduction and dynamic mass start from here and need not know
which it was. The base is six rigid motions of a reference point. It carries some degrees of freedom along (`held`): the flange's
rigid node, the underside of a solid, the interface of a user's model. All others are free.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

import numpy as np
import numpy.typing as npt

from geometry.frames import Array, Integers, frozen, rigid_transformation_6

Sparse = Any
"""A `scipy.sparse.csr_array`; SciPy ships no types."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Structure:
    """Stiffness and mass, and how they follow their base.

    Attributes
    ----------
    stiffness, mass : (n, n) sparse, symmetric, SI, of the unconstrained structure
    rigid : (n, 6) what every degree of freedom does in the six unit motions of the reference point (columns: x, y, z [1 per m],
        alpha, beta, gamma [1 per rad]); stiffness @ rigid = 0
    held : (b,) degrees of freedom that the base carries along
    reference_point : (3,) [m], in the article's frame
    points : (p, 3) [m], places where the shape of a mode can be looked at, in the article's frame
    translations : (p, 3) the degrees of freedom that move those points along x, y, z
    part_stiffness : share of each part in `stiffness`, (n, n) sparse, together all of it; may be left empty
    loss_factors : structural loss factor [1] of the parts that have one
    """

    stiffness: Sparse
    mass: Sparse
    rigid: Array
    held: Integers
    reference_point: Array = field(default_factory=lambda: np.zeros(3))
    points: Array = field(default_factory=lambda: np.zeros((0, 3)))
    translations: Integers = field(default_factory=lambda: np.zeros((0, 3), dtype=np.intp))
    part_stiffness: Mapping[str, Sparse] = field(default_factory=lambda: MappingProxyType({}))
    loss_factors: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))

    def __post_init__(self) -> None:
        object.__setattr__(self, "rigid", frozen(self.rigid, (self.mass.shape[0], 6), "rigid"))
        object.__setattr__(self, "reference_point", frozen(self.reference_point, (3,), "reference_point"))

    @property
    def free(self) -> Integers:
        """Degrees of freedom that the base does not hold, ascending."""
        return np.setdiff1d(np.arange(self.mass.shape[0]), self.held)

    @property
    def rigid_mass(self) -> Array:
        """6x6 mass matrix of the whole structure as a rigid body about the reference point (Eq. 1)."""
        M = self.rigid.T @ (self.mass @ self.rigid)
        return np.asarray((M + M.T) / 2)


def rigid_motion(points: npt.ArrayLike, reference_point: npt.ArrayLike = (0.0, 0.0, 0.0)) -> Array:
    """All six motions of `points` (p, 3) [m] that ride on the reference point; shape (6 p, 6), point by point (Eq. 3)."""
    offsets = np.asarray(points, dtype=np.float64) - np.asarray(reference_point, dtype=np.float64)
    return np.vstack([rigid_transformation_6(offset) for offset in offsets])
