"""Whether the fields of a family that somebody brings hold what they must: words, numbers, tuples, functions."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import isnan
from types import MappingProxyType
from typing import Any

from geometry.errors import BadInput
from validation.effects.family import Family, Size

Rule = tuple[Callable[[Any], bool], str]
"""What a field must be, and how that is said."""


def _number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and not isnan(value)


def _words(value: Any) -> bool:
    return isinstance(value, tuple) and all(isinstance(one, str) and one for one in value)


def _sizes(value: Any) -> bool:
    return isinstance(value, tuple) and all(isinstance(one, Size) for one in value)


def _by_target(value: Any) -> bool:
    return isinstance(value, Mapping) and all(isinstance(one, str) and _sizes(value[one]) for one in value)


def _callable(value: Any) -> bool:
    return value is None or callable(value)


TEXT: Rule = (lambda value: isinstance(value, str), "text")
FLAG: Rule = (lambda value: isinstance(value, bool), "True or False")
NUMBER: Rule = (_number, "a number")
FUNCTION: Rule = (_callable, "a function")
TEXTS: Rule = (_words, 'a tuple of texts, ("one",) where there is one')

OF_FAMILY: Mapping[str, Rule] = MappingProxyType(
    {
        **dict.fromkeys(("name", "side", "what", "example", "stage", "equation", "confirmed_by", "reference", "sentence"), TEXT),
        **dict.fromkeys(("targets", "mistaken_for"), TEXTS),
        "optional": FLAG,
        "sizes": (_sizes, "a tuple of Size, (Size(...),) where there is one"),
        "varying": (_by_target, "a mapping from a target to a tuple of Size"),
        "tolerance": NUMBER,
        **dict.fromkeys(("change", "plant"), FUNCTION),
    }
)

OF_SIZE: Mapping[str, Rule] = MappingProxyType(
    {
        **dict.fromkeys(("unit", "key"), TEXT),
        **dict.fromkeys(("low", "high", "null", "plausible"), NUMBER),
        "default": (lambda value: value is None or _number(value), "a number, or None"),
        **dict.fromkeys(("whole", "logarithmic"), FLAG),
    }
)


def require_form(family: Family, source: str) -> None:
    """Refuse a field that holds something else than it must.

    Raises
    ------
    BadInput : the file (`source`), the field, and what was found.
    """
    _require(family, OF_FAMILY, "", source)
    for sizes in (family.sizes, *family.varying.values()):
        for size in sizes:
            _require(size, OF_SIZE, "sizes.", source)
        if len({size.key for size in sizes}) < len(sizes):
            problem = "two of them have the same key"
            raise BadInput(source=source, field="sizes", problem=problem, remedy='Give each its own, Size(key="m", ...)')


def _require(noun: Any, rules: Mapping[str, Rule], where: str, source: str) -> None:
    for field, (holds, words) in rules.items():
        value = getattr(noun, field)
        if not holds(value):
            raise BadInput(
                source=source, field=f"{where}{field}", problem=f"must be {words}, found {value!r}", remedy="Correct it"
            )
