"""TOML as a person would write it: numbers in the fewest digits that say the same, comments below each other."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Sequence
from math import inf, nextafter

Line = tuple[str, str, str]
"""Key, value, comment."""


def string(value: str) -> str:
    """A basic string of TOML: JSON's escapes are TOML's, but for one character that JSON leaves as it is."""
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")


def block(head: str, lines: Sequence[Line]) -> str:
    """A table with its comments below each other."""
    width = max(len(f"{key} = {value}") for key, value, note in lines if note) if any(note for *_, note in lines) else 0
    return "\n".join([head, *(_line(key, value, note, width) for key, value, note in lines)])


def _line(key: str, value: str, note: str, width: int) -> str:
    pair = f"{key} = {value}"
    return f"{pair:{width}}  # {note}" if note else pair


def number(value: float) -> str:
    """The fewest digits that give `value` back exactly."""
    plain, short = repr(float(value) + 0.0), f"{value:g}"
    return short if "e" in short and len(short) < len(plain) and float(short) == value else plain


def numbers(values: Iterable[float]) -> str:
    return "[" + ", ".join(map(number, values)) + "]"


def shortest(target: float, read: Callable[[float], float], near: float) -> float:
    """The number of fewest digits about `near` that is read as `target`; the nearest where none is, by the last bit."""
    for digits in range(1, 18):
        if read(rounded := float(f"{near:.{digits}g}")) == target:
            return rounded
    beside = [nextafter(near, -inf), near, nextafter(near, inf)]
    return min(beside, key=lambda one: abs(read(one) - target))
