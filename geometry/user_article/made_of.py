"""Materials as users write them: a name of the library, or a density with its unit."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from geometry.errors import BadInput
from geometry.materials import Material, material
from geometry.quantities import quantity


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
    BadInput : no unit, an unknown one, another dimension, a tolerance, or a number that is not positive and finite.
    """
    try:
        read = quantity(text, "density", source=source, field=field)
    except BadInput as error:
        raise _refused(source, field, error.problem) from None
    if read.std_dev:
        raise _refused(source, field, f"no tolerance of a density is carried on, found {text!r}")
    if read.nominal_value <= 0:
        raise _refused(source, field, f"a density must be positive and finite, found {text!r}")
    return float(read.nominal_value)


def _refused(source: str, field: str, problem: str) -> BadInput:
    return BadInput(source=source, field=field, problem=problem, remedy='Write it like "7800 kg/m^3" or "7.8 g/cm^3"')
