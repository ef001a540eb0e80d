"""Help answers in a blink: it imports nothing that takes long."""

import json
import subprocess
import sys

import pytest

from validation.cli.main import COMMANDS

HEAVY = {"cadquery", "OCP", "gmsh", "trimesh", "igl", "pinocchio", "coal", "exudyn", "pyvista", "vtk", "vtkmodules", "trame"} | {
    "scipy"
}


ASKED = (("--help",), ("--version",), *((command, "--help") for command in COMMANDS))


@pytest.fixture(scope="module")
def imported() -> dict[tuple[str, ...], set[str]]:
    """Top-level names in `sys.modules` after ``massline`` ran in one fresh process as `ASKED`, one line after the other."""
    program = (
        "import json, sys; from validation.cli.main import run\n"
        "for asked in json.loads(sys.argv[1]):\n"
        "    code = run(asked)\n"
        "    sys.stderr.write(f'{code} ' + ' '.join({name.split('.')[0] for name in sys.modules}) + '\\n')\n"
    )
    asked = [sys.executable, "-P", "-c", program, json.dumps(ASKED)]
    done = subprocess.run(asked, capture_output=True, encoding="utf-8", check=True)
    codes, names = zip(*(line.split(" ", 1) for line in done.stderr.splitlines()), strict=True)
    assert set(codes) == {"0"}, done.stderr
    return {asked: set(after.split()) for asked, after in zip(ASKED, names, strict=True)}


def test_help_imports_no_heavy_library(imported: dict[tuple[str, ...], set[str]]) -> None:
    assert {asked: names & HEAVY for asked, names in imported.items() if names & HEAVY} == {}


def test_the_top_help_does_not_even_import_numpy(imported: dict[tuple[str, ...], set[str]]) -> None:
    assert "numpy" not in imported[ASKED[0]]
