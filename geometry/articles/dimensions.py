"""Reads the dimension files beside the articles: lengths leave here in metres, names without their unit."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from geometry import toml_file
from geometry.errors import BadInput
from geometry.toml_file import nearest

# A user's own dimensions on top of the built-in ones.
#
# A key is the dimension file, the tables in it and the entry, joined by dots, in the file's own unit:
# ``fmd.load_cell.moving_fraction`` or ``clumod.blade.lower-1.length_mm``. An entry of a list of tables is
# named by its ``name``.


def apply(table: dict[str, Any], file: str, changes: Mapping[str, float]) -> dict[str, Any]:
    """Put `changes` that begin with `file` into `table`, the raw content of its dimension file, and return it.

    Raises
    ------
    BadInput : a key that is not in the file, or that is no number there.
    """
    for key, value in changes.items():
        head, *steps = key.split(".")
        if head == file:
            found: Any = table
            inner: Any = table
            for step in steps:
                # The entry `step` of a table, or of a list of tables that have names
                entries = _entries(found)
                if step in entries:
                    named = entries[step]
                else:
                    remedy = f"{nearest(step, entries)}Known are {', '.join(entries) or 'no further entries'}"
                    raise _refused(key, f"there is no {step!r} here", remedy)
                inner, found = found, named
            if isinstance(found, dict) or (isinstance(found, list) and found and isinstance(found[0], dict)):
                names = ", ".join(f"{key}.{name}" for name, entry in _entries(found).items() if not isinstance(entry, str))
                raise _refused(key, "this is a table of dimensions", f"Name one of {names}")
            if isinstance(found, bool) or not isinstance(found, (int, float)):
                raise _refused(key, f"only a number can be changed, found {found!r}", "Name a number")
            inner[steps[-1]] = type(found)(value) if isinstance(found, float) or float(value).is_integer() else _whole(key, value)
    return table


def changed_files(changes: Mapping[str, float]) -> set[str]:
    """The dimension files that `changes` speak of."""
    return {key.split(".")[0] for key in changes}


def _whole(key: str, value: float) -> int:
    raise _refused(key, f"this is a count, found {value:g}", "Give a whole number")


def _entries(table: Any) -> dict[str, Any]:
    """By name what a table holds, or a list of tables that have names; nothing of anything else."""
    if isinstance(table, list):
        return {entry["name"]: entry for entry in table if isinstance(entry, dict)}
    return table if isinstance(table, dict) else {}


def _refused(key: str, problem: str, remedy: str) -> BadInput:
    return BadInput(source=f"--set, dimension file {key.split('.')[0]}.toml", field=key, problem=problem, remedy=remedy)


Dimensions = dict[str, Any]
"""One dimension file or a table of it: numbers in SI, strings, and nested tables."""


def load(name: str, changes: Mapping[str, float] = MappingProxyType({})) -> Dimensions:
    """The dimensions of the built-in part `name`, from ``geometry/articles/<name>.toml``; lengths [m], angles [rad].

    `changes` replace entries, in the file's own units; `geometry.articles.dimensions` says how they are named and what is
    refused.
    """
    return to_si(apply(toml_file.shipped("geometry.articles", f"{name}.toml"), name, changes))


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
