"""`Reported`: one way's ten parameters about F, as they are reported: mass, CoG and the tensor about the CoG, with intervals.

The ten values are a smooth map of the parameters of Eq. 4; the covariance goes through it linearised (GUM, JCGM 100:2008, 5.2.2),
in which the correlation of first moment and tensor counts: moments about the CoG are better known than those about F.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array, frozen
from geometry.errors import CheckFailed
from geometry.frames import Pose
from geometry.inertia import PARAMETERS, Inertia
from identification.identified import Identified
from validation.stated_inertia import NORMAL_95
from validation.statement import Stated, Statement, about_cog, jacobian

NOTHING = 1e-3
"""A share of the variance below which an input is not worth a word."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Reported:
    """A result as it is printed.

    Attributes
    ----------
    identified : what it comes from, about F
    inertia : in the axes and about the origin of the frame in which it is reported
    values : (10,) mass [kg], CoG [m] from that origin, moments and products [kg m²] about the CoG
    low, high : (10,) ends of the 95 % intervals of `values`
    """

    identified: Identified
    inertia: Inertia
    values: Array
    low: Array
    high: Array

    def __post_init__(self) -> None:
        for name in ("values", "low", "high"):
            object.__setattr__(self, name, frozen(getattr(self, name), (10,), name))

    @property
    def half_width(self) -> Array:
        """(10,) distance to the farther end of each interval."""
        return np.asarray(np.maximum(self.high - self.values, self.values - self.low))

    def statement(self) -> Statement:
        """The result as a column of a reference table."""
        values = tuple(Stated(value=float(v), tolerance=float(t)) for v, t in zip(self.values, self.half_width, strict=True))
        return Statement(name=self.identified.way, values=values, source="massline identify", tolerance_note="95 % intervals")


def reported(identified: Identified, frame: Pose) -> Reported:
    """`identified` seen from `frame`, whose pose is seen from F, along the axes of the campaign.

    Raises
    ------
    CheckFailed : the mass is not positive, so that there is no CoG.
    """
    there = frame.inverse
    if identified.inertia.mass <= 0:
        raise CheckFailed(
            f"the {identified.way} result has a mass of {identified.inertia.mass:.6g} kg: is the polarity of the load cells "
            "inverted, or more taken off than was mounted? `massline check` shows what the channels read",
            mass=identified.inertia.mass,
        )

    def change(parameters: Array) -> Array:
        return about_cog(Inertia(parameters=parameters).placed(there))

    values = change(identified.inertia.parameters)
    J = jacobian(change, identified.inertia.parameters)
    half = NORMAL_95 * np.sqrt(np.maximum(np.diag(J @ identified.covariance @ J.T), 0.0))
    return Reported(
        identified=identified,
        inertia=Inertia(parameters=identified.inertia.parameters).placed(there),
        values=values,
        low=values - half,
        high=values + half,
    )


def dominating(identified: Identified, parameter: str) -> tuple[tuple[str, float], ...]:
    """Inputs by their share of the variance of `parameter` of Eq. 4, the largest first; none where nothing is known."""
    k = PARAMETERS.index(parameter)
    shares = [(name, float(share[k])) for name, share in identified.shares.items()]
    return tuple(sorted((one for one in shares if one[1] > NOTHING), key=lambda one: -one[1]))
