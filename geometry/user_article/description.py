"""``article.toml``: which body of which file is made of what, and where it sits; checked whole before any file is read."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from geometry import keys, toml_file
from geometry.errors import BadInput
from geometry.frames import Pose, rotation_about
from geometry.lengths import length_unit
from geometry.materials import Material
from geometry.quantities import quantity
from geometry.user_article.made_of import density, made_of

DESCRIPTION = "article.toml"
_TOP = ("format", "article", "part", "material")
_ELASTIC = {
    "youngs_modulus": ("pressure", 0.0, np.inf, '"207 GPa"'),
    "poisson_ratio": ("ratio", -1.0, 0.5, "0.3"),
    "loss_factor": ("ratio", -1e-12, 1.0, "0.002 to 0.01"),
}
"""What a solid model needs to know of a material beside its density: dimension, open range in SI, and an example."""

_PART = ("name", "file", "unit", "material", "density", "body", "materials", "position_mm", "rotation_deg")


@dataclass(frozen=True, eq=False, kw_only=True)
class PartEntry:
    """One file, or one body of it, as the user describes it.

    Attributes
    ----------
    name : of the part; of a file with several bodies, the first half of their names
    file : where it is
    unit : of a mesh's numbers, None when the file states it
    material : of every body that `materials` does not name; None when each is named
    materials : of bodies of a STEP file, by name
    body : the one body that is meant: a name in a STEP file, a number from 1 in a mesh; None for all
    pose : where the file's frame sits in the article's frame
    named : whether the user gave the name
    """

    name: str
    file: Path
    unit: str | None = None
    material: Material | None = None
    materials: Mapping[str, Material] = field(default_factory=dict)
    body: str | None = None
    pose: Pose = field(default_factory=Pose)
    named: bool = False


@dataclass(frozen=True, eq=False, kw_only=True)
class Description:
    """The content of an ``article.toml``: the article's `name` and its `parts`."""

    name: str
    parts: tuple[PartEntry, ...]


def read(path: Path) -> Description:
    """The description in `path`, files relative to it.

    Raises
    ------
    BadInput : not TOML, an unknown key (the nearest known one is named), a wrong type, a missing file or material ...
    """
    source = str(path)
    table = toml_file.read(path)
    keys.require_known(table, _TOP, source=source)
    toml_file.require_format(table, source)
    article = keys.require_table(table.get("article", {}), source=source, where="article")
    keys.require_known(article, ("name",), source=source, where="article")
    materials = keys.require_table(table.get("material", {}), source=source, where="material")
    own = {name: _own_material(name, entry, source) for name, entry in materials.items()}
    entries = table.get("part", [])
    if not isinstance(entries, list) or not entries:
        raise BadInput(source=source, field="part", problem="there is no part", remedy="Add a [[part]] with name and file")
    parts = tuple(_part(entry, number, path, own) for number, entry in enumerate(entries, start=1))
    _require_unique([part.name for part in parts], source)
    return Description(name=_text(article, "name", source, "article") or path.resolve().parent.name, parts=parts)


def template(name: str, parts: Iterable[Path]) -> str:
    """An ``article.toml`` for the files `parts`, to be corrected by the user."""
    parts = tuple(parts)
    lines = [f"format = {toml_file.FORMAT}", "", "[article]", f'name = "{name}"']
    for part, name_of_part in zip(parts, _numbered([part.stem for part in parts]), strict=True):
        step = part.suffix.lower() in (".step", ".stp")
        lines += ["", "[[part]]", f'name = "{name_of_part}"', f'file = "{part.name}"', *([] if step else ['unit = "mm"'])]
        lines.append('material = "steel"')
    return "\n".join(lines) + "\n"


def _numbered(names: Sequence[str]) -> list[str]:
    """`names`, each once: x, x and x become x, x-2 and x-3, or the next number where such a name is there already."""
    taken: list[str] = []
    for name in names:
        tries = (name, *(f"{name}-{number}" for number in range(2, len(names) + 2)))
        taken.append(next(each for each in tries if each not in taken and (each == name or each not in names)))
    return taken


def _part(entry: Any, number: int, path: Path, own: Mapping[str, Material]) -> PartEntry:
    source, where = str(path), f"part {number}"
    if not isinstance(entry, dict):
        raise BadInput(source=source, field="part", problem=f"must be a table, found {entry!r}", remedy="Write it as [[part]]")
    keys.require_known(entry, _PART, source=source, where=where)
    name, file = (_needed(entry, key, source, where) for key in ("name", "file"))
    there = path.parent / file
    if not there.is_file():
        raise BadInput(source=source, field=f"{where}.file", problem=f"there is no file {file!r}", remedy=f"Looked for {there}")
    unit = _text(entry, "unit", source, where)
    if unit is not None:
        unit = length_unit(unit, source, f"{where}.unit").name
    return PartEntry(
        name=name,
        file=there,
        unit=unit,
        material=_material(entry, source, where, own),
        materials=_materials(entry, source, where, own),
        body=_body(entry, source, where),
        pose=_pose(entry, source, where),
        named=True,
    )


def _material(entry: dict[str, Any], source: str, where: str, own: Mapping[str, Material]) -> Material | None:
    if "material" in entry and "density" in entry:
        raise BadInput(
            source=source, field=f"{where}.density", problem="is given beside a material", remedy="Leave one of the two out"
        )
    if "density" in entry:
        return Material(name=str(entry["density"]), density=density(entry["density"], source, f"{where}.density"))
    return _named(entry["material"], source, f"{where}.material", own) if "material" in entry else None


def _named(value: Any, source: str, where: str, own: Mapping[str, Material]) -> Material:
    if not isinstance(value, str):
        raise _wrong(value, "a name of a material or a density as text", source, where)
    return made_of(value, f"{source}, {where}", own)


def _own_material(name: str, entry: Any, source: str) -> Material:
    where = f"material.{name}"
    table = keys.require_table(entry, source=source, where=where)
    keys.require_known(table, ("density", *_ELASTIC), source=source, where=where)
    if "density" not in table:
        raise BadInput(source=source, field=f"{where}.density", problem="is missing", remedy='Add density = "7800 kg/m^3"')
    elastic = {key: _elastic(key, table[key], source, f"{where}.{key}") for key in _ELASTIC if key in table}
    return Material(name=name, density=density(table["density"], source, f"{where}.density"), **elastic)


def _elastic(key: str, value: Any, source: str, where: str) -> float:
    """A modulus [Pa], Poisson's ratio or loss factor, within its range."""
    dimension, lowest, highest, example = _ELASTIC[key]
    text = str(value) if dimension == "ratio" and isinstance(value, int | float) and not isinstance(value, bool) else value
    found = quantity(text, dimension, source=source, field=where).nominal_value
    if not lowest < found < highest:
        raise BadInput(
            source=source,
            field=where,
            problem=f"must lie between {lowest:g} and {highest:g}, both excluded, found {value!r}",
            remedy=f"Steel has {example}",
        )
    return float(found)


def _materials(entry: dict[str, Any], source: str, where: str, own: Mapping[str, Material]) -> dict[str, Material]:
    found = entry.get("materials", {})
    if not isinstance(found, dict):
        raise _wrong(found, "a table of body = material", source, f"{where}.materials")
    return {body: _named(value, source, f"{where}.materials.{body}", own) for body, value in found.items()}


def _body(entry: dict[str, Any], source: str, where: str) -> str | None:
    found = entry.get("body")
    if found is None:
        return None
    if isinstance(found, bool) or not isinstance(found, str | int):
        raise _wrong(found, "a body's name (STEP) or its number from 1 (mesh)", source, f"{where}.body")
    return str(found)


def _pose(entry: dict[str, Any], source: str, where: str) -> Pose:
    """Turned about the article's x, then y, then z, then carried to its position."""
    position, angles = (_three(entry, key, source, where) for key in ("position_mm", "rotation_deg"))
    x, y, z = np.deg2rad(angles)
    return Pose(position=1e-3 * position, rotation=rotation_about("z", z) @ rotation_about("y", y) @ rotation_about("x", x))


def _three(entry: dict[str, Any], key: str, source: str, where: str) -> np.ndarray:
    found = entry.get(key, [0, 0, 0])
    numbers = isinstance(found, list) and all(isinstance(v, int | float) and not isinstance(v, bool) for v in found)
    if not numbers or len(found) != 3 or not np.isfinite(np.array(found, dtype=np.float64)).all():
        raise _wrong(found, "three finite numbers", source, f"{where}.{key}")
    return np.array(found, dtype=np.float64)


def _needed(table: dict[str, Any], key: str, source: str, where: str) -> str:
    found = _text(table, key, source, where)
    if not found:
        raise BadInput(source=source, field=f"{where}.{key}", problem="is missing", remedy=f'Add {key} = "..."')
    return found


def _text(table: dict[str, Any], key: str, source: str, where: str) -> str | None:
    found = table.get(key)
    if found is not None and not isinstance(found, str):
        raise _wrong(found, "text", source, f"{where}.{key}")
    return found


def _wrong(found: Any, wanted: str, source: str, where: str) -> BadInput:
    return BadInput(source=source, field=where, problem=f"must be {wanted}, found {found!r}", remedy="Correct it")


def _require_unique(names: list[str], source: str) -> None:
    for name in names:
        if names.count(name) > 1:
            raise BadInput(
                source=source, field="part.name", problem=f"{name!r} names more than one part", remedy="Give each its own name"
            )
