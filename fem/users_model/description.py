"""The TOML text that says what bare numbers mean: units, reference point, interface, what is known of the mass.

It stands in a file of its own or, in HDF5 and npz, in the data file itself (attribute or array ``description``).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from fem.users_model.units import UnitSystem, unit_system
from geometry import keys, toml_file
from geometry.arrays import Array
from geometry.errors import BadInput
from geometry.quantities import quantity

TABLE = "fe_model"
"""The table by which a TOML file is recognised as the description of a model."""

KINDS = ("matrices", "modal")
_TOP = ("format", TABLE, "stated")
_KEYS = ("name", "kind", "units", "reference_point", "file", "grids", "interface", "matrices", "loss_factor", "sha256")
MATRICES = ("stiffness", "mass", "viscous", "structural")


@dataclass(frozen=True, eq=False, kw_only=True)
class Stated:
    """What the user knows of the whole structure from elsewhere, to hold the matrices against.

    Attributes
    ----------
    mass : [kg], None when not stated
    mass_tolerance : [kg], zero when none was stated
    cog : (3,) [m] in the model's frame, None when not stated
    """

    mass: float | None = None
    mass_tolerance: float = 0.0
    cog: Array | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class Description:
    """The content of a description.

    Attributes
    ----------
    source : where the text stands
    name : of the model
    kind : one of `KINDS`
    units : of every number in the data
    reference_point : (3,) [m], in the model's frame
    file, grids : the data, and where a Nastran model has its grid points; None where not named
    interface : identifiers of the nodes that the base carries; empty where the data say it otherwise
    matrices : the names in a Nastran file of what we call stiffness, mass, viscous and structural
    loss_factor : of the whole structure, None when not given
    sha256 : of the data file, empty when not given
    stated : what is known from elsewhere
    """

    source: str
    name: str
    kind: str
    units: UnitSystem
    reference_point: Array
    file: Path | None = None
    grids: Path | None = None
    interface: tuple[int, ...] = ()
    matrices: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    loss_factor: float | None = None
    sha256: str = ""
    stated: Stated = field(default_factory=Stated)


def read(path: Path) -> Description:
    """The description in the file `path`."""
    return parse(toml_file.read(path), str(path), path)


def embedded(text: str, path: Path) -> Description:
    """The description `text` that the data file `path` carries."""
    source = f"{path}, description"
    return parse(toml_file.parse(text, source), source, path)


def parse(table: Mapping[str, Any], source: str, path: Path) -> Description:
    """The description in `table`; other files are relative to `path` and lie in its folder or below.

    Raises
    ------
    BadInput : an unknown or missing key, a wrong type, unit or dimension, a file that is not there or elsewhere.
    """
    keys.require_known(table, _TOP, source=source)
    toml_file.require_format(table, source)
    keys.require_present(table, (TABLE,), source=source)
    model = keys.require_table(table[TABLE], source=source, where=TABLE)
    keys.require_known(model, _KEYS, source=source, where=TABLE)
    keys.require_present(model, ("kind", "units", "reference_point"), source=source, where=TABLE)
    return Description(
        source=source,
        name=_text(model, "name", source) or path.stem,
        kind=keys.one_of(model["kind"], KINDS, source=source, where=f"{TABLE}.kind"),
        units=unit_system(model["units"], source),
        reference_point=_point(model["reference_point"], source, f"{TABLE}.reference_point"),
        file=_file(model, "file", source, path),
        grids=_file(model, "grids", source, path),
        interface=_interface(model.get("interface", []), source),
        matrices=_names(model.get("matrices", {}), source),
        loss_factor=_loss_factor(model.get("loss_factor"), source),
        sha256=(_text(model, "sha256", source) or "").strip().lower(),
        stated=_stated(table.get("stated", {}), source),
    )


def _text(table: Mapping[str, Any], key: str, source: str) -> str | None:
    found = table.get(key)
    if found is not None and (not isinstance(found, str) or not found.strip() or "\0" in found):
        raise _wrong(found, "text", source, f"{TABLE}.{key}", "Write it in quotes")
    return found


def _point(value: Any, source: str, where: str) -> Array:
    """Three lengths (3,) [m], each with its unit."""
    example = 'Write it like ["0 mm", "0 mm", "120.5 mm"]'
    if not isinstance(value, list) or len(value) != 3:
        raise _wrong(value, "three lengths with their units", source, where, example)
    return np.array([quantity(each, "length", source=source, field=where).nominal_value for each in value], dtype=np.float64)


def _file(table: Mapping[str, Any], key: str, source: str, path: Path) -> Path | None:
    name = _text(table, key, source)
    if name is None:
        return None
    folder, there, where = path.parent.resolve(), path.parent / name, f"{TABLE}.{key}"
    if not there.resolve().is_relative_to(folder):
        problem = f"{name!r} leads out of the folder of the description, to {there.resolve()}"
        raise BadInput(source=source, field=where, problem=problem, remedy="Copy the file beside the description")
    if not there.is_file():
        raise BadInput(source=source, field=where, problem=f"there is no file {name!r}", remedy=f"Looked for {there}")
    return there


def _interface(value: Any, source: str) -> tuple[int, ...]:
    where = f"{TABLE}.interface"
    if not isinstance(value, list) or not all(isinstance(node, int) and not isinstance(node, bool) for node in value):
        raise _wrong(value, "a list of node numbers", source, where, "Write it like [1, 2, 3]")
    twice = next((node for node in value if value.count(node) > 1), None)
    if twice is not None:
        problem = f"names node {twice} {value.count(twice)} times"
        raise BadInput(source=source, field=where, problem=problem, remedy="Name every interface node once")
    return tuple(value)


def _names(value: Any, source: str) -> dict[str, str]:
    where = f"{TABLE}.matrices"
    table = keys.require_table(value, source=source, where=where)
    keys.require_known(table, MATRICES, source=source, where=where)
    for key, name in table.items():
        if not isinstance(name, str) or not name.isidentifier():
            raise _wrong(name, "the name of a matrix", source, f"{where}.{key}", 'Write it like { stiffness = "kaa" }')
    return {key: name.lower() for key, name in table.items()}


def _loss_factor(value: Any, source: str) -> float | None:
    if value is None:
        return None
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0 <= value < 2:
        raise _wrong(
            value, "at least 0 and below 2", source, f"{TABLE}.loss_factor", "It is twice the damping ratio at resonance"
        )
    return float(value)


def _stated(value: Any, source: str) -> Stated:
    table = keys.require_table(value, source=source, where="stated")
    keys.require_known(table, ("mass", "cog"), source=source, where="stated")
    cog = _point(table["cog"], source, "stated.cog") if "cog" in table else None
    if "mass" not in table:
        return Stated(cog=cog)
    mass = quantity(table["mass"], "mass", source=source, field="stated.mass")
    if mass.nominal_value <= 0:
        raise _wrong(table["mass"], "positive", source, "stated.mass", "Give the mass of the whole structure")
    return Stated(mass=float(mass.nominal_value), mass_tolerance=float(mass.std_dev), cog=cog)


def _wrong(found: Any, wanted: str, source: str, where: str, remedy: str) -> BadInput:
    return BadInput(source=source, field=where, problem=f"must be {wanted}, found {found!r}", remedy=remedy)
