"""Tables of a user's file, checked at the door: no key that nobody reads, none missing, and the nearest name suggested."""

from __future__ import annotations

import difflib
from collections.abc import Collection, Mapping
from typing import Any

from geometry.errors import BadInput


def require_known(table: Mapping[str, Any], known: Collection[str], *, source: str, where: str = "") -> None:
    """Refuse a key of `table` that is not in `known`.

    Raises
    ------
    BadInput : the first unknown key, with the nearest known one.
    """
    for key in table:
        if key not in known:
            raise BadInput(
                source=source,
                field=f"{where}.{key}" if where else key,
                problem=f"found the unknown key {key!r}",
                remedy=nearest(key, known) + f"Known are {', '.join(known)}",
            )


def require_present(table: Mapping[str, Any], needed: Collection[str], *, source: str, where: str = "") -> None:
    """Refuse a `table` that lacks a key of `needed`.

    Raises
    ------
    BadInput : the first missing key, with the nearest one that is there instead.
    """
    for key in needed:
        if key not in table:
            like = difflib.get_close_matches(key, list(table), n=1)
            instead = f", found {like[0]!r} instead" if like else ""
            raise BadInput(
                source=source, field=f"{where}.{key}" if where else key, problem=f"is missing{instead}", remedy="Add it"
            )


def require_table(value: object, *, source: str, where: str) -> dict[str, Any]:
    """`value`, which must be a table.

    Raises
    ------
    BadInput : it is something else.
    """
    if not isinstance(value, dict):
        raise BadInput(source=source, field=where, problem=f"must be a table, found {value!r}", remedy=f"Write it as [{where}]")
    return value


def one_of(value: object, choices: Collection[str], *, source: str, where: str) -> str:
    """`value`, which must be one of the words `choices`.

    Raises
    ------
    BadInput : it is not; with the nearest.
    """
    if isinstance(value, str) and value in choices:
        return value
    raise BadInput(
        source=source,
        field=where,
        problem=f"must be one of {', '.join(choices)}, found {value!r}",
        remedy=nearest(str(value), choices) or "Choose one of them",
    )


def nearest(word: str, known: Collection[str]) -> str:
    """'Did you mean ...? ', or nothing when no known word is near."""
    near = difflib.get_close_matches(word, list(known), n=1)
    return f"Did you mean {near[0]}? " if near else ""
