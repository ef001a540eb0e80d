"""The climb: what becomes a rung, when it stops, what an interruption leaves. Fits are none of this file's business."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import pytest

from validation.diagnose.diagnosis import Diagnosis
from validation.effects.catalogue import parse
from validation.history import add
from validation.history.add import rewritten
from validation.history.history import Errors, Version, climbed, history_position, kept, next_rung
from validation.model import model_file
from validation.model.model import Added, Model
from validation.model.model_file import text as model_text
from validation.report import diagnose as report_diagnose
from validation.study import Options, Study

Made = Callable[[str], Diagnosis]

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

    def climb(self) -> report_diagnose.Climb:
        bench = Study(model=model_file.read(str(self.path)), campaigns=(), made=())
        return report_diagnose.climb(Options(model=str(self.path), data=("one",)), bench, self.diagnose)

    @property
    def effects(self) -> list[str]:
        return [one.named.id for one in model_file.read(str(self.path)).effects]


@pytest.fixture
def lab(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., Laboratory]:
    """``lab(diagnosis, ...)``: a model file and the diagnoses that it will get."""
    path = tmp_path / "model.toml"
    path.write_text(model_text(Model(source="model.toml", title="one blade", article="fmd+clumod-1")), encoding="utf-8")

    def make(*found: Diagnosis, **more: Any) -> Laboratory:
        of = Laboratory(path=path, found=list(found), **more)
        monkeypatch.setattr(add, "added", of.added)
        return of

    return make


def test_every_accepted_effect_becomes_a_rung_in_order_and_the_climb_ends_where_nothing_is_missing(lab, made: Made) -> None:
    of = lab(made("several"), made("nothing"))
    found = of.climb()
    assert [one.effect for one in found.rungs] == [GAIN, MASS]
    assert of.effects == [GAIN, MASS]
    assert of.seen == [(), (GAIN, MASS)]
    assert "nothing more is missing" in found.ended
    assert [one.parent for one in found.at.ladder.rungs] == [None, 0, 1]


@pytest.mark.parametrize("verdict", ["nothing", "unknown"])
def test_where_there_is_no_name_nothing_is_written(verdict: str, lab, made: Made) -> None:
    of = lab(made(verdict))
    before = of.path.read_bytes()
    found = of.climb()
    assert not found.rungs
    assert of.path.read_bytes() == before
    assert list(of.path.parent.iterdir()) == [of.path]


def test_an_unknown_effect_beside_a_name_is_no_rung_either(lab, made: Made) -> None:
    of = lab(replace(made("unknown"), accepted=made("missing").accepted))
    assert not of.climb().rungs


def test_of_a_class_the_first_becomes_a_rung_that_says_so_and_the_climb_ends(lab, made: Made) -> None:
    of = lab(made("ambiguous"))
    found = of.climb()
    (rung,) = found.rungs
    assert rung.verdict == ("These data cannot tell it from cell-stiffness:2z or force-crosstalk:xz.",)
    assert "cannot tell" in found.ended
    assert len(found.rounds) == 1


@pytest.mark.parametrize(("verdict", "effect"), [("nonlinear", "friction:flange:x"), ("mistake", "polarity:fmd-z2")])
def test_mistakes_and_what_depends_on_the_level_are_rungs_too(verdict: str, effect: str, lab, made: Made) -> None:
    of = lab(made(verdict), made("nothing"))
    assert [one.effect for one in of.climb().rungs] == [effect]


def test_a_rung_that_is_not_worth_a_parameter_is_left_again_and_ends_the_climb(lab, made: Made) -> None:
    of = lab(made("several"), made("nothing"), gains={MASS: 2.0})
    found = of.climb()
    assert [one.effect for one in found.rungs] == [GAIN]
    assert of.effects == [GAIN]
    assert f"{MASS} is not worth a parameter" in found.ended
    assert "went back to rung 1" in found.ended
    assert len(found.at.ladder.rungs) == 3  # it is kept, to be looked at


def test_an_interruption_loses_no_rung_and_the_next_run_goes_on(lab, made: Made) -> None:
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


def test_undo_goes_back_to_the_very_bytes_before_the_climb(lab, made: Made) -> None:
    of = lab(made("missing"), made("nothing"))
    before = of.path.read_bytes()
    found = of.climb()
    from validation.history.history import undone

    undone(found.at)
    assert of.path.read_bytes() == before


def test_a_diagnosis_that_never_ends_is_ended(lab, made: Made) -> None:
    channels = [f"fmd-z{k}" for k in (1, 2, 3, 4)] + ["fmd-x12", "fmd-x34", "fmd-y14"]
    cause = made("missing").accepted[0]
    endless = [
        replace(made("missing"), accepted=(replace(cause, named=parse(f"force-gain:{channel}=0.05")),)) for channel in channels
    ]
    found = lab(*endless).climb()
    assert len(found.rounds) == report_diagnose.MOST_ROUNDS
    assert "look at the ladder" in found.ended


def test_what_the_model_has_already_is_not_added_again(lab, made: Made) -> None:
    of = lab(made("missing"), made("missing"))
    assert len(of.climb().rungs) == 1
