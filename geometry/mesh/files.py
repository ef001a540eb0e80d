"""STL, PLY and OBJ files: bare numbers that become lengths only with a unit."""

from __future__ import annotations

import io
import re
import warnings
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from geometry.errors import BadInput
from geometry.lengths import UNITS, LengthUnit, doubts, length_unit
from geometry.mesh.triangles import TriangleMesh, merged, scaled

ENDINGS = (".stl", ".ply", ".obj")
"""What can be read, upper or lower case."""

_STATED = re.compile(r"\bunits?\s*[:=]\s*([A-Za-z]+)", re.IGNORECASE)
_COMMENT = {".stl": re.compile(rb"\A.{0,80}", re.DOTALL), ".ply": re.compile(rb"^(?:comment|obj_info).*$", re.MULTILINE)}
_COMMENT[".obj"] = re.compile(rb"^#.*$", re.MULTILINE)


class MeshFile(NamedTuple):
    """What a file holds: the mesh [m], the unit of its numbers, and what was noticed, in words."""

    mesh: TriangleMesh
    unit: LengthUnit
    warnings: tuple[str, ...]


def read(path: Path, unit: str | None = None) -> MeshFile:
    """The mesh in `path`, its numbers taken in `unit`, or in the unit that the file states in a comment.

    Raises
    ------
    BadInput : no mesh can be read, the unit is not given, unknown, or contradicts the file.
    """
    content = path.read_bytes()
    ending = path.suffix.lower()
    meant = _unit(content, ending, unit, str(path))
    mesh = scaled(_parsed(content, ending, str(path)), meant.metres)
    return MeshFile(mesh=mesh, unit=meant, warnings=doubts(float(np.ptp(mesh.bounds, axis=0).max()), str(path), meant))


def _unit(content: bytes, ending: str, given: str | None, source: str) -> LengthUnit:
    stated = _stated(content, ending)
    if given is None and stated is None:
        raise BadInput(
            source=source,
            field="unit",
            problem="the file does not say in which unit its lengths are, and none was given",
            remedy=f"Give one of {', '.join(UNITS)}",
        )
    if given is None or stated is None:
        return length_unit(given or stated or "", source)
    meant = length_unit(given, source)
    if meant != length_unit(stated, source):
        raise BadInput(
            source=source,
            field="unit",
            problem=f"the unit given is {meant.name}, but the file says of itself that its unit is {stated}",
            remedy="Leave the unit out to believe the file, or correct the file's comment",
        )
    return meant


def _stated(content: bytes, ending: str) -> str | None:
    """The unit that the file's own comments name, if any."""
    comments = b"\n".join(_COMMENT[ending].findall(content[:4096])).decode("latin-1")
    found = _STATED.search(comments)
    return found.group(1) if found else None


def _parsed(content: bytes, ending: str, source: str) -> TriangleMesh:
    import trimesh

    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            found: Any = trimesh.load_mesh(io.BytesIO(content), file_type=ending[1:], process=False)
            vertices, faces = np.array(found.vertices, dtype=np.float64), np.array(found.faces)
    except Exception as error:  # trimesh's readers raise whatever their parsing stumbles over
        raise _unreadable(ending, "its content does not follow the format", source) from error
    if faces.size == 0:
        raise _unreadable(ending, "no faces in it", source)
    if not np.isfinite(vertices).all():
        number = int((~np.isfinite(vertices)).any(axis=1).sum())
        raise _unreadable(ending, f"{number} of its {len(vertices)} vertices are not finite numbers", source)
    try:
        return merged(TriangleMesh(vertices=vertices, faces=faces))
    except ValueError as error:
        raise _unreadable(ending, str(error), source) from error


def _unreadable(ending: str, why: str, source: str) -> BadInput:
    return BadInput(
        source=source,
        problem=f"no mesh can be read from it as {ending[1:].upper()} ({' '.join(why.split())[:200]})",
        remedy="Check that the file is whole and what its ending says, and export it again",
    )
