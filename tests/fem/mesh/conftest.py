"""Meshes for tests, each with its description beside it: grids in Abaqus text, and a bracket in every format through gmsh."""

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from fem.structure import Structure
from fem.user_model import reading


@pytest.fixture
def meshed(tmp_path: Path) -> Callable[..., Structure]:
    """Writes a mesh and the rest of its description, and reads both: text of the mesh, tables of the parts, more keys."""

    def made(
        mesh: str, parts: str, *, support: str = 'support = "free"', more: str = "", units: str = "m", ending: str = "inp"
    ) -> Structure:
        (tmp_path / f"mesh.{ending}").write_text(mesh)
        text = f'format = 1\n[fe_model]\nkind = "mesh"\nunits = "{units}"\nfile = "mesh.{ending}"\n{support}\n{parts}\n{more}\n'
        (tmp_path / "mesh.toml").write_text(text)
        found = reading.read(tmp_path / "mesh.toml")
        assert isinstance(found, Structure)
        return found

    return made


BRACKET = """
import gmsh, json, sys
paths, order, options = sys.argv[3:], int(sys.argv[1]), json.loads(sys.argv[2])
gmsh.initialize(interruptible=False)
gmsh.option.setNumber("General.Terminal", 0)
occ = gmsh.model.occ
foot, wall = occ.addBox(0, 0, 0, 100, 60, 10), occ.addBox(0, 0, 10, 10, 60, 90)
occ.fragment([(3, foot)], [(3, wall)])
occ.synchronize()
gmsh.model.addPhysicalGroup(3, [foot], name="foot")
gmsh.model.addPhysicalGroup(3, [wall], name="wall")
under = gmsh.model.getEntitiesInBoundingBox(-1, -1, -1, 101, 61, 1, 2)
gmsh.model.addPhysicalGroup(2, [tag for _, tag in under], name="underside")
tip = gmsh.model.getEntitiesInBoundingBox(9, 59, 99, 11, 61, 101, 0)
gmsh.model.addPhysicalGroup(0, [tag for _, tag in tip], name="tip")
for key, value in {"Mesh.MeshSizeMax": 15, "Mesh.SaveGroupsOfNodes": 1, "Mesh.SaveGroupsOfElements": 1, **options}.items():
    gmsh.option.setNumber(key, value)
gmsh.model.mesh.generate(3)
gmsh.model.mesh.setOrder(order)
for path in paths:
    gmsh.write(path)
"""


@pytest.fixture(scope="session")
def bracket_mesh(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Path]:
    """A bracket of two blocks [mm] written by gmsh, a process of its own, into a file of an ending."""
    made: dict[str, Path] = {}

    def write(ending: str, order: int = 2, **options: float) -> Path:
        key = f"{order}-{json.dumps(options)}"
        if key not in made:  # one mesh for all endings
            made[key] = tmp_path_factory.mktemp("bracket")
            paths = [str(made[key] / f"bracket.{each}") for each in ("msh", "med", "inp", "unv", "bdf")]
            subprocess.run([sys.executable, "-P", "-c", BRACKET, str(order), json.dumps(options), *paths], check=True)
        return made[key] / f"bracket.{ending}"

    return write
