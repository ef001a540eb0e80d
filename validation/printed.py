"""Values with the digits that were printed: ``"33.92 kg"``, ``"47.40 +/- 0.05 kg"``.

A value without a tolerance is known to half a unit of its last printed digit and no better: that is the rounding of the print,
and it is the least that two such values can be held to.
"""

from __future__ import annotations

import math
import re

from geometry.errors import BadInput
from geometry.quantities import LARGEST, SI_UNITS, quantity
from validation.statement import Stated

NOT_STATED = "not stated"
_PLACES = round(math.log10(LARGEST))
_LEADING = re.compile(r"\(?\s*[+-]?(\d*)\.?(\d*)(?:[eE]([+-]?\d+))?")
_SHOWN_PER_SI = {"length": 1e3}
"""Statements are shown in millimetres; everything else in SI."""


def stated(text: object, dimension: str, source: str, field: str) -> Stated | None:
    """Read ``value [+/- tolerance] unit`` of `dimension`; "not stated" (or null) gives None.

    Raises
    ------
    BadInput : see `quantity`.
    """
    if text is None or (isinstance(text, str) and text.strip() == NOT_STATED):
        return None
    typed = text.replace("−", "-") if isinstance(text, str) else text
    read = quantity(typed, dimension, source=source, field=field)
    value = float(read.nominal_value)
    last_digit = _last_digit(str(typed).strip())
    one = _one(str(typed).strip(), dimension, source, field)
    tolerance = float(read.std_dev) or 0.5 * 10.0**-last_digit * one
    shown = one * _SHOWN_PER_SI.get(dimension, 1.0)
    return Stated(value=value, tolerance=tolerance, decimals=max(0, last_digit - round(math.log10(shown))))


def tolerance(text: object, dimension: str, value: float, source: str, field: str) -> float:
    """A half-width [SI] from ``"0.15 kg"``, or from ``"3 %"`` of `value` [SI].

    Raises
    ------
    BadInput : see `quantity`; not positive.
    """
    relative = isinstance(text, str) and text.rstrip().endswith("%")
    read = float(quantity(text, "ratio" if relative else dimension, source=source, field=field).nominal_value)
    if read <= 0:
        remedy = f"Give a half-width in {SI_UNITS[dimension]} or per cent"
        raise BadInput(source=source, field=field, problem=f"a tolerance must be positive, found {text!r}", remedy=remedy)
    return read * abs(value) if relative else read


def _one(text: str, dimension: str, source: str, field: str) -> float:
    """The SI value of the number 1 in the unit of `text`."""
    return float(quantity(_LEADING.sub("1 ", text, count=1), dimension, source=source, field=field).nominal_value)


def _last_digit(text: str) -> int:
    """Decimal place of the last printed digit: 2 for 33.92, -3 for 12e3; none beyond those that `quantity` reads."""
    found = _LEADING.match(text)
    place = len(found[2]) - int(found[3] or 0) if found else 0
    return min(max(place, -_PLACES), _PLACES)
