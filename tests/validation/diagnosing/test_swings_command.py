"""`massline diagnose` where no campaign is among the data: the page, the JSON of the contract, refusals."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from validation.diagnose.diagnosis import VERDICTS

Run = Callable[..., tuple[int, str, str]]

MODEL = """format = 1
[model]
article = "fmd+clumod-4"
"""


@pytest.fixture
def model(tmp_path: Path) -> str:
    path = tmp_path / "model.toml"
    path.write_text(MODEL, encoding="utf-8")
    return str(path)


def test_a_pendulum_alone_gets_the_honest_answer(run: Run, model: str, root: Path) -> None:
    code, out, _ = run("diagnose", model, str(root / "examples" / "clumod-4-upright.toml"))
    assert code == 0
    assert "NOTHING IS MISSING" in out
    assert "One period is one number" in out
    assert "off-centre-suspension" in out
    assert "radius" in out  # it would explain the period, were it wrong


def test_json_has_the_keys_of_the_contract(run: Run, model: str, tmp_path: Path) -> None:
    code, out, err = run("diagnose", model, "clumod-4-weighing", "clumod-4-pendulum", "--json", "--out", str(tmp_path / "out"))
    found = json.loads(out)
    assert code == 0
    assert found["verdict"] in VERDICTS
    assert {"text", "accepted", "ranking", "equivalence_class", "next_measurement", "leftover", "errors"} <= set(found)
    assert found["errors"] is None
    assert {"id", "value", "unit", "interval90", "evidence_nats", "text"} <= set(found["ranking"][0])
    assert found["classical"][0]["name"].endswith(": mass")
    assert json.loads((tmp_path / "out" / "diagnose.json").read_text(encoding="utf-8")) == found
    assert "diagnose.json" in err


def test_only_what_is_asked_for_is_tried(run: Run, model: str) -> None:
    _, out, _ = run("diagnose", model, "clumod-4-weighing", "--candidate", "point-mass:mast-top", "--json")
    assert [one["id"] for one in json.loads(out)["ranking"]] == ["point-mass:mast-top"]


@pytest.mark.parametrize("option", [("--auto",), ("--hold-out", "x"), ("--band", "4", "32"), ("--candidate", "force-gain")])
def test_options_that_need_a_campaign_are_refused_by_name(run: Run, model: str, option: tuple[str, ...]) -> None:
    code, _, err = run("diagnose", model, "clumod-4-weighing", *option)
    assert code == 2
    assert option[0] in err


def test_the_same_file_twice_is_refused(run: Run, model: str) -> None:
    code, _, err = run("diagnose", model, "clumod-4-weighing", "clumod-4-weighing")
    assert code == 2
    assert "named twice" in err
