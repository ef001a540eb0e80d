"""The one door for what a user writes down in TOML (or the same in JSON): from a name to a table, or a refusal in words."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from geometry.errors import BadInput

FORMAT = 1
"""The format that every file of ours states, ``format = 1``."""

DEEPEST = 20
"""Levels of tables and lists in each other: no file of ours needs five, and beyond hundreds Python's own stack ends."""

LARGEST = 1e300
"""A whole number beyond is no number that can be calculated with."""


def read(name: str | Path, *, remedy: str = "Check the path") -> dict[str, Any]:
    """The table in the file `name`, JSON where its name ends so, else TOML; `remedy` is said when there is no such file.

    Raises
    ------
    BadInput : no name, no such file, a folder, a device, not UTF-8, not TOML or JSON (with the line), too deeply nested.
    OSError : the file cannot be read.
    """
    return parse(_text(str(name), remedy), str(name))


def parse(text: str, name: str) -> dict[str, Any]:
    """The table in `text`, JSON where `name` ends so, else TOML; `name` says where the text came from.

    Raises
    ------
    BadInput : not TOML or JSON (with the line), too deeply nested.
    """
    form, parser = ("JSON", _json) if name.lower().endswith(".json") else ("TOML", tomllib.loads)
    try:
        table = parser(text)
    except ValueError as error:  # also what Python says of a whole number of thousands of digits
        raise BadInput(
            source=name,
            problem=f"it is not {form}: {error}",
            remedy="Correct the place that it names; .json is read as JSON",
        ) from None
    except RecursionError:
        raise _too_deep(name) from None
    if not isinstance(table, dict):
        raise BadInput(source=name, problem="must hold one JSON object", remedy="Put the values into {...}")
    _require_plain(table, name, DEEPEST)
    return table


def require_format(table: Mapping[str, Any], source: str) -> None:
    """Refuse a `table` that does not state `FORMAT`.

    Raises
    ------
    BadInput : it is missing or another.
    """
    found = table.get("format")
    if found != FORMAT or isinstance(found, bool):
        problem = f"must be {FORMAT}, found {found!r}" if "format" in table else "is missing"
        raise BadInput(source=source, field="format", problem=problem, remedy=f"Write format = {FORMAT}")


def _text(name: str, remedy: str) -> str:
    path = Path(name)
    if not name.strip():
        raise BadInput(source="file", problem=f"the name is empty, found {name!r}", remedy=remedy)
    if path.is_dir():
        raise BadInput(source=name, problem="it is a folder, where a file is needed", remedy=remedy)
    if path.is_char_device() or path.is_block_device():
        raise BadInput(source=name, problem="it is a device, where a file is needed", remedy=remedy)
    if not path.exists():
        raise BadInput(source=name, problem="there is no such file", remedy=remedy)
    try:
        return path.read_text(encoding="utf-8")
    except UnicodeDecodeError as error:
        problem = f"it is not text in UTF-8, found the byte {error.object[error.start]:#04x} at place {error.start}"
        raise BadInput(source=name, problem=problem, remedy="Save it as UTF-8") from None


def _json(text: str) -> Any:
    return json.loads(text, parse_constant=_refused_constant)


def _refused_constant(word: str) -> None:
    raise ValueError(f"a value must be finite, found {word}")


def _require_plain(value: Any, source: str, levels: int) -> None:
    """Refuse what no reader behind this door could as much as print."""
    if isinstance(value, int) and abs(value) > LARGEST:
        raise BadInput(source=source, problem="it holds a whole number of hundreds of digits", remedy="Correct it")
    inner = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
    if inner and not levels:
        raise _too_deep(source)
    for each in inner:
        _require_plain(each, source, levels - 1)


def _too_deep(source: str) -> BadInput:
    problem = f"it is nested too deeply: more than {DEEPEST} tables or lists in each other"
    return BadInput(source=source, problem=problem, remedy="Check its brackets and dots")
