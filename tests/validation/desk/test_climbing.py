"""A rung up and down again: the error, the curve and the identified inertia move, and nothing of the user's does."""

import asyncio
import json
import shlex
import shutil
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from geometry.errors import BadInput
from validation.app import curves, workers
from validation.app.opening import Handed, received
from validation.app.options import StartOptions
from validation.app.panels import stands
from validation.app.session import Session, begun, digest
from validation.app.state import WindowState, unsaved
from validation.app.window import first_state
from validation.estimation.verdicts import expected_z2, largest_z
from validation.history import history
from validation.history.history import Source, history_position
from validation.model import model_file
from validation.output import to_json
from validation.report import page


@pytest.fixture(scope="module")
def climbed(worked, tmp_path_factory) -> Session:
    """A copy of the desk, on which a worker added what was missing."""
    from validation.app.session import opened

    folder = tmp_path_factory.mktemp("climbed") / "desk"  # made anew where another module's test came between two of this one
    shutil.copytree(worked.desk.folder, folder)
    desk = opened(folder)
    assert workers.start(desk, workers.ADD, effect="force-gain:fmd-z2").wait().error == ""
    return desk


def test_a_comparison_makes_rung_0_with_identified_inertia(worked):
    at = worked.desk.ladder()
    assert at.rung.number == 0
    assert at.rung.bodies[0].article == "cuboid"
    assert at.rung.errors.plain == pytest.approx(worked.compared.summary["plain_error_percent"])


def test_adding_moves_error_curve_and_inertia_and_undo_brings_all_back(worked, climbed):
    before, at, after = worked.compared, climbed.ladder(), climbed.comparison()
    assert at.rung.parent == 0
    assert at.rung.effect == "force-gain:fmd-z2"
    assert after.summary["plain_error_percent"] < 0.3 * before.summary["plain_error_percent"]
    assert after.summary["effects"] == ["force-gain:fmd-z2"]
    one, other = (found.maps[0].pairs for found in (before, after))
    assert np.array_equal(one.measured, other.measured)
    assert np.abs(one.predicted - other.predicted)[:, 2, 2].max() > 0.01 * np.abs(one.predicted)[:, 2, 2].max()
    assert at.rung.bodies[0].values[0] != at.ladder.rung(0).bodies[0].values[0]
    assert unsaved(climbed.folder)
    assert not unsaved(worked.desk.folder)
    text = climbed.model.read_text()
    assert climbed.undo().rung.number == 0  # type: ignore[union-attr]
    again = climbed.comparison()
    assert again.summary == before.summary
    assert climbed.diagnosis() is not None
    assert climbed.go_to(1).text == text
    assert climbed.comparison() is not None


def test_a_window_shows_what_stands_on_a_desk_with_two_rungs(worked, climbed):
    class State(SimpleNamespace):
        def flush(self) -> None: ...

        def __getitem__(self, name: str) -> Any:
            return getattr(self, name)

    for desk in (worked.desk, climbed):
        window = WindowState(state=State(**first_state()), folder=desk.folder, opened=StartOptions(), session=desk)
        object.__setattr__(window, "begin", lambda work: work.close())  # what moves a slider is made ready elsewhere
        with ThreadPoolExecutor(1) as pool:  # a browser's driver may have a loop in this thread
            pool.submit(asyncio.run, stands(window)).result()
        plain = desk.comparison().summary["plain_error_percent"]
        assert [one["number"] for one in window.state.rungs] == [one.number for one in reversed(desk.ladder().ladder.rungs)]
        assert f"{plain:.3g}" in json.dumps(window.state.errors)
        if (found := desk.diagnosis()) is not None:
            assert window.state.verdict["headline"] == found.sentences["headline"]
            assert window.state.ranking[0]["id"] == found.accepted[0].id
        assert window.state.fig_ladder is not None
        assert window.state.fig_inertia is not None


@pytest.mark.proof
def test_adding_that_is_cancelled_when_its_rung_is_written_goes_back_and_says_so(fresh):
    desk = fresh("cancelled")
    text = desk.model.read_text()
    worker = workers.start(desk, workers.ADD, effect="force-gain:fmd-z2")
    until = time.monotonic() + 60
    while desk.model.read_text() == text and time.monotonic() < until:
        time.sleep(0.01)
    found = worker.cancel()
    assert found.state == workers.CANCELLED
    assert found.said == "rung 1 was written already and stays on the ladder; the model is back on rung 0"
    _stands_as_before(desk, text)
    assert desk.go_to(1).text != text


@pytest.mark.proof  # a whole worker; the test below goes back as well
def test_adding_that_fails_when_its_rung_is_written_goes_back_and_says_so(climbed, fresh):
    desk = fresh("failed")
    text = desk.model.read_text()
    (desk.folder / "found" / digest(climbed.ladder().ladder.rung(1).model)).write_text("in the way")
    found = workers.start(desk, workers.ADD, effect="force-gain:fmd-z2").wait(60)
    assert found.state == workers.FAILED
    assert found.error.endswith("; rung 1 was written already and stays on the ladder; the model is back on rung 0")
    _stands_as_before(desk, text)


def test_work_that_ended_with_its_window_leaves_its_rung_and_adding_that_is_cancelled_before_says_nothing(climbed, fresh):
    desk = fresh("reopened")
    text = desk.model.read_text()
    for name in ("model.toml", "model.ladder.json"):
        shutil.copy(climbed.model.with_name(name), desk.model.with_name(name))
    desk.go_to(1)
    workers.tell(desk, workers.Job(kind=workers.ADD, asked={}, before=digest(text)))
    found = workers.recovered(desk)
    assert "back on rung 0" in found.said
    _stands_as_before(desk, text)
    desk = fresh("early")
    text = desk.model.read_text()
    assert workers.start(desk, workers.ADD, effect="force-gain:fmd-z2").cancel().said == ""
    _stands_as_before(desk, text)


def _stands_as_before(desk: Session, text: str) -> None:
    at = desk.ladder()
    assert desk.model.read_text() == text
    assert at.rung.number == at.ladder.current == 0
    assert desk.comparison() is not None


def test_the_users_model_has_no_ladder_until_it_is_saved(worked, climbed):
    users = Path(worked.desk.asked.model)
    assert not users.with_name("model.ladder.json").exists()
    mine = users.with_name("mine.toml")
    both = {mine: climbed.model_text(), mine.with_name("mine.ladder.json"): climbed.ladder_text()}
    for path, text in both.items():
        path.write_text(text)
    try:
        at = history_position(mine)
        added = model_file.read(mine).effects
    finally:
        for path in both:  # the folder is that of other tests, too
            path.unlink()
    assert at.rung.effect == "force-gain:fmd-z2"
    (source,) = at.rung.conditions.data
    assert (mine.parent / source.path).resolve() == Path(worked.desk.asked.data[0])
    assert [one.named.id for one in added] == ["force-gain:fmd-z2"]


def test_a_ladder_that_is_not_there_cannot_be_had(bare):
    with pytest.raises(BadInput, match="none yet"):
        bare.ladder_text()
    with pytest.raises(BadInput, match="no ladder"):
        bare.undo()


def test_a_diagnosis_told_again_says_the_same(worked):
    said, again = json.loads((worked.desk.found / "diagnose.json").read_text()), worked.desk.diagnosis()
    told = to_json(again)
    assert told["ranking"] == said["ranking"]
    words = ("verdict", "text", "headline", "equivalence_class", "steps", "warnings")
    for key in (*words, "accepted", "advice", "detectable", "errors"):
        assert told[key] == said[key]
    for when, fit in (("before", again.before.fitted), ("after", again.after.fitted)):
        assert expected_z2(fit) == pytest.approx(said[when]["fitted"]["tolerance_z2_expected"])
        assert largest_z(fit) == pytest.approx(said[when]["fitted"]["largest_z"])


def test_a_diagnosis_that_is_damaged_is_none(fresh):
    desk = fresh("undiagnosed")
    (desk.found / "diagnose.json").write_text("[1]")
    assert desk.diagnosis() is None


def test_an_effect_is_explained_with_what_was_found_of_it(worked):
    found = curves.explained(worked.desk, "force-gain:fmd-z2")
    assert found.sizes[""] == pytest.approx(0.08, abs=0.01)
    assert " % (+" in found.found
    assert found.evidence is not None
    assert found.evidence > 8
    assert "fmd-z2" in found.text
    assert found.separating
    assert found.written.startswith("force-gain:fmd-z2=0.0")


def test_an_effect_that_was_not_tried_is_explained_by_the_catalogue(bare):
    found = curves.explained(bare, "appendage:z=m:0.3,f:21,zeta:0.02")
    assert (found.sizes, found.evidence, found.aliases, found.separating) == ({}, None, (), ())
    assert found.written == "appendage:z=m:0.3,f:21,zeta:0.02"
    assert found.equation
    with pytest.raises(BadInput, match="no effect is called"):
        curves.explained(bare, "nonsense")


def test_a_report_names_the_users_files_and_the_whole_command_line(block, tmp_path, climbed, monkeypatch):
    """A director signs it, and the folder of the desk is gone by then."""
    own = str(tmp_path / "effects")
    monkeypatch.setattr(page, "SOURCES", {"mine": f"{own}/mine.py"})
    (tmp_path / "effects").mkdir()
    (tmp_path / "effects" / "mine.py").write_text("")
    made = begun(tmp_path / "d", block.model, block.data, hold_out=("z",), band=(8, 12))
    made = replace(made, asked=replace(made.asked, effects_from=(own,)))
    made.model.write_text(climbed.ladder().ladder.rung(1).model)
    found = made.provenance(made.read_model(), diagnosed=True)
    words = ["massline", "report", block.model, *block.data, "--hold-out", "z", "--band", "8", "12", "--effects-from", own]
    assert shlex.split(found.command) == words
    assert found.inputs[0] == Source(path=block.model, digest=history.digest(block.model))
    assert [one.path for one in found.inputs] == [block.model, *block.data, f"{own}/mine.py"]
    assert found.settings["effects added in the workbench"] == ("force-gain:fmd-z2",)
    assert found.model_text == made.model_text()
    assert shlex.split(made.provenance(made.read_model(), diagnosed=False).command)[-1] == "--no-diagnosis"


def test_files_that_a_browser_handed_over_are_named_as_it_named_them(block, tmp_path):
    root = Path(block.model).parent
    files = [path for path in root.rglob("*") if path.is_file()]
    names = [f"my series/{path.relative_to(root).as_posix()}" for path in files]
    got = received(tmp_path / "desk-0", [Handed(name=name, content=path) for name, path in zip(names, files, strict=True)])
    made = begun(tmp_path / "desk-0", got.models[0], got.data)
    found = made.provenance(made.read_model(), diagnosed=True)
    shown = ["my series/model.toml", "my series/fmd+cuboid"]
    assert shlex.split(found.command) == ["massline", "report", *shown]
    assert [one.path for one in found.inputs] == shown


def test_a_report_is_written_from_what_was_found(worked, tmp_path, monkeypatch):
    """The parts that are drawn anew are proved with the report; here they stand for nothing."""
    from validation.report import page, parts

    monkeypatch.setattr(page, "article_part", lambda name, *more: parts.ArticlePart(name=name))
    monkeypatch.setattr(page, "campaign_part", lambda one, *more: parts.CampaignPart(campaign=one))
    heard: list[str] = []
    path = worked.desk.report(tmp_path / "report.html", lambda what, share: heard.append(what))
    text = path.read_text()
    assert "fitting" not in heard
    assert "force-gain:fmd-z2" in text
    assert str(worked.desk.folder) not in text
    with pytest.raises(BadInput, match="report"):
        worked.desk.report(tmp_path / "report.txt")
