"""`Parameter`: one thing that a laboratory does not know of its measurement chain, and how far it may be from nominal.

Names are the ids of the catalogue of effects: ``family:target``. A vector theta holds the parameters' offsets from nominal; scale
factors that must stay positive - stiffnesses - are offset by their logarithm, and `Parameter.value` says what a number means.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import exp, expm1, isfinite, log1p

from geometry.errors import BadInput

Offsets = Mapping[str, float]
"""Offsets of the open parameters by name; a parameter that is not in it stands at its nominal value."""


@dataclass(frozen=True, kw_only=True)
class Parameter:
    """One parameter of the chain.

    Attributes
    ----------
    name : id of the catalogue, ``family:target``
    unit : of `value`, SI, "1" for a relative number
    tolerance : standard deviation of its offset before anything was measured (prior), in `unit`; of the natural logarithm where
        `logarithmic`
    channels : columns of the chain that it touches
    nominal : value at offset 0
    logarithmic : whether the offset is that of the logarithm: value = nominal + exp(offset) - 1
    """

    name: str
    unit: str
    tolerance: float
    channels: tuple[int, ...]
    nominal: float = 0.0
    logarithmic: bool = False

    @property
    def family(self) -> str:
        """What stands before the first colon of the name."""
        return self.name.partition(":")[0]

    def value(self, offset: float) -> float:
        """The value, in `unit`, at `offset` from nominal."""
        return self.nominal + (expm1(offset) if self.logarithmic else offset)

    def offset(self, value: float) -> float:
        """The entry of theta at which the parameter has `value`.

        Raises
        ------
        BadInput : the value would turn a stiffness negative.
        """
        away = value - self.nominal
        if self.logarithmic and away <= -1:
            problem = f"a scale factor must stay positive, found {1 + away:g}"
            raise BadInput(source="measurement chain", field=self.name, problem=problem, remedy="Give a smaller change")
        return log1p(away) if self.logarithmic else away

    def slope(self, offset: float) -> float:
        """d value / d offset: how a standard deviation of the offset reads in `unit`."""
        return exp(offset) if self.logarithmic else 1.0


def opened(candidates: Iterable[Parameter], overrides: Mapping[str, float]) -> tuple[Parameter, ...]:
    """The parameters that may move: those of a positive tolerance once `overrides`, by name or by family, have replaced theirs.

    A name goes before its family; 0 closes a parameter.

    Raises
    ------
    BadInput : an override that fits no parameter of this chain, or is negative or not finite.
    """
    known = tuple(candidates)
    _require_known(known, overrides)
    changed = (replace(one, tolerance=overrides.get(one.name, overrides.get(one.family, one.tolerance))) for one in known)
    return tuple(one for one in changed if one.tolerance > 0)


def _require_known(candidates: Sequence[Parameter], overrides: Mapping[str, float]) -> None:
    names = {one.name for one in candidates} | {one.family for one in candidates}
    for name, size in overrides.items():
        if name not in names:
            families = ", ".join(sorted({one.family for one in candidates}))
            problem = "this chain has no such parameter"
            raise BadInput(source="tolerances", field=name, problem=problem, remedy=f"Name one of the families {families}")
        if not (isfinite(size) and size >= 0):
            problem = f"a standard deviation must be finite and not negative, found {size}"
            raise BadInput(source="tolerances", field=name, problem=problem, remedy="Give it in SI units; 0 closes the parameter")
