"""The campaign folder: ``campaign.toml`` and the signal files that it names. Read without changing it, written whole.

    campaign = read("one-blade")            # everything, or a refusal in words
    found = examine("one-blade")            # all that is wrong with it at once
    write("copy", campaign, ending=".uff")

The contract is the page "campaign format" of the project's shared documents; `docs/campaigns.md` tells it to a user.
"""

import os.path
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from datetime import date, datetime
from functools import partial
from pathlib import Path, PurePosixPath, PureWindowsPath
from typing import Any, TypeVar

import numpy as np

from geometry import toml_file
from geometry.atomic import write_text
from geometry.dynamic_mass import MOTIONS
from geometry.errors import BadInput
from geometry.frames import Array, Pose, rotation_about
from geometry.sensors import AXES, GROUPS, SI, Channel, ChannelTable, Place
from geometry.toml_file import doubts, length_unit, string
from identification import campaign as campaigns
from identification.files import files
from identification.files.files import Signals, StatedUnits, require_file

WEAK = 100.0
"""Condition number from which a transformation multiplies errors of the sensors so much that it is said aloud."""


def warnings_of_recordings(campaign: campaigns.Campaign, recordings: Mapping[str, campaigns.Recording]) -> tuple[str, ...]:
    """What is odd but leaves the data usable: weak geometry, runs of different rates, records shorter than their sweep."""
    source = campaign.source
    verdicts = campaigns.observed(campaign.table)
    cover = verdicts["base motion by cover"]
    found, of_runs = [], []
    if campaign.table.select(group="cover") and not cover.complete and verdicts["base motion by table and cover"].complete:
        missing = ", ".join(cover.missing)
        found.append(f"{source}: the cover plate alone does not tell the base motion ({missing}); the table must help")
    for key, verdict in verdicts.items():
        if verdict.complete and verdict.condition > WEAK:
            found.append(f"{source}: {key} has the condition number {verdict.condition:.3g}; move the pick-ups farther apart")
    axes = {"spectra" if one.is_spectrum else f"{one.sampling_rate:g} Hz" for one in recordings.values()}
    alike = f"its runs are not recorded alike, found {', '.join(sorted(axes))}; one run may have been exported otherwise"
    for run in campaign.runs:
        recorded = recordings.get(run.name)
        if recorded is None or run.excitation is None or (rate := recorded.sampling_rate) is None:
            continue
        stop, needed = run.excitation.figure("stop_hz"), run.excitation.sweep_duration
        if stop is not None and stop > rate / 2:
            ends = f"sampled at {rate:g} Hz it ends at {rate / 2:g} Hz"
            of_runs.append(f"{recorded.source}: drives up to {stop:g} Hz, {ends}; check the rate")
        if needed is not None and recorded.duration < needed * (1 - 1e-3):
            lasts = f"lasts {recorded.duration:.1f} s where its sweep takes {needed:.1f} s and must ring down"
            of_runs.append(f"{recorded.source}: {lasts}; is it cut short?")
    return (
        *found,
        *(text for recorded in recordings.values() for text in recorded.warnings),
        *([f"{source}: {alike}"] if len(axes) > 1 else []),
        *of_runs,
    )


# Values out of a parsed TOML file, checked one by one; what is wrong is collected, so that all of it can be said at once.

LARGEST_NUMBER = 1e9
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
        self.problems.found.append(BadInput(self.source, field, problem, remedy))

    def table(self, table: Mapping[str, Any], key: str, known: tuple[str, ...]) -> dict[str, Any]:
        """The table `key`, empty where it is missing, without the keys that are not `known`."""
        found = self.problems.attempt(toml_file.require_table, table.get(key, {}), source=self.source, where=key) or {}
        return self.known(found, key, known)

    def known(self, table: dict[str, Any], where: str, known: tuple[str, ...]) -> dict[str, Any]:
        """`table` without the keys that are not `known`, each of them a problem."""
        for key in table:
            self.problems.attempt(toml_file.require_known, {key: 0}, known, source=self.source, where=where)
        return {key: value for key, value in table.items() if key in known}

    def strings(
        self, table: dict[str, Any], where: str, needed: tuple[str, ...], optional: tuple[str, ...] = ()
    ) -> dict[str, str]:
        """The texts under the `needed` keys, which may not be empty, and the `optional` ones."""
        self.problems.attempt(toml_file.require_present, table, needed, source=self.source, where=where)
        found = {key: table[key] for key in (*needed, *optional) if key in table}
        for key, value in found.items():
            if not isinstance(value, str) or (key in needed and not value.strip()):
                self.refuse(f"{where}.{key}", f"must be text, found {value!r}", "Write it between quotation marks")
        return {key: value for key, value in found.items() if isinstance(value, str)}

    def number(
        self, table: dict[str, Any], where: str, key: str, *, low: float = -LARGEST_NUMBER, high: float = LARGEST_NUMBER
    ) -> float | None:
        """The number under `key`, from `low` to `high`."""
        if key not in table:
            self.refuse(f"{where}.{key}", "is missing", "Add it")
            return None
        value = table[key]
        if is_number(value) and low <= value <= high:
            return float(value)
        span = f" from {low:g} to {high:g}" if (low, high) != (-LARGEST_NUMBER, LARGEST_NUMBER) else ""
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
            self.refuse(where, f"must be three finite numbers, found {value!r}", "Write it like [0, 0, 1]")
            return None
        return np.array(value, dtype=np.float64) * scale

    def named(
        self, table: Mapping[str, Any], key: str, make: Callable[[dict[str, Any], str], T | None], *, alike: bool = False
    ) -> list[T]:
        """What `make` makes of every table of the array `key`; no two have one name unless they may be `alike`."""
        entries = table.get(key, [])
        if not isinstance(entries, list) or not all(isinstance(entry, dict) for entry in entries):
            self.refuse(key, "must be tables", f"Write each as [[{key}]]")
            return []
        if not entries:
            self.refuse(key, "there is none", f"Write each as [[{key}]]")
        names = [entry.get("name") for entry in entries]
        for name in dict.fromkeys(n for n in names if isinstance(n, str) and names.count(n) > 1 and not alike):
            self.refuse(f"{key}.{name}", f"{names.count(name)} have this name", "Give each its own")
        places = [name if isinstance(name, str) and name else str(k + 1) for k, name in enumerate(names)]
        made = [make(entry, f"{key}.{place}") for entry, place in zip(entries, places, strict=True)]
        return [one for one in made if one is not None]

    def channel(self, entry: dict[str, Any], where: str, *, metres: float) -> Channel | None:
        """The channel in `entry`, the table at `where`, lengths in units of so many `metres`; None where it has a problem."""
        before = len(self.problems.found)
        known = self.known(entry, where, CHANNEL)
        words = self.strings(known, where, ("name", "quantity", "unit", "group"))
        name = words.get("name", "ok")
        if name != name.strip() or not name.isprintable() or "/" in name or name in (".", "..") or len(name) > LONGEST_NAME:
            problem = f"must be up to {LONGEST_NAME} printable characters without / and spaces at the ends, found {name!r}"
            self.refuse(f"{where}.name", problem, "Rename it here and in the signal files")
        for key, choices in (("quantity", SI), ("group", GROUPS)):
            if key in words:
                self.problems.attempt(toml_file.one_of, words[key], tuple(choices), source=self.source, where=f"{where}.{key}")
        size = None
        if words.get("quantity") in SI and "unit" in words:
            unit, quantity = words["unit"], words["quantity"]
            size = self.problems.attempt(campaigns.factor, unit, quantity, source=self.source, field=f"{where}.unit")
        places = self.places(known, where, metres)
        reference = self.flag(known, where, "reference", False)
        senses = self.flag(known, where, "senses_gravity", words.get("quantity") == "acceleration")
        if senses and words.get("quantity") in ("force", "moment"):
            self.refuse(f"{where}.senses_gravity", "is for accelerometers", "Leave it out")
        noise = self.number(known, where, "noise_rms", low=0.0) if "noise_rms" in known else None
        if len(self.problems.found) > before or size is None:
            return None
        return Channel(
            **words, places=places, reference=reference, senses_gravity=senses, noise_rms=None if noise is None else noise * size
        )

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
        along = entry.get("direction")
        axes = {"direction": list(AXES[along])} if isinstance(along, str) and along in AXES else {}
        position, direction = (
            self.vector({**entry, **axes}[key], f"{where}.{key}", scale) if key in entry else None
            for key, scale in (("position", metres), ("direction", 1.0))
        )
        if position is None or direction is None or len(self.problems.found) > before:
            return None
        try:
            return Place(position=position, direction=direction)
        except ValueError as error:
            self.refuse(f"{where}.direction", str(error).removeprefix("`direction` "), "Divide it by its length")
            return None

    def processing(self, table: Mapping[str, Any]) -> campaigns.Processing | None:
        if "processing" not in table:
            return None
        where, plain = "processing", campaigns.Processing()
        found = self.table(table, where, PROCESSING)
        method = found.get("method", plain.method)
        self.problems.attempt(toml_file.one_of, method, campaigns.METHODS, source=self.source, where=f"{where}.method")
        size = found.get("block_size", plain.block_size)
        if not toml_file.is_whole(size) or not 2 <= size <= LARGEST_NUMBER:
            self.refuse(f"{where}.block_size", f"must be a whole number of samples, found {size!r}", "Write for example 8192")
        overlap = self.number({"overlap": plain.overlap, **found}, where, "overlap", low=0.0, high=1 - 1e-6)
        grid = self.table({"frequency": found.get("frequency", {})}, "frequency", ("start", "stop", "step"))
        start, stop, step = (
            self.number({key: getattr(plain, key), **grid}, f"{where}.frequency", key, low=0.0)
            for key in ("start", "stop", "step")
        )
        if (
            start is None
            or stop is None
            or step is None
            or overlap is None
            or method not in campaigns.METHODS
            or not isinstance(size, int)
        ):
            return None
        if not (stop > start and 0 < step <= stop - start and (stop - start) / step < 1e7):
            self.refuse(f"{where}.frequency", f"is no grid of lines: {start:g} to {stop:g} in steps of {step:g} Hz", "Correct it")
        return campaigns.Processing(method=method, block_size=size, overlap=overlap, start=start, stop=stop, step=step)

    def run(self, entry: dict[str, Any], where: str) -> campaigns.Run | None:
        before = len(self.problems.found)
        known = self.known(entry, where, RUN)
        words = self.strings(known, where, ("name", "file"), ("axis",))
        if "axis" in words:
            self.problems.attempt(toml_file.one_of, words["axis"], MOTIONS, source=self.source, where=f"{where}.axis")
        if "file" in words:
            self.problems.attempt(files.require_known, words["file"], self.source, f"{where}.file")
        excitation = self.excitation(known["excitation"], f"{where}.excitation") if "excitation" in known else None
        return None if len(self.problems.found) > before else campaigns.Run(**words, excitation=excitation)

    def dated(self, table: dict[str, Any], where: str, keys: tuple[str, ...]) -> dict[str, Any]:
        """`table` with the days under `keys` as text; a day is a date of TOML, or a text in ISO 8601."""
        found = dict(table)
        for key in keys:
            value = found.get(key)
            if isinstance(value, date):
                found[key] = value.isoformat()
            elif isinstance(value, str):
                try:
                    datetime.fromisoformat(value)
                except ValueError:
                    self.refuse(f"{where}.{key}", f"must be a day, found {value!r}", "Write it as 2026-03-31")
        return found

    def instrument(self, entry: dict[str, Any], where: str, *, channels: tuple[str, ...]) -> campaigns.Instrument | None:
        before = len(self.problems.found)
        known = self.dated(self.known(entry, where, INSTRUMENT), where, DATES)
        words = self.strings(known, where, ("name",), ("serial_number", *DATES))
        measured = known.get("channels", [])
        if not isinstance(measured, list) or not all(isinstance(one, str) for one in measured):
            self.refuse(f"{where}.channels", f"must be a list of channels, found {measured!r}", 'Write ["cover-z1", "cover-z2"]')
            return None
        for one in measured:
            self.problems.attempt(toml_file.one_of, one, channels, source=self.source, where=f"{where}.channels")
        return None if len(self.problems.found) > before else campaigns.Instrument(**words, channels=tuple(measured))

    def excitation(self, value: Any, where: str) -> campaigns.Excitation | None:
        kind = value.get("kind") if isinstance(value, dict) else value
        if not isinstance(value, dict) or not isinstance(kind, str) or kind not in EXCITATIONS:
            self.refuse(f"{where}.kind", f"must be one of {', '.join(EXCITATIONS)}, found {kind!r}", "Correct it")
            return None
        figures: dict[str, float | tuple[float, ...]] = {}
        for key, one in self.known(value, where, ("kind", *EXCITATIONS[kind])).items():
            if key == "levels":
                if not isinstance(one, list) or len(one) != 6 or not all(map(is_number, one)):
                    self.refuse(f"{where}.{key}", f"must be six finite numbers, found {one!r}", "Correct it")
                    continue
                figures[key] = tuple(map(float, one))
            elif key != "kind":
                number = self.number(value, where, key, low=0.0)
                figures |= {} if number is None else {key: number}
        return campaigns.Excitation(kind=kind, figures=figures)


def is_number(value: Any) -> bool:
    """Whether `value` is a number, no truth value, and of a size that a test has."""
    return toml_file.is_number(value) and abs(value) <= LARGEST_NUMBER


# The tables [[channel]] of ``campaign.toml``: one channel each, in metres and SI.

CHANNEL = ("name", "quantity", "unit", "group", "position", "direction", "cells", "reference", "senses_gravity", "noise_rms")

LONGEST_NAME = 80
"""Characters of a channel's name: the id line of a universal file has no more."""


# ``campaign.toml``: from its tables to a `Campaign` without samples. `campaign_words` writes it.
#
# Everything that is wrong with it is collected, so that it can be corrected in one go. Lengths leave here in metres and noise
# floors in SI, whatever the file is written in. Positions and the origin of [mounting] are in the `length_unit` of [frame].

TOP = ("format", "campaign", "mounting", "environment", "frame", "processing", "instrument", "channel", "run")
CAMPAIGN = ("title", "article", "hardware", "notes", "date", "place", "operator", "serial_number")
CROSS_MOTION = "cross_motion"
DATES = ("calibrated", "due")
INSTRUMENT = ("name", "serial_number", *DATES, "channels")
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


def parse(table: Mapping[str, Any], source: str, problems: Problems) -> campaigns.Campaign | None:
    """The campaign that `table`, a parsed ``campaign.toml``, describes; None where `problems` has got one more.

    `source` names the file in messages.
    """
    before = len(problems.found)
    problems.attempt(toml_file.require_format, table, source)
    problems.attempt(toml_file.require_known, table, TOP, source=source)
    problems.attempt(toml_file.require_present, table, ("campaign", "environment", "channel", "run"), source=source)
    reader = Reader(source=source, problems=problems)
    stated = reader.dated(reader.table(table, "campaign", (*CAMPAIGN, CROSS_MOTION)), "campaign", ("date",))
    cross = reader.number({CROSS_MOTION: 0.0, **stated}, "campaign", CROSS_MOTION, low=0.0, high=1.0)
    stated = {key: value for key, value in stated.items() if key != CROSS_MOTION}
    about = reader.strings(stated, "campaign", CAMPAIGN[:2], CAMPAIGN[2:])
    frame = reader.table(table, "frame", ("origin", "length_unit"))
    unit = problems.attempt(length_unit, str(frame.get("length_unit", "m")), source, "frame.length_unit")
    metres = unit.metres if unit else 1.0
    origin = reader.vector(frame.get("origin", [0, 0, 0]), "frame.origin", metres)
    around = reader.table(table, "environment", ("gravity",))
    gravity = reader.number(around, "environment", "gravity", low=0.0) if "environment" in table else None
    if "mounting" not in table:
        mounting: Pose | None = None
    else:
        found = reader.table(table, "mounting", ("origin", "rotation_deg"))
        reader.problems.attempt(toml_file.require_present, found, ("origin",), source=reader.source, where="mounting")
        seat = reader.vector(found.get("origin", [0, 0, 0]), "mounting.origin", metres)
        turn = reader.number({"rotation_deg": 0.0, **found}, "mounting", "rotation_deg", low=-360.0, high=360.0)
        if seat is None or turn is None:
            mounting = None
        else:
            mounting = Pose(position=seat, rotation=rotation_about("z", float(np.radians(turn))))
    processing = reader.processing(table)
    channels = reader.named(table, "channel", partial(reader.channel, metres=metres))
    runs = reader.named(table, "run", reader.run)
    names = tuple(one.name for one in channels)
    made = partial(reader.instrument, channels=names)
    instruments = reader.named(table, "instrument", made, alike=True) if "instrument" in table else []
    if len(problems.found) > before or origin is None or gravity is None:
        return None
    sensors = ChannelTable(channels=tuple(channels), origin=origin)
    if sensors.extent > MISTAKEN and unit is not None:
        problem = f"is {unit.name}, and puts the channels {sensors.extent:.4g} m apart"
        reader.refuse("frame.length_unit", problem, 'Write length_unit = "mm" if these are millimetres, or correct the positions')
        return None
    if gravity == 0 or EARTH[0] <= gravity <= EARTH[1]:
        odd: tuple[str, ...] = ()
    else:
        here = f"{gravity:g} m/s² is met nowhere on Earth ({EARTH[0]:g} to {EARTH[1]:g})"
        odd = (f"{source}: `environment.gravity` {here}; 0 is a test without gravity",)
    return campaigns.Campaign(
        title=about.get("title", ""),
        article=about.get("article", ""),
        hardware=about.get("hardware", ""),
        notes=about.get("notes", ""),
        date=about.get("date", ""),
        place=about.get("place", ""),
        operator=about.get("operator", ""),
        serial_number=about.get("serial_number", ""),
        instruments=tuple(instruments),
        cross_motion=cross or 0.0,
        table=sensors,
        runs=tuple(runs),
        mounting=mounting,
        gravity=gravity,
        processing=processing,
        warnings=(*doubts(sensors.extent, f"{source}: channels", unit), *odd),
        source=source,
    )


MISTAKEN = 100.0
"""[m] Extent of channels that no shaking table has: millimetres that are called metres. Held by test_doors_agree.py."""

EARTH = (9.76, 9.84)
"""[m/s²] Gravity at sea level and on mountains, from the equator to the poles. Held by test_doors_agree.py."""


# A `Campaign` as the text of its ``campaign.toml``, in the order and the layout of the contract.

ROUNDING = 1e-12
"""How far a mounting may be turned about another axis than z [1]: rounding of a rotation matrix."""


def text(campaign: campaigns.Campaign) -> str:
    """The text of ``campaign.toml``; lengths in metres, noise floors in the unit of their channel.

    Raises
    ------
    BadInput : a mounting that is turned about another axis than z, which the format cannot say.
    """
    blocks: list[tuple[str, Lines]] = []
    about = [(key, getattr(campaign, key)) for key in CAMPAIGN]
    cross = [(CROSS_MOTION, repr(float(campaign.cross_motion)))] if campaign.cross_motion else []
    blocks.append(("[campaign]", [*((key, string(value)) for key, value in about if value), *cross]))
    if campaign.mounting is not None:
        R = campaign.mounting.rotation
        if abs(R[2, 2] - 1) > ROUNDING:
            problem, remedy = "is turned about another axis than z", "The format knows rotation_deg about z only"
            raise BadInput(campaign.source, "mounting", problem, remedy)
        turn = float(np.degrees(np.arctan2(R[1, 0], R[0, 0])))
        seat = _numbers(campaign.mounting.position)
        blocks.append(("[mounting]", [("origin", seat), ("rotation_deg", _number(turn))]))
    blocks.append(("[environment]", [("gravity", _number(campaign.gravity))]))
    blocks.append(("[frame]", [("origin", _numbers(campaign.table.origin)), ("length_unit", '"m"')]))
    if (of := campaign.processing) is not None:
        held = of.method == "peak-reference-hold"
        blocked = [("block_size", str(of.block_size)), ("overlap", _number(of.overlap))] if held else []
        grid = f"{{ start = {_number(of.start)}, stop = {_number(of.stop)}, step = {_number(of.step)} }}"
        blocks.append(("[processing]", [("method", string(of.method)), *blocked, ("frequency", grid)]))
    for tool in campaign.instruments:
        stated = [(key, string(value)) for key in INSTRUMENT[:-1] if (value := getattr(tool, key))]
        measured = [("channels", f"[{', '.join(map(string, tool.channels))}]")] if tool.channels else []
        blocks.append(("[[instrument]]", stated + measured))
    blocks += [("[[channel]]", _channel(channel)) for channel in campaign.table.channels]
    for run in campaign.runs:
        lines = [(key, string(value)) for key in ("name", "file", "axis") if (value := getattr(run, key)) or key != "axis"]
        if run.excitation is not None:
            figures = {"kind": string(run.excitation.kind)}
            for key, value in run.excitation.figures.items():
                figures[key] = _numbers(value) if isinstance(value, tuple) else _number(value)
            lines.append(("excitation", "{ " + ", ".join(f"{key} = {value}" for key, value in figures.items()) + " }"))
        blocks.append(("[[run]]", lines))
    written = ["\n".join([head, *(f"{key} = {value}" for key, value in lines)]) for head, lines in blocks]
    return "\n\n".join([f"format = {toml_file.FORMAT}", *written]) + "\n"


Lines = list[tuple[str, str]]


def _channel(channel: Channel) -> Lines:
    lines = [(key, string(getattr(channel, key))) for key in ("name", "quantity", "unit", "group")]
    if channel.is_sum:
        cells = "".join(
            f"  {{ position = {position}, direction = {direction} }},\n"
            for position, direction in map(_place_text, channel.places)
        )
        lines.append(("cells", f"[\n{cells}]"))
    else:
        position, direction = _place_text(channel.places[0])
        lines += [("position", position), ("direction", direction)]
    if channel.reference:
        lines.append(("reference", "true"))
    if channel.quantity == "acceleration":
        lines.append(("senses_gravity", "true" if channel.senses_gravity else "false"))
    if channel.noise_rms is not None:
        lines.append(("noise_rms", _number(channel.noise_rms / campaigns.factor_of(channel))))
    return lines


def _place_text(place: Place) -> tuple[str, str]:
    return _numbers(place.position), _numbers(place.direction)


def _number(value: float) -> str:
    """The fewest digits that give `value` back exactly."""
    return repr(float(value) + 0.0)


def _numbers(values: Iterable[float]) -> str:
    return "[" + ", ".join(map(_number, values)) + "]"


NAME = "campaign.toml"

LARGEST_TEXT = 10_000_000
"""Bytes: a campaign of a thousand channels needs a hundredth of it."""

Progress = Callable[[float], None]
"""Called with the share done, 0 to 1; it may raise to end the work."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Examined:
    """What a folder holds and what is wrong with it.

    Attributes
    ----------
    campaign : with the recordings that can be used; None where its description cannot be
    problems : each of them makes the folder unusable as it is
    """

    campaign: campaigns.Campaign | None
    problems: tuple[BadInput, ...]


def read(folder: str | Path, *, progress: Progress | None = None) -> campaigns.Campaign:
    """The campaign in `folder`, with all its recordings in SI.

    Raises
    ------
    BadInput : whatever is wrong with it; of several problems the first, and how many more there are.
    OSError : a file cannot be read.
    """
    found = examine(folder, progress=progress)
    if found.campaign is not None and not found.problems:
        return found.campaign
    first, more = found.problems[0], len(found.problems) - 1
    if not more:
        raise first
    remedy = f"{first.remedy.rstrip('. ')}. `massline check` lists this and {more} more"
    raise BadInput(first.source, first.field, first.problem, remedy)


def read_description(folder: str | Path) -> campaigns.Campaign:
    """The campaign in `folder` as ``campaign.toml`` describes it, without recordings: quick.

    Raises
    ------
    BadInput : the first thing that is wrong with ``campaign.toml``.
    """
    problems = Problems()
    campaign = _described(Path(folder), problems)
    if campaign is None or problems.found:
        raise problems.found[0]
    return campaign


def examine(folder: str | Path, *, progress: Progress | None = None) -> Examined:
    """The campaign in `folder` and all that is wrong with it; a run that cannot be used does not hide the next.

    Raises
    ------
    OSError : a file cannot be read.
    """
    problems = Problems()
    campaign = _described(Path(folder), problems)
    if campaign is None:
        return Examined(campaign=None, problems=tuple(problems.found))
    # What cannot be told from the channels at all: a base motion by table and cover plate together, or a resultant
    source = f"{folder}/{NAME}"
    verdicts = campaigns.observed(campaign.table)
    found, wanted = [], []
    if not campaign.cross_motion:  # of a single-axis shaker no more is known
        wanted.append(("base motion by table and cover", "base motion", "Add an accelerometer that moves with it to [[channel]]"))
        if campaign.table.select(group="fmd") or not campaign.table.select(group="article", quantity="acceleration"):
            remedy = "Add a load cell that senses it to [[channel]], or give the cells of a sum singly"
            wanted.append(("resultants by fmd", "resultant", remedy))
    for key, what, remedy in wanted:
        verdict = verdicts[key]
        if not verdict.complete:
            what = what if len(verdict.missing) == 1 else f"{what}s"
            problem = f"the {what} {', '.join(verdict.missing)} cannot be told from its channels: {verdict.text}"
            found.append(BadInput(source, "channel", problem, remedy))
    problems.found += found
    recordings: dict[str, campaigns.Recording] = {}
    for k, run in enumerate(campaign.runs):
        one = problems.attempt(_recorded, Path(folder), run, campaign, problems)
        recordings |= {} if one is None else {run.name: one}
        if progress is not None:
            progress((k + 1) / len(campaign.runs))
    warnings = (*campaign.warnings, *warnings_of_recordings(campaign, recordings))
    read = replace(campaign, recordings=recordings, warnings=warnings)
    read = replace(read, warnings=(*warnings, *campaigns.warnings_of_runs(read)))
    return Examined(campaign=read, problems=tuple(problems.found))


def write(
    folder: str | Path, campaign: campaigns.Campaign, *, ending: str | None = ".h5", progress: Progress | None = None
) -> None:
    """Write `campaign` to the new `folder`, its runs as ``<name><ending>``, or with None as the files that they name.

    ``campaign.toml`` comes last: a folder whose writing was interrupted is none.

    Raises
    ------
    BadInput : the folder holds something already, a run without recording or with a name that is no file name, or what the format
        cannot hold.
    OSError : the folder cannot be written.
    """
    folder = Path(folder)
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise BadInput(str(folder), "", "it is there already and not empty", "Name a new folder; a campaign is never overwritten")
    if ending is not None:
        files.require_known(f"x{ending}", "write", "ending")
    runs = list(campaign.runs)
    for k, run in enumerate(runs if ending is not None else ()):
        file = f"{run.name}{ending}"
        if PurePosixPath(file).name != file or "\\" in file or not file.isprintable() or file.startswith("."):
            raise BadInput(str(folder), "run.name", f"cannot be the name of a file, found {run.name!r}", "Rename the run")
        runs[k] = replace(run, file=file)
    for k, run in enumerate(runs):
        if run.name not in campaign.recordings:
            raise BadInput(str(folder), f"run.{run.name}", "has no recording", "Record or read it first")
        path = inside(folder, run.file, str(folder), f"run.{run.name}.file")
        files.write(path, _signals(campaign.recordings[run.name], campaign))
        if progress is not None:
            progress((k + 1) / len(runs))
    write_text(folder / NAME, text(replace(campaign, runs=tuple(runs))))


def _described(folder: Path, problems: Problems) -> campaigns.Campaign | None:
    path = folder / NAME
    table = problems.attempt(_table, folder, path)
    if table is None:
        return None
    campaign = parse(table, str(path), problems)
    return None if campaign is None else replace(campaign, source=str(folder))


def _table(folder: Path, path: Path) -> Mapping[str, object]:
    if not folder.is_dir():
        named = "file" if folder.suffix.lower() in (".toml", ".uff", ".unv") else "folder"
        problem = "it is no folder" if folder.exists() else f"there is no such {named}"
        if folder.suffix.lower() == ".toml" and folder.is_file() and "model" in toml_file.read(folder):
            problem = "it is a model file, where the folder of a campaign is needed"
        remedy = "Check the path" if problem.endswith("file") else f"Name the folder that holds {NAME}"
        raise BadInput(str(folder), "", problem, remedy)
    if not path.exists() and not path.is_symlink():
        raise _undescribed(folder)
    require_file(path)
    if path.stat().st_size > LARGEST_TEXT:
        raise BadInput(str(path), "", "it is larger than any campaign.toml", "Check what it holds")
    return toml_file.read(path)


def _undescribed(folder: Path) -> BadInput:
    """What a folder without campaign.toml is, and what to do: recordings alone do not say where force and pick-ups were."""
    records = sorted(path.name for path in folder.iterdir() if path.is_file() and path.suffix.lower() in files.FORMATS)
    problem, remedy = f"it holds no {NAME}", "Name the folder of the campaign itself"
    if records:
        more = f" and {len(records) - 1} more" if len(records) > 1 else ""
        problem += f", nor a test.toml that says where {records[0]}{more} were driven and read"
        named = f'{{ path = "{records[0]}", drive = "tip:z" }}{", ..." if more else ""}'
        remedy = (
            "Write test.toml beside them, for blows of a hammer for example: format = 1, "
            f'kind = "response-functions", article = "mine", files = [{named}], responses = ["tip:z", "root:z"], '
            'records = { kind = "hammer" }; for a shaker table campaign.toml; docs/model-file.md and docs/campaigns.md'
        )
    return BadInput(str(folder), "", problem, remedy)


def _recorded(folder: Path, run: campaigns.Run, campaign: campaigns.Campaign, problems: Problems) -> campaigns.Recording | None:
    path = inside(folder, run.file, f"{folder}/{NAME}", f"run.{run.name}.file")
    try:
        signals = files.read(path)
    except OSError as error:
        raise BadInput(str(path), "", f"it cannot be read: {error.strerror or error}", "Check its name and permissions") from None
    made, found = campaigns.recording(signals, campaign.table, f"{folder.name}/{NAME}")
    problems.found += found
    return made


def inside(folder: Path, name: str, source: str, field: str) -> Path:
    """The path of the file `name` in `folder`, reached without leaving it and without links.

    Raises
    ------
    BadInput : it is absolute, climbs out of the folder, or passes a link.
    """

    def refused(problem: str) -> BadInput:
        return BadInput(source, field, problem, "Put the file into the folder and name it from there")

    parts = PurePosixPath(name).parts
    absolute = PurePosixPath(name).is_absolute() or bool(PureWindowsPath(name).drive) or "\\" in name or "\0" in name
    if absolute or ".." in parts or not parts:
        raise refused(f"must be a file inside the folder, found {name!r}")
    path = folder
    for part in parts:
        path = path / part
        if os.path.islink(path):
            raise refused(f"is reached over the link {part!r}, which is not followed")
    return path


def _signals(recorded: campaigns.Recording, campaign: campaigns.Campaign) -> Signals:
    """The samples in the units of the channel table."""
    if recorded.names != campaign.table.names:
        problem = f"has other channels than the table: {', '.join(recorded.names)}"
        raise BadInput(recorded.source, "", problem, "Put them in the order of the table")
    sizes = [campaigns.factor_of(channel) for channel in campaign.table.channels]
    samples = {name: recorded.values[:, k] / sizes[k] for k, name in enumerate(recorded.names)}
    units = {}  # systems of units in which each quantity has the unit of its size in SI
    for c, size in zip(campaign.table.channels, sizes, strict=True):
        length, force = (size, 1.0) if c.quantity == "acceleration" else (1.0, size)
        units[c.name] = StatedUnits(length=length, force=force, words="massline")
    return Signals(
        source=recorded.source,
        samples=samples,
        sampling_rate=recorded.sampling_rate,
        frequency=recorded.frequency,
        units=units,
        labels={c.name: c.unit for c in campaign.table.channels},
    )
