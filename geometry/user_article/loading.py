"""From a path to a `UserArticle`: one file with one material, or an ``article.toml`` that says which body is made of what."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

import numpy as np

from geometry.errors import BadInput
from geometry.lengths import MILLIMETRE, LengthUnit, doubts
from geometry.materials import Material
from geometry.mesh import files
from geometry.mesh.bodies import bodies
from geometry.mesh.checks import require_closed_volume
from geometry.mesh.triangles import TriangleMesh, placed
from geometry.user_article import description
from geometry.user_article.description import DESCRIPTION, PartEntry
from geometry.user_article.made_of import made_of
from geometry.user_article.nouns import UserArticle, UserPart
from geometry.user_article.routes import overlap_warnings

if TYPE_CHECKING:
    from geometry.cad import step

RELATIVE_CHORD = 1e-4
"""Chord error of the mesh of a solid where none is asked for, relative to the diagonal of the box around it."""

STEP_ENDINGS = (".step", ".stp")
ENDINGS = (*STEP_ENDINGS, *files.ENDINGS, ".toml")
"""Files that can be an article, upper or lower case; a folder stands for the ``article.toml`` in it."""


def load(path: str | Path, *, unit: str | None = None, material: str | None = None, chord: float | None = None) -> UserArticle:
    """The article in the file or folder `path`, every mesh closed and checked, every body with its material.

    `unit` is that of a mesh file's numbers (mm, cm, m, in, ft); it may be left out where the file itself states one, and STEP
    always does. `material` is a name of the library or a density such as ``"7800 kg/m^3"``, for all bodies; of an
    ``article.toml`` both go to the parts that state none themselves. `chord` [m] is that of the meshes made of STEP solids, by
    default `RELATIVE_CHORD` of each.

    Raises
    ------
    BadInput : whatever is wrong with path, file, unit, material or mesh.
    """
    path = require_file(path)
    given = None if material is None else made_of(material, "--material")
    if path.suffix.lower() == ".toml":
        return _described(path, unit, given, chord)
    parts, warnings = _parts(PartEntry(name=path.stem, file=path, unit=unit, material=given), chord)
    return _finished(path.stem, parts, f"{path.stem}: read from {path.name}.", warnings)


def require_file(path: str | Path) -> Path:
    """The file that `path` is or, of a folder, its ``article.toml``; nothing in it is looked at.

    Raises
    ------
    BadInput : there is none, it is a device, or one of its ending cannot be an article.
    """
    path = Path(path)
    if not path.exists():
        raise BadInput(source=str(path), problem="there is no such file or folder", remedy="Check the path")
    if path.is_dir():
        return _description_in(path)
    if not path.is_file():
        raise BadInput(source=str(path), problem="it is a device or a pipe, where a file is needed", remedy="Check the path")
    if path.suffix.lower() not in ENDINGS:
        raise _unreadable(path)
    return path


def _unreadable(path: Path) -> BadInput:
    problem = f"a file that ends in {path.suffix.lower() or 'nothing'} cannot be read"
    return BadInput(source=str(path), problem=problem, remedy=f"Give one of {', '.join(ENDINGS)}")


def _described(path: Path, unit: str | None, material: Material | None, chord: float | None) -> UserArticle:
    """The article that `path` describes; `unit` and `material` go to the parts that state none."""
    found = description.read(path)
    parts: list[UserPart] = []
    warnings: list[str] = []
    for entry in found.parts:
        default = None if entry.file.suffix.lower() in STEP_ENDINGS else unit
        there, said = _parts(replace(entry, unit=entry.unit or default, material=entry.material or material), chord)
        parts += there
        warnings += said
    return _finished(found.name, tuple(parts), f"{found.name}: read from {path.name}.", tuple(warnings))


def _finished(name: str, parts: tuple[UserPart, ...], note: str, warnings: tuple[str, ...]) -> UserArticle:
    return UserArticle(name=name, parts=parts, note=note, warnings=(*dict.fromkeys(warnings), *overlap_warnings(name, parts)))


def _parts(entry: PartEntry, chord: float | None) -> tuple[tuple[UserPart, ...], tuple[str, ...]]:
    """The bodies that one entry stands for, and what was noticed."""
    ending = entry.file.suffix.lower()
    if ending in STEP_ENDINGS:
        parts = _from_step(entry, chord)
        corners = np.vstack([part.mesh.bounds for part in parts])
        return parts, doubts(float(np.ptp(corners, axis=0).max()), str(entry.file))
    if ending in files.ENDINGS:
        return _from_mesh(entry)
    raise _unreadable(entry.file)


# --- STEP -----------------------------------------------------------------------------------------------------------------


def _from_step(entry: PartEntry, chord: float | None) -> tuple[UserPart, ...]:
    from geometry.cad import step

    if entry.unit is not None:
        raise BadInput(
            source=str(entry.file),
            field="unit",
            problem=f"a STEP file states its own unit, and {entry.unit!r} was given beside it",
            remedy="Leave the unit out",
        )
    found = step.read(entry.file)
    if entry.body is not None:
        chosen = tuple(body for body in found if entry.body in (body.name, body.label))
        found = chosen or _no_body(entry, [body.name for body in found])
    materials = {body.name: entry.materials.get(body.name, entry.materials.get(body.label, entry.material)) for body in found}
    _require_used(entry, {name for body in found for name in (body.name, body.label)})
    _require_materials(entry, materials)
    made_of_it = ((body, materials[body.name]) for body in found)
    return tuple(_of_solid(entry, body, _name(entry, body, len(found)), made, chord) for body, made in made_of_it if made)


def _name(entry: PartEntry, body: step.Body, count: int) -> str:
    return body.name if not entry.named else entry.name if count == 1 else f"{entry.name}/{body.name}"


def _of_solid(entry: PartEntry, body: step.Body, name: str, made: Material, chord: float | None) -> UserPart:
    """The part that is made of one solid, with its mesh."""
    from geometry.cad import step
    from geometry.cad.tessellation import tessellate_solid

    solid = step.moved(body.solid, entry.pose)
    chord = chord or RELATIVE_CHORD * step.diagonal(solid)
    mesh = tessellate_solid(solid, chord)
    require_closed_volume(mesh, f"{entry.file}, mesh of {body.name}", MILLIMETRE)
    return UserPart(name=name, material=made, source=str(entry.file), mesh=mesh, chord=chord, solid=solid)


def _require_materials(entry: PartEntry, materials: Mapping[str, Material | None]) -> None:
    missing = [name for name, found in materials.items() if found is None]
    if missing:
        rows = ", ".join(f'"{name}" = "..."' for name in missing)
        raise BadInput(
            source=str(entry.file),
            field="material",
            problem=f"no material is given for {', '.join(missing)}",
            remedy=f"Give one for all (--material steel), or one for each in an {DESCRIPTION}: "
            f'[[part]] name = "{entry.name}", file = "{entry.file.name}", materials = {{ {rows} }}',
        )


def _require_used(entry: PartEntry, names: set[str]) -> None:
    for name in entry.materials:
        if name not in names:
            _no_body(entry, sorted(names), name)


# --- meshes ---------------------------------------------------------------------------------------------------------------


def _from_mesh(entry: PartEntry) -> tuple[tuple[UserPart, ...], tuple[str, ...]]:
    source = str(entry.file)
    mesh, unit, doubts = files.read(entry.file, entry.unit)
    touching = require_closed_volume(mesh, source, unit)
    found = bodies(mesh)
    if entry.materials:
        raise BadInput(
            source=source,
            field="materials",
            problem="bodies of a mesh have no names",
            remedy="Give each a [[part]] of its own with body = 1, 2 ...",
        )
    if entry.material is None:
        raise BadInput(
            source=source,
            field="material",
            problem="no material is given",
            remedy='Give a name (steel) or a density ("7800 kg/m^3")',
        )
    if entry.body is not None:
        numbers = [str(number) for number in range(1, len(found) + 1)]
        if entry.body not in numbers:
            _no_body(entry, numbers)
        mesh = found[int(entry.body) - 1]
    elif len(found) > 1:
        doubts = (*doubts, *touching, _several(entry, found, unit))
    part = UserPart(name=entry.name, material=entry.material, source=source, mesh=placed(mesh, entry.pose))
    return (part,), doubts


def _several(entry: PartEntry, found: tuple[TriangleMesh, ...], unit: LengthUnit) -> str:
    """How a user learns that one density may not do."""
    listed = "; ".join(
        f"body {number}: {body.volume / unit.metres**3:.6g} {unit.name}³ around {unit.shown(body.bounds.mean(axis=0))}"
        for number, body in enumerate(found[:6], start=1)
    )
    more = f"; and {len(found) - 6} more" if len(found) > 6 else ""
    return (
        f"{entry.file}: {len(found)} separate bodies are taken as one material ({listed}{more}); if they differ, give each a "
        f"[[part]] with its own body = 1, 2 ... and material in an {DESCRIPTION}"
    )


def _no_body(entry: PartEntry, names: list[str], wanted: str | None = None) -> NoReturn:
    raise BadInput(
        source=str(entry.file),
        field="materials" if wanted else "body",
        problem=f"it holds no body {wanted or entry.body!r}",
        remedy=f"It holds {', '.join(names)}",
    )


# --- folders --------------------------------------------------------------------------------------------------------------


def _description_in(folder: Path) -> Path:
    there = folder / DESCRIPTION
    if there.is_file():
        return there
    parts = sorted(file for file in folder.iterdir() if file.suffix.lower() in (*STEP_ENDINGS, *files.ENDINGS))
    if not parts:
        raise BadInput(
            source=str(folder),
            problem=f"the folder holds neither {DESCRIPTION} nor a part ({', '.join(ENDINGS[:-1])})",
            remedy="Check the path",
        )
    raise BadInput(
        source=str(folder),
        problem=f"the folder holds {len(parts)} part(s) but no {DESCRIPTION} to say what they are of",
        remedy=f"Put this into {there}, corrected:\n\n{description.template(folder.name, parts)}\nThen try again",
    )
