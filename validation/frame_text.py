"""The user's own frame in one line: ``"0 0 45 mm; z 90 deg"``.

Before the semicolon stands where the origin is, seen from the article's frame, with its unit; after it, optionally, the turns
that carry the article's axes into the user's, each about an axis of the frame as turned so far, in the order written. A file may
say the same as a table with ``origin = "0 0 45 mm"`` and ``rotation``, either such turns or a 3x3 matrix whose columns are the
user's axes in the article's frame, written as three rows of three or as nine numbers row by row.
"""

from __future__ import annotations

import re
from typing import Any

import numpy as np

from geometry import keys, toml_file
from geometry.arrays import Array
from geometry.errors import BadInput
from geometry.frames import Pose, proper_rotation, rotation_about
from geometry.quantities import quantity

NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"

_POSITION = re.compile(rf"\s*({NUMBER})[\s,]+({NUMBER})[\s,]+({NUMBER})\s*([A-Za-zµ]+)\s*")
_TURN = re.compile(rf"\s*([xyz])\s+({NUMBER})\s*([A-Za-z°]+)\s*")


def read_frame(option: str, source: str = "--frame") -> Pose:
    """The pose of the user's frame in the article's, from one line or from a TOML file with a ``[frame]`` table.

    Raises
    ------
    BadInput : neither; no such file or no TOML in it; a unit missing or of another dimension; a matrix that is no rotation.
    OSError : the file cannot be read.
    """
    if not option.strip().endswith(".toml"):
        return pose_of(option, source)
    table = toml_file.read(option, remedy='Name a TOML file with a [frame] table, or write the frame: "0 0 45 mm; z 90 deg"')
    keys.require_present(table, ["frame"], source=option)
    return pose_of(table["frame"], option)


def pose_of(frame: object, source: str, field: str = "frame") -> Pose:
    """The pose that a line of text or a table with `origin` and `rotation` describes.

    Raises
    ------
    BadInput : see `read_frame`.
    """
    if isinstance(frame, str):
        origin, _, turns = frame.partition(";")
        return Pose(position=position(origin, source, field), rotation=_rotation(turns, source, field))
    table = keys.require_table(frame, source=source, where=field)
    keys.require_known(table, ("origin", "rotation"), source=source, where=field)
    there = position(table.get("origin", "0 0 0 m"), source, f"{field}.origin")
    return Pose(position=there, rotation=_rotation(table.get("rotation", ""), source, f"{field}.rotation"))


def position(text: object, source: str, field: str) -> Array:
    """Position (3,) [m] from three numbers and one unit of length.

    Raises
    ------
    BadInput : it does not read so.
    """
    found = _POSITION.fullmatch(text) if isinstance(text, str) else None
    if found is None:
        raise BadInput(
            source=source,
            field=field,
            problem=f"must be three numbers and a unit of length, found {text!r}",
            remedy='Write for example "0 0 45 mm", turns after a semicolon: "0 0 45 mm; z 90 deg"',
        )
    numbers, unit = found.groups()[:3], found[4]
    return np.array([_si(f"{number} {unit}", "length", source, field) for number in numbers])


def _rotation(value: Any, source: str, field: str) -> Array:
    if isinstance(value, str):
        return _turned(value, source, field)
    numbers = _nine(value)
    if numbers is None:
        raise _no_rotation(f"found {value!r}", source, field)
    try:
        return proper_rotation(np.array(numbers).reshape(3, 3), field)
    except ValueError as error:
        raise _no_rotation(str(error), source, field) from None


def _no_rotation(why: str, source: str, field: str) -> BadInput:
    remedy = 'Give nine numbers with ten digits each, row by row, or turns such as "z 30 deg"'
    return BadInput(source=source, field=field, problem=f"is no rotation: {why}", remedy=remedy)


def _nine(value: Any) -> list[float] | None:
    """The numbers of three rows of three, or of one list of nine, row by row; None when it is neither."""
    entries = value if isinstance(value, list) else []
    if len(entries) == 3 and all(isinstance(row, list) and len(row) == 3 for row in entries):
        entries = [entry for row in entries for entry in row]
    numbers = all(isinstance(entry, int | float) and not isinstance(entry, bool) for entry in entries)
    return [float(entry) for entry in entries] if numbers and len(entries) == 9 else None


def _turned(text: str, source: str, field: str) -> Array:
    rotation = np.eye(3)
    for turn in filter(str.strip, text.split(",")):
        found = _TURN.fullmatch(turn)
        if found is None:
            raise BadInput(
                source=source,
                field=field,
                problem=f"a turn must be an axis, a number and a unit of angle, found {turn.strip()!r}",
                remedy='Write for example "z 90 deg, x 5 deg"',
            )
        angle = _si(f"{found[2]} {found[3]}", "angle", source, field)
        rotation = rotation @ rotation_about(found[1], angle)
    return rotation


def _si(text: str, dimension: str, source: str, field: str) -> float:
    return float(quantity(text, dimension, source=source, field=field).nominal_value)
