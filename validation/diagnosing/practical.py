"""A figure with its practical unit and so many digits, for sentences: "12 mm". Units are those of `diagnosing.figures`."""

from __future__ import annotations

from math import floor, isfinite, log10

from validation.diagnosing import figures


def said(value: float, unit: str, digits: int = 2) -> str:
    """`value` [SI, `unit`] with so many significant `digits`; a ratio is a per cent."""
    chosen = figures.scale(unit, LEAST * value, ratio=True)
    return figures.with_unit(significant(chosen.per_si * value, digits), chosen.unit)


LEAST = 1 / 0.995
"""What rounds to the larger unit is said in it."""


def significant(value: float, digits: int) -> str:
    """`value` rounded to `digits` significant digits, without an exponent where that reads well."""
    if value == 0 or not isfinite(value):
        return f"{value:g}"
    decimals = digits - 1 - floor(log10(abs(float(f"{value:.{digits - 1}e}"))))
    return f"{value:.{digits - 1}e}" if decimals > MANY else f"{round(value, decimals):.{max(decimals, 0)}f}"


MANY = 6
"""Decimals beyond which zeros would be counted."""
