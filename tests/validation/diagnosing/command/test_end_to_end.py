"""The whole way once: a virtual test with a hidden gain, a model that does not know, `massline diagnose --auto`."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from validation.cli import main
from validation.history.history import history_position
from validation.model import model_file

GAIN = "force-gain:fmd-z2"
FAST = ("--octaves-per-minute", "120", "--band", "8", "16", "--rate", "256", "--model", "rigid", "--noise", "0.1")
ASKED = ("diagnose", "model.toml", "cuboid", "--hold-out", "z", "--candidate", "force-gain", "--candidate", "cell-stiffness")


@pytest.fixture(scope="module")
def climbed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder in which the climb was asked for once; ``first.json`` is what it said."""
    folder = tmp_path_factory.mktemp("climb")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        plan = ("--seed", "3", "--tolerances", "0.3", "--effect", f"{GAIN}=0.08", *FAST)
        assert main.run(["simulate", "fmd+cuboid", "--out", "cuboid", *plan]) == main.DONE
        assert main.run(["model", "fmd+cuboid", "--out", "model.toml"]) == main.DONE
        text = Path("model.toml").read_text(encoding="utf-8").replace('kind = "beam"', 'kind = "rigid"')
        Path("model.toml").write_text(text, encoding="utf-8")
        Path("before.toml").write_bytes(Path("model.toml").read_bytes())
        assert main.run([*ASKED, "--auto", "--json", "--out", "first"]) == main.DONE
    return folder


def first(folder: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((folder / "first" / "diagnose.json").read_text(encoding="utf-8"))
    return found


def test_the_hidden_gain_is_named_with_its_size(climbed: Path) -> None:
    found = first(climbed)
    truth = json.loads((climbed / "cuboid.truth.json").read_text(encoding="utf-8"))["tolerances"][GAIN]
    (gain,) = found["accepted"]
    assert (found["verdict"], gain["id"]) == ("missing", GAIN)
    low, high = gain["interval90"]
    assert abs(gain["value"] - truth) < high - low  # 2.4 half-widths of what 9 of 10 lie within: 1 of 15,000 beyond
    assert gain["evidence_nats"] > 20


def test_the_errors_fall_on_the_run_that_no_fit_has_seen(climbed: Path) -> None:
    errors = first(climbed)["errors"]
    assert errors["plain_after_percent"] < 0.3 * errors["plain_before_percent"]
    assert errors["heldout_after_percent"] < 0.5 * errors["heldout_before_percent"]


def test_the_climb_made_one_rung_and_ended_where_nothing_is_missing(climbed: Path) -> None:
    auto = first(climbed)["auto"]
    assert [one["verdict"] for one in auto["rounds"]] == ["missing", "nothing"]
    assert auto["rungs"] == [1]
    at = history_position(climbed / "model.toml")
    assert [one.effect for one in at.ladder.rungs] == ["", GAIN]
    assert at.ladder.rungs[0].model == (climbed / "before.toml").read_bytes().decode("utf-8")
    assert [one.named.id for one in model_file.read(str(climbed / "model.toml")).effects] == [GAIN]


def test_the_rung_is_what_the_diagnosis_said(climbed: Path) -> None:
    """Two fits from different beginnings, of the same model to the same data."""
    (gain,) = first(climbed)["accepted"]
    (size,) = history_position(climbed / "model.toml").ladder.rungs[1].effects[GAIN]
    low, high = gain["interval90"]
    assert abs(size.value - gain["value"]) < 0.05 * (high - low)
