"""A user's own dimensions on top of the built-in ones.

A key is the dimension file, the tables in it and the entry, joined by dots, in the file's own unit:
``fmd.load_cell.moving_fraction`` or ``clumod.blade.lower-1.length_mm``. An entry of a list of tables is
named by its ``name``.
"""

from __future__ import annotations

import difflib
from collections.abc import Mapping
from typing import Any

from geometry.errors import BadInput


def apply(table: dict[str, Any], file: str, changes: Mapping[str, float]) -> dict[str, Any]:
    """Put `changes` that begin with `file` into `table`, the raw content of its dimension file, and return it.

    Raises
    ------
    BadInput : a key that is not in the file, or that is no number there.
    """
    for key, value in changes.items():
        head, *steps = key.split(".")
        if head == file:
            _put(table, steps, value, key)
    return table


def files(changes: Mapping[str, float]) -> set[str]:
    """The dimension files that `changes` speak of."""
    return {key.split(".")[0] for key in changes}


def _put(table: dict[str, Any], steps: list[str], value: float, key: str) -> None:
    *tables, entry = steps or [""]
    inner: Any = table
    for step in tables:
        inner = _named(inner, step, key)
    found = _named(inner, entry, key)
    if isinstance(found, bool) or not isinstance(found, (int, float)):
        raise BadInput(
            source="dimensions",
            field=key,
            problem=f"only a number can be changed, found {type(found).__name__} {found!r}",
            remedy="Name a number",
        )
    inner[entry] = type(found)(value) if isinstance(found, float) or float(value).is_integer() else _whole(key, value)


def _whole(key: str, value: float) -> int:
    raise BadInput(source="dimensions", field=key, problem=f"this is a count, found {value:g}", remedy="Give a whole number")


def _named(table: Any, name: str, key: str) -> Any:
    """The entry `name` of a table, or of a list of tables that have names."""
    entries = {entry["name"]: entry for entry in table} if isinstance(table, list) else table
    if isinstance(entries, dict) and name in entries:
        return entries[name]
    known = list(entries) if isinstance(entries, dict) else []
    near = difflib.get_close_matches(name, known, n=1)
    raise BadInput(
        source="dimensions",
        field=key,
        problem=f"there is no {name!r} here",
        remedy=(f"Did you mean {near[0]}? " if near else "") + f"Known are {', '.join(known) or 'no further entries'}",
    )
