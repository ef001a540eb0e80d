"""Units of length that a file of bare numbers may mean."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geometry.errors import BadInput
from geometry.keys import nearest


@dataclass(frozen=True, kw_only=True)
class LengthUnit:
    """A unit of length.

    Attributes
    ----------
    name : as on the command line
    metres : its length [m]
    """

    name: str
    metres: float

    def shown(self, point: npt.ArrayLike) -> str:
        """A point (3,) [m] in this unit, ``(1.2, 3.4, 5.6) mm``."""
        x, y, z = (f"{value + 0.0:.6g}" for value in np.asarray(point, dtype=np.float64) / self.metres)
        return f"({x}, {y}, {z}) {self.name}"


PLAUSIBLE = (2e-3, 20.0)
"""Largest dimension [m] of a structure that is mounted on a shaking table; outside, the unit is doubted aloud."""

METRE = LengthUnit(name="m", metres=1.0)
MILLIMETRE = LengthUnit(name="mm", metres=1e-3)

UNITS = {
    unit.name: unit
    for unit in (
        MILLIMETRE,
        LengthUnit(name="cm", metres=1e-2),
        METRE,
        LengthUnit(name="in", metres=0.0254),
        LengthUnit(name="ft", metres=0.3048),
    )
}
"""The units on offer, by name."""

_WORDS = {
    "mm": ("millimetre", "millimetres", "millimeter", "millimeters"),
    "cm": ("centimetre", "centimetres", "centimeter", "centimeters"),
    "m": ("metre", "metres", "meter", "meters"),
    "in": ("inch", "inches"),
    "ft": ("foot", "feet"),
}
_BY_WORD = {word: UNITS[name] for name, words in _WORDS.items() for word in (name, *words)}


def doubts(size: float, source: str, unit: LengthUnit | None = None) -> tuple[str, ...]:
    """A word about a largest dimension `size` [m] that no article has.

    `unit` is the one that the user gave or the file states in words, and units that would make the size an ordinary one are
    proposed; None is for files whose own unit nobody chooses.
    """
    smallest, largest = PLAUSIBLE
    if smallest <= size <= largest:
        return ()
    if unit is None:
        return (f"{source}: its own unit makes it {size:.4g} m long, which is suspicious; check the unit of the export",)
    better = [other.name for other in UNITS.values() if 5 * smallest <= size / unit.metres * other.metres <= largest / 2]
    instead = f"; in {' or '.join(better)} it would be of ordinary size" if better else ""
    return (f"{source}: with unit {unit.name} it is {size:.4g} m long, which is suspicious{instead}",)


def length_unit(text: str, source: str, field: str = "unit") -> LengthUnit:
    """The unit that `text` names, short (``mm``) or in full (``millimetres``), upper or lower case.

    Raises
    ------
    BadInput : no such unit; the message lists those on offer.
    """
    unit = _BY_WORD.get(text.strip().lower())
    if unit is not None:
        return unit
    raise BadInput(
        source=source,
        field=field,
        problem=f"no unit of length is called {text!r}",
        remedy=f"{nearest(text.strip().lower(), _BY_WORD)}Give one of {', '.join(UNITS)}",
    )
