"""SI figures as people say them in a laboratory: per cent, millimetres, microseconds, grams, degrees."""

from __future__ import annotations

from math import floor, isfinite, log10, pi

STEPS = {
    "kg": ((1.0, "kg"), (1e-3, "g"), (1e-6, "mg")),
    "m": ((1.0, "m"), (1e-3, "mm"), (1e-6, "µm")),
    "s": ((1.0, "s"), (1e-3, "ms"), (1e-6, "µs")),
    "1": ((1e-2, "%"), (1e-6, "ppm")),
    "rad": ((pi / 180, "°"), (pi / 180e3, "mdeg")),
    "N": ((1e3, "kN"), (1.0, "N"), (1e-3, "mN")),
    "N/m": ((1e6, "N/µm"), (1e3, "N/mm"), (1.0, "N/m")),
    "m/N": ((1e-3, "mm/N"), (1e-6, "µm/N"), (1e-9, "nm/N"), (1e-12, "pm/N")),
    "rad/(N m)": ((1e-6, "µrad/(N m)"), (1e-9, "nrad/(N m)")),
    "kg m": ((1.0, "kg m"), (1e-3, "g m")),
    "kg m^2": ((1.0, "kg m²"), (1e-3, "g m²")),
    "Hz": ((1.0, "Hz"), (1e-3, "mHz")),
    "m/s^2": ((1.0, "m/s²"), (1e-3, "mm/s²")),
}
"""By SI unit the units of which the largest that leaves a whole digit is used: how many SI units it is, and its name."""

LEAST = 0.995
"""Figure below which a smaller unit is taken."""


def scaled(value: float, unit: str) -> tuple[float, str]:
    """`value` [SI, `unit`] in a unit that people use, and that unit; one of no such list stays as it is."""
    steps = STEPS.get(unit, ((1.0, unit),))
    return next(((value / one, name) for one, name in steps if abs(value) >= LEAST * one), (value / steps[-1][0], steps[-1][1]))


def said(value: float, unit: str, digits: int = 2) -> str:
    """`value` [SI, `unit`] with so many significant `digits` and its practical unit: "12 mm"."""
    if value == 0 or not isfinite(value):
        return f"{value:g} {STEPS.get(unit, ((1.0, unit),))[0][1]}"
    size, name = scaled(value, unit)
    return f"{significant(size, digits)} {name}"


def significant(value: float, digits: int) -> str:
    """`value` rounded to `digits` significant digits, without an exponent where that reads well."""
    if value == 0:
        return "0"
    decimals = digits - 1 - floor(log10(abs(float(f"{value:.{digits - 1}e}"))))
    return f"{value:.{digits - 1}e}" if decimals > 6 else f"{round(value, decimals):.{max(decimals, 0)}f}"
