"""Running a draw loses nothing that is finished, and one broken case ends no other."""

from pathlib import Path
from threading import Event
from typing import Any

import pytest
from click.testing import CliRunner

from benchmarks.blind import __main__ as program
from benchmarks.blind import ledger, running
from benchmarks.blind.drawing.case import CUBOID, NULL, SINGLE, Case, Planted
from benchmarks.blind.keeping import Kept, present_code
from benchmarks.blind.ledger import Ledger, Look
from benchmarks.blind.names import Json
from validation.virtual_test.plan import RIGID

FAST: dict[str, Any] = {"octaves_per_minute": 120.0, "quiet": 0.2, "model": RIGID, "simulation_rate": 2000.0}

BOOK = Ledger(development=(1, 2), test=9)


def case(number: int, *planted: str) -> Case:
    name = f"{NULL}-{number:03d}"
    effects = tuple(Planted(text=one) for one in planted)
    return Case(name=name, kind=SINGLE if planted else NULL, laboratory=number, articles=(CUBOID,), planted=effects, null=name)


@pytest.fixture
def kept(tmp_path: Path) -> Kept:
    return Kept(seed=5, code="abc", folder=tmp_path)


def test_what_is_finished_is_not_done_again(kept: Kept, monkeypatch: pytest.MonkeyPatch) -> None:
    solved: list[str] = []

    def stub(one: Case, **options: object) -> tuple[Json, Json]:
        solved.append(one.name)
        return {"name": one.name}, {"verdict": "nothing"}

    monkeypatch.setattr(running, "solved", stub)
    kept.keep_truth("nulls-001", {"name": "nulls-001"})
    kept.keep_answer("nulls-001", {"verdict": "nothing"})
    names = [one.name for one in running.finished([case(k) for k in range(4)], kept, jobs=2)]
    assert sorted(names) == [f"nulls-{k:03d}" for k in range(4)]
    assert sorted(solved) == ["nulls-000", "nulls-002", "nulls-003"]
    assert [truth["name"] for truth, _ in kept.pairs()] == sorted(names)
    assert [one.name for one in running.finished([case(k) for k in range(4)], kept, jobs=2)] == sorted(names)
    assert len(solved) == 3


def test_an_interruption_keeps_what_was_finished_and_nothing_of_what_was_not(kept: Kept, monkeypatch: pytest.MonkeyPatch) -> None:
    def stub(one: Case, **options: object) -> tuple[Json, Json]:
        if one.name == "nulls-002":
            raise KeyboardInterrupt
        return {"name": one.name}, {"verdict": "nothing"}

    monkeypatch.setattr(running, "solved", stub)
    with pytest.raises(KeyboardInterrupt):
        list(running.finished([case(k) for k in range(4)], kept, jobs=1))
    assert {"nulls-000", "nulls-001"} <= {truth["name"] for truth, _ in kept.pairs()}
    assert not kept.finished("nulls-002")


def test_a_series_that_cannot_be_simulated_is_an_answer_of_its_own() -> None:
    truth, answer = running.solved(case(1, "point-mass:top=-999"), driven=FAST)  # no body has so much to lose
    assert truth["planted"][0]["id"] == "point-mass:top"
    assert set(answer) == {"broken"}


def test_a_diagnosis_that_dies_is_broken_and_what_it_said_is_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(running.sys, "executable", "false")
    assert running._diagnosed(tmp_path, Event()) == {"broken": "ended with 1"}


def test_a_diagnosis_that_takes_for_ever_is_broken(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    sleeper = tmp_path / "sleeper"
    sleeper.write_text("#!/bin/sh\nexec sleep 60\n")
    sleeper.chmod(0o755)
    monkeypatch.setattr(running.sys, "executable", str(sleeper))
    monkeypatch.setattr(running, "PATIENCE", 0.2)
    assert "no answer" in running._diagnosed(tmp_path, Event())["broken"]


def test_a_case_that_is_told_to_stop_leaves_no_answer_and_no_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    stop = Event()
    stop.set()
    with pytest.raises(running.Interrupted):
        running.solved(case(1), driven=FAST, stop=stop)
    assert list(tmp_path.iterdir()) == []


def test_results_of_other_code_and_other_draws_are_not_mixed_in(kept: Kept) -> None:
    kept.keep_truth("nulls-000", {})
    kept.keep_answer("nulls-000", {})
    assert not Kept(seed=6, code="abc", folder=kept.folder).finished("nulls-000")
    assert not Kept(seed=5, code="abd", folder=kept.folder).finished("nulls-000")


def test_a_draw_is_blind_until_the_code_changes_after_a_look() -> None:
    look = Look(seed=9, code="abc", day="2026-11-21", cases=10)
    after = BOOK.with_look(look)
    assert BOOK.blind(9, "abc")
    assert after.blind(9, "abc")
    assert not after.blind(9, "abd")
    assert not BOOK.blind(1, "abc")


def test_more_cases_of_the_same_code_are_the_same_look() -> None:
    looks = [Look(seed=9, code="abc", day="2026-11-21", cases=count) for count in (10, 20)]
    assert BOOK.with_look(looks[0]).with_look(looks[1]).looks == (looks[1],)


def test_a_retired_test_draw_is_for_development_and_the_next_one_is_new() -> None:
    after = BOOK.retired()
    assert after.development == (1, 2, 9)
    assert after.test not in (1, 2, 9)
    assert BOOK.retired() == after


def test_a_look_is_written_down_for_the_test_draw_alone(tmp_path: Path) -> None:
    file = tmp_path / "ledger.json"
    ledger.write(BOOK, file)
    ledger.look(1, "abc", 10, file)
    assert ledger.read(file) == BOOK
    ledger.look(9, "abc", 10, file)
    assert [(one.seed, one.code, one.cases) for one in ledger.read(file).looks] == [(9, "abc", 10)]
    assert "looked at with one version" in ledger.told(ledger.read(file))


def test_the_ledger_of_the_repository_can_be_read_and_its_test_draw_is_no_development_draw() -> None:
    book = ledger.read()
    assert book.test not in book.development


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--draw", "test", "--seed", "3"), "stands in the ledger"),
        (("--draw", "development", "--seed", "-3"), "not for development"),
        (("--kinds", "nulls,pears"), "pears"),
    ],
)
def test_what_cannot_be_asked_for_is_said(options: tuple[str, ...], said: str) -> None:
    done = CliRunner().invoke(program.main, list(options))
    assert done.exit_code == 2
    assert said in done.output


def test_the_hash_of_the_code_is_of_files_that_are_there(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(Path(__file__).parents[4])
    present_code.cache_clear()
    assert len(present_code()) == 12
    present_code.cache_clear()
