"""No sentence of a diagnosis says more than was looked at; fits are none of this file's business."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from validation.diagnose import diagnose, diagnosis, mistakes
from validation.diagnose.diagnosis import MISSING, NONLINEAR, NOTHING, SEVERAL, UNKNOWN, VERDICTS, Advice, Diagnosis, ReportedStep
from validation.effects.catalogue import parse
from validation.model.model import Model
from validation.output import to_json
from validation.report import diagnose as report_diagnose
from validation.study import Study

Made = Callable[[str], Diagnosis]
BENCH = Study(model=Model(source="model.toml", title="m", article="fmd+cuboid"), campaigns=(), made=())


def quiet(what: str, share: float) -> None:
    """Hears nothing."""


def test_of_what_was_asked_for_alone_the_sentence_says_so(made: Made) -> None:
    asked = {"only": ("force-gain", "cell-stiffness:2z")}
    said = diagnosis.headline(replace(made("nothing"), **asked))
    assert said == "NOTHING IS MISSING of what was asked for (force-gain and cell-stiffness:2z) at the resolution of these data."
    said = diagnosis.headline(replace(made("unknown"), **asked))
    assert "massline knows" not in said
    assert "nothing of what was asked for (force-gain and cell-stiffness:2z) explains it" in said


@pytest.mark.parametrize("verdict", VERDICTS)
def test_the_text_of_json_is_never_empty(verdict: str, made: Made) -> None:
    assert to_json(replace(made(verdict), text=""))["text"] == diagnosis.headline(made(verdict))


def test_what_the_data_say_of_a_cause_is_on_the_page_and_in_json(made: Made) -> None:
    (one,) = made("mistake").accepted
    told = replace(one, note="its numbers are in g, and the file says m/s^2")
    assert ("these data say", told.note) in report_diagnose.explained(told).lines
    assert to_json(told)["note"] == told.note
    assert to_json(one)["note"] is None
    assert not any(line[0] == "these data say" for line in report_diagnose.explained(one).lines)
    assert to_json(Advice(test="weigh it", gain=3.0, hours=0.5))["hours"] == 0.5


def test_what_an_earlier_round_fitted_is_not_said_to_be_unfitted(made: Made) -> None:
    several = made("several")
    (other, *_) = made("missing").accepted
    step = ReportedStep(added=other.id, ranking=(other,), misfit=1.0, price=1.0, text="")
    found = replace(several, ranking=(), equivalence_class=(other.id, "force-gain:fmd-z4"), steps=(step,))
    fitted, unfitted = report_diagnose.DiagnosisPage(found=found).alike().lines
    assert "was not fitted" not in fitted[1]
    assert f"{other.evidence:+.1f} nats" in fitted[1]
    assert "was not fitted" in unfitted[1]


@pytest.mark.parametrize(("verdict", "told"), [("nonlinear", False), ("mistake", False), ("missing", True)])
def test_evidence_gained_is_told_of_fits_only(verdict: str, told: bool, made: Made) -> None:
    assert (
        any(line[0].startswith("evidence gained") for line in report_diagnose.DiagnosisPage(found=made(verdict)).errors().lines)
        == told
    )


def test_two_levels_and_a_mistake_are_told_together_and_before_is_the_model_as_it_was(
    made: Made, monkeypatch: pytest.MonkeyPatch
) -> None:
    seen: list[tuple[Any, Any]] = []
    monkeypatch.setattr(
        mistakes, "errors_without_fit", lambda bench, offsets: seen.append((bench, offsets)) or made("missing").before
    )
    found = replace(made("nonlinear"), text="Driven along x, two levels differ")
    wrong = made("mistake").accepted
    both = mistakes.with_mistakes(BENCH, found, wrong)
    assert both.verdict == NONLINEAR
    assert [one.id for one in both.accepted] == ["polarity:fmd-z2", "friction:flange:x"]
    assert both.text == "Driven along x, two levels differ; beside that a mistake in the data: polarity:fmd-z2"
    assert seen == [(BENCH, {})]
    assert both.before is made("missing").before


def test_what_is_beside_a_mistake_is_said_in_words(made: Made, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mistakes, "errors_without_fit", lambda bench, offsets: made("missing").before)
    wrong = made("mistake").accepted
    assert mistakes.with_mistakes(BENCH, made("nothing"), wrong).text == ""
    assert "to confirm polarity:fmd-z2: " in mistakes.with_mistakes(BENCH, made("nothing"), wrong).next_measurement
    said = mistakes.with_mistakes(BENCH, replace(made("missing"), text=""), wrong).text
    assert said.startswith("Beside polarity:fmd-z2: MISSING: force-gain:fmd-z2")


def test_of_two_levels_only_what_is_asked_for_is_named(made: Made, monkeypatch: pytest.MonkeyPatch) -> None:
    (friction,) = made("nonlinear").accepted
    gap = replace(friction, named=parse("gap:1=500"), evidence=118.0)
    monkeypatch.setattr(diagnose, "nonlinear", lambda bench, levels, progress: (friction, gap))
    monkeypatch.setattr(diagnose, "errors_without_fit", lambda bench, offsets: made("missing").before)
    monkeypatch.setattr(diagnose, "of_bench", lambda bench: {"method": "sine"})

    def named(**asked: Any) -> Diagnosis:
        return diagnose.nonlinear_answer(BENCH, made("nonlinear").levels, quiet, **asked)

    assert named().equivalence_class == (friction.id, gap.id)
    assert [one.test.split(": ")[0] for one in named().advice] == [f"to confirm {friction.id}", f"to confirm {gap.id}"]
    for asked in ({"only": ("gap",)}, {"leave_out": ("friction",)}):
        found = named(**asked)
        assert [one.id for one in found.accepted] == [gap.id]
        assert [one.id for one in found.ranking] == [gap.id]
    assert named(only=("force-gain",)).accepted == ()
    assert named().settings["method"] == "sine"


def test_mistakes_are_left_out_where_that_is_asked_and_settings_say_what_was(made: Made, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mistakes, "errors_without_fit", lambda bench, offsets: made("missing").before)
    monkeypatch.setattr(diagnose, "mistakes", lambda of: made("mistake").accepted)
    monkeypatch.setattr(diagnose, "_linear_or_not", lambda right, only, leave_out, tell: made("nothing"))
    assert diagnose.diagnosed(BENCH).verdict == "mistake"
    found = diagnose.diagnosed(BENCH, only=("force-gain",), leave_out=("polarity",))
    assert found.verdict == NOTHING
    assert found.only == ("force-gain",)
    assert (found.settings["only"], found.settings["leave_out"]) == (["force-gain"], ["polarity"])


def test_beside_a_class_only_the_mistake_becomes_a_rung(made: Made) -> None:
    wrong, unsure = made("mistake").accepted, made("ambiguous")
    both = replace(unsure, verdict="mistake", accepted=(*wrong, *unsure.accepted))
    assert report_diagnose.new(both, BENCH.model) == wrong


def test_an_unknown_effect_is_told_with_what_its_own_fit_leaves(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(diagnose, "goodness_of_fit", lambda fit, problem: SimpleNamespace(text="chi² is 9"))
    left: Any = SimpleNamespace(gain=50.0)
    bare: Any = SimpleNamespace(effects=(), fit=None, problem=None)

    def best(text: str) -> Any:
        return SimpleNamespace(tried=(SimpleNamespace(id="gap:1", evidence=3.0, goodness=SimpleNamespace(text=text)),))

    said = diagnose._text(UNKNOWN, bare, best("chi² is 4"), left)
    assert said == "As the model is, chi² is 9. With the closest, gap:1, chi² is 4"
    assert "3.0 nats better, which is not enough" in diagnose._text(UNKNOWN, bare, best(""), left)
    assert diagnose._text(MISSING, bare, best(""), left) == ""


def test_each_of_several_is_confirmed_by_what_the_catalogue_knows(made: Made) -> None:
    both = made("several").accepted
    found: Any = SimpleNamespace(effects=both)
    advised = diagnose._advice(BENCH, SEVERAL, None, found, lambda share: None)  # type: ignore[arg-type]
    assert [one.test for one in advised] == [f"to confirm {one.id}: {one.confirmed_by}" for one in both]
