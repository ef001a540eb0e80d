"""Signals in universal files: dataset 58, ASCII or binary (58b), one a channel, its name in the first id line.

Function type 1 is a time history, 12 a spectrum. A dataset 164 states the units of the functions behind it. Other datasets (151
header, nodes, traces) are passed over. `uff_blocks` measures and reads the numbers, pyuff the headers. `uff_writing` writes.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from geometry.arrays import Array
from geometry.errors import BadInput
from identification.files.axis import LARGEST, rate_of_increment, rate_of_times, require_lines, roundest
from identification.files.contents import DAMAGED, Samples, Signals, StatedUnits, as_complex, require_file, require_one_length
from identification.files.uff_blocks import COMPLEX, Block, blocks, column
from identification.files.uff_writing import RATE, write

__all__ = ["ENDINGS", "read", "write"]

ENDINGS = (".uff", ".unv")

TIME_RESPONSE, SPECTRUM = 1, 12

CODES = {1: "SI", 2: "BG", 3: "MG", 4: "BA", 5: "MM", 6: "CM", 7: "IN", 8: "GM", 9: "user defined"}
"""Systems of units of dataset 164."""

AXIS = ("num_pts", "abscissa_spacing", "abscissa_min", "abscissa_inc")


def read(path: Path) -> Signals:
    """The signals in `path`.

    Raises
    ------
    BadInput : no universal file, damaged, no function, one of another type, without name or with another's, axes that differ.
    """
    require_file(path)
    source = str(path)
    found = blocks(path.read_bytes(), source)
    functions = [block for block in found if block.number == 58]
    if not functions:
        raise BadInput(source=source, problem="it holds no dataset 58", remedy="Export the signals as dataset 58 or 58b")
    kind = _function_type(functions, source)
    names = _names(functions, source)
    sets = _headers(path, [block.index for block in functions], len(found))
    abscissae, ordinates = zip(*(_split(one, block) for one, block in zip(sets, functions, strict=True)), strict=True)
    samples: dict[str, Samples] = dict(zip(names, ordinates, strict=True))
    _require_one_axis(sets, abscissae, names, source)
    require_one_length(samples, None, source)
    axis: dict[str, Any] = {}
    if kind == TIME_RESPONSE:
        axis["sampling_rate"] = _rate(sets[0], abscissae[0], functions, names, source)
    else:
        axis["frequency"] = abscissae[0]
        require_lines(axis["frequency"], source, names[0])
    labels = {name: str(one.get("ordinate_axis_units_lab", "")).strip() for name, one in zip(names, sets, strict=True)}
    units = _units(found, names, source)
    warnings = tuple(text for block in functions for text in block.warnings)
    return Signals(source=source, samples=samples, units=units, labels=labels, warnings=warnings, **axis)


def _function_type(functions: list[Block], source: str) -> int:
    kinds = {}
    for block in functions:
        name = block.lines[0].strip()
        kinds[name] = int(column(block.lines[5], 0, 5, int, name, source))
        if kinds[name] not in (TIME_RESPONSE, SPECTRUM):
            problem = (
                f"has the function type {kinds[name]}, where {TIME_RESPONSE} (time response) or {SPECTRUM} (spectrum) is read"
            )
            raise BadInput(
                source=source, field=name, problem=problem, remedy="Export the recorded signals, not what was made of them"
            )
    if len(set(kinds.values())) > 1:
        odd = next(name for name in kinds if kinds[name] != next(iter(kinds.values())))
        problem = "is a spectrum beside time histories, or the other way round"
        raise BadInput(source=source, field=odd, problem=problem, remedy="Put them into files of their own")
    return next(iter(kinds.values()))


def _names(functions: list[Block], source: str) -> list[str]:
    names = [block.lines[0].strip() for block in functions]
    for name in names:
        if name in ("", "NONE"):
            problem = "a dataset 58 has no name in its first id line"
            raise BadInput(source=source, problem=problem, remedy="Write the channel's name there")
        if names.count(name) > 1:
            problem = f"{names.count(name)} datasets have this name in their first id line"
            raise BadInput(source=source, field=name, problem=problem, remedy="Give every channel its own name")
    return names


def _headers(path: Path, chosen: list[int], count: int) -> list[dict[str, Any]]:
    """What pyuff reads of the headers of the `chosen` datasets, when it tells as many apart as are framed."""
    import pyuff

    try:
        file = pyuff.UFF(str(path))
        agreed = file.get_n_sets() == count
        sets = [file.read_sets(index, header_only=True) for index in chosen] if agreed else []
    except Exception as error:  # pyuff raises bare exceptions
        problem = f"it cannot be read as a universal file: {error}"
        raise BadInput(source=str(path), problem=problem, remedy=DAMAGED) from None
    if agreed and any(one.get("type") != 58 or "z_axis_spec_data_type" not in one for one in sets):
        raise BadInput(source=str(path), problem="a dataset 58 has a damaged header", remedy=DAMAGED)
    if any(not abs(one[key]) < LARGEST for one in sets for key in ("abscissa_min", "abscissa_inc")):
        raise BadInput(source=str(path), problem="a dataset 58 has no finite abscissa", remedy=DAMAGED)
    if not agreed:
        problem = f"its marks -1 tell {file.get_n_sets()} datasets apart where {count} are framed"
        raise BadInput(source=str(path), problem=problem, remedy=DAMAGED)
    return sets


def _split(one: dict[str, Any], block: Block) -> tuple[Array, Samples]:
    """Abscissa and ordinate of a function."""
    rows = block.numbers.reshape(int(one["num_pts"]), -1)
    if one["abscissa_spacing"]:
        abscissa = one["abscissa_min"] + one["abscissa_inc"] * np.arange(len(rows))
    else:
        abscissa, rows = rows[:, 0], rows[:, 1:]
    return abscissa, as_complex(rows[:, 0], rows[:, 1]) if one["ord_data_type"] in COMPLEX else rows[:, 0]


def _require_one_axis(sets: list[dict[str, Any]], abscissae: Sequence[Array], names: list[str], source: str) -> None:
    first = sets[0]
    for name, one, abscissa in zip(names, sets, abscissae, strict=True):
        differs = [key for key in AXIS if one[key] != first[key]]
        if differs or not np.array_equal(abscissa, abscissae[0]):
            what = ", ".join(f"{key} {one[key]:g}" for key in differs) or "other abscissa values"
            theirs = ", ".join(f"{first[key]:g}" for key in differs)
            problem = f"has another axis than {names[0]}: {what}" + (f" instead of {theirs}" if theirs else "")
            raise BadInput(source=source, field=name, problem=problem, remedy="Record all channels at one rate and length")


def _rate(one: dict[str, Any], time: Array, functions: list[Block], names: list[str], source: str) -> float:
    """The sampling rate behind an increment of six digits, or behind time stamps; an id line of ours has it in full."""
    if not one["abscissa_spacing"]:
        return rate_of_times(time, source, "time")
    increment = float(one["abscissa_inc"])
    if not 0 < increment < np.inf:
        problem = f"has the abscissa increment {increment:g} s"
        raise BadInput(source=source, field=names[0], problem=problem, remedy="Export it with its sampling interval")
    low, high = rate_of_increment(increment)
    for block, name in zip(functions, names, strict=True):
        stated = re.fullmatch(RATE.format(r"(\S+)"), block.lines[3].strip())
        full = float(stated[1]) if stated and re.fullmatch(r"[-+.\deE]+", stated[1]) else None
        if full is not None and not low <= full <= high:
            problem = f"says {stated[0] if stated else ''!r}, and its increment is that of {low:.9g} to {high:.9g} Hz"
            raise BadInput(source=source, field=name, problem=problem, remedy=DAMAGED)
        if full is not None:
            return full
    return roundest(low, high)


def _units(found: list[Block], names: list[str], source: str) -> dict[str, StatedUnits]:
    """The last dataset 164 before every function; one that comes only behind all of them counts for all."""
    stated, order = [], iter(names)
    current: StatedUnits | None = None
    for block in found:
        if block.number == 164:
            current = _system(block, source)
        elif block.number == 58:
            stated.append((next(order), current))
    return {name: units or current for name, units in stated if units or current}  # type: ignore[misc]


def _system(block: Block, source: str) -> StatedUnits:
    what = "dataset 164"
    if len(block.lines) < 2:
        raise BadInput(source=source, field=what, problem="is cut short", remedy=DAMAGED)
    code = int(column(block.lines[0], 0, 10, int, what, source))
    row = block.lines[1].replace("D", "E").replace("d", "e")
    length, force = (column(row, start, 25, float, what, source) for start in (0, 25))
    if not (0 < length < np.inf and 0 < force < np.inf):
        raise BadInput(source=source, field=what, problem=f"has the factors {length:g} and {force:g}", remedy="Correct it")
    described = block.lines[0][10:30].strip()
    words = f"code {code}, {CODES.get(code, 'unknown')}" + (f", {described!r}" if described else "")
    return StatedUnits(length=1 / length, force=1 / force, words=words)
