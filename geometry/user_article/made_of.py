"""Materials as users write them: a name of the library, or a density with its unit."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Any

from geometry.errors import BadInput
from geometry.materials import Material, material


def made_of(text: str, source: str, own: Mapping[str, Material] | None = None) -> Material:
    """The material that `text` names, first among the user's `own`, then in the library; or a density, ``"7800 kg/m^3"``.

    Raises
    ------
    BadInput : no such material, or a density that is none.
    """
    if own and text in own:
        return own[text]
    if text[:1].isdigit() or text[:1] in ("-", "+", "."):
        return Material(name=text, density=density(text, source))
    return material(text, source)


def density(text: Any, source: str, field: str = "density") -> float:
    """`text`, such as ``"7.85 g/cm^3"``, as a density in kg/m³.

    Raises
    ------
    BadInput : no unit, an unknown one, another dimension, or a number that is not positive and finite.
    """
    try:
        quantity = _registry().Quantity(text) if isinstance(text, str) else None
        value = float(quantity.to("kg/m^3").magnitude) if quantity is not None else float("nan")
    except Exception as error:  # pint raises its own, tokenize's and Python's errors on nonsense
        raise _refused(text, source, field, "it cannot be read as a density") from error
    if quantity is None:
        raise _refused(text, source, field, "a density needs its unit, as text")
    if not 0 < value < float("inf"):
        raise _refused(text, source, field, "a density must be positive and finite")
    return value


def _refused(text: Any, source: str, field: str, problem: str) -> BadInput:
    return BadInput(
        source=source, field=field, problem=f"{problem}, found {text!r}", remedy='Write it like "7800 kg/m^3" or "7.8 g/cm^3"'
    )


@cache
def _registry() -> Any:
    from pint import UnitRegistry

    return UnitRegistry()
