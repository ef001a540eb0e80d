"""The rules of import hold, and each of them can fail: a copy of the packages is broken on purpose."""

import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

PACKAGES = ("massline", "geometry", "fem", "identification", "validation")

TRESPASSES = {
    "layers": ("geometry", "from validation import cli"),
    "independence": ("fem", "import identification"),
    "estimation": ("validation/estimation", "from identification import plain"),
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
    "plotly": ("validation/report", "import plotly.graph_objects"),
    "trame": ("validation", "from trame.app import get_server"),
    "distributed": ("validation", "from distributed import Client"),
    "faces": ("validation/diagnose", "from validation.report import charts"),
    "face-layers": ("validation/report", "from validation import app"),
}
"""For every contract a package that is not its door, and an import that it forbids there, directly or on the way."""


def copied(root: Path, folder: Path) -> Path:
    """A copy of the four packages with the contracts, to be broken."""
    for package in PACKAGES:
        shutil.copytree(root / package, folder / package, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(root / "pyproject.toml", folder)
    return folder


def broken(tree: Path) -> dict[str, str]:
    """Contracts that `lint-imports` finds broken in `tree`, by identifier, each with the imports that it names."""
    contracts = {contract["name"]: contract["id"] for contract in contracts_of(tree)}
    lint = "import sys; from importlinter.cli import lint_imports; sys.exit(lint_imports(no_cache=True))"
    wide = {**os.environ, "COLUMNS": "200"}  # a narrow terminal breaks the names of contracts over lines
    run = subprocess.run([sys.executable, "-c", lint], cwd=tree, env=wide, capture_output=True, encoding="utf-8", check=False)
    found = {identifier for name, identifier in contracts.items() if f"{name} BROKEN" in run.stdout}
    assert (run.returncode == 0) == (not found), run.stdout + run.stderr
    assert all(f"{name} KEPT" in run.stdout or f"{name} BROKEN" in run.stdout for name in contracts), run.stdout
    _, *parts = re.split(rf"^({'|'.join(map(re.escape, contracts))})\n-+$", run.stdout, flags=re.MULTILINE)
    named = {contracts[name]: text for name, text in zip(parts[::2], parts[1::2], strict=True)}
    assert named.keys() == found, run.stdout
    return named


def contracts_of(tree: Path) -> list[dict[str, str]]:
    return list(tomllib.loads((tree / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["importlinter"]["contracts"])


@pytest.fixture(scope="module")
def trespassed(root: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """What is found broken where every trespass is there, each in a module of its own that nobody imports."""
    tree = copied(root, tmp_path_factory.mktemp("trespassed"))
    for contract, (package, statement) in TRESPASSES.items():
        (tree / package / f"trespasser_{contract}.py").write_text(f"def trespass():\n    {statement}\n", encoding="utf-8")
    return broken(tree)


def test_the_packages_keep_every_contract(root: Path, tmp_path: Path) -> None:
    assert broken(copied(root, tmp_path)) == {}


def test_every_contract_has_a_trespass(root: Path) -> None:
    assert {contract["id"] for contract in contracts_of(root)} == set(TRESPASSES)


@pytest.mark.parametrize("contract", TRESPASSES)
def test_a_trespass_inside_a_function_breaks_its_contract_and_is_named(contract: str, trespassed: dict[str, str]) -> None:
    package, _ = TRESPASSES[contract]
    assert f"{package.replace('/', '.')}.trespasser_{contract} -> " in trespassed.get(contract, "")
