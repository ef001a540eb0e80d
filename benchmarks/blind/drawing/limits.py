"""Detection limits by id, from ``limits.json``, which ``python -m benchmarks.blind.limits`` makes."""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from types import MappingProxyType

from geometry.sensors import Tolerances
from validation.effects.catalogue import FAMILIES
from validation.effects.effect import TABLE
from validation.model.model import StructureTolerances

FILE = Path(__file__).with_name("limits.json")

STUDY: Mapping[str, float] = MappingProxyType(
    {
        "force-gain": 0.015,
        "point-mass:mast-top": 0.1,
        "force-delay": 100e-6,
        "accelerometer-delay": 100e-6,
        "modulus:mast": 0.035,
        "accelerometer-position": 2.5e-3,
        "appendage": 0.010,
    }
)
"""The limits of the feasibility study, by id or family, which ours may not exceed."""

TOLERANCES = 5.0
"""Tolerances within which nothing is told from what a careful laboratory admits."""


@cache
def found() -> Mapping[str, float]:
    """By id what development nulls say, SI."""
    stated: dict[str, dict[str, float]] = json.loads(FILE.read_text(encoding="utf-8"))
    return MappingProxyType(stated["limits"])


def limit(id: str) -> float:
    """The size of which those that are planted are multiples: no larger than the study's.

    Raises
    ------
    KeyError : nothing is known of `id`; make the file again.
    """
    return min(found()[id], STUDY.get(id, STUDY.get(id.partition(":")[0], float("inf"))))


def told(id: str) -> float:
    """The size below which what a careful laboratory admits hides it, or data; it may lie above `limit`."""
    return max(found()[id], TOLERANCES * tolerance(id))


def tolerance(id: str) -> float:
    """One standard deviation of what is admitted; 0 for nothing."""
    family, _, target = id.partition(":")
    if family == "modulus":
        return StructureTolerances().modulus
    if family == "accelerometer-gain" and target in TABLE:
        return Tolerances().table_gain
    return FAMILIES[family].tolerance
