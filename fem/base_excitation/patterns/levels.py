"""Levels in words, and what every number of a pattern has to be."""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite
from types import MappingProxyType

from geometry.dynamic_mass import MOTIONS
from geometry.errors import BadInput
from geometry.keys import one_of


def unit(axis: str) -> str:
    """Unit of acceleration along or about `axis`."""
    return "m/s²" if axis in MOTIONS[:3] else "rad/s²"


def listed(levels: Mapping[str, float]) -> str:
    """`levels` in words: ``x 2.5 m/s², gamma 6 rad/s²``."""
    return ", ".join(f"{axis} {level:g} {unit(axis)}" for axis, level in levels.items())


def require_positive(value: float, field: str, source: str, unit: str = "") -> None:
    """Refuse what is not a positive number.

    Raises
    ------
    BadInput : zero, negative, NaN or infinite.
    """
    if not (isfinite(value) and value > 0):
        problem = f"must be positive and finite, found {value:g} {unit}".rstrip()
        raise BadInput(source=source, field=field, problem=problem, remedy="Give a positive number")


def require_not_negative(value: float, field: str, source: str, unit: str) -> None:
    """Refuse what is not a number from 0 up.

    Raises
    ------
    BadInput : negative, NaN or infinite.
    """
    if not (isfinite(value) and value >= 0):
        problem = f"must be finite and not negative, found {value:g} {unit}".rstrip()
        raise BadInput(source=source, field=field, problem=problem, remedy="Give 0 or a positive number")


def require_band(start: float, stop: float, source: str, *, line: bool = False) -> None:
    """Refuse a band [Hz] that does not ascend; a `line`, where both bounds are one, may be allowed.

    Raises
    ------
    BadInput : see above, and a bound that is not positive.
    """
    require_positive(start, "start", source, "Hz")
    require_positive(stop, "stop", source, "Hz")
    if start > stop or (start == stop and not line):
        problem = f"must be below `stop`, found {start:g} Hz and {stop:g} Hz"
        raise BadInput(source=source, field="start", problem=problem, remedy="Give the lower bound first")


def require_axes(levels: Mapping[str, float], field: str, source: str) -> Mapping[str, float]:
    """`levels` by axis, every one positive, in the order of `MOTIONS`.

    Raises
    ------
    BadInput : no axis, an unknown one (with the nearest), a level that is not positive.
    """
    if not levels:
        raise BadInput(source=source, field=field, problem="names no axis", remedy=f"Name some of {', '.join(MOTIONS)}")
    for axis, level in levels.items():
        one_of(axis, MOTIONS, source=source, where=field)
        require_positive(level, f"{field}.{axis}", source, unit(axis))
    return MappingProxyType({axis: float(levels[axis]) for axis in MOTIONS if axis in levels})
