"""The rules of import hold, and each of them can fail: a copy of the packages is broken on purpose."""

import os
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

PACKAGES = ("geometry", "fem", "identification", "validation")

TRESPASSES = {
    "layers": ("geometry", "from validation import cli"),
    "independence": ("fem", "import identification"),
    "engine": ("validation/engine", "from identification import sensitivity"),
    "cadquery": ("geometry", "from OCP.gp import gp_Trsf"),
    "gmsh": ("fem", "import gmsh"),
    "skfem": ("validation", "from skfem import MeshTet2"),
    "pyyeti": ("fem", "from pyyeti import cb"),
    "pyuff": ("validation", "import pyuff"),
    "trimesh": ("validation", "import trimesh"),
    "igl": ("geometry", "from igl.copyleft import cgal"),
    "pinocchio": ("fem", "import coal"),
    "exudyn": ("geometry", "import exudyn"),
    "pyvista": ("geometry", "import vtkmodules.all"),
    "matplotlib": ("validation", "from PIL import Image"),
    "trame": ("validation", "from trame.app import get_server"),
}
"""For every contract a package that is not its door, and an import that it forbids there, directly or on the way."""

DOORS = {
    "cadquery": "geometry/cad/solids.py",
    "pyuff": "identification/files/uff.py",
    "trimesh": "geometry/mesh/mass.py",
    "igl": "geometry/mesh/self_intersection.py",
    "pinocchio": "geometry/multibody.py",
    "exudyn": "fem/flexible_body/inertia.py",
    "gmsh": "fem/solid/tetrahedra.py",
    "skfem": "fem/solid/elasticity.py",
    "pyyeti": "fem/users_model/nastran.py",
    "pyvista": "validation/pictures/scene.py",
    "matplotlib": "validation/pictures/page.py",
}
"""Who may import what: the module that is the door to each library."""


@pytest.fixture
def tree(root: Path, tmp_path: Path) -> Path:
    """A copy of the four packages with the contracts, to be broken."""
    for package in PACKAGES:
        shutil.copytree(root / package, tmp_path / package, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(root / "pyproject.toml", tmp_path)
    return tmp_path


def broken(tree: Path) -> set[str]:
    """Identifiers of the contracts that `lint-imports` finds broken in `tree`."""
    contracts = {contract["name"]: contract["id"] for contract in contracts_of(tree)}
    lint = "import sys; from importlinter.cli import lint_imports; sys.exit(lint_imports(no_cache=True))"
    wide = {**os.environ, "COLUMNS": "200"}  # a narrow terminal breaks the names of contracts over lines
    run = subprocess.run([sys.executable, "-c", lint], cwd=tree, env=wide, capture_output=True, encoding="utf-8", check=False)
    found = {identifier for name, identifier in contracts.items() if f"{name} BROKEN" in run.stdout}
    assert (run.returncode == 0) == (not found), run.stdout + run.stderr
    assert all(f"{name} KEPT" in run.stdout or f"{name} BROKEN" in run.stdout for name in contracts), run.stdout
    return found


def contracts_of(tree: Path) -> list[dict[str, str]]:
    return list(tomllib.loads((tree / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["importlinter"]["contracts"])


def test_the_packages_keep_every_contract(tree: Path) -> None:
    assert broken(tree) == set()


def test_every_contract_has_a_trespass(root: Path) -> None:
    assert {contract["id"] for contract in contracts_of(root)} == set(TRESPASSES)


@pytest.mark.parametrize("contract", TRESPASSES)
def test_a_trespass_inside_a_function_breaks_its_contract(contract: str, tree: Path) -> None:
    package, statement = TRESPASSES[contract]
    (tree / package / "trespasser.py").write_text(f"def trespass():\n    {statement}\n", encoding="utf-8")
    assert contract in broken(tree)


@pytest.mark.parametrize("library", DOORS)
def test_the_door_itself_may_import_its_library(library: str, tree: Path) -> None:
    door = tree / DOORS[library]
    door.parent.mkdir(parents=True, exist_ok=True)
    (door.parent / "__init__.py").touch()
    with door.open("a", encoding="utf-8") as file:
        file.write(f"\n\ndef enter():\n    import {library}\n")
    assert broken(tree) == set()
