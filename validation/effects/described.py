"""A family in words: its identifier, its sizes with their limits, its tolerance, and what is plausible of it."""

from __future__ import annotations

from collections.abc import Mapping
from math import exp, isfinite
from types import MappingProxyType
from typing import Any

from validation.effects.catalogue import SOURCES
from validation.effects.family import (
    BODY_STAGE,
    CHANNEL_STAGE,
    NOISE_STAGE,
    OPENED,
    PERIOD_STAGE,
    STRUCTURE_STAGE,
    Family,
    Size,
)
from validation.rows import NONE

DOES: Mapping[str, str] = MappingProxyType(
    {
        STRUCTURE_STAGE: "changes masses, springs and losses of the structure",
        BODY_STAGE: "changes the dynamic mass of the article on its place",
        CHANNEL_STAGE: "changes what channels read",
        NOISE_STAGE: "changes how much noise is expected",
        PERIOD_STAGE: "changes the period of a pendulum",
        OPENED: "opens the tolerance of its name as wide as a fault may be",
    }
)
"""By stage, what an effect does to a prediction."""


SHORT = MappingProxyType(
    {
        "force channel": "channel",
        "accelerometer": "channel",
        "lateral axis": "axis",
        "turning axis": "axis",
        "cell and axis": "cell",
        "pair of axes": "axes",
        "part with a layer": "part",
        "direction of the joint": "direction",
        "direction of the FMD": "direction",
        "direction of a cable": "direction",
    }
)
"""Kinds of targets in one word."""

PREFIXED = MappingProxyType({"s": (1e-6, "µs"), "m": (1e-3, "mm"), "rad": (1e-3, "mrad")})
"""By unit of a size, the one in which its tolerance reads best, and its factor."""


def examples(family: Family) -> tuple[str, ...]:
    """What can be typed."""
    return tuple(family.example.split(", or "))


def identifier(family: Family) -> str:
    """``accelerometer-position:CHANNEL:AXIS``"""
    words = [SHORT.get(one, one).upper() for one in family.targets]
    last = f"[:{words.pop()}]" if family.optional else ""
    return ":".join((family.name, *words)) + last


def targets(family: Family) -> str:
    """What it acts on, in words."""
    words = [*family.targets]
    if family.optional:
        words[-1] = f"[{words[-1]}]"
    return ", ".join(words) or NONE


def sizes(family: Family) -> tuple[Size, ...]:
    """All sizes that its value may hold, whatever the target, each once."""
    return tuple(dict.fromkeys((*family.sizes, *(one for varying in family.varying.values() for one in varying))))


def limits(size: Size) -> str:
    """``m: 1e-06 to 100 kg``"""
    unit = "" if size.unit == "1" else f" {size.unit}"
    said = f"{size.low:g} or {size.high:g}" if size.whole else f"{size.low:.3g} to {size.high:.3g}{unit}"
    return _of(size, said)


def unit(family: Family) -> str:
    """Of every size."""
    return ", ".join(dict.fromkeys(_of(size, size.unit) for size in sizes(family))) or NONE


def plausible(family: Family) -> str:
    """Standard deviation of a fault, of every size that is fitted; × 7.4 is a factor either way."""
    return ", ".join(dict.fromkeys(_plausible(one) for one in sizes(family) if one.plausible > 0)) or NONE


def tolerance(family: Family) -> str:
    """Standard deviation of what a careful laboratory admits."""
    first = next(iter(sizes(family)), None)
    return _measured(family.tolerance, first.unit) if family.tolerance and first else NONE


def sentence(family: Family, named: str = "") -> str:
    """What it means at the targets of `named`, ``one:two``, or at those of its example."""
    there = named or examples(family)[0].partition("=")[0].removeprefix(family.name).lstrip(":")
    words = there.split(":")
    return family.sentence.replace("{targets}", " and ".join(words)).replace("{target}", words[0])


def as_json(family: Family) -> dict[str, Any]:
    """One entry of ``massline effects --json``."""
    return {
        "id": family.name,
        "side": family.side,
        "what": family.what,
        "sentence": sentence(family),
        "targets": list(family.targets),
        "last_target_optional": family.optional,
        "sizes": [_size_json(size) for size in family.sizes],
        "sizes_by_target": {target: [_size_json(size) for size in varying] for target, varying in family.varying.items()},
        "tolerance": family.tolerance or None,
        "changes": family.stage,
        "equation": family.equation,
        "mistaken_for": list(family.mistaken_for),
        "confirmed_by": family.confirmed_by,
        "reference": family.reference,
        "examples": list(examples(family)),
        "from": SOURCES.get(family.name, "massline"),
    }


def _size_json(size: Size) -> dict[str, Any]:
    return {
        "key": size.key,
        "unit": size.unit,
        "low": size.low,
        "high": size.high,
        "default": size.default,
        "whole": size.whole,
        "null": size.null if isfinite(size.null) else None,
        "plausible": size.plausible or None,
        "logarithmic": size.logarithmic,
    }


def _of(size: Size, said: str) -> str:
    return f"{size.key}: {said}" if size.key else said


def _plausible(size: Size) -> str:
    said = f"× {_plain(exp(size.plausible))}" if size.logarithmic else _measured(size.plausible, size.unit)
    return "on or off" if size.whole else f"{size.key} {said}".strip()


def _measured(value: float, unit: str) -> str:
    """``0.3 %``, ``20 µs``, ``0.5 mm``: as people write it."""
    if unit == "1":
        return f"{_plain(100 * value)} %"
    scale, prefixed = PREFIXED.get(unit, (1.0, unit))
    return f"{_plain(value / scale)} {prefixed}"


def _plain(value: float) -> str:
    """Two digits, without an exponent from a thousandth to a million."""
    return f"{float(f'{value:.2g}'):g}".replace("e-0", "e-")
