"""`massline diagnose` from options to exit code, on diagnoses made by hand: what is tested is the way, not the answer."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from geometry.errors import CheckFailed
from validation.cli import main
from validation.diagnose.diagnosis import VERDICTS, Diagnosis
from validation.model import model_file
from validation.model.model import Model
from validation.model.model_file import text as model_text
from validation.report import diagnose
from validation.study import Study

Run = Callable[..., tuple[int, str, str]]
Made = Callable[[str], Diagnosis]


@pytest.fixture
def answers(monkeypatch: pytest.MonkeyPatch, run: Run) -> Callable[[Diagnosis], None]:
    """``answers(diagnosis)``: what every diagnosis comes to, of a model file where the command runs."""
    Path("model.toml").write_text(model_text(Model(source="model.toml", title="m", article="fmd+clumod-1")), encoding="utf-8")
    for name in ("one", "two"):
        Path(name).mkdir()
    monkeypatch.setattr(diagnose, "draw_left", lambda found, bench, folder, progress: (folder / "left.png",))

    def prepared(asked: Any, *, quiet: bool = True) -> Study:
        return Study(model=model_file.read(str(asked.model)), campaigns=(), made=())

    def set_to(found: Diagnosis) -> None:
        monkeypatch.setattr(diagnose, "prepared", prepared)
        monkeypatch.setattr(diagnose, "diagnosis", lambda asked, bench, progress=None: found)

    return set_to


@pytest.mark.parametrize("verdict", VERDICTS)
def test_the_exit_code_is_0_whatever_is_found(verdict: str, answers, made: Made, run: Run) -> None:
    answers(made(verdict))
    code, out, err = run("diagnose", "model.toml", "one")
    assert (code, err) == (0, "")
    assert "What model.toml is missing" in out


def test_json_is_one_object_and_says_what_was_asked(answers, made: Made, run: Run) -> None:
    answers(made("ambiguous"))
    code, out, err = run(
        "diagnose", "model.toml", "one", "two", "--json", "--hold-out", "z", "--band", "4", "32", "--candidate", "force-gain"
    )
    assert (code, err) == (0, "")
    found = json.loads(out)
    assert found["verdict"] == "ambiguous"
    assert found["data"] == ["one", "two"]
    assert found["hold_out"] == ["z"]
    assert found["band_hz"] == [4.0, 32.0]
    assert found["candidates"] == ["force-gain"]
    assert found["next_measurement"] == "run the Cuboid turned by 90 degrees about z"
    assert "auto" not in found


def test_a_folder_gets_the_same_json_and_the_pictures(answers, made: Made, run: Run) -> None:
    answers(made("missing"))
    code, out, err = run("diagnose", "model.toml", "one", "--json", "--out", "found")
    assert code == 0
    assert json.loads(Path("found/diagnose.json").read_text(encoding="utf-8")) == json.loads(out)
    names = ["diagnose-errors.png", "diagnose-evidence.png"]
    assert sorted(path.name for path in Path("found").glob("*.png")) == names
    assert all(f"wrote found/{name}" in err for name in names)
    assert all(Path("found", name).stat().st_size > 10_000 for name in names)


def test_what_is_left_of_an_unknown_effect_is_drawn_too(answers, made: Made, run: Run) -> None:
    answers(made("unknown"))
    assert "wrote found/left.png" in run("diagnose", "model.toml", "one", "--out", "found")[2]


def test_a_baseline_that_does_not_converge_is_refused_with_its_reason(
    answers, made: Made, run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(asked: Any, bench: Study, progress: Any = None) -> Diagnosis:
        raise CheckFailed("the baseline does not converge: the FMD's mass ended at its bound")

    answers(made("missing"))
    monkeypatch.setattr(diagnose, "diagnosis", fails)
    code, out, err = run("diagnose", "model.toml", "one", "--json", "--out", "found")
    assert (code, out) == (main.FAILED_CHECK, "")
    assert "the FMD's mass ended at its bound" in err
    assert not Path("found").exists() or not any(Path("found").iterdir())


def test_an_interruption_is_said_and_leaves_the_model_alone(
    answers, made: Made, run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(asked: Any, bench: Study, progress: Any = None) -> Diagnosis:
        raise KeyboardInterrupt

    answers(made("missing"))
    before = Path("model.toml").read_bytes()
    monkeypatch.setattr(diagnose, "diagnosis", interrupted)
    code, out, err = run("diagnose", "model.toml", "one", "--auto")
    assert (code, out) == (main.INTERRUPTED, "")
    assert "interrupted" in err
    assert Path("model.toml").read_bytes() == before
    assert not Path("model.ladder.json").exists()


def test_auto_without_anything_to_add_says_why_it_ends(answers, made: Made, run: Run) -> None:
    answers(made("nothing"))
    code, out, err = run("diagnose", "model.toml", "one", "--auto")
    assert (code, err) == (0, "")
    assert "NOTHING IS MISSING" in out
    assert "The climb ends: nothing more is missing at the resolution of these data." in out
    found = json.loads(run("diagnose", "model.toml", "one", "--auto", "--json")[1])
    assert found["auto"]["rungs"] == []
    assert [one["verdict"] for one in found["auto"]["rounds"]] == ["nothing"]
    assert found["auto"]["ladder"]["rungs"] == []


def test_auto_finds_out_before_it_begins_that_the_model_cannot_be_written(
    answers, made: Made, run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(path: Path) -> None:
        raise OSError(30, "Read-only file system", str(path))

    answers(made("missing"))
    monkeypatch.setattr(diagnose, "probe", full)
    monkeypatch.setattr(diagnose, "prepared", None)
    code, _, err = run("diagnose", "model.toml", "one", "--auto")
    assert code == main.BAD_INPUT
    assert "Read-only file system" in err


def test_words_of_a_user_are_no_markup(answers, made: Made, run: Run) -> None:
    answers(replace(made("unknown"), text="[red]spring[/red] :bomb:", remarks=("[bold]x",)))
    out = run("diagnose", "model.toml", "one")[1]
    assert "[red]spring[/red] :bomb:" in out
    assert "warning: [bold]x." in out
