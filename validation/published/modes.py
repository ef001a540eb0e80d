"""What the paper prints about the eigenfrequencies of an article, and whether a model's are so."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any

import numpy as np

from geometry.arrays import Array


@dataclass(frozen=True, kw_only=True)
class Claim:
    """One sentence of the paper.

    Attributes
    ----------
    says : the sentence
    found : what the model has instead, in the same words
    holds : whether it is so within the rounding of the print; None where too few modes were computed to tell
    """

    says: str
    found: str
    holds: bool | None


def claims(article: str, frequency: Array) -> tuple[Claim, ...]:
    """Every sentence about the eigenfrequencies of `article`, held against `frequency` (n,) [Hz]; empty where there is none."""
    return tuple(_claim(entry, frequency) for entry in _table().get(article, ()))


def _claim(entry: Mapping[str, Any], frequency: Array) -> Claim:
    if "count" in entry:
        low, high = entry["between_hz"]
        count = int(np.sum((frequency >= low) & (frequency <= high)))
        enough = len(frequency) > 0 and frequency[-1] > high
        return Claim(says=entry["says"], found=f"{count} modes", holds=count == entry["count"] if enough else None)
    if len(frequency) < entry["mode"]:
        return Claim(says=entry["says"], found=f"{len(frequency)} modes computed", holds=None)
    found = float(frequency[entry["mode"] - 1])
    holds = found >= entry["above_hz"] if "above_hz" in entry else abs(found - entry["hz"]) <= entry["half_hz"]
    return Claim(says=entry["says"], found=f"mode {entry['mode']} at {found:.2f} Hz", holds=holds)


@cache
def _table() -> dict[str, Any]:
    return tomllib.loads(files("validation.published").joinpath("modes.toml").read_text(encoding="utf-8"))
