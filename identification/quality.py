"""The quality indicator that the paper says is missing: intervals, what dominates them, and a verdict in words."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from geometry.arrays import Array
from geometry.frames import Pose
from identification.identified import Identified


@dataclass(frozen=True, eq=False, kw_only=True)
class Quality:
    """A result as one reads it.

    Attributes
    ----------
    mass : [kg]
    cog : (3,) [m], in the frame asked for
    moments, products : (3,) [kg m²] about the CoG, xx yy zz and xy xz yz as matrix entries
    interval95 : by "mass" (1, 2), "cog", "moments", "products" (3, 2), in the same units: low and high
    deviation : standard deviations by the same words, (1,) and (3,)
    dominant : by PARAMETER and by "mass", "cog x", "Ixx about the CoG" ... the input with the largest share of the variance
    verdict : by the same words, in words
    """

    mass: float
    cog: Array
    moments: Array
    products: Array
    interval95: Mapping[str, Array]
    deviation: Mapping[str, Array]
    dominant: Mapping[str, str] = field(default_factory=dict)
    verdict: Mapping[str, str] = field(default_factory=dict)


def quality(identified: Identified, frame: Pose | None = None) -> Quality:
    """Mass, CoG and moments of inertia about the CoG with their 95 % intervals and verdicts.

    Parameters
    ----------
    frame : pose of the article's frame seen from F, to give its CoG and tensor in; F's own frame by default
    """
    raise NotImplementedError  # pragma: no cover
