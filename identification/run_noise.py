"""`RunNoise`: the noise of loads and base motions, run by run and line by line.

`identification.base_motion` and `identification.resultants` tell it from the noise of the channels: their `covariance`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array, frozen


@dataclass(frozen=True, eq=False, kw_only=True)
class RunNoise:
    """Covariances of complex noise, E n n^H, the same for all phases; motions and loads are independent of each other.

    Attributes
    ----------
    load : (r, n, 6, 6) of forces and moments about the reference point, in their units squared
    motion : (r, n, 6, 6) of the base motions about the same point
    """

    load: Array
    motion: Array

    def __post_init__(self) -> None:
        shape = np.asarray(self.load).shape
        if len(shape) != 4 or shape[2:] != (6, 6):
            raise ValueError(f"`load` must have shape (r, n, 6, 6), found {shape}")
        object.__setattr__(self, "load", frozen(self.load, shape, "load"))
        object.__setattr__(self, "motion", frozen(self.motion, shape, "motion"))
