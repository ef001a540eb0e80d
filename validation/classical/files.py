"""Measurement files: small TOML files with a unit for every value. The one door through which they come in.

    format = 1
    kind = "weighing"            # or "crane-cog", "pendulum", "results"
    title = "..."                # a sentence, printed above the results
    origin = "..."               # where the numbers come from; printed with every result

What else a file holds depends on its kind; `validation.classical.weigh`, `validation.classical.pendulum` and this file say so.
A key that a kind does not know is refused by name, since a misspelt tolerance is a lost one.
"""

import math
import tomllib
from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any

from geometry import toml_file
from geometry.errors import BadInput
from geometry.toml_file import doubtful_at_first_order, exact, nearest, quantity, tagged
from validation.output import derived, entry, unwritten
from validation.reference.statement import Row

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
    inputs: "dict[str, UFloat]" = field(default_factory=dict, repr=False)

    def path(self, key: str) -> str:
        """`key` with the path of its table."""
        return f"{self.place}.{key}" if self.place else key

    def refused(self, key: str, problem: str, remedy: str) -> BadInput:
        """The complaint about `key`, ready to be raised."""
        return BadInput(self.source, self.path(key), problem, remedy)

    def only(self, allowed: Iterable[str]) -> "Fields":
        """Pass unchanged; BadInput when the table has a key besides those `allowed`, with the nearest of them."""
        known = sorted(allowed)
        for key in self.table:
            if key not in known:
                raise self.refused(key, "no such key", f"{toml_file.nearest(key, known)}Known are {', '.join(known)}")
        return self

    def quantity(self, key: str, dimension: str, name: str = "") -> "UFloat":
        """The quantity under `key`, in SI, called `name` in budgets; BadInput when it is absent or unreadable."""
        if key not in self.table:
            raise self.refused(key, f"a {dimension} is missing here", "Add it, with its unit and tolerance")
        path = self.path(key)
        if path not in self.inputs:
            label = name or key.replace("_", " ")
            self.inputs[path] = quantity(self.table[key], dimension, source=self.source, field=path, name=label)
        return self.inputs[path]

    def optional(self, key: str, dimension: str, name: str = "") -> "UFloat | None":
        """The same, or None where `key` is absent."""
        return self.quantity(key, dimension, name) if key in self.table else None

    def quantity_or_zero(self, key: str, dimension: str) -> "UFloat":
        """The same, or an exact zero where `key` is absent."""
        return self.quantity(key, dimension) if key in self.table else exact(0.0)

    def positive(self, key: str, dimension: str, name: str = "") -> "UFloat":
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
            raise self.refused(key, f"found {value!r}", f"{toml_file.nearest(value, choices)}Known are {', '.join(choices)}")
        return value

    def integer(self, key: str, default: int, least: int) -> int:
        """The whole number under `key`, at least `least`, or `default`."""
        value = self.table.get(key, default)
        if not toml_file.is_whole(value) or value < least:
            remedy = "Write it without unit and quotes"
            raise self.refused(key, f"a whole number, {least} or more, is expected, found {value!r}", remedy)
        return value

    def switch(self, key: str, default: bool) -> bool:
        """true or false under `key`, or `default`."""
        value = self.table.get(key, default)
        if not isinstance(value, bool):
            raise self.refused(key, f"true or false is expected, found {value!r}", "Write it without quotes")
        return value

    def inner(self, key: str) -> "Fields":
        """The table under `key`; empty where it is absent."""
        value = self.table.get(key, {})
        if not isinstance(value, dict):
            raise self.refused(key, f"a table is expected, found {value!r}", f"Start it with [{self.path(key)}]")
        return Fields(source=self.source, place=self.path(key), table=value, inputs=self.inputs)

    def each(self, key: str) -> "tuple[Fields, ...]":
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
    bare = name.removesuffix(".toml")
    if bare in shipped() and not Path(name).is_file():
        table = _shipped()[bare]
    else:
        known = shipped(kinds)
        remedy = f"{toml_file.nearest(name, known)}Shipped with massline are {', '.join(known)}"
        table = toml_file.read(name, remedy=remedy)
    fields = Fields(source=name, place="", table=table)
    toml_file.require_format(fields.table, name)
    if "model" in fields.table and "kind" not in fields.table:
        problem = "it is a model file, where a measurement is needed"
        raise BadInput(name, "", problem, "MODEL comes first and DATA, campaigns or measurements, behind it")
    kind = fields.choice("kind", KINDS)
    if kind not in kinds:
        commands = {"weighing": "massline weigh", "crane-cog": "massline cog", "pendulum": "massline pendulum"}
        problem = f"this is a {kind} file, where {' or '.join(kinds)} is needed"
        raise fields.refused("kind", problem, f"Reduce it with `{commands.get(kind, 'weigh, cog or pendulum')}`")
    return fields


def shipped(kinds: tuple[str, ...] = KINDS) -> tuple[str, ...]:
    """Names of the measurement files of `kinds` that come with massline."""
    return tuple(sorted(name for name, table in _shipped().items() if table["kind"] in kinds))


@cache
def _shipped() -> dict[str, dict[str, Any]]:
    """By name everything published that has a kind; what has none (a table, a result file) is no measurement file."""
    entries = [entry for entry in files("validation.reference").joinpath("in_print").iterdir() if entry.name.endswith(".toml")]
    tables = {entry.name.removesuffix(".toml"): tomllib.loads(entry.read_text(encoding="utf-8")) for entry in entries}
    return {name: table for name, table in tables.items() if "kind" in table}


# The tolerance of a result, itemised: what each input contributes, and which one dominates.


@dataclass(frozen=True, eq=False, kw_only=True)
class Item:
    """One input's part in the tolerance of a result.

    Attributes
    ----------
    name : the input's name
    value, tolerance : of the input, SI; of the first one where several share the name (readings of one kind)
    contribution : |d result / d input| times the tolerance, in the unit of the result
    share : of the result's variance, 0 to 1
    """

    name: str = entry("input")
    value: float = entry("value_si")
    tolerance: float = entry("tolerance_si")
    contribution: float = entry("contribution_si")
    share: float


def itemised(result: "UFloat") -> tuple[Item, ...]:
    """The inputs that make the tolerance of `result`, the largest first; inputs of one name are taken together."""
    parts: dict[str, list[tuple[Any, float]]] = defaultdict(list)
    for variable, part in result.error_components().items():
        parts[variable.tag or "unnamed"].append((variable, part))
    variance = sum(part**2 for named in parts.values() for _, part in named)
    items = []
    for name, named in parts.items():
        first, contribution = named[0][0], math.sqrt(sum(part**2 for _, part in named))
        share = contribution**2 / variance if variance else 0.0
        item = Item(name=name, value=first.nominal_value, tolerance=first.std_dev, contribution=contribution, share=share)
        items.append(item)
    return tuple(sorted((item for item in items if item.contribution > 0), key=lambda item: -item.contribution))


def dominating(result: "UFloat") -> str:
    """Name of the input with the largest share; empty when `result` is exact."""
    items = itemised(result)
    return items[0].name if items else ""


# `Reduction`: what a measurement file comes down to, as rows, as budgets, on paper and as JSON.


QUANTITIES = {
    "mass": ("mass", "kg", 1.0),
    "cog_x": ("CoG x", "mm", 1e3),
    "cog_y": ("CoG y", "mm", 1e3),
    "cog_z": ("CoG z", "mm", 1e3),
    "Ixx": ("MoI xx about the CoG", "kg m²", 1.0),
    "Iyy": ("MoI yy about the CoG", "kg m²", 1.0),
    "Izz": ("MoI zz about the CoG", "kg m²", 1.0),
    "Ixy": ("PoI xy about the CoG", "kg m²", 1.0),
    "Ixz": ("PoI xz about the CoG", "kg m²", 1.0),
    "Iyz": ("PoI yz about the CoG", "kg m²", 1.0),
    "rope_force": ("force of the crane's rope", "N", 1.0),
}
"""Key of a result -> its words, the unit it is printed in, and how many of that unit make one SI unit."""

KEYS = tuple(QUANTITIES)[:10]
"""Of mass, CoG and moments, in the order of `identification.request.quantities`."""

SMALL_SHARE = 0.01
"""Share of the variance below which an input cannot spoil a result, however wide its own tolerance."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Reduction:
    """The results of one measurement.

    Attributes
    ----------
    title : a sentence on what was measured
    origin : where the numbers come from; it stands with every result
    article : name of the article, empty where the file names none
    results : key of `QUANTITIES` -> value with tolerance, SI
    notes : what the user should know, sentences
    terms : key -> {correction: relative change that it makes to the result}
    assumed : whether the tolerances are assumed rather than stated by whoever measured
    reference : by the same keys what the results are held against, SI
    """

    article: str
    origin: str
    title: str = unwritten()
    results: "Mapping[str, UFloat]" = unwritten()
    notes: tuple[str, ...] = unwritten(default=())
    terms: Mapping[str, Mapping[str, float]] = unwritten(default_factory=dict)
    assumed: bool = entry("tolerances", write=lambda assumed: "assumed" if assumed else "stated", default=False)
    reference: "Mapping[str, UFloat]" = unwritten(default_factory=dict)

    @property
    @derived("rows", before="article")
    def rows(self) -> list[Row]:
        """One row a result, beside its reference where it has one."""
        made = []
        for key, value in self.results.items():
            words, unit, factor = QUANTITIES[key]
            known = self.reference.get(key)
            made.append(
                Row(
                    quantity=words,
                    value=factor * value.nominal_value,
                    tolerance=factor * value.std_dev,
                    unit=unit,
                    reference=None if known is None else factor * known.nominal_value,
                    reference_tolerance=None if known is None else factor * known.std_dev or None,
                    dominated_by=dominating(value),
                )
            )
        return made

    @property
    @derived("budget")
    def budgets(self) -> dict[str, tuple[Item, ...]]:
        """By the words of a result, what makes its tolerance."""
        return {QUANTITIES[key][0]: itemised(value) for key, value in self.results.items()}

    @property
    @derived("corrections_percent")
    def corrections_percent(self) -> dict[str, dict[str, float]]:
        """By the words of a result, what every correction makes of it."""
        return {QUANTITIES[key][0]: {name: 100 * part for name, part in parts.items()} for key, parts in self.terms.items()}

    @property
    @derived("notes")
    def all_notes(self) -> tuple[str, ...]:
        """The notes, one for every input that matters and whose tolerance is too large for first order, and `impossible`."""
        items = [item for value in self.results.values() for item in itemised(value) if item.share > SMALL_SHARE]
        wide = dict.fromkeys(item.name for item in items if doubtful_at_first_order(item.value, item.tolerance))
        said = [f"The tolerance of {name} exceeds 10 % of it: first order is doubtful." for name in wide]
        return (*self.notes, *said, *([self.impossible] if self.impossible else []))

    @property
    def impossible(self) -> str:
        """Why no body has these moments of inertia, even within their tolerance, a sentence; empty when one may have them."""
        if not {"Ixx", "Iyy", "Izz"} <= self.results.keys():
            return ""
        moments = [self.results[key] for key in ("Ixx", "Iyy", "Izz")]
        excess = 2 * max(moments, key=lambda m: m.nominal_value) - sum(moments)
        if excess.nominal_value <= excess.std_dev:
            return ""
        return f"No body has these moments: the largest exceeds the sum of the others by {excess.nominal_value:.3g} kg m²."


# Published results as such: what somebody printed, when the readings behind it are not known.
#
# kind = "results"
# [article]
# name = "clumod-4"
# [tolerance]
# assumed = true               # the tolerances below are ours, not theirs; every output says so
# [mass]                       # any of `validation.classical.files.QUANTITIES`: mass, cog_z, Ixx ...
# value = "47.400 +/- 0.024 kg"


_DIMENSIONS = {"kg": "mass", "mm": "length", "kg m²": "moment of inertia"}
_PUBLISHABLE = tuple(key for key, (_, unit, _) in QUANTITIES.items() if unit in _DIMENSIONS)


def reduce(file: Fields, keys: tuple[str, ...] = _PUBLISHABLE) -> Reduction:
    """The published results of `file` that are among `keys`.

    Raises
    ------
    BadInput : something in the file cannot be used, or it holds none of `keys`.
    """
    file.only((*HEAD, "tolerance", *_PUBLISHABLE))
    assumed = file.inner("tolerance").only(("assumed",)).switch("assumed", False)
    results = {}
    for key in _PUBLISHABLE:
        if key in file.table and key in keys:
            value = file.inner(key).only(("value",)).quantity("value", _DIMENSIONS[QUANTITIES[key][1]])
            results[key] = tagged(value.nominal_value, value.std_dev, "assumed tolerance" if assumed else "stated tolerance")
    if not results:
        raise BadInput(file.source, "", f"it holds none of {', '.join(keys)}", "Use weigh, cog or pendulum as fits")
    return Reduction(
        title=file.text("title", "Published results"),
        origin=file.text("origin", "origin not stated"),
        article=file.inner("article").only(("name",)).text("name"),
        results=results,
        notes=("No tolerance is printed in the source; those shown are ASSUMED.",) if assumed else (),
        assumed=assumed,
    )


def readings_or_results(name: str, kind: str, readings: Callable[[Fields], Reduction], keys: tuple[str, ...]) -> Reduction:
    """The measurement file `name`: of `kind`, reduced by `readings`, or what somebody printed of `keys`.

    Raises
    ------
    BadInput : see `validation.classical.files.read`, `readings` and `reduce`.
    """
    file = read(name, (kind, "results"))
    return readings(file) if file.text("kind") == kind else reduce(file, keys)


def reference(name: str) -> "dict[str, UFloat]":
    """What is published about the article (or stored in the results file) `name`: key of `QUANTITIES` -> value, SI.

    Of an article called ``clumod-4`` it is the shipped file ``clumod-4-reference``.

    Raises
    ------
    BadInput : nothing is published about it.
    """
    articles = tuple(entry.removesuffix("-reference") for entry in shipped(("results",)) if entry.endswith("-reference"))
    if name in articles:
        return dict(reduce(read(f"{name}-reference", ("results",))).results)
    if name.endswith(".toml") or name in shipped(("results",)):
        return dict(reduce(read(name, ("results",))).results)
    remedy = f"{nearest(name, articles)}Known are {', '.join(articles)}, or a file of kind results"
    raise BadInput("--against", "", f"nothing is published here about {name!r}", remedy)
