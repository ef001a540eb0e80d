"""What an engineer and other programs read of a diagnosis: pages, sentences, JSON, pictures."""

from dataclasses import replace
from itertools import combinations
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from validation.diagnose import diagnose as diagnosing
from validation.diagnose import diagnosis
from validation.diagnose.diagnosis import NONLINEAR, NOTHING, VERDICTS, Advice, Detectable, Diagnosis, ReportedStep
from validation.effects import practical_units
from validation.effects.catalogue import parse
from validation.effects.practical_units import said
from validation.model.model import Model
from validation.output import nats, to_json
from validation.report import diagnose
from validation.report import diagnose as report_diagnose
from validation.report import history as climbing
from validation.report.diagnose import grid
from validation.study import Study

PAGES = Path(__file__).parent / "pages"
WIDTH = 110


def printed(found: Diagnosis, width: int = WIDTH) -> str:
    return replace(diagnose.document(found), title=diagnose.title("model.toml", ("cuboid", "clumod-1"))).text(width)


@pytest.mark.parametrize("verdict", VERDICTS)
def test_the_page_of_every_verdict_is_as_it_was_looked_at(verdict, made):
    assert printed(made(verdict)) == (PAGES / f"{verdict}.txt").read_text(encoding="utf-8")


def test_nothing_is_said_twice_a_name_nearly_found_is_said_and_what_was_accepted_before_a_class_is_certain(made):
    found = made("missing")
    once = replace(found, text=diagnosis.headline(found))
    assert diagnose.document(once).opening == (diagnosis.headline(found),)
    assert "The closest is point-mass:mast-top, +198.0 g" in " ".join(printed(made("nothing")).split())
    far = replace(made("nothing"), ranking=tuple(replace(one, evidence=1.0) for one in made("nothing").ranking))
    assert "The closest" not in printed(far)
    found = replace(made("several"), verdict="ambiguous", equivalence_class=("point-mass:mast-top", "rigid-inertia:m"))
    said = diagnosis.headline(found)
    assert said.startswith("MISSING IS force-gain:fmd-z2, +7.93 % (+7.69 to +8.17), and then one of these")
    assert said.endswith("point-mass:mast-top or rigid-inertia:m.")


def test_a_tie_is_one_name_with_its_places_in_words_and_in_json(made):
    found = made("missing")
    two = replace(found, accepted=(replace(found.accepted[0], same=("force-gain:fmd-z4",)),))
    said = "MISSING: force-gain:fmd-z2 (or force-gain:fmd-z4, which is the same to these data), +7.93 %"
    assert diagnosis.headline(two).startswith(said)
    (told,) = to_json(two)["accepted"]
    assert told["same"] == ["force-gain:fmd-z4"]
    assert "same" not in to_json(found)["accepted"][0]


def test_what_is_missing_beside_a_mistake_is_told_apart(made):
    found = made("mistake")
    said = diagnosis.headline(replace(found, accepted=(*found.accepted, *made("missing").accepted)))
    assert said == (
        "A MISTAKE in the data: polarity:fmd-z2: a channel is inverted; and missing beside it: "
        "force-gain:fmd-z2, +7.93 % (+7.69 to +8.17)."
    )


def test_sentences_name_a_few_and_count_the_rest_and_settings_of_any_kind_are_json(made):
    assert diagnosis.listed(["a"]) == "a"
    assert diagnosis.listed(["a", "b"], "or") == "a or b"
    assert diagnosis.listed(list("abcdef")) == "a, b, c, d and 2 more"
    assert diagnosis.listed([]) == ""
    found = to_json(made("missing"))["settings"]
    assert found == {"method": "full-record", "band_hz": [4.0, 32.0], "worth_nats": {"": 8.0}, "lines": 560}
    assert to_json({"a": np.inf, "b": (None, True, {1})}) == {"a": None, "b": [None, True, [1]]}


BENCH = Study(model=Model(source="model.toml", title="m", article="fmd+cuboid"), campaigns=(), made=())


def quiet(what: str, share: float) -> None:
    """Hears nothing."""


def test_of_what_was_asked_for_alone_the_sentence_says_so(made):
    asked = {"only": ("force-gain", "cell-stiffness:2z")}
    said = diagnosis.headline(replace(made("nothing"), **asked))
    assert said == "NOTHING IS MISSING of what was asked for (force-gain and cell-stiffness:2z) at the resolution of these data."
    said = diagnosis.headline(replace(made("unknown"), **asked))
    assert "massline knows" not in said
    assert "nothing of what was asked for (force-gain and cell-stiffness:2z) explains it" in said


def test_what_is_named_beside_what_is_left_stands_first(made):
    named = replace(made("unknown"), accepted=made("missing").accepted)
    said = diagnosis.headline(named)
    assert said.startswith(f"MISSING IN PART: {diagnosis.cause(named.accepted[0])}; and something is left")
    assert to_json(named)["verdict"] == "unknown"
    assert [one["id"] for one in to_json(named)["accepted"]] == [named.accepted[0].id]


@pytest.mark.parametrize("verdict", VERDICTS)
def test_the_text_of_json_is_never_empty(verdict, made):
    assert to_json(replace(made(verdict), text=""))["text"] == diagnosis.headline(made(verdict))


def test_what_the_data_say_of_a_cause_is_on_the_page_and_in_json(made):
    (one,) = made("mistake").accepted
    told = replace(one, note="its numbers are in g, and the file says m/s^2")
    assert ("these data say", told.note) in report_diagnose.explained(told).lines
    assert to_json(told)["note"] == told.note
    assert to_json(one)["note"] is None
    assert not any(line[0] == "these data say" for line in report_diagnose.explained(one).lines)
    assert to_json(Advice(test="weigh it", gain=3.0, hours=0.5))["hours"] == 0.5
    sure = [Advice(test="weigh it", gain=gain, separates=("a", "b"), hours=0.5).text for gain in (999.0, 1001.0)]
    assert [text.partition("expected ")[2] for text in sure] == [
        "999 nats between a and b",
        "more than 1000 nats between a and b",
    ]


def test_what_an_earlier_round_fitted_is_not_said_to_be_unfitted(made):
    several = made("several")
    (other, *_) = made("missing").accepted
    step = ReportedStep(added=other.id, ranking=(other,), misfit=1.0, price=1.0, text="")
    found = replace(several, ranking=(), equivalence_class=(other.id, "force-gain:fmd-z4"), steps=(step,))
    fitted, unfitted = report_diagnose.DiagnosisPage(found=found).alike().lines
    assert "was not fitted" not in fitted[1]
    assert f"{nats(other.evidence)} nats" in fitted[1]
    assert "was not fitted" in unfitted[1]


def test_what_a_fit_leaves_as_it_was_has_no_line_among_what_was_tried(made):
    of = made("missing")
    places = ("flange", "hub-1", "hub-2", "hub-3", "hub-4", "mast-top", "top", "top-1", "top-2")
    idle = [replace(of.ranking[0], named=parse(f"point-mass:{place}=1"), evidence=0.01) for place in places]
    shown = report_diagnose.DiagnosisPage(found=replace(of, ranking=(*of.ranking, *idle)))
    assert [row.id for row in shown.ranking().rows] == [one.id for one in of.ranking]
    assert not any("more effects were tried" in note for note in shown.notes())


@pytest.mark.parametrize(("verdict", "told"), [("nonlinear", False), ("mistake", False), ("missing", True)])
def test_evidence_gained_is_told_of_fits_only(verdict, told, made):
    errors = report_diagnose.DiagnosisPage(found=made(verdict)).errors()
    assert any(line[0].startswith("evidence gained") for line in errors.lines) == told


def test_two_levels_and_a_mistake_are_told_together_and_before_is_the_model_as_it_was(made, monkeypatch):
    seen: list[tuple[Any, Any]] = []
    monkeypatch.setattr(
        diagnosing,
        "errors_without_fit",
        lambda bench, offsets: seen.append((bench, offsets)) or made("missing").before,
    )
    found = replace(made("nonlinear"), text="Driven along x, two levels differ")
    wrong = made("mistake").accepted
    both = diagnosing.with_mistakes(BENCH, found, wrong)
    assert both.verdict == NONLINEAR
    assert [one.id for one in both.accepted] == ["polarity:fmd-z2", "friction:flange:x"]
    assert both.text == "Driven along x, two levels differ; beside that a mistake in the data: polarity:fmd-z2"
    assert seen == [(BENCH, {})]
    assert both.before is made("missing").before


def test_what_is_beside_a_mistake_is_said_in_words(made, monkeypatch):
    monkeypatch.setattr(diagnosing, "errors_without_fit", lambda bench, offsets: made("missing").before)
    wrong = made("mistake").accepted
    assert diagnosing.with_mistakes(BENCH, made("nothing"), wrong).text == ""
    assert "to confirm polarity:fmd-z2: " in diagnosing.with_mistakes(BENCH, made("nothing"), wrong).next_measurement
    said = diagnosing.with_mistakes(BENCH, replace(made("missing"), text=""), wrong).text
    assert said.startswith("Beside polarity:fmd-z2: MISSING: force-gain:fmd-z2")


def test_of_two_levels_only_what_is_asked_for_is_named(made, monkeypatch):
    (friction,) = made("nonlinear").accepted
    gap = replace(friction, named=parse("gap:1=500"), evidence=118.0)
    monkeypatch.setattr(diagnosing, "nonlinear", lambda bench, levels, progress: (friction, gap))
    monkeypatch.setattr(diagnosing, "errors_without_fit", lambda bench, offsets: made("missing").before)
    monkeypatch.setattr(diagnosing, "settings", lambda bench: {"method": "sine"})

    def named(**asked):
        return diagnosing.nonlinear_answer(BENCH, made("nonlinear").levels, quiet, **asked)

    assert named().equivalence_class == (friction.id, gap.id)
    assert [one.test.split(": ")[0] for one in named().advice] == [f"to confirm {friction.id}", f"to confirm {gap.id}"]
    for asked in ({"only": ("gap",)}, {"leave_out": ("friction",)}):
        found = named(**asked)
        assert [one.id for one in found.accepted] == [gap.id]
        assert [one.id for one in found.ranking] == [gap.id]
    assert named(only=("force-gain",)).accepted == ()
    assert named().settings["method"] == "sine"


def test_mistakes_are_left_out_where_that_is_asked_and_settings_say_what_was(made, monkeypatch):
    monkeypatch.setattr(diagnosing, "errors_without_fit", lambda bench, offsets: made("missing").before)
    monkeypatch.setattr(diagnosing, "mistakes", lambda of: made("mistake").accepted)
    monkeypatch.setattr(diagnosing, "differing_levels", lambda of: ("some",))
    monkeypatch.setattr(diagnosing, "nonlinear_answer", lambda of, levels, tell, **asked: made("nothing"))
    monkeypatch.setattr("validation.diagnose.candidates.candidates", lambda of, **asked: ())
    assert diagnosing.diagnosed(BENCH).verdict == "mistake"
    found = diagnosing.diagnosed(BENCH, only=("force-gain",), leave_out=("polarity",))
    assert found.verdict == NOTHING
    assert found.only == ("force-gain",)
    assert (found.settings["only"], found.settings["leave_out"]) == (["force-gain"], ["polarity"])


def test_of_what_is_left_a_share_that_nobody_knows_is_not_told(made):
    found = made("unknown")
    for share, told in ((0.83, True), (0.0, False)):  # "0 %", where all that is left is told by its tolerances
        grid = diagnose.DiagnosisPage(found=replace(found, leftover=replace(found.leftover, share=share))).leftover()
        assert ("share of it that this covers" in [line[0] for line in grid.lines]) == told


def test_beside_a_class_only_the_mistake_becomes_a_rung(made):
    wrong, unsure = made("mistake").accepted, made("ambiguous")
    both = replace(unsure, verdict="mistake", accepted=(*wrong, *unsure.accepted))
    assert climbing.new(both, BENCH.model) == wrong


def test_an_unknown_effect_is_told_with_what_its_own_fit_leaves(monkeypatch):
    monkeypatch.setattr(diagnosing, "goodness_of_fit", lambda fit, problem: SimpleNamespace(text="chi² is 9"))
    left: Any = SimpleNamespace(gain=50.0)
    bare: Any = SimpleNamespace(effects=(), fit=SimpleNamespace(converged=True), problem=None)

    def best(text):
        return SimpleNamespace(tried=(SimpleNamespace(id="gap:1", evidence=3.0, goodness=SimpleNamespace(text=text)),))

    said = diagnosing.text_of_unknown(bare, best("chi² is 4"), left)
    assert said == "As the model is, chi² is 9. With the closest, gap:1, chi² is 4"
    assert "3.0 nats better, which is not enough" in diagnosing.text_of_unknown(bare, best(""), left)


def test_each_of_several_is_confirmed_by_what_the_catalogue_knows(made):
    both = made("several").accepted
    told = [one.test for one in diagnosis.confirming(one.named for one in both)]
    assert told == [f"to confirm {one.id}: {one.confirmed_by}" for one in both]


@pytest.mark.parametrize(
    ("family", "key", "unit", "values", "expected"),
    [
        ("force-gain", "", "1", (0.0793, 0.0769, 0.0817), (("+7.93", "+7.69", "+8.17"), "%")),
        ("force-gain", "", "1", (-0.0793,), (("-7.93",), "%")),
        ("point-mass", "", "kg", (0.198, 0.190, 0.205), (("+198", "+190", "+205"), "g")),
        ("point-mass", "", "kg", (2.0,), (("+2.00",), "kg")),
        ("accelerometer-position", "", "m", (0.0195, 0.0188, 0.0202), (("+19.5", "+18.8", "+20.2"), "mm")),
        ("board-delay", "", "s", (1e-3, 0.98e-3, 1.02e-3), (("+1.000", "+0.980", "+1.020"), "ms")),
        ("force-delay", "", "s", (1e-4,), (("+100",), "µs")),
        ("cable", "", "N/m", (5012.0, 4900.0, 5100.0), (("5012", "4900", "5100"), "N/m")),
        ("joint-compliance", "", "rad/(N m)", (3.96e-6,), (("3.96",), "µrad/(N m)")),
        ("orientation", "", "rad", (0.05,), (("+2.86",), "°")),
        ("structural-damping", "", "1", (0.0103,), (("1.03",), "%")),
        ("load-path-shunt", "", "1", (0.04,), (("4.00",), "%")),
        ("fmd-compliance", "", "1", (10.0,), (("10.0",), "")),
        ("gravity", "", "1", (0.0,), (("0",), "")),
        ("appendage", "zeta", "1", (0.02,), (("0.0200",), "")),
        ("unit", "", "1", (0.0101972,), (("0.0102",), "")),
    ],
)
def test_sizes_stand_in_the_unit_and_with_the_digits_that_read_best(family, key, unit, values, expected):
    assert practical_units.written(family, key, unit, values) == expected


def test_an_interval_has_two_digits_of_its_width_and_a_degree_follows_its_figure_at_once():
    texts, _ = practical_units.written("cable", "", "N/m", (5000.0, 4999.4, 5000.6))
    assert texts == ("5000.0", "4999.4", "5000.6")
    assert practical_units.one("orientation", "", "rad", 0.05) == "+2.86°"
    assert practical_units.one("appendage", "f", "Hz", 21.0) == "21.0 Hz"
    assert practical_units.one("fmd-compliance", "", "1", 10.0) == "10.0"


FOUND = (
    Detectable(id="force-gain:fmd-z2", size=0.0149, unit="1"),
    Detectable(id="point-mass:hub-1", size=0.44, unit="kg"),
    Detectable(id="force-gain:fmd-x12", size=0.011, unit="1"),
    Detectable(id="accelerometer-delay:cover-z1", size=95e-6, unit="s"),
    Detectable(id="accelerometer-delay:cover-z2", size=96e-6, unit="s"),
    Detectable(id="appendage:z", size=0.0101, unit="kg", at="21 Hz"),
    Detectable(id="rigid-inertia:m", size=0.44, unit="kg"),
    Detectable(id="rigid-inertia:mx", size=0.012, unit="kg m"),
    Detectable(id="accelerometer-position:cover-z3:x", size=0.0025, unit="m"),
    Detectable(id="accelerometer-misalignment:cover-z3:x", size=0.0087, unit="rad"),
)


def test_smallest_sizes_stand_in_the_order_of_the_catalogue_units_apart_as_a_laboratory_says_them():
    lines = [tuple(cell.strip() for cell in line) for line in grid(FOUND).lines]
    assert [line[0] for line in lines if line[1] == ""] == ["structure", "force side", "acceleration side"]
    assert [line for line in lines if line[1]] == [
        ("point-mass", "440 g", "hub-1"),
        ("rigid-inertia", "440 g", "m"),
        ("rigid-inertia", "12 g m", "mx"),
        ("appendage", "10 g", "z, at 21 Hz"),
        ("force-gain", "1.1 % to 1.5 %", "fmd-x12 to fmd-z2, 2 in all"),  # the most and the least telling
        ("accelerometer-delay", "95 µs", "both alike"),
        ("accelerometer-position", "2.5 mm", "cover-z3:x"),
        ("accelerometer-misalignment", "0.50°", "cover-z3:x"),
    ]


def test_a_size_that_no_effect_can_have_is_said_not_to_be_seen():
    """A page said that a pick-up 2600 m beside its place, or one turned by 11000 degrees, would have been named."""
    sizes = {"position:a:x": 0.019, "position:a:y": 2600.0, "position:b:x": 0.02, "misalignment:a:x": 192.0}
    of = [Detectable(id=f"accelerometer-{name}", size=size, unit="rad" if "mis" in name else "m") for name, size in sizes.items()]
    assert [line[1:] for line in grid(of).lines[1:]] == [
        ("19 mm to 20 mm", "a:x to b:x, 3 in all, at no size at 1"),
        ("at no size    ", "a:x"),
    ]


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (0.9999, "kg", "1.0 kg"),
        (0.0996, "kg", "100 g"),
        (-0.0121, "m", "-12 mm"),
        (2e-6, "m/N", "2.0 µm/N"),
        (0.0, "s", "0 µs"),
        (3.0, "furlong", "3.0 furlong"),
    ],
)
def test_figures_keep_two_digits_and_no_zeros_in_front(value, unit, text):
    assert said(value, unit) == text


def box(of: Any) -> Any:
    return of.get_window_extent()


def texts(figure: Any) -> list[Any]:
    of_axes = [text for axes in figure.axes for text in (*axes.texts, *axes.get_yticklabels())]
    return [text for text in (*figure.texts, *of_axes) if text.get_text()]


@pytest.mark.parametrize("verdict", ["nothing", "ambiguous", "several"])
def test_everything_stays_on_the_page_and_off_each_other(verdict, drawn, made, tmp_path):
    diagnose.draw(made(verdict), tmp_path)
    assert len(drawn) == (2 if made(verdict).ranking or made(verdict).accepted else 1)
    for figure in drawn:
        page = figure.bbox
        for one in texts(figure):
            assert box(one).x0 >= page.x0, one.get_text()
            assert box(one).x1 <= page.x1, one.get_text()
        (legend,) = figure.legends
        assert not any(box(legend).overlaps(box(axes)) for axes in figure.axes)
        title = max(figure.texts, key=lambda text: box(text).y0)
        assert not box(legend).overlaps(box(title))


def test_many_causes_have_a_bar_and_a_size_each(drawn, made, tmp_path):
    first = made("missing").accepted[0]
    names = ["accelerometer-misalignment:cover-z1:x", "cable:upper-short-:lateral", "joint-compliance:rotation"]
    sizes = [0.1, 5000.0, 3e-6]
    more = [
        replace(first, named=parse(f"{name}={size}"), evidence=evidence, null=False)
        for name, size, evidence in zip(names, sizes, (28000.0, 0.4, 3.0), strict=True)
    ]
    diagnose.draw(replace(made("missing"), ranking=(first, *more)), tmp_path)
    axes = drawn[0].axes[0]
    assert len(axes.patches) == 4
    labels = [box(text) for text in axes.texts]
    assert len(labels) == 4
    assert not [pair for pair in combinations(labels, 2) if pair[0].overlaps(pair[1])]
    assert all(one.x1 <= drawn[0].bbox.x1 for one in labels)
    assert axes.get_xlim()[1] > 28000.0
    against = replace(made("nothing"), ranking=tuple(replace(one, evidence=-one.evidence) for one in more))
    diagnose.draw(against, tmp_path)  # what data speak against is not drawn
    assert len(drawn) == 3


def test_where_nothing_was_found_there_is_no_after_and_what_is_asked_for_is_drawn_where_it_is_said(drawn, made, tmp_path):
    found = made("nothing")
    diagnose.draw(replace(found, after=found.before), tmp_path)
    labels = [text.get_text() for text in drawn[-1].legends[0].get_texts()]
    assert labels == ["due, nothing wrong"]
    assert diagnose.asked(made("missing")) == 8.0
    assert diagnose.asked(replace(made("missing"), settings={})) is None
