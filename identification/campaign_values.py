"""Values out of a parsed TOML file, checked one by one; what is wrong is collected, so that all of it can be said at once."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np

from geometry import keys
from geometry.arrays import Array
from geometry.errors import BadInput

LARGEST = 1e9
"""No figure of a test lies beyond, in whatever unit."""

T = TypeVar("T")


class Problems:
    """What is wrong, collected: the work goes on behind every problem that leaves something to be looked at."""

    def __init__(self) -> None:
        self.found: list[BadInput] = []

    def attempt(self, make: Callable[..., T], *given: Any, **named: Any) -> T | None:
        """What `make` makes of what it is given; None where it is refused, which is kept."""
        try:
            return make(*given, **named)
        except BadInput as error:
            self.found.append(error)
            return None


@dataclass(frozen=True, eq=False, kw_only=True)
class Reader:
    """Values of one file; a method returns None, or leaves the value out, where it added a problem.

    Attributes
    ----------
    source : the file, for messages
    problems : where what is wrong goes
    """

    source: str
    problems: Problems

    def refuse(self, field: str, problem: str, remedy: str) -> None:
        """Add what is wrong with `field`."""
        self.problems.found.append(BadInput(source=self.source, field=field, problem=problem, remedy=remedy))

    def table(self, table: Mapping[str, Any], key: str, known: tuple[str, ...]) -> dict[str, Any]:
        """The table `key`, empty where it is missing, without the keys that are not `known`."""
        found = self.problems.attempt(keys.require_table, table.get(key, {}), source=self.source, where=key) or {}
        return self.known(found, key, known)

    def known(self, table: dict[str, Any], where: str, known: tuple[str, ...]) -> dict[str, Any]:
        """`table` without the keys that are not `known`, each of them a problem."""
        for key in table:
            self.problems.attempt(keys.require_known, {key: 0}, known, source=self.source, where=where)
        return {key: value for key, value in table.items() if key in known}

    def strings(
        self, table: dict[str, Any], where: str, needed: tuple[str, ...], optional: tuple[str, ...] = ()
    ) -> dict[str, str]:
        """The texts under the `needed` keys, which may not be empty, and the `optional` ones."""
        self.problems.attempt(keys.require_present, table, needed, source=self.source, where=where)
        found = {key: table[key] for key in (*needed, *optional) if key in table}
        for key, value in found.items():
            if not isinstance(value, str) or (key in needed and not value.strip()):
                self.refuse(f"{where}.{key}", f"must be text, found {value!r}", "Write it between quotation marks")
        return {key: value for key, value in found.items() if isinstance(value, str)}

    def number(
        self, table: dict[str, Any], where: str, key: str, *, low: float = -LARGEST, high: float = LARGEST
    ) -> float | None:
        """The number under `key`, from `low` to `high`."""
        if key not in table:
            self.refuse(f"{where}.{key}", "is missing", "Add it")
            return None
        value = table[key]
        if is_number(value) and low <= value <= high:
            return float(value)
        span = f" from {low:g} to {high:g}" if (low, high) != (-LARGEST, LARGEST) else ""
        self.refuse(f"{where}.{key}", f"must be a finite number{span}, found {value!r}", "Correct it")
        return None

    def flag(self, table: dict[str, Any], where: str, key: str, default: bool) -> bool:
        """True or false under `key`, `default` where it is missing."""
        value = table.get(key, default)
        if not isinstance(value, bool):
            self.refuse(f"{where}.{key}", f"must be true or false, found {value!r}", "Correct it")
        return bool(value)

    def vector(self, value: Any, where: str, scale: float = 1.0) -> Array | None:
        """Three numbers times `scale`."""
        if not isinstance(value, list) or len(value) != 3 or not all(map(is_number, value)):
            self.refuse(where, f"must be three finite numbers, found {value!r}", "Write it like [0.1, 0.0, 0.03]")
            return None
        return np.array(value, dtype=np.float64) * scale

    def named(self, table: Mapping[str, Any], key: str, make: Callable[[dict[str, Any], str], T | None]) -> list[T]:
        """What `make` makes of every table of the array `key`, no two of one name."""
        entries = table.get(key, [])
        if not isinstance(entries, list) or not all(isinstance(entry, dict) for entry in entries):
            self.refuse(key, "must be tables", f"Write each as [[{key}]]")
            return []
        if not entries:
            self.refuse(key, "there is none", f"Write each as [[{key}]]")
        names = [entry.get("name") for entry in entries]
        for name in dict.fromkeys(n for n in names if isinstance(n, str) and names.count(n) > 1):
            self.refuse(f"{key}.{name}", f"{names.count(name)} have this name", "Give each its own")
        places = [name if isinstance(name, str) and name else str(k + 1) for k, name in enumerate(names)]
        made = [make(entry, f"{key}.{place}") for entry, place in zip(entries, places, strict=True)]
        return [one for one in made if one is not None]


def is_number(value: Any) -> bool:
    """Whether `value` is a number, no truth value, and of a size that a test has."""
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) <= LARGEST
