"""`Reported`: one way's result as it is printed: mass, CoG and the tensor about the CoG in a frame, with their intervals."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from geometry.errors import CheckFailed
from geometry.frames import Pose
from geometry.inertia import Inertia
from identification.identified import Identified
from identification.quality import Quality, quality
from validation.statement import Stated, Statement

NOTHING = 1e-3
"""A share of the variance below which an input is not worth a word."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Reported:
    """A result and what is to be thought of it.

    Attributes
    ----------
    identified : about F
    quality : in the frame in which it is reported
    """

    identified: Identified
    quality: Quality

    @property
    def inertia(self) -> Inertia:
        """In the axes and about the origin of the frame."""
        return self.quality.inertia

    @property
    def values(self) -> Array:
        """(10,) mass [kg], CoG [m] from the frame's origin, moments and products [kg m²] about the CoG."""
        return self.quality.values

    @property
    def half_width(self) -> Array:
        """(10,) distance to the farther end of each 95 % interval."""
        low, high = self.quality.intervals.T
        return np.asarray(np.maximum(high - self.values, self.values - low))

    def statement(self) -> Statement:
        """The result as a column of a reference table."""
        values = tuple(Stated(value=float(v), tolerance=float(t)) for v, t in zip(self.values, self.half_width, strict=True))
        return Statement(name=self.identified.way, values=values, source="massline identify", tolerance_note="95 % intervals")

    def dominating(self, k: int) -> tuple[tuple[str, float], ...]:
        """Inputs by their share of the variance of value `k`, the largest first; none where nothing is known."""
        shares = [(name, float(share[k])) for name, share in self.quality.shares.items()]
        return tuple(sorted((one for one in shares if one[1] > NOTHING), key=lambda one: -one[1]))


def reported(identified: Identified, frame: Pose) -> Reported:
    """`identified` seen from `frame`, whose pose is seen from F, along the axes of the campaign.

    Raises
    ------
    CheckFailed : the mass is not positive, so that there is no CoG.
    """
    if identified.inertia.mass <= 0:
        raise CheckFailed(
            f"the {identified.way} result has a mass of {identified.inertia.mass:.6g} kg: is the polarity of the load cells "
            "inverted, or more taken off than was mounted? `massline check` shows what the channels read",
            mass=identified.inertia.mass,
        )
    return Reported(identified=identified, quality=quality(identified, frame))
