"""`massline effects`: the catalogue in the terminal, and the page that is made of it."""

import json
import runpy
import subprocess
import sys
from collections.abc import Callable

import pytest
from rich.console import Console

from tools import effects_page
from validation.cli import main
from validation.effects.catalogue import FAMILIES

Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def run(capsys) -> Run:
    def run(*arguments: str) -> tuple[int, str, str]:
        code = main.run(["effects", *arguments])
        return code, *capsys.readouterr()

    return run


@pytest.mark.parametrize("columns", ["80", "100", "132"])
def test_the_list_names_every_family_whatever_the_width(run, columns, monkeypatch):
    monkeypatch.setenv("COLUMNS", columns)
    code, out, err = run()
    assert (code, err) == (main.DONE, "")
    words = out.replace("[", " ").replace(":", " ").split()
    assert set(FAMILIES) <= set(words)
    assert "…" not in out
    assert max(map(len, out.splitlines())) <= int(columns)


@pytest.mark.parametrize("name", FAMILIES)
def test_each_has_a_page_of_its_own_with_all_that_is_known_of_it(run, name):
    code, out, _ = run(name)
    family, flat = FAMILIES[name], " ".join(out.split())
    assert code == main.DONE
    for said in (family.what, family.equation, family.confirmed_by, family.reference, *family.mistaken_for):
        assert " ".join(said.split()) in flat
    assert "{target" not in out


def test_an_effect_with_its_target_is_told_of_that_target(run):
    _, out, _ = run("force-gain:fmd-y14", "gap:3", "cable:hub-1:vertical", "channel-swap:fmd-z1:fmd-z3")
    assert "The force channel fmd-y14 reads too much" in out
    assert "Cell 3 has lost" in out
    assert "ties hub-1 to the laboratory" in out
    assert "The plugs of fmd-z1 and fmd-z3 were crossed" in out


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("force-gian", "no effect is called 'force-gian'. Did you mean force-gain?"),
        ("force-gain:fmd-z9", "no force channel is called 'fmd-z9'. Did you mean fmd-z4?"),
        ("polarity:fmd-z1:x", "it acts on channel, found fmd-z1:x"),
    ],
)
def test_what_is_not_there_ends_with_2_and_the_nearest(refused, name, says):
    assert says in refused(name)


def test_a_users_effects_are_listed_with_the_file_they_come_from(run, root):
    folder = root / "examples" / "effects"
    _, out, _ = run("--effects-from", str(folder), "--json")
    found = {one["id"]: one["from"] for one in json.loads(out)["effects"]}
    assert found["dashpot"] == str(folder / "dashpot.py")
    assert found["force-lowpass"] == str(folder / "force_lowpass.py")


def test_the_page_of_the_catalogue_is_what_the_code_writes_and_its_example_is_about_thirty_lines(root, tmp_path):
    written = tmp_path / "effects.md"
    subprocess.run([sys.executable, "-P", "-m", "tools.effects_page", str(written)], cwd=root, check=True)
    again = "write it again: python -m tools.effects_page"
    assert written.read_text(encoding="utf-8") == (root / effects_page.PAGE).read_text(encoding="utf-8"), again
    worst, found = runpy.run_path(str(root / "examples" / "own_effect.py"))["main"](Console(quiet=True))
    assert worst < 2e-3  # noise is off; the bilinear rule and the ends of a short sweep are left
    assert found == pytest.approx(1e-3, rel=0.02)
    for name in ("dashpot", "force_lowpass"):
        lines = (root / "examples" / "effects" / f"{name}.py").read_text(encoding="utf-8").splitlines()
        assert len([line for line in lines if line.strip() and not line.startswith(("import", "from", '"""'))]) <= 35
