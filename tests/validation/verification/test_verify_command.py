"""`massline verify`: the whole table passes, says what fails, and is the one on docs/verification.md."""

import json
import re
from typing import Any

import pytest

import fem.solid.assembly
from validation.cli import main
from validation.output import from_json, plain_unit
from validation.report.flexible import cells
from validation.verification.check import FAMILIES, CheckResult, checks

LONG = ("solids", "rods", "time", "pendulum")
"""Nearly all of the time of the table: their rows are held by `make proof`. That those of solids and rods pass is held by
`test_rows_can_fail.py` on coarser meshes, of time and pendulum by the page, whose command runs them."""


@pytest.fixture(scope="module", params=[False, pytest.param(True, marks=pytest.mark.proof)], ids=["short", "whole"])
def families(request) -> tuple[str, ...]:
    return tuple(one for one in FAMILIES if request.param or one not in LONG)


@pytest.fixture(scope="module")
def table(apart, families) -> dict[str, Any]:
    """The JSON object of the table, or of its part."""
    run = apart("verify", *families, "--json")
    assert run.returncode == 0, run.stdout + run.stderr
    return json.loads(run.stdout)


def test_the_whole_table_passes(table, families):
    assert table["pass"] is True
    assert [row["what"] for row in table["rows"] if not row["pass"]] == []
    assert all(row["error"] <= row["bar"] for row in table["rows"])
    assert len({row["family"] for row in table["rows"]}) == len(families)


def test_the_page_shows_the_table_of_today(root, table):
    # to the letter but for the last digits of what was computed, and for the size of mere rounding
    page = (root / "docs" / "verification.md").read_text(encoding="utf-8")
    shown = re.findall(r"^\|(?! (?:check|:--))(.*)\|$", page, re.MULTILINE)
    lines = [[cell.strip().replace("\\", "") for cell in line.split("|")] for line in shown]
    assert len(lines) == len(checks())
    by_name = {plain_unit(line[0]): line for line in lines}
    for row in table["rows"]:
        now = cells(from_json(CheckResult, row))
        _, reference, value, _, bar, passed, source = by_name[now[0]]
        assert (bar, passed, source) == (now[4], now[5], now[6])
        for printed, known in ((reference, row["reference"]), (value, row["value"])):
            # an exponent is fitted to errors that are nearly rounding: another processor finds it off by some 1e-4 of one
            rounding = max(1e-9, 1e-2 * row["bar"]) if row["error_is"] == "absolute" else 0.0
            assert float(printed) == pytest.approx(known, rel=1e-4, abs=rounding)


def test_a_failed_check_ends_with_exit_code_1_and_its_name(monkeypatch, capsys):
    right = fem.solid.assembly._mass
    monkeypatch.setattr(fem.solid.assembly, "_mass", lambda *args: 1.01 * right(*args))
    assert main.run(["verify", "essentials"]) == main.FAILED_CHECK
    said = capsys.readouterr()
    assert "2 of 16 checks fail: Rigid mass matrix of hexahedra; Rigid mass matrix of tetrahedra." in said.err
    assert said.out.count(" NO ") == 2


def test_finer_meshes_come_no_less_close(capsys):
    errors = []
    for options in ([], ["--fine"]):
        assert main.run(["verify", "beams", "--json", *options]) == main.DONE
        rows = json.loads(capsys.readouterr().out)["rows"]
        errors.append({row["what"]: row["error"] for row in rows if row["unit"] == "Hz"})
    assert all(errors[1][what] <= 1.1 * errors[0][what] + 1e-6 for what in errors[0])


def test_an_unknown_family_is_refused_with_those_there_are(capsys):
    assert main.run(["verify", "plate"]) == main.BAD_INPUT
    assert "'plates'" in capsys.readouterr().err
