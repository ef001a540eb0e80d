"""`Parameter`: one number of a prediction that a fit may move, and what is known of it beforehand."""

from __future__ import annotations

from dataclasses import dataclass
from math import exp, inf, log

IDENTIFIED, DECLARED, STRUCTURAL, SENSOR, EFFECT = KINDS = ("identified", "declared", "structural", "sensor", "effect")
"""What a laboratory legitimately has to identify (the FMD's inertia), what the model declares to know within a tolerance
(frequencies, damping, moduli), what else it leaves open of its modes (participation, coupling), tolerances of the measurement,
and effects that were added."""

NOMINAL: tuple[str, ...] = ()
PLAIN = (IDENTIFIED, DECLARED, EFFECT)
FITTED = KINDS
"""Which kinds of parameters are free in the three fits behind the nominal, the plain and the fitted error."""

IDENTIFYING = (*PLAIN, STRUCTURAL)
"""Those that are free where an article's inertia is identified: whatever its modes do, its mass does not follow from them."""

TOLERANCES = (DECLARED, STRUCTURAL, SENSOR)
"""Those whose offsets have a price."""


WITHIN = 2.5
"""Tolerances by which a plain fit may move what is declared."""


@dataclass(frozen=True, kw_only=True)
class Parameter:
    """One parameter. Fits move its offset; `value` says what an offset means.

    Attributes
    ----------
    name : unique in a problem; the id of an effect where it is one, with ``[key]`` behind it for one of several sizes
    unit : of the value, SI
    tolerance : standard deviation of the offset beforehand
    kind : of `KINDS`
    nominal : value at offset 0
    logarithmic : whether the offset is that of the logarithm: value = nominal * exp(offset) + above
    above : what a logarithmic value has on top, -1 for a relative change of something that stays positive
    start : offset at which a fit begins
    within : greatest offset either way that a plain fit allows a declared one
    low, high : least and greatest offset of all fits; beyond is no physics, or nothing that anybody would build
    """

    name: str
    unit: str
    tolerance: float
    kind: str = SENSOR
    nominal: float = 0.0
    logarithmic: bool = False
    above: float = 0.0
    start: float = 0.0
    within: float = inf
    low: float = -inf
    high: float = inf

    def bounds(self, *, plain: bool) -> tuple[float, float]:
        """Least and greatest offset, in a plain fit or in any other."""
        within = self.within if plain and self.kind == DECLARED else inf
        return max(self.low, -within), min(self.high, within)

    def value(self, offset: float) -> float:
        """Value in `unit` at `offset`."""
        return self.nominal * exp(offset) + self.above if self.logarithmic else self.nominal + offset

    def offset(self, value: float) -> float:
        """Offset at which the parameter has `value`."""
        return log((value - self.above) / self.nominal) if self.logarithmic else value - self.nominal

    def slope(self, offset: float) -> float:
        """d value / d offset: how a standard deviation of the offset reads in `unit`."""
        return self.nominal * exp(offset) if self.logarithmic else 1.0
