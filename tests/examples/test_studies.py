"""Studies of at most fifteen lines: each is tested by the virtual laboratory, and its page says what an analyst would miss."""

import re
from pathlib import Path

import pytest

from validation.cli import main
from validation.virtual_test import structure_tests

STUDIES = {
    "plate": ("hammer", ("a:z", "b:z"), ("a:z", "b:z", "c:z", "d:z"), (10, 200), "point-mass:c=0.05"),
    "frame": ("shaker", ("floor-1:x",), ("floor-1:x", "floor-2:x", "floor-3:x"), (3, 40), "modulus:legs-2=-0.2"),
    "bridge": ("modes", (), ("w1:z", "w2:z", "e1:z", "e2:z"), (1, 60), "modulus:span-east-2=-0.3"),
}
"""Kind of test, drives, responses, band [Hz] and what is hidden."""


@pytest.mark.parametrize("name", [pytest.param(one, marks=[pytest.mark.proof] * (one != "frame")) for one in STUDIES])
def test_a_study_in_fifteen_lines_compares_and_says_where_shapes_are_green_and_the_model_is_wrong(
    name: str, root: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    study = root / "examples" / "studies" / f"{name}.toml"
    assert len(study.read_text(encoding="utf-8").splitlines()) <= 15
    monkeypatch.chdir(tmp_path)
    kind, drives, responses, band, effect = STUDIES[name]
    points = [part for word, of in (("--drive", drives), ("--response", responses)) for one in of for part in (word, one)]
    given = ["simulate", str(study), "--test", kind, *points, "--band", *map(str, band), "--effect", effect, "--out", "test"]
    assert main.run(given) == 0
    capsys.readouterr()
    assert main.run(["compare", str(study), "test/test.toml"]) == 0
    page = re.sub(r"\s+", " ", capsys.readouterr().out)
    assert "every MAC is 0.9 or more, and the model is wrong" in page
    assert "MAC does not see frequencies" in page


@pytest.mark.proof  # the study as shipped; prediction/test_on_the_article.py shows such sensors
def test_a_base_test_has_accelerometers_on_its_article(
    root: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    study = root / "examples" / "studies" / "mast.toml"
    assert len(study.read_text(encoding="utf-8").splitlines()) <= 15
    monkeypatch.chdir(tmp_path)
    fast = ["--octaves-per-minute", "120", "--band", "8", "16", "--rate", "256", "--response", "mast-top:x"]
    assert main.run(["simulate", "fmd+clumod-1", *fast, "--effect", "accelerometer-gain:mast-top-x=0.2", "--out", "test"]) == 0
    capsys.readouterr()
    assert main.run(["compare", str(study), "test"]) == 0
    assert "mast-top-x" in capsys.readouterr().out  # where the model fails most


@pytest.mark.parametrize(("name", "lowest", "drive"), [("plate", 37.9, "a:z"), ("bridge", 7.98, "w1:z")])
def test_a_test_of_which_nothing_is_said_reaches_the_first_mode_from_a_point_that_moves_in_the_lowest(
    name: str, lowest: float, drive: str, root: Path
) -> None:
    asked = {"noise": 1.0, "tolerances": 1.0, "band": None, "drives": (), "responses": (), "block": 0.0}
    study = str(root / "examples" / "studies" / f"{name}.toml")
    plan = structure_tests.plan_of(study, kind="hammer", effects=(), seed=0, **asked)  # type: ignore[arg-type]
    assert plan.band[0] == pytest.approx(lowest / 2, rel=0.01)
    assert [one.name for one in plan.drives] == [drive.replace(":", "-")]
