"""``campaign.toml``: from its tables to a `Campaign` without samples. `campaign_words` writes it.

Everything that is wrong with it is collected, so that it can be corrected in one go. Lengths leave here in metres and noise
floors in SI, whatever the file is written in. Positions and the origin of [mounting] are in the `length_unit` of [frame].
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np

from geometry import keys, toml_file
from geometry.dynamic_mass import MOTIONS
from geometry.frames import Pose, rotation_about
from geometry.lengths import doubts, length_unit
from geometry.sensors import ChannelTable
from identification import files
from identification.campaign import METHODS, Campaign, Excitation, Processing, Run
from identification.campaign_channels import channel
from identification.campaign_values import LARGEST, Problems, Reader, is_number

TOP = ("format", "campaign", "mounting", "environment", "frame", "processing", "channel", "run")
CAMPAIGN = ("title", "article", "hardware", "notes")
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


def parse(table: Mapping[str, Any], source: str, problems: Problems) -> Campaign | None:
    """The campaign that `table`, a parsed ``campaign.toml``, describes; None where `problems` has got one more.

    `source` names the file in messages.
    """
    before = len(problems.found)
    problems.attempt(toml_file.require_format, table, source)
    problems.attempt(keys.require_known, table, TOP, source=source)
    problems.attempt(keys.require_present, table, ("campaign", "environment", "channel", "run"), source=source)
    reader = Reader(source=source, problems=problems)
    about = reader.strings(reader.table(table, "campaign", CAMPAIGN), "campaign", ("title", "article"), ("hardware", "notes"))
    frame = reader.table(table, "frame", ("origin", "length_unit"))
    unit = problems.attempt(length_unit, str(frame.get("length_unit", "m")), source, "frame.length_unit")
    metres = unit.metres if unit else 1.0
    origin = reader.vector(frame.get("origin", [0, 0, 0]), "frame.origin", metres)
    around = reader.table(table, "environment", ("gravity",))
    gravity = reader.number(around, "environment", "gravity", low=0.0) if "environment" in table else None
    mounting = _mounting(reader, table, metres)
    processing = _processing(reader, table)
    channels = reader.named(table, "channel", partial(channel, reader, metres=metres))
    runs = reader.named(table, "run", partial(_run, reader))
    if len(problems.found) > before or origin is None or gravity is None:
        return None
    extent = np.ptp([place.position for one in channels for place in one.places], axis=0).max()
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


def _mounting(reader: Reader, table: Mapping[str, Any], metres: float) -> Pose | None:
    if "mounting" not in table:
        return None
    found = reader.table(table, "mounting", ("origin", "rotation_deg"))
    reader.problems.attempt(keys.require_present, found, ("origin",), source=reader.source, where="mounting")
    origin = reader.vector(found.get("origin", [0, 0, 0]), "mounting.origin", metres)
    turn = reader.number({"rotation_deg": 0.0, **found}, "mounting", "rotation_deg", low=-360.0, high=360.0)
    if origin is None or turn is None:
        return None
    return Pose(position=origin, rotation=rotation_about("z", float(np.radians(turn))))


def _processing(reader: Reader, table: Mapping[str, Any]) -> Processing | None:
    if "processing" not in table:
        return None
    where, plain = "processing", Processing()
    found = reader.table(table, where, PROCESSING)
    method = found.get("method", plain.method)
    reader.problems.attempt(keys.one_of, method, METHODS, source=reader.source, where=f"{where}.method")
    size = found.get("block_size", plain.block_size)
    if not isinstance(size, int) or isinstance(size, bool) or not 2 <= size <= LARGEST:
        reader.refuse(f"{where}.block_size", f"must be a whole number of samples, found {size!r}", "Write for example 8192")
    overlap = reader.number({"overlap": plain.overlap, **found}, where, "overlap", low=0.0, high=1 - 1e-6)
    grid = reader.table({"frequency": found.get("frequency", {})}, "frequency", ("start", "stop", "step"))
    start, stop, step = (
        reader.number({key: getattr(plain, key), **grid}, f"{where}.frequency", key, low=0.0) for key in ("start", "stop", "step")
    )
    if start is None or stop is None or step is None or overlap is None or method not in METHODS or not isinstance(size, int):
        return None
    if not (stop > start and 0 < step <= stop - start and (stop - start) / step < 1e7):
        reader.refuse(f"{where}.frequency", f"is no grid of lines: {start:g} to {stop:g} in steps of {step:g} Hz", "Correct it")
    return Processing(method=method, block_size=size, overlap=overlap, start=start, stop=stop, step=step)


def _run(reader: Reader, entry: dict[str, Any], where: str) -> Run | None:
    before = len(reader.problems.found)
    known = reader.known(entry, where, RUN)
    words = reader.strings(known, where, ("name", "file"), ("axis",))
    if "axis" in words:
        reader.problems.attempt(keys.one_of, words["axis"], MOTIONS, source=reader.source, where=f"{where}.axis")
    if "file" in words:
        reader.problems.attempt(files.require_known, words["file"], reader.source, f"{where}.file")
    excitation = _excitation(reader, known["excitation"], f"{where}.excitation") if "excitation" in known else None
    return None if len(reader.problems.found) > before else Run(**words, excitation=excitation)


def _excitation(reader: Reader, value: Any, where: str) -> Excitation | None:
    kind = value.get("kind") if isinstance(value, dict) else value
    if not isinstance(value, dict) or not isinstance(kind, str) or kind not in EXCITATIONS:
        reader.refuse(f"{where}.kind", f"must be one of {', '.join(EXCITATIONS)}, found {kind!r}", "Correct it")
        return None
    figures: dict[str, float | tuple[float, ...]] = {}
    for key, one in reader.known(value, where, ("kind", *EXCITATIONS[kind])).items():
        if key == "levels":
            if not isinstance(one, list) or len(one) != 6 or not all(map(is_number, one)):
                reader.refuse(f"{where}.{key}", f"must be six finite numbers, found {one!r}", "Correct it")
                continue
            figures[key] = tuple(map(float, one))
        elif key != "kind":
            number = reader.number(value, where, key, low=0.0)
            figures |= {} if number is None else {key: number}
    return Excitation(kind=kind, figures=figures)
