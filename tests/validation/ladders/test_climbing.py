"""Up, down and aside: nothing is ever lost, and wherever an interruption falls the model file and its ladder agree."""

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from geometry.errors import BadInput
from validation.history import history
from validation.history.history import Conditions, Ladder, Version, climbed, gone_to, history_position, kept, next_rung, undone

MakeRung = Callable[..., Version]


def grown(model: Path, rung: MakeRung, *texts: str) -> None:
    """Rung 0 of the model as it is, then one more for each of `texts`, each on top of the last."""
    at = history_position(model)
    if at.rung is None:
        kept(at, rung(0, None, at.text))
    for text in texts:
        at = history_position(model)
        climbed(at, rung(99, at.rung.number, text))


def tree(model: Path) -> list[str]:
    return [f"{branch}{one.number}" for branch, one in history_position(model).ladder.tree()]


def test_a_model_without_a_ladder_has_its_first_rung_before_it(model):
    at = history_position(model)
    assert at.rung is None
    assert not at.edited
    first = next_rung(at)
    assert (first.number, first.parent, first.cause, first.model) == (0, None, "start", "# mine\r\na = 1\n")


def test_every_rung_carries_the_model_up_and_undo_brings_back_its_bytes(model, rung):
    before = model.read_bytes()
    grown(model, rung, "a = 2\r\n", "a = 3")
    assert model.read_bytes() == b"a = 3"
    assert undone(history_position(model)).text == "a = 2\r\n"
    assert model.read_bytes() == b"a = 2\r\n"
    undone(history_position(model))
    assert model.read_bytes() == before
    assert len(history_position(model).ladder.rungs) == 3  # what was there is kept
    with pytest.raises(BadInput, match="nothing to undo"):
        undone(history_position(model))


def test_adding_after_undo_branches(model, rung):
    grown(model, rung, "a = 2", "a = 3")
    undone(history_position(model))
    grown(model, rung, "a = 4", "a = 5")
    assert tree(model) == ["0", "1", "├─ 2", "└─ 3", "   4"]
    assert [one.number for one in history_position(model).ladder.path(4)] == [0, 1, 3, 4]
    gone_to(history_position(model), 2)
    assert model.read_bytes() == b"a = 3"
    found = history_position(model)
    assert (found.rung.number, found.ladder.current) == (2, 2)


def test_a_rung_that_is_not_there_is_refused_by_the_numbers_that_are(model, rung):
    with pytest.raises(BadInput, match="has no ladder"):
        gone_to(history_position(model), 0)
    grown(model, rung, "a = 2")
    for number in (-1, 2):
        with pytest.raises(BadInput, match=f"no rung {number}.*0 to 1"):
            gone_to(history_position(model), number)


def test_an_edit_by_hand_is_seen_and_going_away_from_it_keeps_it_as_a_branch(model, rung):
    grown(model, rung, "a = 2")
    model.write_text("a = 2  # mine\n", encoding="utf-8")
    at = history_position(model)
    assert at.edited
    assert next_rung(at).cause == "edited by hand"
    undone(at)
    assert model.read_bytes() == b"a = 2"
    found = history_position(model)
    assert found.rung.number == 1
    edit = found.ladder.rung(2)
    assert (edit.parent, edit.errors, edit.model) == (1, None, "a = 2  # mine\n")
    gone_to(found, 2)
    assert model.read_bytes() == b"a = 2  # mine\n"


def test_an_edit_that_was_put_aside_gets_its_figures_in_place(model, rung):
    grown(model, rung)
    model.write_text("a = 7\n", encoding="utf-8")
    undone(history_position(model))
    at = gone_to(history_position(model), 1)
    waiting = next_rung(at)
    assert waiting.number == 1
    kept(at, rung(1, 0, waiting.model))
    found = history_position(model).ladder
    assert len(found.rungs) == 2
    assert found.rung(1).errors is not None


def test_rungs_made_meanwhile_stay_numbered_before_and_branches_at_the_foot_are_drawn_beside_each_other(model, rung):
    grown(model, rung)
    early = history_position(model)
    grown(model, rung, "a = 2")
    gone_to(history_position(model), 0)
    climbed(early, rung(1, 0, "a = 3"))
    found = history_position(model)
    assert [one.model for one in found.ladder.rungs[1:]] == ["a = 2", "a = 3"]
    assert found.rung.number == 2
    ladder = Ladder(rungs=(rung(0), rung(1, 0), rung(2, 0), rung(3, 1), rung(4, 1)), current=4)
    assert [branch + str(one.number) for branch, one in ladder.tree()] == ["0", "├─ 1", "│  ├─ 3", "│  └─ 4", "└─ 2"]


def test_two_that_begin_at_once_share_the_first_rung(model, rung):
    one = other = history_position(model)
    climbed(kept(one, rung(0, None, one.text)), rung(1, 0, "a = 2"))
    at = kept(other, rung(0, None, other.text))
    assert at.rung.number == 0
    climbed(at, rung(1, 0, "a = 3"))
    assert [(each.number, each.parent) for each in history_position(model).ladder.rungs] == [(0, None), (1, 0), (2, 0)]


def test_a_rung_on_other_data_is_another_rung(model, rung):
    at = history_position(model)
    kept(at, rung(0, None, at.text))
    kept(at, rung(0, None, at.text, conditions=Conditions(band=(4.0, 20.0))))
    assert len(history_position(model).ladder.rungs) == 2


def test_going_elsewhere_loses_no_rung_that_was_made_meanwhile(model, rung):
    grown(model, rung, "a = 2")
    early = history_position(model)
    grown(model, rung, "a = 3")
    gone_to(early, 0)
    assert [one.model for one in history_position(model).ladder.rungs[1:]] == ["a = 2", "a = 3"]


AT_ONCE = """
import sys
from dataclasses import replace
from pathlib import Path
from validation.history.history import history_position, kept
path, name = Path(sys.argv[1]), sys.argv[2]
for k in range(15):
    at = history_position(path)
    kept(at, replace(at.ladder.rung(0), parent=0, model=f"{name} = {k}"))
"""


def test_processes_that_write_at_once_lose_no_rung(model, rung):
    grown(model, rung)
    both = [subprocess.Popen([sys.executable, "-c", AT_ONCE, str(model), name]) for name in "bc"]
    assert [one.wait(60) for one in both] == [0, 0]
    found = {one.model for one in history_position(model).ladder.rungs[1:]}
    assert found == {f"{name} = {k}" for name in "bc" for k in range(15)}


def test_a_model_that_was_edited_while_a_fit_ran_is_left_alone_and_the_rung_is_kept(model, rung):
    grown(model, rung)
    at = history_position(model)
    model.write_text("a = 9\n", encoding="utf-8")
    climbed(at, rung(1, 0, "a = 2"))
    assert model.read_text(encoding="utf-8") == "a = 9\n"
    found = history_position(model)
    assert found.edited
    assert found.below.number == 0
    assert found.ladder.rung(1).model == "a = 2"


@pytest.mark.parametrize("act", ["climb", "undo", "go"])
@pytest.mark.parametrize("writes", range(4))
def test_wherever_an_interruption_falls_model_and_ladder_agree_and_no_rung_is_lost(act, writes, model, rung, monkeypatch):
    grown(model, rung, "a = 2")
    before, done = history_position(model), []

    def stopping(write):
        def instead(*arguments):
            if len(done) == writes:
                raise KeyboardInterrupt
            done.append(arguments)
            write(*arguments)

        return instead

    monkeypatch.setattr(history, "write", stopping(history.write))
    monkeypatch.setattr(history, "write_with", stopping(history.write_with))
    acts = {
        "climb": lambda: climbed(before, rung(2, 1, "a = 3")),
        "undo": lambda: undone(before),
        "go": lambda: gone_to(before, 0),
    }
    try:
        acts[act]()
    except KeyboardInterrupt:
        pass
    else:
        assert len(done) <= writes
    after = history_position(model)
    assert after.rung.model.encode() == model.read_bytes()
    assert [one.model for one in after.ladder.rungs[:2]] == [one.model for one in before.ladder.rungs]


def test_the_same_model_on_other_data_is_told_apart_by_the_ladder(model, rung):
    grown(model, rung)
    at = history_position(model)
    kept(at, rung(1, 0, at.text, cause="other data"))
    found = history_position(model)
    assert found.rung.number == 1
    undone(found)
    back = history_position(model)
    assert back.rung.number == 0


@pytest.mark.parametrize(("content", "words"), [(None, "no such file"), (b"\xff\xfe", "not text")])
def test_a_model_that_is_none_is_refused(content, words, tmp_path):
    if content is not None:
        (tmp_path / "m.toml").write_bytes(content)
    with pytest.raises(BadInput, match=words):
        history_position(tmp_path / "m.toml")
