"""What a description calls by name: parts, places, supports and joints of a structure (``docs/own-model.md``)."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

import numpy as np

from fem.gravity import Storey
from fem.user_model.units import UnitSystem, measured
from geometry import article, toml_file, user_article
from geometry.dynamic_mass import MOTIONS
from geometry.errors import BadInput
from geometry.frames import Array

SUPPORTS = ("base", "ground", "free")
"""How a structure is held: by an interface that moves, by the ground, or by nothing."""

GROUND = "ground"
"""The other side of a joint that is a support."""

RESERVED = (GROUND, "data", "indices", "indptr", "shape")
"""Names that mean something else: the ground itself, and the arrays of a sparse matrix."""

TOLERANCES = ("modulus", "density", "loss_factor", "thickness")
"""What may be off in a part."""

_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.\-]*")

_SECTIONS: tuple[dict[str, str], ...] = (
    {"width": "length", "height": "length"},
    {"area": "area", "Iy": "second moment of area", "Iz": "second moment of area", "J": "second moment of area"},
)
"""Ways to say the section of a beam, each with the dimensions of its figures."""


@dataclass(frozen=True, eq=False, kw_only=True)
class StatedPart:
    """A part by its name.

    Attributes
    ----------
    material : None where the matrices say it
    thickness : of a shell [m], None where it is none
    section : of a beam: width and height [m], or area [m²], Iy, Iz and J [m⁴]; empty where it is none
    loss_factor : [1], None when not given
    tolerance : standard deviation, relative, of those of `TOLERANCES` that are stated
    """

    material: article.Material | None = None
    thickness: float | None = None
    section: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    loss_factor: float | None = None
    tolerance: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))


@dataclass(frozen=True, eq=False, kw_only=True)
class StatedPlace:
    """A place by its name: one of the three.

    Attributes
    ----------
    node : its number
    point : (3,) [m], in the model's frame
    rows : degrees of freedom, from 0, that move it along x, y, z and, where there are six, turn it about them; -1 for none
    """

    node: int | None = None
    point: Array | None = None
    rows: tuple[int, ...] = ()


@dataclass(frozen=True, eq=False, kw_only=True)
class StatedJoint:
    """Springs between two places or parts, or from one to the ground.

    Attributes
    ----------
    between : two names, the second may be `GROUND`; empty where not given
    at : name of the place that the springs are about, empty where it is the first of `between`
    stiffness : (6,) along x, y, z [N/m] and about them [N m/rad]; None where the matrices have a part of the joint's name
    tolerance : standard deviation of all of them, relative; None when not given
    """

    between: tuple[str, ...] = ()
    at: str = ""
    stiffness: Array | None = None
    tolerance: float | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class Named:
    """All that has a name in a description.

    Attributes
    ----------
    support : one of `SUPPORTS`
    parts, places, joints : by name
    supports : parts of the matrices that are springs to the ground
    storeys : by the part that each is, what stands or hangs under gravity, which acts along axis `vertical`
    """

    support: str = "base"
    parts: Mapping[str, StatedPart] = field(default_factory=lambda: MappingProxyType({}))
    places: Mapping[str, StatedPlace] = field(default_factory=lambda: MappingProxyType({}))
    joints: Mapping[str, StatedJoint] = field(default_factory=lambda: MappingProxyType({}))
    supports: tuple[str, ...] = ()
    storeys: Mapping[str, Storey] = field(default_factory=lambda: MappingProxyType({}))
    vertical: int = 2


KEYS = ("support", "parts", "places", "joints", "supports", "storeys", "down")


def named(model: Mapping[str, Any], units: UnitSystem, source: str, where: str) -> Named:
    """The names in the table `model`, which `source` has at `where`.

    Raises
    ------
    BadInput : an unknown or missing key, a wrong type, unit or dimension, a name twice or one that cannot be called.
    """
    support = toml_file.one_of(model.get("support", "base"), SUPPORTS, source=source, where=f"{where}.support")
    tables = {}
    for key in ("parts", "places", "joints", "storeys"):
        tables[key] = toml_file.require_table(model.get(key, {}), source=source, where=f"{where}.{key}")
        for name in tables[key]:
            require_name(name, source, f"{where}.{key}")
    supports = model.get("supports", [])
    if not isinstance(supports, list) or not all(isinstance(name, str) for name in supports):
        raise toml_file.wrong(supports, "a list of names of parts", source, f"{where}.supports", 'Write it like ["y1", "y2"]')
    for name in supports:
        if supports.count(name) > 1:
            raise BadInput(source, f"{where}.supports", f"names {name!r} {supports.count(name)} times", "Name every support once")
    down = direction(model.get("down", "-z"), source, f"{where}.down")
    return Named(
        support=support,
        parts={name: _part(entry, units, source, f"{where}.parts.{name}") for name, entry in tables["parts"].items()},
        places={name: _place(entry, units, source, f"{where}.places.{name}") for name, entry in tables["places"].items()},
        joints={name: _joint(entry, units, source, f"{where}.joints.{name}") for name, entry in tables["joints"].items()},
        supports=tuple(supports),
        storeys={name: _storey(entry, units, source, f"{where}.storeys.{name}") for name, entry in tables["storeys"].items()},
        vertical=int(np.argmax(np.abs(down))),
    )


def require_name(name: str, source: str, where: str) -> None:
    """Refuse a `name` that no command could call: letters, digits, ``_``, ``-`` and ``.`` alone, and none of `RESERVED`.

    Raises
    ------
    BadInput : it is another.
    """
    if not _NAME.fullmatch(name) or name in RESERVED:
        problem = f"{name!r} means something else" if name in RESERVED else f"{name!r} cannot be called: it has other signs"
        remedy = "Give it another name, of letters, digits, _, - and . that does not begin with - or ."
        raise BadInput(source, where, problem, remedy)


def _part(entry: Any, units: UnitSystem, source: str, where: str) -> StatedPart:
    table = toml_file.require_table(entry, source=source, where=where)
    known = ("material", "thickness", "section", "loss_factor", "tolerance")
    toml_file.require_known(table, known, source=source, where=where)
    material = None
    if isinstance(table.get("material"), str):
        material = article.material(table["material"], f"{source}, {where}")
    elif "material" in table:
        material = user_article.own_material(where.rpartition(".")[2], table["material"], source, f"{where}.material")
    section = {}
    if "section" in table:
        stated = toml_file.require_table(table["section"], source=source, where=f"{where}.section")
        dimensions = next((way for way in _SECTIONS if set(way) & set(stated)), _SECTIONS[0])
        toml_file.require_known(stated, dimensions, source=source, where=f"{where}.section")
        toml_file.require_present(stated, dimensions, source=source, where=f"{where}.section")
        section = {key: _positive(stated[key], dimensions[key], units, source, f"{where}.section.{key}") for key in dimensions}
    tolerance = toml_file.require_table(table.get("tolerance", {}), source=source, where=f"{where}.tolerance")
    toml_file.require_known(tolerance, TOLERANCES, source=source, where=f"{where}.tolerance")
    return StatedPart(
        material=material,
        thickness=_positive(table["thickness"], "length", units, source, f"{where}.thickness") if "thickness" in table else None,
        section=section,
        loss_factor=loss_factor(table, source, where),
        tolerance={key: _share(value, source, f"{where}.tolerance.{key}") for key, value in tolerance.items()},
    )


def loss_factor(table: Mapping[str, Any], source: str, where: str) -> float | None:
    """``loss_factor`` of `table`, None where it has none.

    Raises
    ------
    BadInput : it is no number from 0 up to 2.
    """
    loss = table.get("loss_factor")
    if loss is not None and (not toml_file.is_number(loss) or not 0 <= loss < 2):
        remedy = "It is twice the damping ratio at resonance"
        raise toml_file.wrong(loss, "at least 0 and below 2", source, f"{where}.loss_factor", remedy)
    return None if loss is None else float(loss)


def _place(entry: Any, units: UnitSystem, source: str, where: str) -> StatedPlace:
    if toml_file.is_whole(entry):
        return StatedPlace(node=entry)
    if isinstance(entry, list):
        return StatedPlace(point=point(entry, units, source, where))
    if not isinstance(entry, dict):
        remedy = 'Write 117, ["1 m", "0 m", "20 mm"] or { dof = [0, 1, 2] }'
        raise toml_file.wrong(entry, "a node, three coordinates or a table with `dof`", source, where, remedy)
    toml_file.require_known(entry, ("dof",), source=source, where=where)
    toml_file.require_present(entry, ("dof",), source=source, where=where)
    rows = entry["dof"]
    whole = isinstance(rows, list) and all(toml_file.is_whole(row) and row >= -1 for row in rows)
    moving = [row for row in rows if row >= 0] if whole else []
    if len(rows if whole else ()) not in (3, 6) or not moving or len(set(moving)) < len(moving):
        remedy = "Count from 0, once each, and write -1 for a direction in which nothing moves"
        raise toml_file.wrong(rows, "three rows for x, y, z, or six with the rotations", source, f"{where}.dof", remedy)
    return StatedPlace(rows=tuple(rows))


def point(value: Any, units: UnitSystem, source: str, where: str) -> Array:
    """Three lengths (3,) [m], each with its unit; bare numbers where `units` are not known.

    Raises
    ------
    BadInput : other than three, no unit, another dimension.
    """
    if not isinstance(value, list) or len(value) != 3:
        example = '["0 mm", "0 mm", "120.5 mm"]' if units.known else "[0.0, 0.0, 120.5]"
        raise toml_file.wrong(value, "three lengths with their units", source, where, f"Write it like {example}")
    return np.array([measured(each, "length", units, source, where) for each in value], dtype=np.float64)


def _joint(entry: Any, units: UnitSystem, source: str, where: str) -> StatedJoint:
    table = toml_file.require_table(entry, source=source, where=where)
    toml_file.require_known(table, ("between", "at", "stiffness", "tolerance"), source=source, where=where)
    toml_file.require_present(table, ("between",) if "stiffness" in table else (), source=source, where=where)
    between = table.get("between", [])
    two = isinstance(between, list) and len(between) == 2 and all(isinstance(name, str) for name in between)
    if "between" in table and (not two or between[0] in (GROUND, between[1])):
        remedy = f'Write it like ["deck", "rail"], or ["foot", "{GROUND}"] with the ground last'
        raise toml_file.wrong(between, "two different names", source, f"{where}.between", remedy)
    at = table.get("at", "")
    if not isinstance(at, str):
        raise toml_file.wrong(at, "the name of a place", source, f"{where}.at", "State its coordinates in fe_model.places")
    stiffness = six_stiffnesses(table["stiffness"], units, source, f"{where}.stiffness") if "stiffness" in table else None
    tolerance = _share(table["tolerance"], source, f"{where}.tolerance") if "tolerance" in table else None
    return StatedJoint(between=tuple(between), at=at, stiffness=stiffness, tolerance=tolerance)


def direction(value: Any, source: str, where: str) -> Array:
    """(3,) along an axis of the model, as in ``-z``."""
    word = value.removeprefix("-") if isinstance(value, str) else value
    axis, found = toml_file.one_of(word, MOTIONS[:3], source=source, where=where), np.zeros(3)
    found[MOTIONS.index(axis)] = -1.0 if word != value else 1.0
    return found


def _storey(entry: Any, units: UnitSystem, source: str, where: str) -> Storey:
    table = toml_file.require_table(entry, source=source, where=where)
    toml_file.require_known(table, ("below", "above", "height", "weight", "hinged"), source=source, where=where)
    needed = ("above", "height") if units.known else ("above", "height", "weight")  # in units not known gravity is none
    toml_file.require_present(table, needed, source=source, where=where)
    ends = tuple(table.get(key, GROUND) for key in ("below", "above"))
    if not all(isinstance(end, str) for end in ends) or not isinstance(table.get("hinged", False), bool):
        remedy = 'Write it like { below = "floor-1", above = "floor-2", height = "3 m", hinged = false }'
        raise toml_file.wrong(dict(table), "names of two places, and true or false", source, where, remedy)
    height = measured(table["height"], "length", units, source, f"{where}.height")
    weight = _positive(table["weight"], "force", units, source, f"{where}.weight") if "weight" in table else None
    return Storey(below=ends[0], above=ends[1], height=height, weight=weight, hinged=table.get("hinged", False))


def six_stiffnesses(values: Any, units: UnitSystem, source: str, where: str) -> Array:
    """Stiffnesses (6,) along x, y, z [N/m] and about them [N m/rad]; a 0 needs no unit.

    Raises
    ------
    BadInput : other than six, a negative one, all zero, no unit or another dimension.
    """
    if not isinstance(values, list) or len(values) != 6:
        remedy = 'Write ["1e8 N/m", 0, 0, "1e4 N m/rad", 0, 0]: along x, y, z and about them'
        raise toml_file.wrong(values, "six stiffnesses", source, where, remedy)
    dimensions = [*3 * ["stiffness"], *3 * ["rotational stiffness"]]
    stiffness = np.zeros(6)  # where a bare 0 is written, too: nothing is nothing in every unit
    for k, value in enumerate(values):
        if isinstance(value, bool) or value not in (0, 0.0):
            stiffness[k] = measured(value, dimensions[k], units, source, where)
    if np.any(stiffness < 0) or not np.any(stiffness):
        what = f"{stiffness.min():g} along {MOTIONS[int(np.argmin(stiffness))]}" if np.any(stiffness < 0) else "zeros alone"
        raise toml_file.wrong(what, "positive or zero, and not all zero", source, where, "Leave such a joint out")
    return stiffness


def _positive(value: Any, dimension: str, units: UnitSystem, source: str, where: str) -> float:
    found = measured(value, dimension, units, source, where)
    if found <= 0:
        raise toml_file.wrong(value, "positive", source, where, "Correct it, or leave it out")
    return found


def _share(value: Any, source: str, where: str) -> float:
    if not toml_file.is_number(value) or not 0 < value < 1:
        remedy = "5 % is 0.05"
        raise toml_file.wrong(value, "a standard deviation relative to the value, above 0 and below 1", source, where, remedy)
    return float(value)
