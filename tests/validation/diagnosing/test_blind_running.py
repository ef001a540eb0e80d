"""The blind proof is sealed, answered and kept as its page says."""

import json
import subprocess
import sys
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

from benchmarks.blind import __main__ as program
from benchmarks.blind import ledger, running
from benchmarks.blind.drawing.case import CUBOID, NULL, SINGLE, Case, Planted
from benchmarks.blind.keeping import ALSO, FACES, KEPT_AS, ROOMS, Kept, hashed, present_code
from benchmarks.blind.ledger import Ledger, Look
from benchmarks.blind.names import MODEL, SETTINGS, Json
from benchmarks.blind.sealing import known, sealed
from benchmarks.blind.split import SURE, Half, Tried, told
from identification import campaign_file
from tools import house
from validation.model import model_file
from validation.model.model import Model
from validation.prediction.series import predictions
from validation.study import Study
from validation.virtual_test.plan import RIGID, Plan
from validation.virtual_test.simulate import simulate

FAST: dict[str, Any] = {"octaves_per_minute": 120.0, "quiet": 0.2, "model": RIGID, "simulation_rate": 2000.0}

BOOK = Ledger(development=(1, 2), test=9)


def case(number: int, *planted: str) -> Case:
    name = f"{NULL}-{number:03d}"
    effects = tuple(Planted(text=one) for one in planted)
    return Case(name=name, kind=SINGLE if planted else NULL, laboratory=number, articles=(CUBOID,), planted=effects, null=name)


@pytest.fixture
def kept(tmp_path) -> Kept:
    return Kept(seed=5, code="abc", folder=tmp_path)


def test_what_is_finished_is_not_done_again(kept, monkeypatch):
    solved: list[str] = []

    def stub(one, **options):
        solved.append(one.name)
        return {"name": one.name}, {"verdict": "nothing"}

    monkeypatch.setattr(running, "solved", stub)
    kept.keep_truth("nulls-001", {"name": "nulls-001"})
    kept.keep_answer("nulls-001", {"verdict": "nothing"})
    names = [one.name for one in running.finished([case(k) for k in range(4)], kept, jobs=1)]
    assert sorted(names) == [f"nulls-{k:03d}" for k in range(4)]
    assert sorted(solved) == ["nulls-000", "nulls-002", "nulls-003"]
    assert [truth["name"] for truth, _ in kept.pairs()] == sorted(names)
    assert [one.name for one in running.finished([case(k) for k in range(4)], kept, jobs=1)] == sorted(names)
    assert len(solved) == 3


def test_an_interruption_keeps_what_was_finished_and_nothing_of_what_was_not(kept, monkeypatch):
    def stub(one, **options):
        if one.name == "nulls-002":
            raise KeyboardInterrupt
        return {"name": one.name}, {"verdict": "nothing"}

    monkeypatch.setattr(running, "solved", stub)
    with pytest.raises(KeyboardInterrupt):
        list(running.finished([case(k) for k in range(4)], kept, jobs=1))
    assert {"nulls-000", "nulls-001"} <= {truth["name"] for truth, _ in kept.pairs()}
    assert not kept.finished("nulls-002")


def test_a_series_that_cannot_be_simulated_and_a_diagnosis_that_dies_are_answers_of_their_own(tmp_path, monkeypatch):
    truth, answer = running.solved(case(1, "point-mass:top=-999"), driven=FAST)  # no body has so much to lose
    assert truth["planted"][0]["id"] == "point-mass:top"
    assert set(answer) == {"broken"}
    monkeypatch.setattr(running.sys, "executable", "false")
    assert running._diagnosed(tmp_path) == {"broken": "ended with 1"}


def test_a_diagnosis_that_computes_for_ever_is_broken(tmp_path, monkeypatch):
    busy = tmp_path / "busy"
    busy.write_text("#!/bin/sh\nwhile :; do :; done\n")
    busy.chmod(0o755)
    monkeypatch.setattr(running.sys, "executable", str(busy))
    monkeypatch.setattr(running, "PATIENCE", 1)
    assert "no answer" in running._diagnosed(tmp_path)["broken"]


def test_an_interruption_while_a_case_is_simulated_leaves_no_folder(tmp_path, monkeypatch):
    def interrupted(*of, **how):
        raise KeyboardInterrupt

    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    monkeypatch.setattr(running, "sealed", interrupted)
    with pytest.raises(KeyboardInterrupt):
        running.solved(case(1), driven=FAST)
    assert list(tmp_path.iterdir()) == []


def test_a_case_whose_processes_die_is_an_answer_that_counts_as_a_miss(kept, monkeypatch):
    lost = running.parallel.WorkerLost("its process died 4 times")
    monkeypatch.setattr(running.parallel, "finished", lambda work, cases, **how: ((one, lost) for one in cases))
    assert [one.name for one in running.finished([case(1, "point-mass:top=0.1")], kept, jobs=2)] == ["nulls-001"]
    truth, answer = kept.pair("nulls-001")
    assert truth["planted"][0]["id"] == "point-mass:top"
    assert answer == {"broken": "its process died 4 times"}


def test_results_of_other_code_and_other_draws_are_not_mixed_in(kept):
    kept.keep_truth("nulls-000", {})
    kept.keep_answer("nulls-000", {})
    assert not Kept(seed=6, code="abc", folder=kept.folder).finished("nulls-000")
    assert not Kept(seed=5, code="abd", folder=kept.folder).finished("nulls-000")


def test_a_draw_is_blind_until_the_code_changes_after_a_look_and_retired_for_development():
    look = Look(seed=9, code="abc", day="2026-11-21", cases=10)
    after = BOOK.with_look(look)
    assert BOOK.blind(9, "abc")
    assert after.blind(9, "abc")
    assert not after.blind(9, "abd")
    assert not BOOK.blind(1, "abc")
    more = replace(look, cases=20)  # of the same code: the same look
    assert after.with_look(more).looks == (more,)
    after = BOOK.retired()
    assert after.development == (1, 2, 9)
    assert after.test not in (1, 2, 9)
    assert BOOK.retired() == after
    other = replace(BOOK, structures=7).retired(ledger.STRUCTURES)  # the newest for development stays the last
    assert other.development == (1, 7, 2)
    assert other.structures not in (1, 2, 7, 9)
    assert other.test == BOOK.test


def test_a_look_is_written_down_for_the_test_draw_alone(tmp_path):
    file = tmp_path / "ledger.json"
    ledger.write(BOOK, file)
    ledger.look(1, "abc", 10, file)
    assert ledger.read(file) == BOOK
    ledger.look(9, "abc", 10, file)
    assert [(one.seed, one.code, one.cases) for one in ledger.read(file).looks] == [(9, "abc", 10)]
    assert "looked at with one version" in ledger.told(ledger.read(file))
    assert ledger.read().test not in ledger.read().development  # that of the repository


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--draw", "test", "--seed", "3"), "stands in the ledger"),
        (("--draw", "development", "--seed", "-3"), "not for development"),
        (("--kinds", "nulls,pears"), "pears"),
    ],
)
def test_what_cannot_be_asked_for_is_said(options, said):
    done = CliRunner().invoke(program.main, list(options))
    assert done.exit_code == 2
    assert said in done.output


def test_the_hash_of_the_code_is_of_files_that_are_there(monkeypatch, root):
    monkeypatch.chdir(root)
    present_code.cache_clear()
    assert len(present_code()) == 12
    present_code.cache_clear()


CASE = Case(
    name="singles-042",
    kind=SINGLE,
    laboratory=918273645,
    articles=(CUBOID,),
    planted=(Planted(text="force-gain:fmd-z2=0.075", multiple=5.0, told=5.0),),
    leave_out=("polarity",),
    hold_out=(f"{CUBOID}/y",),
    null="nulls-007",
)

Sealed = tuple[Path, Json]


@pytest.fixture(scope="module")
def handed(tmp_path_factory) -> Sealed:
    folder = tmp_path_factory.mktemp("scratch") / "series"
    return folder, sealed(CASE, folder, driven=FAST)


def test_no_file_of_the_folder_holds_the_truth_and_settings_and_model_say_what_the_laboratory_knows(handed):
    folder, truth = handed
    drawn = truth["planted"][0]["sizes"][""]
    secrets = [b"918273645", b"force-gain", b"singles", b"nulls", repr(drawn).encode(), b"truth", b"seed"]
    files = [path for path in folder.rglob("*") if path.is_file()]
    assert len(files) == 1 + 6 + 2
    for path in files:
        content = path.read_bytes()
        assert not [one for one in secrets if one in content or one.decode() in str(path.relative_to(folder))], path
    assert b"polarity" in (folder / SETTINGS).read_bytes()  # what is left out must be said, and such a search finds it
    settings = json.loads((handed[0] / SETTINGS).read_text())
    assert settings == {"data": [CUBOID], "hold_out": [f"{CUBOID}/y"], "leave_out": ["polarity"]}
    found, expected = model_file.read(handed[0] / MODEL), known()
    assert (found.article, found.effects, found.tolerances) == (expected.article, (), expected.tolerances)
    np.testing.assert_array_equal(found.cell_stiffness, expected.cell_stiffness)


def test_the_true_size_is_what_was_planted_on_top_of_what_the_laboratory_has_and_is_in_the_campaign(handed, tmp_path):
    stated = handed[1]["planted"][0]
    plain = sealed(replace(CASE, planted=(Planted(text="force-gain:fmd-z2=0"),)), tmp_path / "series", driven=FAST)
    drawn = plain["planted"][0]["sizes"][""]
    assert drawn != 0
    assert stated["id"] == "force-gain:fmd-z2"
    assert stated["sizes"][""] == pytest.approx((1 + drawn) * 1.075 - 1)
    sealed(replace(CASE, planted=()), tmp_path / "without", driven=FAST)
    with_it, without = (campaign_file.read(folder / CUBOID).recordings["z"] for folder in (handed[0], tmp_path / "without"))
    k = with_it.names.index("fmd-z2")
    level = np.sqrt(np.mean(with_it.values**2, axis=0))
    moved = np.sqrt(np.mean((with_it.values - without.values) ** 2, axis=0)) / level
    assert moved[k] == pytest.approx(0.075 / 1.075, rel=0.02)  # noise and hum, which are the same in both, are not multiplied
    assert np.all(np.delete(moved, k) < 1e-9)


def test_the_process_that_answers_knows_no_draw_and_no_virtual_test(root):
    script = "import sys, benchmarks.blind.answering; print(*sorted(sys.modules))"
    done = subprocess.run([sys.executable, "-c", script], cwd=root, capture_output=True, text=True, check=True)
    loaded = done.stdout.split()
    assert "benchmarks.blind.names" in loaded
    assert not [
        name
        for name in loaded
        if name.startswith(("benchmarks.blind.drawing", "benchmarks.blind.sealing", "validation.virtual_test"))
    ]


@pytest.fixture(scope="module")
def covered(root) -> set[str]:
    return {path.relative_to(root).as_posix() for path in hashed(root)}


@pytest.mark.parametrize("file", ["validation/diagnose/search.py", "fem/beam/articles.py", "geometry/articles/cuboid.toml"])
def test_a_file_that_figures_come_from_is_covered(file, root, covered):
    if not (root / file).exists():
        pytest.fail(f"{file} is no longer there: name another")
    assert file in covered


@pytest.mark.parametrize("face", FACES)
def test_a_face_is_there_and_not_covered(face, root, covered):
    assert (root / face).exists()
    assert {name for name in covered if name.startswith(face)} <= set(KEPT_AS)


def test_all_that_draws_and_asks_imports_is_covered(root, covered):
    found = house.modules(root, (*house.ROOMS, "benchmarks"))
    beside = {f"benchmarks.blind.{name.removesuffix('.py')}" for name in ALSO if "/" not in name} | {
        "benchmarks.cross_check_proof"
    }
    asking = [one for one in found if one in beside or one.startswith("benchmarks.blind.drawing")]
    imports = house.imports(found)
    reached = {to for one in asking for to in imports[one] if to.split(".")[0] in ROOMS}
    files = {(root / to.replace(".", "/")).relative_to(root) for to in reached}
    assert "validation/diagnose/diagnose" in {file.as_posix() for file in files}
    assert {f"{file}.py" for file in files if (root / f"{file}.py").exists()} <= covered


def of(planted: str, over: float, unseen: float) -> Tried:
    return Tried(case="one", planted=planted, found="force-gain:fmd-z1", over=over, unseen=unseen)


def test_two_halves_share_no_line_and_are_all_lines_together():
    campaign = simulate(Plan(article="fmd+cuboid", seed=1, octaves_per_minute=120.0, quiet=0.3, ringing=1e-3)).campaign
    model = Model(source="here", title="a block", article="fmd+cuboid")
    whole = Study(model=model, campaigns=(campaign,), made=predictions(model, [campaign]))
    given = {one.name: getattr(whole, one.name) for one in fields(whole) if one.init}
    halves = [Half(**given, odd=odd).problem() for odd in (False, True)]
    (name,) = halves[0].lines
    even, odd = (half.lines[name] for half in halves)
    assert not set(even) & set(odd)
    assert np.array_equal(np.sort(np.concatenate([even, odd])), whole.problem().lines[name])


def test_what_evidence_names_and_what_the_other_half_confirms_are_counted_apart():
    found = [of("", 0.5, SURE - 1), of("", -2.0, SURE + 1), of("cable", 3.0, SURE + 9), of("cable", 1.0, SURE + 5)]
    nulls, effects = told(found)
    assert "of 2 evidence in half of the lines names 1, the other half confirms 1 (median +3.0 nats)" in nulls
    assert "of 2 evidence in half of the lines names 2, the other half confirms 2 (median +10.0 nats)" in effects
