"""Measurement files: small TOML files with a unit for every value. The one door through which they come in.

    format = 1
    kind = "weighing"            # or "crane-cog", "pendulum", "results"
    title = "..."                # a sentence, printed above the results
    origin = "..."               # where the numbers come from; printed with every result

What else a file holds depends on its kind; `validation.weighing`, `validation.crane_cog`, `validation.pendulum_file` and
`validation.results_file` say so. A key that a kind does not know is refused by name, since a misspelt tolerance is a lost one.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any

from geometry import keys, toml_file
from geometry.errors import BadInput
from geometry.quantities import exact, quantity

if TYPE_CHECKING:
    from uncertainties import UFloat

KINDS = ("weighing", "crane-cog", "pendulum", "results")
HEAD = ("format", "kind", "title", "origin", "article")


@dataclass(frozen=True, eq=False, kw_only=True)
class Fields:
    """One table of a measurement file, with its place, so that every complaint can name it.

    Attributes
    ----------
    source : the file
    place : dotted path of the table in the file; empty for the file itself
    table : its keys and values
    inputs : quantities already read, by path: an input that several swings share stays one input, so that its tolerance does not
        average out between them
    """

    source: str
    place: str
    table: dict[str, Any]
    inputs: dict[str, UFloat] = field(default_factory=dict, repr=False)

    def path(self, key: str) -> str:
        """`key` with the path of its table."""
        return f"{self.place}.{key}" if self.place else key

    def refused(self, key: str, problem: str, remedy: str) -> BadInput:
        """The complaint about `key`, ready to be raised."""
        return BadInput(source=self.source, field=self.path(key), problem=problem, remedy=remedy)

    def only(self, allowed: Iterable[str]) -> Fields:
        """Pass unchanged; BadInput when the table has a key besides those `allowed`, with the nearest of them."""
        known = sorted(allowed)
        for key in self.table:
            if key not in known:
                raise self.refused(key, "no such key", f"{keys.nearest(key, known)}Known are {', '.join(known)}")
        return self

    def quantity(self, key: str, dimension: str, name: str = "") -> UFloat:
        """The quantity under `key`, in SI, called `name` in budgets; BadInput when it is absent or unreadable."""
        if key not in self.table:
            raise self.refused(key, f"a {dimension} is missing here", "Add it, with its unit and tolerance")
        path = self.path(key)
        if path not in self.inputs:
            label = name or key.replace("_", " ")
            self.inputs[path] = quantity(self.table[key], dimension, source=self.source, field=path, name=label)
        return self.inputs[path]

    def optional(self, key: str, dimension: str, name: str = "") -> UFloat | None:
        """The same, or None where `key` is absent."""
        return self.quantity(key, dimension, name) if key in self.table else None

    def quantity_or_zero(self, key: str, dimension: str) -> UFloat:
        """The same, or an exact zero where `key` is absent."""
        return self.quantity(key, dimension) if key in self.table else exact(0.0)

    def positive(self, key: str, dimension: str, name: str = "") -> UFloat:
        """The quantity under `key`; BadInput when it is not positive."""
        value = self.quantity(key, dimension, name)
        if value.nominal_value <= 0:
            raise self.refused(key, f"it must be positive, found {self.table[key]!r}", "Check the sign and the number")
        return value

    def text(self, key: str, default: str = "") -> str:
        """The text under `key`, or `default`; BadInput when it is something else."""
        value = self.table.get(key, default)
        if not isinstance(value, str):
            raise self.refused(key, f"a text is expected, found {value!r}", 'Put it in quotes, "like this"')
        return value

    def choice(self, key: str, choices: tuple[str, ...]) -> str:
        """The text under `key`, one of `choices`; BadInput else."""
        value = self.text(key)
        if value not in choices:
            raise self.refused(key, f"found {value!r}", f"{keys.nearest(value, choices)}Known are {', '.join(choices)}")
        return value

    def integer(self, key: str, default: int, least: int) -> int:
        """The whole number under `key`, at least `least`, or `default`."""
        value = self.table.get(key, default)
        if not isinstance(value, int) or isinstance(value, bool) or value < least:
            raise self.refused(
                key, f"a whole number, {least} or more, is expected, found {value!r}", "Write it without unit and quotes"
            )
        return value

    def switch(self, key: str, default: bool) -> bool:
        """true or false under `key`, or `default`."""
        value = self.table.get(key, default)
        if not isinstance(value, bool):
            raise self.refused(key, f"true or false is expected, found {value!r}", "Write it without quotes")
        return value

    def inner(self, key: str) -> Fields:
        """The table under `key`; empty where it is absent."""
        value = self.table.get(key, {})
        if not isinstance(value, dict):
            raise self.refused(key, f"a table is expected, found {value!r}", f"Start it with [{self.path(key)}]")
        return Fields(source=self.source, place=self.path(key), table=value, inputs=self.inputs)

    def each(self, key: str) -> tuple[Fields, ...]:
        """The tables under `key`, one or more; BadInput when there is none."""
        value = self.table.get(key, [])
        if not isinstance(value, list) or not value or not all(isinstance(entry, dict) for entry in value):
            raise self.refused(key, "one table or more is expected", f"Start each with [[{self.path(key)}]]")
        places = [f"{self.path(key)}[{i}]" for i in range(1, len(value) + 1)]
        return tuple(
            Fields(source=self.source, place=place, table=entry, inputs=self.inputs)
            for place, entry in zip(places, value, strict=True)
        )


def read(name: str, kinds: tuple[str, ...]) -> Fields:
    """The measurement file at path `name`, or shipped under that name (with or without ``.toml``), of one of `kinds`.

    Raises
    ------
    BadInput : no such file, a folder, not TOML, another format number or another kind.
    """
    fields = Fields(source=name, place="", table=_table(name, kinds))
    toml_file.require_format(fields.table, name)
    kind = fields.choice("kind", KINDS)
    if kind not in kinds:
        commands = {"weighing": "massline weigh", "crane-cog": "massline cog", "pendulum": "massline pendulum"}
        problem = f"this is a {kind} file, where {' or '.join(kinds)} is needed"
        raise fields.refused("kind", problem, f"Reduce it with `{commands.get(kind, 'weigh, cog or pendulum')}`")
    return fields


def shipped(kinds: tuple[str, ...] = KINDS) -> tuple[str, ...]:
    """Names of the measurement files of `kinds` that come with massline."""
    return tuple(sorted(name for name, kind in _shipped_kinds().items() if kind in kinds))


@cache
def _shipped_kinds() -> dict[str, str]:
    """Kind by name of everything published that has one; what has none (a table, a result file) is no measurement file."""
    entries = [entry for entry in files("validation").joinpath("published").iterdir() if entry.name.endswith(".toml")]
    tables = {entry.name.removesuffix(".toml"): tomllib.loads(entry.read_text(encoding="utf-8")) for entry in entries}
    return {name: table["kind"] for name, table in tables.items() if "kind" in table}


def _table(name: str, kinds: tuple[str, ...]) -> dict[str, Any]:
    bare = name.removesuffix(".toml")
    if bare in shipped() and not Path(name).is_file():
        return tomllib.loads(files("validation").joinpath("published", f"{bare}.toml").read_text(encoding="utf-8"))
    known = shipped(kinds)
    return toml_file.read(name, remedy=f"{keys.nearest(name, known)}Shipped with massline are {', '.join(known)}")
