"""`massline doctor`, commands that lack their extra, and the page of licences."""

import builtins
import re
import sys
import tomllib

import pytest

from validation.cli import main


def declared(root):
    project = tomllib.loads((root / "pyproject.toml").read_text("utf-8"))["project"]
    optional = {name: project["optional-dependencies"][name] for name in main.EXTRAS}
    return {
        re.split(r"[<>=~ \[]", one)[0]: extra
        for extra, lines in ({"": project["dependencies"]} | optional).items()
        for one in lines
    }


def test_doctor_says_what_is_there(answer, run):
    said = answer("doctor")
    assert said["missing_of_extras"] == {"cad": [], "fem": [], "pictures": [], "fleet": [], "app": []}
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
    without(*(module for modules in main.EXTRAS.values() for module in modules))
    code, out, err = run("reference", "cuboid")
    assert (code, out) == (main.BAD_INPUT, "")
    assert "pip install 'massline[cad]'" in err
    assert run("reference", "t.obj", "--unit", "m", "--material", "steel")[0] == main.DONE
    assert run("weigh", "clumod-4-weighing")[0] == main.DONE


def test_every_dependency_has_its_line_on_the_page_of_licences(root):
    page = (root / "docs" / "licences.md").read_text("utf-8")
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in page.splitlines() if line.startswith("| ")][2:]
    listed = {cells[0].split(" ")[0]: cells[2].strip("`") for cells in rows}
    assert listed == declared(root)
    assert all(cells[1] and cells[3] for cells in rows)
