"""Sizes of effects as a laboratory says them: per cent, grams, millimetres, microseconds, degrees; else SI.

SI inside and in JSON; these are for pages and pictures.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import floor, isfinite, log10, pi

from validation.effects.catalogue import FAMILIES
from validation.effects.effect import SizeSpec as Described
from validation.output import LARGE, SMALL, significant, with_unit


@dataclass(frozen=True, kw_only=True)
class Scale:
    """A unit of a page: its name, and how many of it are one SI unit."""

    unit: str
    per_si: float = 1.0


PERCENT = Scale(unit="%", per_si=100.0)

SMALLER: dict[str, tuple[tuple[float, Scale], ...]] = {
    "kg": ((1.0, Scale(unit="kg")), (0.0, Scale(unit="g", per_si=1e3))),
    "m": ((1.0, Scale(unit="m")), (0.0, Scale(unit="mm", per_si=1e3))),
    "s": ((1.0, Scale(unit="s")), (1e-3, Scale(unit="ms", per_si=1e3)), (0.0, Scale(unit="µs", per_si=1e6))),
    "rad": ((0.0, Scale(unit="°", per_si=180 / pi)),),
    "m/N": ((1e-6, Scale(unit="µm/N", per_si=1e6)), (0.0, Scale(unit="nm/N", per_si=1e9))),
    "rad/(N m)": ((0.0, Scale(unit="µrad/(N m)", per_si=1e6)),),
    "kg m": ((1.0, Scale(unit="kg m")), (0.0, Scale(unit="g m", per_si=1e3))),
    "kg m^2": ((1.0, Scale(unit="kg m²")), (0.0, Scale(unit="g m²", per_si=1e3))),
}
"""By SI unit, from which size on which scale is used, the largest first."""


def scale(unit: str, size: float, *, ratio: bool = False) -> Scale:
    """That in which a number of about `size` in the SI `unit` reads best; `ratio` where 1 is a hundred per cent of something."""
    if unit == "1":
        return PERCENT if ratio else Scale(unit="")
    ladder = SMALLER.get(unit, ((0.0, Scale(unit=unit)),))
    return next((one for least, one in ladder if abs(size) >= least), ladder[-1][1])


def is_ratio(family: str, key: str = "") -> bool:
    """Whether the size `key` of `family` is a share of something, of which 0 is none."""
    return any(
        size.unit == "1" and size.null == 0 and not size.whole and not size.logarithmic
        for size in _described(family)
        if size.key == key
    )


def written(family: str, key: str, unit: str, values: Sequence[float]) -> tuple[tuple[str, ...], str]:
    """`values` of one size of `family` with the digits that their differences deserve, and the unit in which they stand."""
    # Whether it may be more or less than none
    signed = any(size.low < 0 for size in _described(family) if size.key == key)
    return written_as(unit, values, ratio=is_ratio(family, key), signed=signed)


def written_as(unit: str, values: Sequence[float], *, ratio: bool = True, signed: bool = True) -> tuple[tuple[str, ...], str]:
    """The same of `values` in an SI `unit`, whatever they are of; `signed` ones above zero have a plus."""
    chosen = scale(unit, max((abs(one) for one in values if isfinite(one)), default=0.0), ratio=ratio)
    shown = [chosen.per_si * one for one in values]
    # With two digits of the width of `shown`, of one alone with three digits; with an exponent where zeros would be counted
    finite = [value for value in shown if isfinite(value)]
    most, width = max(map(abs, finite), default=0.0), max(finite, default=0.0) - min(finite, default=0.0)
    if most == 0:
        form: str = "{:g}"
    elif not SMALL <= most < LARGE:
        form = "{:.3g}"
    else:
        first = floor(log10(width)) - 1 if width > 1e-6 * most else floor(log10(most)) - 2
        form = f"{{:.{max(-first, 0)}f}}"
    return tuple(("+" if signed and value > 0 else "") + form.format(value) for value in shown), chosen.unit


def one(family: str, key: str, unit: str, value: float) -> str:
    """`value` of one size of `family` with its unit, three digits."""
    (text,), shown = written(family, key, unit, (value,))
    return with_unit(text, shown)


def _described(family: str) -> tuple[Described, ...]:
    known = FAMILIES[family]
    return (*known.sizes, *(size for sizes in known.varying.values() for size in sizes))


# A figure with its practical unit and so many digits, for sentences: "12 mm".


def said(value: float, unit: str, digits: int = 2) -> str:
    """`value` [SI, `unit`] with so many significant `digits`; a ratio is a per cent."""
    chosen = scale(unit, LEAST * value, ratio=True)
    return with_unit(significant(chosen.per_si * value, digits), chosen.unit)


LEAST = 1 / 0.995
"""What rounds to the larger unit is said in it."""
