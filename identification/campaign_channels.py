"""The tables [[channel]] of ``campaign.toml``: one channel each, in metres and SI."""

from __future__ import annotations

from typing import Any

from geometry import keys
from geometry.sensors import GROUPS, SI, Channel, Place
from identification.campaign_values import Reader
from identification.units import factor

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

LONGEST_NAME = 80
"""Characters of a channel's name: the id line of a universal file has no more."""


def channel(reader: Reader, entry: dict[str, Any], where: str, *, metres: float) -> Channel | None:
    """The channel in `entry`, the table at `where`, with lengths in units of so many `metres`; None where it has a problem."""
    before = len(reader.problems.found)
    known = reader.known(entry, where, CHANNEL)
    words = reader.strings(known, where, ("name", "quantity", "unit", "group"))
    _require_name(reader, words.get("name"), f"{where}.name")
    for key, choices in (("quantity", SI), ("group", GROUPS)):
        if key in words:
            reader.problems.attempt(keys.one_of, words[key], tuple(choices), source=reader.source, where=f"{where}.{key}")
    size = None
    if words.get("quantity") in SI and "unit" in words:
        unit, quantity = words["unit"], words["quantity"]
        size = reader.problems.attempt(factor, unit, quantity, source=reader.source, field=f"{where}.unit")
    places = _places(reader, known, where, metres)
    reference = reader.flag(known, where, "reference", False)
    senses = reader.flag(known, where, "senses_gravity", words.get("quantity") == "acceleration")
    if senses and words.get("quantity") in ("force", "moment"):
        reader.refuse(f"{where}.senses_gravity", "is for accelerometers", "Leave it out")
    noise = reader.number(known, where, "noise_rms", low=0.0) if "noise_rms" in known else None
    if len(reader.problems.found) > before or size is None:
        return None
    return Channel(
        **words,
        places=places,
        reference=reference,
        senses_gravity=senses,
        noise_rms=None if noise is None else noise * size,
    )


def _require_name(reader: Reader, name: str | None, where: str) -> None:
    if name is None:
        return
    if name != name.strip() or not name.isprintable() or "/" in name or name in (".", "..") or len(name) > LONGEST_NAME:
        problem = f"must be up to {LONGEST_NAME} printable characters without / and spaces at the ends, found {name!r}"
        reader.refuse(where, problem, "Rename it here and in the signal files")


def _places(reader: Reader, entry: dict[str, Any], where: str, metres: float) -> tuple[Place, ...]:
    if "cells" not in entry:
        one = _place(reader, entry, where, metres)
        return () if one is None else (one,)
    both = [key for key in ("position", "direction") if key in entry]
    if both:
        reader.refuse(f"{where}.cells", f"stands beside {' and '.join(both)}", "Give either, cells for a sum of several")
    cells = entry["cells"]
    if not isinstance(cells, list) or not cells or not all(isinstance(cell, dict) for cell in cells):
        reader.refuse(
            f"{where}.cells", f"must be tables, found {cells!r}", "Write { position = [...], direction = [...] } for each"
        )
        return ()
    made = []
    for k, cell in enumerate(cells):
        at = f"{where}.cells[{k + 1}]"
        made.append(_place(reader, reader.known(cell, at, ("position", "direction")), at, metres))
    return tuple(one for one in made if one is not None)


def _place(reader: Reader, entry: dict[str, Any], where: str, metres: float) -> Place | None:
    before = len(reader.problems.found)
    for key in ("position", "direction"):
        if key not in entry:
            reader.refuse(f"{where}.{key}", "is missing", "Add it")
    position, direction = (
        reader.vector(entry[key], f"{where}.{key}", scale) if key in entry else None
        for key, scale in (("position", metres), ("direction", 1.0))
    )
    if position is None or direction is None or len(reader.problems.found) > before:
        return None
    try:
        return Place(position=position, direction=direction)
    except ValueError as error:
        reader.refuse(f"{where}.direction", str(error).removeprefix("`direction` "), "Divide it by its length")
        return None
