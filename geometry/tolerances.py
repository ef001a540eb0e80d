"""`Tolerances`: what an ordinary, careful laboratory does not know of its own measurement chain, one standard deviation each.

The figures are those of the catalogue of effects. Virtual tests draw from them, identification takes them for priors.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from math import inf, radians

from geometry.errors import BadInput


@dataclass(frozen=True, kw_only=True)
class Tolerances:
    """Standard deviations of a measurement chain.

    Attributes
    ----------
    gain : relative, of every load-cell channel and of the accelerometers on cover plate and article
    table_gain : relative, of the accelerometers below the FMD
    delay : [s] of every channel
    position : [m] of a pick-up along each axis
    angle : [rad] of a pick-up about each of the two axes across its direction
    cell_stiffness : relative, of each load cell along each axis
    crosstalk : relative, of each load resultant in each other one of the same kind
    fmd_inertia : relative, of the mass and the moments of inertia of the FMD's moving part
    """

    gain: float = 0.003
    table_gain: float = 0.015
    delay: float = 20e-6
    position: float = 0.5e-3
    angle: float = radians(0.3)
    cell_stiffness: float = 0.05
    crosstalk: float = 0.0015
    fmd_inertia: float = 0.05

    def __post_init__(self) -> None:
        for one in fields(self):
            value = getattr(self, one.name)
            if not 0 <= value < inf:
                problem = f"a standard deviation must be finite and not negative, found {value}"
                raise BadInput(source="tolerances", field=one.name, problem=problem, remedy="Give it in SI units; 0 is exact")

    def scaled(self, factor: float) -> Tolerances:
        """All of them times `factor` [1]."""
        return Tolerances(**{one.name: factor * getattr(self, one.name) for one in fields(self)})
