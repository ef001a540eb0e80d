"""Solids out of the house: STEP assemblies with a name for every body, BREP files and STL meshes. In millimetres."""

from __future__ import annotations

import hashlib
import io
from collections.abc import Mapping
from pathlib import Path

from geometry import atomic
from geometry.cad.solids import OccShape
from geometry.cad.step import silence


def write_step(path: Path, solids: Mapping[str, OccShape], name: str) -> None:
    """Write `solids` [mm] by the name of each body as one STEP assembly called `name`."""
    from cadquery import Assembly

    assembly = Assembly(name=name)
    for body, solid in solids.items():
        assembly.add(solid, name=body)
    with silence():
        atomic.write_with(path, lambda temporary: assembly.export(str(temporary), "STEP"))


def write_stl(path: Path, solid: OccShape, chord: float = 0.01) -> None:
    """Write `solid` [mm] as a binary STL with chord error `chord` [mm]."""
    atomic.write_with(path, lambda temporary: solid.exportStl(str(temporary), chord, 0.1))


def write_brep(path: Path, solid: OccShape) -> None:
    """Write `solid` [mm] as OCC's own BREP text: every digit, no names."""
    atomic.write_with(path, lambda temporary: solid.exportBrep(str(temporary)))


def brep_digest(solid: OccShape) -> str:
    """SHA-256 of the BREP text of `solid`, hexadecimal: the same for the same geometry, whatever file it came from."""
    text = io.BytesIO()
    solid.exportBrep(text)
    return hashlib.sha256(text.getvalue()).hexdigest()
