"""``campaign.toml``: from its text to a `Campaign` without samples, and back.

Everything that is wrong with it is collected, so that it can be corrected in one go. Lengths leave here in metres and noise
floors in SI, whatever the file is written in. Positions and the origin of [mounting] are in the `length_unit` of [frame].
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any, TypeVar

import numpy as np

from geometry import keys, toml_file
from geometry.arrays import Array
from geometry.dynamic_mass import MOTIONS
from geometry.errors import BadInput
from geometry.frames import Pose, rotation_about
from geometry.lengths import doubts, length_unit
from geometry.sensors import GROUPS, SI, Channel, ChannelTable, Place
from identification import files
from identification.campaign import METHODS, Campaign, Excitation, Processing, Run
from identification.units import factor

TOP = ("format", "campaign", "mounting", "environment", "frame", "processing", "channel", "run")
CAMPAIGN = ("title", "article", "hardware", "notes")
CHANNEL = (
    "name",
    "quantity",
    "unit",
    "group",
    "position",
    "direction",
    "cells",
    "reference",
    "senses_gravity",
    "noise_rms",
)
RUN = ("name", "file", "axis", "excitation")
PROCESSING = ("method", "block_size", "overlap", "frequency")

SWEEP = ("start_hz", "stop_hz", "octaves_per_minute", "level")
EXCITATIONS = {
    "sine-sweep": (*SWEEP, "duration_s"),
    "random": ("start_hz", "stop_hz", "level", "duration_s"),
    "burst": ("start_hz", "stop_hz", "level", "duration_s"),
    "multi-axis": (*SWEEP, "levels", "duration_s"),
}
"""Kinds of excitation, and the figures that each may state."""

LARGEST = 1e9
"""No figure of a test lies beyond, in whatever unit."""

LONGEST_NAME = 80
"""Characters of a channel's name: the id line of a universal file has no more."""

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


def parse(table: Mapping[str, Any], source: str, problems: Problems) -> Campaign | None:
    """The campaign that `table`, a parsed ``campaign.toml``, describes; None where `problems` has got one more.

    `source` names the file in messages.
    """
    before = len(problems.found)
    problems.attempt(toml_file.require_format, table, source)
    problems.attempt(keys.require_known, table, TOP, source=source)
    problems.attempt(keys.require_present, table, ("campaign", "environment", "channel", "run"), source=source)
    reader = _Reader(source, problems)
    about = reader.strings(reader.table(table, "campaign", CAMPAIGN), "campaign", ("title", "article"), ("hardware", "notes"))
    frame = reader.table(table, "frame", ("origin", "length_unit"))
    unit = problems.attempt(length_unit, str(frame.get("length_unit", "m")), source, "frame.length_unit")
    metres = unit.metres if unit else 1.0
    origin = reader.vector(frame.get("origin", [0, 0, 0]), "frame.origin", metres)
    around = reader.table(table, "environment", ("gravity",))
    gravity = reader.number(around, "environment", "gravity", low=0.0) if "environment" in table else None
    mounting = reader.mounting(table, metres)
    processing = reader.processing(table)
    channels = reader.named(table, "channel", partial(reader.channel, metres=metres))
    runs = reader.named(table, "run", reader.run)
    if len(problems.found) > before or origin is None or gravity is None:
        return None
    extent = np.ptp([place.position for channel in channels for place in channel.places], axis=0).max()
    return Campaign(
        title=about.get("title", ""),
        article=about.get("article", ""),
        hardware=about.get("hardware", ""),
        notes=about.get("notes", ""),
        table=ChannelTable(channels=tuple(channels), origin=origin),
        runs=tuple(runs),
        mounting=mounting,
        gravity=gravity,
        processing=processing,
        warnings=doubts(float(extent), f"{source}: channels", unit),
        source=source,
    )


class _Reader:
    """Values of one file; a method returns None, or leaves the value out, where it added a problem."""

    def __init__(self, source: str, problems: Problems) -> None:
        self.source = source
        self.problems = problems

    def refuse(self, field: str, problem: str, remedy: str) -> None:
        self.problems.found.append(BadInput(source=self.source, field=field, problem=problem, remedy=remedy))

    def table(self, table: Mapping[str, Any], key: str, known: tuple[str, ...]) -> dict[str, Any]:
        """The table `key`, empty where it is missing, without the keys that are not `known`."""
        found = self.problems.attempt(keys.require_table, table.get(key, {}), source=self.source, where=key) or {}
        return self.known(found, key, known)

    def known(self, table: dict[str, Any], where: str, known: tuple[str, ...]) -> dict[str, Any]:
        for key in table:
            self.problems.attempt(keys.require_known, {key: 0}, known, source=self.source, where=where)
        return {key: value for key, value in table.items() if key in known}

    def strings(
        self, table: dict[str, Any], where: str, needed: tuple[str, ...], optional: tuple[str, ...] = ()
    ) -> dict[str, str]:
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
        if _is_number(value) and low <= value <= high:
            return float(value)
        span = f" from {low:g} to {high:g}" if (low, high) != (-LARGEST, LARGEST) else ""
        self.refuse(f"{where}.{key}", f"must be a finite number{span}, found {value!r}", "Correct it")
        return None

    def flag(self, table: dict[str, Any], where: str, key: str, default: bool) -> bool:
        value = table.get(key, default)
        if not isinstance(value, bool):
            self.refuse(f"{where}.{key}", f"must be true or false, found {value!r}", "Correct it")
        return bool(value)

    def vector(self, value: Any, where: str, scale: float = 1.0) -> Array | None:
        if not isinstance(value, list) or len(value) != 3 or not all(map(_is_number, value)):
            self.refuse(where, f"must be three finite numbers, found {value!r}", "Write it like [0.1, 0.0, 0.03]")
            return None
        return np.array(value, dtype=np.float64) * scale

    def mounting(self, table: Mapping[str, Any], metres: float) -> Pose | None:
        if "mounting" not in table:
            return None
        found = self.table(table, "mounting", ("origin", "rotation_deg"))
        self.problems.attempt(keys.require_present, found, ("origin",), source=self.source, where="mounting")
        origin = self.vector(found.get("origin", [0, 0, 0]), "mounting.origin", metres)
        turn = self.number({"rotation_deg": 0.0, **found}, "mounting", "rotation_deg", low=-360.0, high=360.0)
        if origin is None or turn is None:
            return None
        return Pose(position=origin, rotation=rotation_about("z", float(np.radians(turn))))

    def processing(self, table: Mapping[str, Any]) -> Processing | None:
        if "processing" not in table:
            return None
        where, plain = "processing", Processing()
        found = self.table(table, where, PROCESSING)
        method = found.get("method", plain.method)
        self.problems.attempt(keys.one_of, method, METHODS, source=self.source, where=f"{where}.method")
        size = found.get("block_size", plain.block_size)
        if not isinstance(size, int) or isinstance(size, bool) or not 2 <= size <= LARGEST:
            self.refuse(f"{where}.block_size", f"must be a whole number of samples, found {size!r}", "Write for example 8192")
        overlap = self.number({"overlap": plain.overlap, **found}, where, "overlap", low=0.0, high=1 - 1e-6)
        grid = self.table({"frequency": found.get("frequency", {})}, "frequency", ("start", "stop", "step"))
        start, stop, step = (
            self.number({key: getattr(plain, key), **grid}, f"{where}.frequency", key, low=0.0)
            for key in ("start", "stop", "step")
        )
        if start is None or stop is None or step is None or overlap is None or method not in METHODS or not isinstance(size, int):
            return None
        if not (stop > start and 0 < step <= stop - start and (stop - start) / step < 1e7):
            self.refuse(f"{where}.frequency", f"is no grid of lines: {start:g} to {stop:g} in steps of {step:g} Hz", "Correct it")
        return Processing(method=method, block_size=size, overlap=overlap, start=start, stop=stop, step=step)

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

    def channel(self, entry: dict[str, Any], where: str, *, metres: float) -> Channel | None:
        before = len(self.problems.found)
        known = self.known(entry, where, CHANNEL)
        words = self.strings(known, where, ("name", "quantity", "unit", "group"))
        self.require_name(words.get("name"), f"{where}.name")
        for key, choices in (("quantity", SI), ("group", GROUPS)):
            if key in words:
                self.problems.attempt(keys.one_of, words[key], tuple(choices), source=self.source, where=f"{where}.{key}")
        size = None
        if words.get("quantity") in SI and "unit" in words:
            unit, quantity = words["unit"], words["quantity"]
            size = self.problems.attempt(factor, unit, quantity, source=self.source, field=f"{where}.unit")
        places = self.places(known, where, metres)
        reference = self.flag(known, where, "reference", False)
        senses = self.flag(known, where, "senses_gravity", words.get("quantity") == "acceleration")
        if senses and words.get("quantity") in ("force", "moment"):
            self.refuse(f"{where}.senses_gravity", "is for accelerometers", "Leave it out")
        noise = self.number(known, where, "noise_rms", low=0.0) if "noise_rms" in known else None
        if len(self.problems.found) > before or size is None:
            return None
        return Channel(
            **words,
            places=places,
            reference=reference,
            senses_gravity=senses,
            noise_rms=None if noise is None else noise * size,
        )

    def require_name(self, name: str | None, where: str) -> None:
        if name is None:
            return
        if name != name.strip() or not name.isprintable() or "/" in name or name in (".", "..") or len(name) > LONGEST_NAME:
            problem = f"must be up to {LONGEST_NAME} printable characters without / and spaces at the ends, found {name!r}"
            self.refuse(where, problem, "Rename it here and in the signal files")

    def places(self, entry: dict[str, Any], where: str, metres: float) -> tuple[Place, ...]:
        if "cells" not in entry:
            one = self.place(entry, where, metres)
            return () if one is None else (one,)
        both = [key for key in ("position", "direction") if key in entry]
        if both:
            self.refuse(f"{where}.cells", f"stands beside {' and '.join(both)}", "Give either, cells for a sum of several")
        cells = entry["cells"]
        if not isinstance(cells, list) or not cells or not all(isinstance(cell, dict) for cell in cells):
            self.refuse(
                f"{where}.cells", f"must be tables, found {cells!r}", "Write { position = [...], direction = [...] } for each"
            )
            return ()
        made = []
        for k, cell in enumerate(cells):
            at = f"{where}.cells[{k + 1}]"
            made.append(self.place(self.known(cell, at, ("position", "direction")), at, metres))
        return tuple(one for one in made if one is not None)

    def place(self, entry: dict[str, Any], where: str, metres: float) -> Place | None:
        before = len(self.problems.found)
        for key in ("position", "direction"):
            if key not in entry:
                self.refuse(f"{where}.{key}", "is missing", "Add it")
        position, direction = (
            self.vector(entry[key], f"{where}.{key}", scale) if key in entry else None
            for key, scale in (("position", metres), ("direction", 1.0))
        )
        if position is None or direction is None or len(self.problems.found) > before:
            return None
        try:
            return Place(position=position, direction=direction)
        except ValueError as error:
            self.refuse(f"{where}.direction", str(error).removeprefix("`direction` "), "Divide it by its length")
            return None

    def run(self, entry: dict[str, Any], where: str) -> Run | None:
        before = len(self.problems.found)
        known = self.known(entry, where, RUN)
        words = self.strings(known, where, ("name", "file"), ("axis",))
        if "axis" in words:
            self.problems.attempt(keys.one_of, words["axis"], MOTIONS, source=self.source, where=f"{where}.axis")
        if "file" in words:
            self.problems.attempt(files.require_known, words["file"], self.source, f"{where}.file")
        excitation = self.excitation(known["excitation"], f"{where}.excitation") if "excitation" in known else None
        return None if len(self.problems.found) > before else Run(**words, excitation=excitation)

    def excitation(self, value: Any, where: str) -> Excitation | None:
        if not isinstance(value, dict) or value.get("kind") not in EXCITATIONS:
            found = value.get("kind") if isinstance(value, dict) else value
            self.refuse(f"{where}.kind", f"must be one of {', '.join(EXCITATIONS)}, found {found!r}", "Correct it")
            return None
        figures: dict[str, float | tuple[float, ...]] = {}
        for key, one in self.known(value, where, ("kind", *EXCITATIONS[value["kind"]])).items():
            if key == "levels":
                if not isinstance(one, list) or len(one) != 6 or not all(map(_is_number, one)):
                    self.refuse(f"{where}.{key}", f"must be six finite numbers, found {one!r}", "Correct it")
                    continue
                figures[key] = tuple(map(float, one))
            elif key != "kind":
                number = self.number(value, where, key, low=0.0)
                figures |= {} if number is None else {key: number}
        return Excitation(kind=value["kind"], figures=figures)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) <= LARGEST
