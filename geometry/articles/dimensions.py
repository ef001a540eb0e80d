"""Reads the dimension files beside the articles: lengths leave here in metres, names without their unit."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from importlib.resources import files
from types import MappingProxyType
from typing import Any

from geometry.articles.changes import apply

Dimensions = dict[str, Any]
"""One dimension file or a table of it: numbers in SI, strings, and nested tables."""


def load(name: str, changes: Mapping[str, float] = MappingProxyType({})) -> Dimensions:
    """The dimensions of the built-in part `name`, from ``geometry/articles/<name>.toml``; lengths [m], angles [rad].

    `changes` replace entries, in the file's own units; `geometry.articles.changes` says how they are named and what is refused.
    """
    text = files("geometry.articles").joinpath(f"{name}.toml").read_text(encoding="utf-8")
    return to_si(apply(tomllib.loads(text), name, changes))


def to_si(table: dict[str, Any]) -> Dimensions:
    """`table` with every ``…_mm`` turned into metres and every ``…_deg`` into radians, the suffix dropped."""
    return dict(_converted(key, value) for key, value in table.items())


def _converted(key: str, value: Any) -> tuple[str, Any]:
    if isinstance(value, dict):
        return key, to_si(value)
    if isinstance(value, list) and value and isinstance(value[0], dict):
        return key, [to_si(entry) for entry in value]
    for suffix, factor in (("_mm", 1e-3), ("_deg", 0.017453292519943295)):
        if key.endswith(suffix):
            scaled = [v * factor for v in value] if isinstance(value, list) else value * factor
            return key.removesuffix(suffix), scaled
    return key, value
