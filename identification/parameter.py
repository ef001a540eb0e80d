"""`Parameter`: one number that a fit may move, what an offset of it means, and what is known of it beforehand."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from math import exp, inf, isfinite, log
from sys import float_info

from geometry.errors import BadInput

LARGEST = log(float_info.max)
"""Logarithm of a factor beyond which no number holds it."""


@dataclass(frozen=True, kw_only=True)
class Parameter:
    """One parameter. Fits move its offset; `value` says what an offset means.

    Attributes
    ----------
    name : unique in a problem, ``family:target``; of an effect the id of the catalogue, with ``[key]`` behind it for one of
        several sizes
    unit : of the value, SI, "1" for a relative number
    tolerance : standard deviation of the offset before anything was measured (prior), in `unit`; of the natural logarithm where
        `logarithmic`
    channels : columns of the measurement chain that it touches, where it is one of a chain
    kind : what it is to a model, `validation.estimation.problem.KINDS`
    nominal : value at offset 0, less `above`
    logarithmic : whether the offset is that of the logarithm: value = nominal * exp(offset) + above
    above : what a logarithmic value has on top, -1 for a relative change of something that stays positive
    start : offset at which a fit begins
    within : greatest offset either way that a plain fit allows a declared one
    low, high : least and greatest offset of all fits; beyond is no physics, or nothing that anybody would build
    plausible : standard deviation of it as a fault, where that is another than its family has
    """

    name: str
    unit: str
    tolerance: float
    channels: tuple[int, ...] = ()
    kind: str = "sensor"
    nominal: float = 0.0
    logarithmic: bool = False
    above: float = 0.0
    start: float = 0.0
    within: float = inf
    low: float = -inf
    high: float = inf
    plausible: float = 0.0

    @property
    def family(self) -> str:
        """What stands before the first colon of the name."""
        return self.name.partition(":")[0]

    def bounds(self, *, plain: bool) -> tuple[float, float]:
        """Least and greatest offset, in a plain fit or in any other."""
        within = self.within if plain and self.kind == "declared" else inf
        return max(self.low, -within), min(self.high, within)

    def value(self, offset: float) -> float:
        """Value in `unit` at `offset`; infinite where a factor is beyond what numbers hold, as where data tell none."""
        return self.slope(offset) + self.above if self.logarithmic else self.nominal + offset

    def offset(self, value: float) -> float:
        """Offset at which the parameter has `value`.

        Raises
        ------
        BadInput : the value would turn negative what stays positive.
        """
        if not self.logarithmic:
            return value - self.nominal
        factor = (value - self.above) / self.nominal
        if factor <= 0:
            problem = f"a scale factor must stay positive, found {factor:g}"
            raise BadInput("measurement chain", self.name, problem, "Give a smaller change")
        return log(factor)

    def slope(self, offset: float) -> float:
        """d value / d offset: how a standard deviation of the offset reads in `unit`."""
        return self.nominal * (exp(offset) if offset < LARGEST else inf) if self.logarithmic else 1.0


def opened(candidates: Iterable[Parameter], overrides: Mapping[str, float]) -> tuple[Parameter, ...]:
    """The parameters that may move: those of a positive tolerance once `overrides`, by name or by family, have replaced theirs.

    A name goes before its family; 0 closes a parameter.

    Raises
    ------
    BadInput : an override that fits no parameter of this chain, or is negative or not finite.
    """
    known = tuple(candidates)
    names = {one.name for one in known} | {one.family for one in known}
    for name, size in overrides.items():
        if name not in names:
            families = ", ".join(sorted({one.family for one in known}))
            raise BadInput("tolerances", name, "this chain has no such parameter", f"Name one of the families {families}")
        if not (isfinite(size) and size >= 0):
            problem = f"a standard deviation must be finite and not negative, found {size}"
            raise BadInput("tolerances", name, problem, "Give it in SI units; 0 closes the parameter")
    changed = (replace(one, tolerance=overrides.get(one.name, overrides.get(one.family, one.tolerance))) for one in known)
    return tuple(one for one in changed if one.tolerance > 0)
