"""Units of signal files. A channel states its own; its samples are multiplied once, where they are read."""

from __future__ import annotations

import math

from geometry.errors import BadInput
from geometry.keys import nearest

STANDARD_GRAVITY = 9.80665
POUND_FORCE = 4.4482216152605
FOOT, INCH = 0.3048, 0.0254

UNITS: dict[str, dict[str, float]] = {
    "acceleration": {"m/s^2": 1.0, "g": STANDARD_GRAVITY, "mm/s^2": 1e-3, "in/s^2": INCH, "ft/s^2": FOOT},
    "force": {"N": 1.0, "kN": 1e3, "mN": 1e-3, "lbf": POUND_FORCE},
    "moment": {"N m": 1.0, "kN m": 1e3, "N mm": 1e-3, "lbf in": POUND_FORCE * INCH, "lbf ft": POUND_FORCE * FOOT},
}
"""Units of each quantity, and what a number in one is multiplied with to be SI."""

SAME = 1e-6
"""Relative difference up to which two factors are the same unit: universal files write them with seven digits and more."""

_SPELT = {"m/s²": "m/s^2", "m/s2": "m/s^2", "m/s**2": "m/s^2", "mm/s²": "mm/s^2", "mm/s2": "mm/s^2", "Nm": "N m", "N*m": "N m"}


def factor(unit: object, quantity: str, *, source: str, field: str) -> float:
    """What a number in `unit` is multiplied with to be in the SI unit of `quantity`.

    Raises
    ------
    BadInput : no unit of this quantity; those on offer are named.
    """
    known = UNITS[quantity]
    name = _SPELT.get(unit, unit) if isinstance(unit, str) else ""
    if name in known:
        return known[name]
    other = next((what for what, units in UNITS.items() if name in units), None)
    a = "an" if quantity[0] in "aeiou" else "a"
    problem = f"must be a unit of {a} {quantity}, found {unit!r}" + (f", a unit of {other}" if other else "")
    raise BadInput(source=source, field=field, problem=problem, remedy=f"{nearest(name, known)}Known are {', '.join(known)}")


def is_unit(text: str) -> bool:
    """Whether `text` is one of the units known here."""
    return any(_SPELT.get(text, text) in units for units in UNITS.values())


def is_same(unit: str, other: str, quantity: str) -> bool:
    """Whether both are the same unit of `quantity`."""
    known = UNITS[quantity]
    sizes = [known.get(_SPELT.get(one, one)) for one in (unit, other)]
    return sizes[0] is not None and sizes[0] == sizes[1]


def named(size: float, quantity: str) -> str:
    """The unit of `quantity` with the factor `size`, or the factor in SI when it has no name."""
    names = [name for name, value in UNITS[quantity].items() if math.isclose(value, size, rel_tol=SAME)]
    return names[0] if names else f"{size:.7g} {next(iter(UNITS[quantity]))}"
