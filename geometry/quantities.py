"""Quantities as people write them, ``"47.40 +/- 0.05 kg"``, turned into SI values that remember their tolerance and their name.

What a tolerance means: a half-width at one level of confidence that is the same for every input of a file (all of them one
standard deviation, or all 95 % limits: the reader need not know which) and comes back at that level. Inputs are independent, and
tolerances combine in quadrature to first order (ISO/IEC Guide 98-3, the GUM, section 5.1.2). A value without a tolerance is
exact. `uncertainties` carries the derivatives; every input is tagged with its name, so that each result can be itemised.
"""

from __future__ import annotations

import math
import re
from functools import cache
from typing import TYPE_CHECKING, Any

from geometry.errors import BadInput

if TYPE_CHECKING:
    from pint import UnitRegistry
    from uncertainties import UFloat

SI_UNITS = {
    "mass": "kg",
    "length": "m",
    "time": "s",
    "acceleration": "m/s^2",
    "force": "N",
    "density": "kg/m^3",
    "pressure": "Pa",
    "moment of inertia": "kg m^2",
    "first moment": "kg m",
    "angle": "rad",
    "ratio": "1",
}
"""The dimensions that users' files use, and the unit in which their values leave here."""

FIRST_ORDER_LIMIT = 0.1
"""Relative tolerance above which first order is doubtful: the neglected terms are of the order of its square, 1 %."""

LARGEST = 1e15
"""In SI: no quantity of a test article lies beyond, and arithmetic stays far from overflow. What is smaller than its inverse is
the rounding that another program leaves of a zero, and is read as zero."""

_NAMED = {**SI_UNITS, "frequency": "Hz", "area": "m^2", "volume": "m^3", "velocity": "m/s", "torque": "N m"}
_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_QUANTITY = re.compile(
    rf"\(?\s*(?P<value>{_NUMBER})\s*(?P<unit>[^\d\s+()±,-][^+()±]*?)?\s*"
    rf"(?:(?:\+/-|\+-|±)\s*(?P<tolerance>{_NUMBER})\s*\)?\s*(?P<last>[^\d\s+±-][^+()±]*?)?)?\s*\)?"
)


def quantity(text: Any, dimension: str, *, source: str, field: str, name: str = "") -> UFloat:
    """Read `text` as a value of `dimension` (a key of `SI_UNITS`), in SI, tagged with `name` (`field` by default).

    ``"1.92 s"``, ``"1.9245 ± 0.0002 s"``, ``"(47.40 +/- 0.05) kg"`` and ``"47.40 kg +/- 50 g"`` are understood, and
    ``"47.40 kg +/- 0.1 %"``, a tolerance relative to the value. A ratio may stand without a unit.

    Raises
    ------
    BadInput : not such a text, no unit, an unknown unit, another dimension (both are named), a negative tolerance, NaN.
    """
    match = _QUANTITY.fullmatch(text.strip()) if isinstance(text, str) else None
    if match is None:
        raise _not_a_quantity(text, dimension, source, field)
    first, last = match["unit"], match["last"]
    unit = first or last
    if unit is None and dimension != "ratio":
        raise _refused(f"{_a(dimension)} needs its unit, found {text!r}", dimension, source, field)
    factor = _factor(unit or "1", dimension, source, field)
    value = float(match["value"]) * factor
    width = float(match["tolerance"] or 0.0)
    if first and last:
        width *= abs(value) if _is_percent(last) else _factor(last, dimension, source, field)
        width *= 0.01 if _is_percent(last) else 1.0
    else:
        width *= factor
    if first and match["tolerance"] and not last:
        raise _refused(f"the tolerance needs its unit too, found {text!r}", dimension, source, field)
    if width < 0 or not math.isfinite(value + width):
        raise _refused(f"a tolerance must not be negative and all must be finite, found {text!r}", dimension, source, field)
    if max(abs(value), width) >= LARGEST:
        raise _refused(f"no measured {dimension} has this size, found {text!r}", dimension, source, field)
    return tagged(_nothing_less(value), _nothing_less(width), name or field)


def tagged(value: float, tolerance: float, name: str) -> UFloat:
    """`value` with `tolerance` (same unit, not negative), under `name` in every budget that it enters; zero makes it exact."""
    from uncertainties import ufloat

    return ufloat(value, tolerance, tag=name) if tolerance else exact(value)


def exact(value: float) -> UFloat:
    """`value` without tolerance; it enters no budget."""
    from uncertainties.core import AffineScalarFunc, LinearCombination

    return AffineScalarFunc(value, LinearCombination({}))


def doubtful_at_first_order(value: float, tolerance: float) -> bool:
    """Whether the `tolerance` of an input is so large beside its `value` that first-order propagation is doubtful."""
    return value != 0 and tolerance > FIRST_ORDER_LIMIT * abs(value)


def _nothing_less(size: float) -> float:
    return size if abs(size) > 1 / LARGEST else 0.0


@cache
def _registry() -> UnitRegistry[float]:
    from pint import UnitRegistry

    return UnitRegistry()


def _is_percent(unit: str) -> bool:
    return unit.strip() in {"%", "percent"}


def _factor(unit: str, dimension: str, source: str, field: str) -> float:
    """What a number in `unit` is multiplied with to be in the SI unit of `dimension`."""
    registry = _registry()
    try:
        found = registry.Quantity(1.0, registry.parse_units("dimensionless" if unit.strip() == "1" else unit))
        wanted = registry.Unit(SI_UNITS[dimension] if dimension != "ratio" else "dimensionless")
    except Exception as error:  # pint raises its own, tokenize's and Python's errors on nonsense
        raise _refused(f"the unit {unit!r} is not known", dimension, source, field) from error
    angular = "radian" in str(found.to_root_units().units)
    if found.dimensionality != wanted.dimensionality or (dimension == "angle") != angular:
        what = "an angle" if angular else _described(found.dimensionality)
        raise _refused(f"{unit!r} is {what}, where {_a(dimension)} should be", dimension, source, field)
    return float(found.to(wanted).magnitude)


def _described(dimensionality: Any) -> str:
    registry = _registry()
    for name, unit in _NAMED.items():
        if name not in {"angle", "ratio"} and registry.Unit(unit).dimensionality == dimensionality:
            return _a(name)
    return "a pure number" if not dimensionality else f"of dimension {dimensionality}"


def _a(name: str) -> str:
    return f"an {name}" if name[0] in "aeiou" else f"a {name}"


def _not_a_quantity(text: Any, dimension: str, source: str, field: str) -> BadInput:
    if isinstance(text, int | float) and not isinstance(text, bool):
        return _refused(f"{_a(dimension)} needs its unit, found the bare number {text!r}", dimension, source, field)
    return _refused(f"{_a(dimension)} cannot be read from {text!r}", dimension, source, field)


def _refused(problem: str, dimension: str, source: str, field: str) -> BadInput:
    unit = SI_UNITS[dimension]
    example = "0.3 %" if dimension == "ratio" else f"1.00 +/- 0.01 {unit}"
    return BadInput(source=source, field=field, problem=problem, remedy=f'Write it like "{example}"')
