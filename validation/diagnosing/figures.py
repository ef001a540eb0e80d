"""Sizes of effects as a laboratory says them: per cent, grams, millimetres, microseconds, degrees; else SI.

SI inside and in JSON; these are for pages and pictures.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import floor, isfinite, log10

from validation.diagnosing.practical import scaled
from validation.effects.catalogue import FAMILIES
from validation.effects.family import Size as Described
from validation.rows import LARGE, SMALL


@dataclass(frozen=True, kw_only=True)
class Scale:
    """A unit of a page: its name, and how many of it are one SI unit."""

    unit: str
    per_si: float = 1.0


PERCENT, PLAIN = Scale(unit="%", per_si=100.0), Scale(unit="")


def scale(unit: str, size: float, *, ratio: bool = False) -> Scale:
    """That in which a number of about `size` in the SI `unit` reads best; `ratio` where 1 is a hundred per cent of something."""
    if unit == "1":
        return PERCENT if ratio else PLAIN
    shown, name = scaled(abs(size) or 1.0, unit)
    return Scale(unit=name, per_si=shown / (abs(size) or 1.0))


def is_ratio(family: str, key: str = "") -> bool:
    """Whether the size `key` of `family` is a share of something, of which 0 is none."""
    return any(_is_share(size) for size in _described(family) if size.key == key)


def is_signed(family: str, key: str = "") -> bool:
    """Whether it may be more or less than none."""
    return any(size.low < 0 for size in _described(family) if size.key == key)


def written(family: str, key: str, unit: str, values: Sequence[float]) -> tuple[tuple[str, ...], str]:
    """`values` of one size of `family` with the digits that their differences deserve, and the unit in which they stand."""
    ratio = is_ratio(family, key)
    chosen = scale(unit, max((abs(one) for one in values if isfinite(one)), default=0.0), ratio=ratio)
    shown = [chosen.per_si * one for one in values]
    form, signed = _form(shown), is_signed(family, key)
    return tuple(("+" if signed and value > 0 else "") + form.format(value) for value in shown), chosen.unit


def one(family: str, key: str, unit: str, value: float) -> str:
    """`value` of one size of `family` with its unit, three digits."""
    (text,), shown = written(family, key, unit, (value,))
    return with_unit(text, shown)


def with_unit(text: str, unit: str) -> str:
    """A figure and its unit; a degree follows at once."""
    return text + (unit if unit == "°" else f" {unit}" if unit else "")


def _form(values: Sequence[float]) -> str:
    """With two digits of the width of `values`, of one alone with three digits; with an exponent where zeros would be counted."""
    finite = [value for value in values if isfinite(value)]
    most, width = max(map(abs, finite), default=0.0), max(finite, default=0.0) - min(finite, default=0.0)
    if most == 0:
        return "{:g}"
    if not SMALL <= most < LARGE:
        return "{:.3g}"
    first = floor(log10(width)) - 1 if width > 1e-6 * most else floor(log10(most)) - 2
    return f"{{:.{max(-first, 0)}f}}"


def _described(family: str) -> tuple[Described, ...]:
    known = FAMILIES[family]
    return (*known.sizes, *(size for sizes in known.varying.values() for size in sizes))


def _is_share(size: Described) -> bool:
    return size.unit == "1" and size.null == 0 and not size.whole and not size.logarithmic
