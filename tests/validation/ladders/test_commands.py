"""`massline add`, `ladder` and `undo` on a short virtual test of the Cuboid with a gain of 8 % on one load cell."""

import json
import re
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.errors import CheckFailed
from validation.cli import main
from validation.compare.compare import compared
from validation.estimation.problem import Evaluation, Fit, Share
from validation.history import add
from validation.history.add import EvaluatedModel, judged
from validation.history.history import Version, history_position
from validation.report import identify
from validation.study import Study

Run = Callable[..., tuple[int, str, str]]

GAIN = "force-gain:fmd-z2"
FAST = ("--octaves-per-minute", "120", "--band", "8", "16", "--rate", "256", "--model", "rigid", "--noise", "0.1")
PLAN = ("--seed", "3", "--tolerances", "0.3", "--effect", f"{GAIN}=0.08", *FAST)
RIGID = 'kind = "rigid"'
HELD = ("--hold-out", "z")
"""One run, where each in turn would be six fits."""


@pytest.fixture(scope="module")
def once(tmp_path_factory) -> Path:
    """A campaign, and a model that has the gain: its first attempt was interrupted after the rung before it was evaluated."""
    folder = tmp_path_factory.mktemp("ladder")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        assert main.run(["simulate", "fmd+cuboid", "--out", "cuboid", *PLAN]) == main.DONE
        assert main.run(["model", "fmd+cuboid", "--out", "model.toml"]) == main.DONE
        text = Path("model.toml").read_text(encoding="utf-8").replace('kind = "beam"', RIGID)
        Path("model.toml").write_text(f"# mine\n{text}", encoding="utf-8")
        shutil.copy("model.toml", "before.toml")
        _interrupted(patch)
        Path("interrupted.json").write_text(json.dumps(_state()), encoding="utf-8")
        assert main.run(["add", "model.toml", GAIN, *HELD]) == main.DONE
    return folder


def _interrupted(patch: pytest.MonkeyPatch) -> None:
    """The command, ended by Ctrl-C when the fit of the effect begins."""

    def only_before(study: Any, parent: Any, progress: Any = None, **how: Any) -> Any:
        if parent is not None:
            raise KeyboardInterrupt
        return judged(study, parent, progress, **how)

    with patch.context() as inner:
        inner.setattr(add, "judged", only_before)
        assert main.run(["add", "model.toml", GAIN, "cuboid", *HELD]) == main.INTERRUPTED


def _state() -> dict[str, Any]:
    at = history_position(Path("model.toml"))
    return {"text": at.text, "rungs": len(at.ladder.rungs), "on": at.rung.number if at.rung else None}


@pytest.fixture
def made(once, run) -> Path:
    """A copy of it in the folder in which the command runs."""
    shutil.copytree(once, Path(), dirs_exist_ok=True)
    return Path("model.toml")


def ladder(run: Run, *arguments: str) -> dict[str, Any]:
    code, out, err = run("ladder", "model.toml", "--json", "--no-plot", *arguments)
    assert code == main.DONE, err
    found: dict[str, Any] = json.loads(out)
    return found


def test_an_interrupted_fit_keeps_the_rung_that_was_finished(once):
    state = json.loads((once / "interrupted.json").read_text(encoding="utf-8"))
    assert (state["rungs"], state["on"]) == (1, 0)
    assert state["text"] == (once / "before.toml").read_text(encoding="utf-8")


def test_the_right_effect_is_found_and_its_error_falls(made, run):
    found = ladder(run)
    assert found["current"] == 1
    before, after = found["rungs"]
    (effect,) = after["effects"]
    truth = json.loads(Path("cuboid.truth.json").read_text(encoding="utf-8"))
    low, high = effect["interval90"]
    gain = truth["tolerances"][GAIN]  # with the channel's own tolerance
    assert abs(effect["value"] - gain) < 2 * (high - low)  # 2.4 times the half-width that 9 of 10 lie within: 1 of 15,000 beyond
    assert after["evidence_gain_nats"] > 20
    assert after["worth_a_parameter"]
    assert after["errors"]["plain_percent"] < 0.3 * before["errors"]["plain_percent"]  # of the lines that are driven
    assert after["errors"]["heldout_percent"] < 0.3 * before["errors"]["heldout_percent"]
    assert after["errors"]["tolerance_z2"] < 0.5 * before["errors"]["tolerance_z2"]
    assert any("worth a parameter" in sentence for sentence in after["verdict"])
    assert any("fmd-z2 gains most" in sentence for sentence in after["verdict"])


def test_a_comparison_does_not_doubt_the_model_that_has_the_right_effect(made, answer):
    """Nothing but tolerances is left: what a fit leaves on runs that it has not seen is what they explain."""
    found = answer("compare", str(made), "cuboid")
    verdicts = {one["name"]: one["verdict"] for one in found["errors"]}
    assert set(verdicts.values()) == {None, "good"}, verdicts
    assert any("400 of the 561 lines" in said for said in found["warnings"])


def no_fit(study: Study, parent: Version | None, progress: object = None, **how: Any) -> EvaluatedModel:
    """What a rung of any figures is made of, in no time."""
    none = Fit(
        parameters=(), offsets=np.zeros(0), covariance=np.zeros((0, 0)), cost=0.0, chi2=1.0, degrees_of_freedom=1,
        tolerance_z2=0.0, tolerances=0, log_evidence=0.0, converged=True,
    )  # fmt: skip
    share = Share(percent=1.0)
    found = Evaluation(nominal=share, plain=share, held_out=None, held_out_nominal=None, plain_fit=none, fitted=none)
    return EvaluatedModel(model=study.model, evaluation=found, body=None)


@pytest.mark.parametrize("effect", ["polarity:fmd-z1", "channel-swap:fmd-z1:fmd-z2"])
@pytest.mark.parametrize("form", [(), ("--json",)])
def test_an_effect_without_a_size_is_added_to_a_bare_model(effect, form, once, run, monkeypatch):
    shutil.copytree(once / "cuboid", "cuboid")
    shutil.copy(once / "before.toml", "model.toml")
    monkeypatch.setattr(add, "judged", no_fit)
    code, out, err = run("add", "model.toml", effect, "cuboid", "--band", "8", "16", *form)
    assert code == main.DONE, err
    assert effect in out
    if form:
        assert [one["id"] for one in json.loads(out)["after"]["effects"]] == [effect]
    else:
        assert re.search(rf"^ *{effect} +–$", out, flags=re.MULTILINE), out


@pytest.mark.parametrize("effect", ["force-gain:fmd-z1", "channel-swap:fmd-z1:fmd-z2"])
def test_what_is_missing_is_added_where_nothing_fits_without_it(effect, once, run, monkeypatch):
    """The rung below has no figures then. Where nothing fits with it either, it is refused."""
    fits = []

    def judged_or_failed(study, parent, progress=None, **how):
        if not (fits and study.model.effects):
            raise CheckFailed("the fit does not converge")
        assert parent is None
        return no_fit(study, parent)

    shutil.copytree(once / "cuboid", "cuboid")
    shutil.copy(once / "before.toml", "model.toml")
    monkeypatch.setattr(add, "judged", judged_or_failed)
    code, _, err = run("add", "model.toml", effect, "cuboid", "--band", "8", "16")
    assert code == main.FAILED_CHECK
    assert "does not converge" in err
    assert Path("model.toml").read_text() == (once / "before.toml").read_text()
    fits.append(True)
    code, out, err = run("add", "model.toml", effect, "cuboid", "--band", "8", "16")
    assert code == main.DONE, err
    assert "the fit does not converge" in " ".join(out.split())
    found = ladder(run)
    assert [one["errors"] is None for one in found["rungs"]] == [True, False]
    assert found["rungs"][1]["evidence_gain_nats"] is None
    assert found["current"] == 1


def test_the_page_marks_the_rung_and_draws_the_fall(made, run):
    code, out, err = run("ladder", "model.toml")
    assert code == main.DONE
    assert f"→ 1 {GAIN}" in out
    assert "  0 the model at first" in out
    assert "cuboid, rung 1" in out
    for name in ("model-ladder.png", "model-ladder-cuboid.png"):
        assert f"wrote out/{name}" in err
        assert Path("out", name).stat().st_size > 10_000


def test_a_report_has_the_inertia_of_the_rung_and_without_a_ladder_finds_the_same(made, run):
    """With the effects of the model: the raw records of a load cell that reads too much know none."""

    def quiet(what, share): ...

    study = Study.open("model.toml", ["cuboid"], hold_out=["z"])
    found = compared(study, quiet)
    at = history_position(made)
    assert at.rung is not None
    (kept,), _ = identify.identified(study, found, at, quiet)
    (here,) = at.rung.bodies
    assert kept is here
    (fitted,), _ = identify.identified(study, found, None, quiet)
    assert_allclose((fitted.values - here.values) / here.deviation, 0.0, atol=0.01)
    assert_allclose(fitted.half_width, here.half_width, rtol=0.01)
    # the rung stands on other lines than these, and does not speak for them
    elsewhere = Study.open("model.toml", ["cuboid"], hold_out=["z"], band=(9.0, 15.0))
    (other,), _ = identify.identified(elsewhere, found, at, quiet)
    assert other is not here
    bare = elsewhere.by(replace(elsewhere.model, effects=()))
    assert identify.identified(bare, found, at, quiet) == ((), "")


def test_an_edit_by_hand_is_said(made, run):
    made.write_text(made.read_text(encoding="utf-8") + "# more\n", encoding="utf-8")
    _, out, _ = run("ladder", "model.toml", "--no-plot")
    assert "edited by hand since rung 1" in out
    assert ladder(run)["current"] is None


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((GAIN,), "the model has it already"),
        (("modulus:mast=0.05",), "acts nowhere on these data"),
        (("force-gian:fmd-z2",), "`massline effects` lists all"),
        (("force-gain:fmd-z9",), "Did you mean fmd-z"),
        (("force-gain:fmd-z1", "--fixed"), "its size is missing"),
        (("force-gain:fmd-z1=99",), "between -0.9 and 9"),
        (("force-gain:fmd-z1", "--hold-out", "delta"), "delta"),
        (("rigid-inertia:m=-100",), "no body is left of fmd+cuboid: the mass must be positive, found -87.9"),
        (("rigid-inertia:m=-100", "--fixed"), "no body is left of fmd+cuboid"),
        (("force-gain:fmd-z1", "nowhere"), "no such file or folder"),
    ],
)
def test_what_cannot_be_added_is_refused_in_words_and_nothing_changes(arguments, words, made, refused):
    before = made.read_bytes(), Path("model.ladder.json").read_bytes()
    assert words in refused("add", "model.toml", *arguments)
    assert (made.read_bytes(), Path("model.ladder.json").read_bytes()) == before


def test_exact_aliases_are_refused_with_their_direction(made, refused):
    text = made.read_text(encoding="utf-8")
    # of a rigid body the two halves of gravity cancel to rounding
    made.write_text(f'{text}\n[[effect]]\nid = "gravity"\nvalue = 0.0\nfixed = true\n', encoding="utf-8")
    err = refused("add", "model.toml", "accelerometer-tilt")
    assert "cannot tell it from what is in the model" in err
    assert "gravity" in err
    assert "--alias-ok" in err


def test_without_data_or_a_ladder_it_says_what_is_missing(once, run, refused):
    shutil.copy(once / "before.toml", "model.toml")
    assert "there is no data" in run("add", "model.toml", GAIN)[2]
    for command in ("ladder", "undo"):
        assert "has no ladder" in refused(command, "model.toml")


def test_data_that_moved_away_or_changed_are_said(made, refused):
    Path("cuboid").rename("elsewhere")
    assert "stands on cuboid, which is not there any more" in refused("add", "model.toml", "force-gain:fmd-z1")


def test_a_damaged_ladder_is_refused_by_every_command_and_kept(made, refused):
    beside = Path("model.ladder.json")
    beside.write_bytes(beside.read_bytes()[:1000])
    before = beside.read_bytes(), made.read_bytes()
    for arguments in (("ladder", "model.toml"), ("undo", "model.toml"), ("add", "model.toml", "force-gain:fmd-z1")):
        assert "model.ladder.json" in refused(*arguments)
    assert (beside.read_bytes(), made.read_bytes()) == before


def test_identified_inertia_lies_within_its_interval_of_the_truth(made, run):
    (body,) = ladder(run)["rungs"][1]["inertia"]
    assert body["article"] == "cuboid"
    assert_allclose(body["reference"]["mass_kg"], body["identified"]["mass_kg"], atol=1.5 * body["half_width95"]["mass_kg"])


def test_an_own_effect_is_looked_for_where_the_ladder_had_it(made, refused):
    beside = Path("model.ladder.json")
    beside.write_text(beside.read_text(encoding="utf-8").replace('"effects_from": []', '"effects_from": ["mine/effects"]'))
    made.write_text(f'{made.read_text(encoding="utf-8")}\n[[effect]]\nid = "force-sag:fmd-z1"\nvalue = 0.1\n', encoding="utf-8")
    for arguments in (("compare", "model.toml", "cuboid"), ("add", "model.toml", "force-gain:fmd-z1")):
        err = refused(*arguments)
        assert "no effect is called 'force-sag'" in err
        assert "--effects-from mine/effects" in err


def test_a_folder_that_cannot_be_written_is_said_before_the_fit(made, refused, monkeypatch):
    def full(path):
        raise OSError(30, "Read-only file system", str(path))

    monkeypatch.setattr(add, "probe", full)
    monkeypatch.setattr(add, "judged", None)
    assert "Read-only file system" in refused("add", "model.toml", "force-gain:fmd-z1")
