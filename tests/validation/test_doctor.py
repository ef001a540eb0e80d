"""`massline doctor`, commands that lack their extra, and the page of licences."""

import builtins
import json
import os
import re
import subprocess
import sys
import tomllib

import pytest

from geometry.errors import EXTRAS
from validation.cli import main
from validation.report.reference import tried


def declared(root):
    project = tomllib.loads((root / "pyproject.toml").read_text("utf-8"))["project"]
    optional = {name: project["optional-dependencies"][name] for name in EXTRAS}
    return {
        re.split(r"[<>=~ \[]", one)[0]: extra
        for extra, lines in ({"": project["dependencies"]} | optional).items()
        for one in lines
    }


def test_doctor_says_what_is_there(answer, run):
    said = answer("doctor")
    assert said["missing_of_extras"] == {"cad": [], "fem": [], "gpl": [], "pictures": [], "fleet": [], "app": []}
    assert all(said["core"].values())
    assert "superlu" in " ".join(said["factorisers"]).lower()
    assert run("--version")[1].startswith("massline")


@pytest.fixture
def without(monkeypatch):
    """``without(*modules)``: imports of these fail, as where their extra is not installed."""
    whole = builtins.__import__

    def hide(*names):
        for name in [one for one in sys.modules if one.partition(".")[0] in names]:
            monkeypatch.delitem(sys.modules, name)

        def refuse(name, *arguments, **more):
            if name.partition(".")[0] in names:
                raise ModuleNotFoundError(f"No module named {name!r}", name=name)
            return whole(name, *arguments, **more)

        monkeypatch.setattr(builtins, "__import__", refuse)

    return hide


def test_a_command_that_lacks_its_extra_says_which_and_the_core_works_without(run, without, tmp_path):
    corners = ["v 0 0 0", "v 1 0 0", "v 0 1 0", "v 0 0 1", "f 1 3 2", "f 1 2 4", "f 2 3 4", "f 1 4 3"]
    (tmp_path / "t.obj").write_text("\n".join(corners), encoding="utf-8")
    without(*(module for modules in EXTRAS.values() for module in modules))
    code, out, err = run("reference", "cuboid")
    assert (code, out) == (main.BAD_INPUT, "")
    assert "pip install 'massline[cad]'" in err
    assert run("reference", "t.obj", "--unit", "m", "--material", "steel")[0] == main.DONE
    assert run("weigh", "clumod-4-weighing")[0] == main.DONE


EVERYTHING = """
import importlib, json, pkgutil, sys
shut = set(sys.argv[1:])

class Shut:
    def find_spec(self, name, path=None, target=None):
        if shut & {name, name.partition(".")[0], ".".join(name.split(".")[:2])}:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)

sys.meta_path.insert(0, Shut())
for package in ("massline", "geometry", "fem", "identification", "validation"):
    for module in pkgutil.walk_packages(importlib.import_module(package).__path__, package + "."):
        if not module.name.endswith("__main__"):
            importlib.import_module(module.name)
from geometry import mesh, repair
points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
ball = mesh.TriangleMesh(vertices=points, faces=[[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
mesh.require_closed_volume(ball, "one")
repair.estimated(repair.mended(ball).mesh)
print(json.dumps(sorted(name for name in sys.modules if name.startswith("igl"))))
"""


def test_every_module_is_imported_without_the_extras_and_nothing_asks_libigl_for_its_gpl() -> None:
    shut = [*(module for modules in EXTRAS.values() for module in modules), "igl.copyleft", "igl.triangle"]
    run = subprocess.run([sys.executable, "-P", "-c", EVERYTHING, *shut], capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    assert "igl.predicates" in json.loads(run.stdout)


@pytest.mark.parametrize("name", ["geometry", "fem", "identification"])
def test_a_package_of_others_that_bears_a_name_of_ours_is_named_in_the_first_sentence(name, tmp_path) -> None:
    (tmp_path / name).mkdir()
    (tmp_path / name / "__init__.py").write_text("", encoding="utf-8")
    start = f"import sys; sys.path.insert(0, {str(tmp_path)!r}); from validation.cli.main import main; main(['--version'])"
    run = subprocess.run([sys.executable, "-P", "-c", start], capture_output=True, text=True, check=False)
    assert (run.returncode, run.stdout) == (main.BAD_INPUT, "")
    assert run.stderr.startswith("massline: another package bears a name of massline's")
    assert f"{name} is {tmp_path.resolve() / name / '__init__.py'}" in run.stderr
    assert run.stderr.count("\n") == 1


def test_the_shell_completes_commands() -> None:
    asked = {"_MASSLINE_COMPLETE": "bash_complete", "COMP_WORDS": "massline dia", "COMP_CWORD": "1"}
    start = "import sys; sys.argv[0] = 'massline'; from validation.cli.main import main; main()"
    command = [sys.executable, "-P", "-c", start]
    run = subprocess.run(command, env={**os.environ, **asked}, capture_output=True, text=True, check=False)
    assert run.stdout.split() == ["plain,diagnose"], run.stderr
    asked = {"_MASSLINE_COMPLETE": "bash_source"}
    run = subprocess.run(command, env={**os.environ, **asked}, capture_output=True, text=True, check=False)
    assert "complete -o nosort -F _massline_completion massline" in run.stdout


def test_a_part_of_a_report_that_lacks_its_extra_says_which_and_the_report_goes_on() -> None:
    def drawn() -> str:
        raise ModuleNotFoundError("No module named 'cadquery'", name="cadquery")

    missing: list[str] = []
    assert tried(drawn, missing, "No map: ") is None
    assert "pip install 'massline[cad]'" in missing[0]
    assert missing[0].startswith("No map: this needs cadquery")


def test_every_dependency_has_its_line_on_the_page_of_licences(root):
    page = (root / "docs" / "licences.md").read_text("utf-8")
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in page.splitlines() if line.startswith("| ")][2:]
    listed = {cells[0].split(" ")[0]: cells[2].strip("`") for cells in rows}
    assert listed == declared(root)
    assert all(cells[1] and cells[3] for cells in rows)
