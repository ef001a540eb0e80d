"""`massline diagnose` from options to exit code: the way, the climb, refusals, one whole run."""

import json
import shutil
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import pytest

from geometry.dynamic_mass import MOTIONS
from geometry.errors import CheckFailed
from identification import campaign_file
from validation.cli import main
from validation.diagnose.diagnosis import VERDICTS, Diagnosis
from validation.effects.catalogue import parse
from validation.history import add
from validation.history.add import rewritten
from validation.history.history import Errors, Version, climbed, history_position, kept, next_rung
from validation.model import model_file
from validation.model.model import Added, Model
from validation.model.model_file import text as model_text
from validation.report import diagnose
from validation.report import history as climbing
from validation.study import Options, Study

Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def answers(monkeypatch, run) -> Callable[[Diagnosis], None]:
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


def test_json_is_one_object_and_says_what_was_asked(answers, made, run):
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


def test_a_folder_gets_the_same_json_the_pictures_and_what_is_left_of_an_unknown_effect(answers, made, run):
    answers(made("missing"))
    code, out, err = run("diagnose", "model.toml", "one", "--json", "--out", "found")
    assert code == 0
    assert json.loads(Path("found/diagnose.json").read_text(encoding="utf-8")) == json.loads(out)
    names = ["diagnose-errors.png", "diagnose-evidence.png"]
    assert sorted(path.name for path in Path("found").glob("*.png")) == names
    assert all(f"wrote found/{name}" in err for name in names)
    assert all(Path("found", name).stat().st_size > 10_000 for name in names)
    answers(made("unknown"))
    assert "wrote found/left.png" in run("diagnose", "model.toml", "one", "--out", "found")[2]


def test_a_baseline_that_does_not_converge_is_refused_with_its_reason(answers, made, run, monkeypatch):
    def fails(asked, bench, progress=None):
        raise CheckFailed("the baseline does not converge: the FMD's mass ended at its bound")

    answers(made("missing"))
    monkeypatch.setattr(diagnose, "diagnosis", fails)
    code, out, err = run("diagnose", "model.toml", "one", "--json", "--out", "found")
    assert (code, out) == (main.FAILED_CHECK, "")
    assert "the FMD's mass ended at its bound" in err
    assert not Path("found").exists() or not any(Path("found").iterdir())


def test_an_interruption_is_said_and_leaves_the_model_alone(answers, made, run, monkeypatch):
    def interrupted(asked, bench, progress=None):
        raise KeyboardInterrupt

    answers(made("missing"))
    before = Path("model.toml").read_bytes()
    monkeypatch.setattr(diagnose, "diagnosis", interrupted)
    code, out, err = run("diagnose", "model.toml", "one", "--auto")
    assert (code, out) == (main.INTERRUPTED, "")
    assert "interrupted" in err
    assert Path("model.toml").read_bytes() == before
    assert not Path("model.ladder.json").exists()


def test_auto_without_anything_to_add_says_why_it_ends(answers, made, run):
    answers(made("nothing"))
    code, out, err = run("diagnose", "model.toml", "one", "--auto")
    assert (code, err) == (0, "")
    assert "NOTHING IS MISSING" in out
    assert "The climb ends: nothing more is missing at the resolution of these data." in out
    found = json.loads(run("diagnose", "model.toml", "one", "--auto", "--json")[1])
    assert found["auto"]["rungs"] == []
    assert [one["verdict"] for one in found["auto"]["rounds"]] == ["nothing"]
    assert found["auto"]["ladder"]["rungs"] == []


def test_auto_finds_out_before_it_begins_that_the_model_cannot_be_written(answers, made, run, monkeypatch):
    def full(path):
        raise OSError(30, "Read-only file system", str(path))

    answers(made("missing"))
    monkeypatch.setattr(diagnose, "probe", full)
    monkeypatch.setattr(diagnose, "prepared", None)
    code, _, err = run("diagnose", "model.toml", "one", "--auto")
    assert code == main.BAD_INPUT
    assert "Read-only file system" in err


def test_words_of_a_user_are_no_markup(answers, made, run):
    answers(replace(made("unknown"), text="[red]spring[/red] :bomb:", remarks=("[bold]x",)))
    out = run("diagnose", "model.toml", "one")[1]
    assert "[red]spring[/red] :bomb:" in out
    assert "warning: [bold]x." in out


GAIN, MASS = "force-gain:fmd-z2", "point-mass:mast-top"
ERRORS = Errors(nominal=9.0, plain=3.0, chi2=1.0, degrees_of_freedom=1, tolerance_z2=1.0, tolerances=1, log_evidence=0.0)


@dataclass
class Laboratory:
    """Diagnoses that come one after the other, and rungs without fits.

    Attributes
    ----------
    gains : by effect, the evidence that its rung gains; many nats by default
    interrupted : effect whose fit is interrupted
    """

    path: Path
    found: list[Diagnosis]
    gains: dict[str, float] = field(default_factory=dict)
    interrupted: str = ""
    seen: list[tuple[str, ...]] = field(default_factory=list)

    def diagnose(self, bench: Study) -> Diagnosis:
        self.seen.append(tuple(one.named.id for one in bench.model.effects))
        return self.found[len(self.seen) - 1]

    def added(self, study: Study, asked: add.AddedEffectOptions, progress: Any = None) -> add.AddResult:
        """As `massline add`: the rung below is kept first, and is there when the fit is interrupted."""
        at = history_position(self.path)
        at = at if at.rung is not None else kept(at, replace(next_rung(at), errors=ERRORS))
        named = parse(asked.effect)
        if named.id == self.interrupted:
            raise KeyboardInterrupt
        assert at.rung is not None
        text = rewritten(at.text, (Added(named=named),), str(self.path))
        rung = Version(
            number=len(at.ladder.rungs),
            parent=at.rung.number,
            cause="added",
            effect=named.id,
            model=text,
            errors=ERRORS,
            gain=self.gains.get(named.id, 99.0),
            verdict=tuple(asked.remarks),
        )
        there = climbed(at, rung)
        return add.AddResult(at=there, before=at.rung, after=rung, said=(), study=study)

    def climb(self) -> climbing.Climb:
        bench = Study(model=model_file.read(str(self.path)), campaigns=(), made=())
        return climbing.climb(Options(model=str(self.path), data=("one",)), bench, self.diagnose)

    @property
    def effects(self) -> list[str]:
        return [one.named.id for one in model_file.read(str(self.path)).effects]


@pytest.fixture
def lab(tmp_path, monkeypatch) -> Callable[..., Laboratory]:
    """``lab(diagnosis, ...)``: a model file and the diagnoses that it will get."""
    path = tmp_path / "model.toml"
    path.write_text(model_text(Model(source="model.toml", title="one blade", article="fmd+clumod-1")), encoding="utf-8")

    def make(*found: Diagnosis, **more: Any) -> Laboratory:
        of = Laboratory(path=path, found=list(found), **more)
        monkeypatch.setattr(add, "added", of.added)
        return of

    return make


def test_every_accepted_effect_becomes_a_rung_in_order_and_the_climb_ends_where_nothing_is_missing(lab, made):
    of = lab(made("several"), made("nothing"))
    found = of.climb()
    assert [one.effect for one in found.rungs] == [GAIN, MASS]
    assert of.effects == [GAIN, MASS]
    assert of.seen == [(), (GAIN, MASS)]
    assert "nothing more is missing" in found.ended
    assert [one.parent for one in found.at.ladder.rungs] == [None, 0, 1]


@pytest.mark.parametrize("verdict", ["nothing", "unknown"])
def test_where_there_is_no_name_nothing_is_written(verdict, lab, made):
    of = lab(made(verdict))
    before = of.path.read_bytes()
    found = of.climb()
    assert not found.rungs
    assert of.path.read_bytes() == before
    assert list(of.path.parent.iterdir()) == [of.path]


def test_an_unknown_effect_beside_a_name_and_what_the_model_has_already_are_no_rungs(lab, made):
    of = lab(replace(made("unknown"), accepted=made("missing").accepted))
    assert not of.climb().rungs
    of = lab(made("missing"), made("missing"))
    assert len(of.climb().rungs) == 1


def test_of_a_class_the_first_becomes_a_rung_that_says_so_and_the_climb_ends(lab, made):
    of = lab(made("ambiguous"))
    found = of.climb()
    (rung,) = found.rungs
    assert rung.verdict == ("These data cannot tell it from cell-stiffness:2z or force-crosstalk:xz.",)
    assert "cannot tell" in found.ended
    assert len(found.rounds) == 1


@pytest.mark.parametrize(("verdict", "effect"), [("nonlinear", "friction:flange:x"), ("mistake", "polarity:fmd-z2")])
def test_mistakes_and_what_depends_on_the_level_are_rungs_too(verdict, effect, lab, made):
    of = lab(made(verdict), made("nothing"))
    assert [one.effect for one in of.climb().rungs] == [effect]


def test_a_rung_that_is_not_worth_a_parameter_is_left_again_and_ends_the_climb(lab, made):
    of = lab(made("several"), made("nothing"), gains={MASS: 2.0})
    found = of.climb()
    assert [one.effect for one in found.rungs] == [GAIN]
    assert of.effects == [GAIN]
    assert f"{MASS} is not worth a parameter" in found.ended
    assert "went back to rung 1" in found.ended
    assert len(found.at.ladder.rungs) == 3  # it is kept, to be looked at


def test_an_interruption_loses_no_rung_and_the_next_run_goes_on(lab, made):
    of = lab(made("several"), interrupted=MASS)
    with pytest.raises(KeyboardInterrupt):
        of.climb()
    assert of.effects == [GAIN]
    assert len(history_position(of.path).ladder.rungs) == 2
    mass = replace(made("several"), verdict="missing", accepted=made("several").accepted[1:])
    on = lab(mass, made("nothing"))
    assert [one.effect for one in on.climb().rungs] == [MASS]
    assert on.seen[0] == (GAIN,)
    assert on.effects == [GAIN, MASS]


def test_undo_goes_back_to_the_very_bytes_before_the_climb(lab, made):
    of = lab(made("missing"), made("nothing"))
    before = of.path.read_bytes()
    found = of.climb()
    from validation.history.history import undone

    undone(found.at)
    assert of.path.read_bytes() == before


def test_a_diagnosis_that_never_ends_is_ended(lab, made):
    channels = [f"fmd-z{k}" for k in (1, 2, 3, 4)] + ["fmd-x12", "fmd-x34", "fmd-y14"]
    cause = made("missing").accepted[0]
    endless = [
        replace(made("missing"), accepted=(replace(cause, named=parse(f"force-gain:{channel}=0.05")),)) for channel in channels
    ]
    found = lab(*endless).climb()
    assert len(found.rounds) == climbing.MOST_ROUNDS
    assert "look at the ladder" in found.ended


@pytest.fixture(scope="module")
def drawn(tmp_path_factory, meaningless) -> Path:
    """``cuboid`` with six runs, ``again`` with the same, ``short`` with one, and a model."""
    folder = tmp_path_factory.mktemp("bad")
    for name, runs in {"cuboid": MOTIONS, "again": MOTIONS, "short": ("x",)}.items():
        campaign_file.write(folder / name, meaningless(runs))
    model = Model(source="model.toml", title="disc and cuboid", article="fmd+disc+cuboid")
    (folder / "model.toml").write_text(model_text(model), encoding="utf-8")
    return folder


@pytest.fixture
def here(drawn, run) -> Path:
    """A copy of it where the command runs."""
    shutil.copytree(drawn, Path(), dirs_exist_ok=True)
    return Path("model.toml")


def refused(run: Run, *arguments: str) -> str:
    code, printed, error = run("diagnose", "model.toml", *arguments)
    assert (code, printed) == (2, ""), error
    assert "Traceback" not in error
    return " ".join(error.split())


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["short"], "too few: 1 in all (x of short)"),
        (["cuboid", "--hold-out", "gama"], "Did you mean gamma"),
        (["cuboid", "--hold-out", "cuboid"], "nothing is left to fit"),
        (["cuboid", "--band", "16", "4"], "--band"),
        (["cuboid", "nowhere"], "no such file or folder"),
        (["cuboid", "cuboid"], "is named twice"),
        (["cuboid", "--effects-from", "nowhere"], "nowhere"),
        (["cuboid", "--out", "model.toml"], "--out"),
        (["nowhere.toml"], "no such file or folder"),
        (["clumod-4-weighing", "clumod-4-weighing"], "is named twice"),
        (["cuboid/campaign.toml"], "Name its folder"),
        (["clumod-4-weighing", "--candidate", "force-gain"], "no effect that weights and periods could show"),
    ],
)
def test_what_cannot_be_used_is_said(words, said, here, run):
    assert said in refused(run, *words)


@pytest.mark.parametrize(
    ("candidate", "said"),
    [
        ("force-gian", "no effect is called 'force-gian' Did you mean force-gain"),
        ("force-gain:fmd-z9", "no force channel is called 'fmd-z9'"),
        ("force-gain:fmd-z2=0.08", "it has a size, which is what is looked for"),
        ("modulus:mast", "no part is called 'mast'"),
        ("point-mass:mast-top", "no place is called 'mast-top'"),
        ("force-gain:fmd-z2:x", "force-gain:fmd-z2:x"),
        ("polarity:fmd-z2", "mistakes are looked for in every diagnosis"),
        ("pendulum-damping", "of the kind 'pendulum'"),
        ("noise:fmd-z2", "of the kind 'processing'"),
        ("friction:flange:x", "every axis was driven at one level"),
        ("saturation", "one level cannot see saturation"),
        ("modulus", "is no effect that could act on these data"),
    ],
)
def test_a_candidate_that_cannot_be_looked_for_says_why(candidate, said, here, run):
    assert said in refused(run, "cuboid", "--candidate", candidate).replace(". ", " ")


@pytest.mark.parametrize("more", [["--hold-out", "z"], ["--band", "4", "16"], ["--auto"]])
def test_what_needs_a_campaign_is_refused_without_one(more, here, run):
    said = refused(run, "clumod-4-weighing", *more)
    assert "there is no campaign among DATA" in said
    assert more[0] in said


MODEL = """format = 1
[model]
article = "fmd+clumod-4"
"""


@pytest.fixture
def model(tmp_path) -> str:
    path = tmp_path / "model.toml"
    path.write_text(MODEL, encoding="utf-8")
    return str(path)


def test_a_pendulum_alone_gets_the_honest_answer(run, model, root):
    code, out, _ = run("diagnose", model, str(root / "examples" / "clumod-4-upright.toml"))
    assert code == 0
    assert "NOTHING IS MISSING" in out
    assert "One period is one number" in out
    assert "off-centre-suspension" in out
    assert "radius" in out  # it would explain the period, were it wrong


def test_json_has_the_keys_of_the_contract_and_only_what_is_asked_for_is_tried(run, model, tmp_path):
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
    _, out, _ = run("diagnose", model, "clumod-4-weighing", "--candidate", "point-mass:mast-top", "--json")
    assert [one["id"] for one in json.loads(out)["ranking"]] == ["point-mass:mast-top"]
