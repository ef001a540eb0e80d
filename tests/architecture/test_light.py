"""Help answers in a blink: it imports nothing that takes long."""

import subprocess
import sys

import pytest

from validation.cli.main import COMMANDS

HEAVY = {"cadquery", "OCP", "gmsh", "trimesh", "igl", "pinocchio", "coal", "exudyn", "pyvista", "vtk", "vtkmodules", "trame"} | {
    "scipy"
}


def imported_by(*arguments: str) -> set[str]:
    """Top-level names in `sys.modules` after ``massline`` ran with `arguments` in a fresh process."""
    statement = (
        "import sys; from validation.cli.main import run; code = run(sys.argv[1:]);"
        "sys.stderr.write(' '.join({name.split('.')[0] for name in sys.modules})); sys.exit(code)"
    )
    run = subprocess.run([sys.executable, "-P", "-c", statement, *arguments], capture_output=True, encoding="utf-8", check=False)
    assert run.returncode == 0, run.stderr
    return set(run.stderr.split())


@pytest.mark.parametrize("arguments", [["--help"], ["--version"], *([command, "--help"] for command in COMMANDS)], ids=" ".join)
def test_help_imports_no_heavy_library(arguments: list[str]) -> None:
    assert imported_by(*arguments) & HEAVY == set()


def test_the_top_help_does_not_even_import_numpy() -> None:
    assert "numpy" not in imported_by("--help")
