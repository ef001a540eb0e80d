"""Tests of a user's own frame from the command line, and the league: a hidden modulus in response functions of a closed form."""

import os
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from validation.report.fleet import League, RealSet, Result

E, WIDTH, THICKNESS, HEIGHT, MASS, LOSS = 70e9, 0.025, 0.003, 0.15, 5.0, 0.02
HIDDEN = -0.2
"""Relative change of the modulus of the second storey."""

TEST = """\
kind = "response-functions"
article = "frame"
band = [3.0, 40.0]
responses = ["floor-1:x", "floor-2:x", "floor-3:x"]
files = [{ path = "one.csv", drive = "floor-1:x" }, { path = "three.csv", drive = "floor-3:x" }]
"""
FILE = "lab.toml"


def springs(change: float = 0.0, third: float = 0.0) -> np.ndarray:
    """(3,) [N/m] of the storeys: 12 E I / L³ of a leg that is clamped at both ends, four times."""
    one = 4 * 12 * E * (WIDTH * THICKNESS**3 / 12) / HEIGHT**3
    return one * np.array([1.0, 1.0 + change, 1.0 + third])


def matrices(change: float = 0.0, third: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    k1, k2, k3 = springs(change, third)
    return np.array([[k1 + k2, -k2, 0], [-k2, k2 + k3, -k3], [0, -k3, k3]]), MASS * np.eye(3)


def write_functions(folder: Path, change: float = HIDDEN, third: float = 0.0) -> None:
    """Accelerances of a chain of three masses, of which no code of ours knows, with noise of half a per cent."""
    rng, f = np.random.default_rng(20), np.arange(3.0, 40.0, 0.1)
    K, M = matrices(change, third)
    H = np.array([-(w**2) * np.linalg.inv(K * (1 + 1j * LOSS) - w**2 * M) for w in 2 * np.pi * f])
    for name, drive in (("one.csv", 0), ("three.csv", 2)):
        rows = H[:, :, drive]
        rows = rows * (1 + 0.005 * (rng.standard_normal(rows.shape) + 1j * rng.standard_normal(rows.shape)) / np.sqrt(2))
        lines = (
            ",".join(f"{x:.9g}" for x in [at, *row.view(float)]) for at, row in zip(f, np.ascontiguousarray(rows), strict=True)
        )
        (folder / name).write_text("frequency," + ",".join(f"r{k},i{k}" for k in (1, 2, 3)) + "\n" + "\n".join(lines) + "\n")


@pytest.fixture
def lab(tmp_path: Path, three_floors: Callable[..., str]) -> Path:
    """A model file with its test beside the data, the modulus of one storey hidden in them."""
    write_functions(tmp_path)
    (tmp_path / FILE).write_text(three_floors() + "[[test]]\n" + TEST, encoding="utf-8")
    return tmp_path


def plain_words(text: str) -> str:
    return re.sub(r"\s+", " ", text)


@pytest.mark.proof  # the league's own test below names the same modulus of the same data
def test_a_hidden_modulus_is_found_by_diagnose_among_all_parts_places_and_gains(lab, answer):
    found = answer("diagnose", FILE)
    assert found["verdict"] == "ambiguous"  # ends of the legs that give are the same to floors that move along x alone
    best = found["accepted"][0]
    assert best["id"] == "modulus:legs-2"
    assert_allclose(best["value"], HIDDEN, rtol=0.05)  # gains and frequencies, known to per cents, share in it


def test_two_storeys_that_are_softer_are_both_named_and_added(lab, answer):
    write_functions(lab, HIDDEN, third=-0.3)
    found = answer("diagnose", FILE, "--candidate", "modulus", "--auto")
    assert found["verdict"] == "several"
    sizes = {one["id"]: one["value"] for one in found["accepted"]}
    assert sizes == {"modulus:legs-2": pytest.approx(HIDDEN, rel=0.1), "modulus:legs-3": pytest.approx(-0.3, rel=0.1)}
    added = [rung["effect"] for rung in answer("ladder", FILE, "--no-plot")["rungs"][1:]]
    assert sorted(added) == sorted(sizes)


def test_with_the_effect_the_error_falls_on_data_held_out_and_undo_takes_it_back(lab, run, answer):
    before = (lab / FILE).read_bytes()
    assert_allclose(answer("add", FILE, "modulus:legs-2")["effect"]["value"], HIDDEN, rtol=0.05)
    percents = [rung["errors"]["plain_percent"] for rung in answer("ladder", FILE, "--no-plot")["rungs"]]
    assert percents[1] < percents[0] / 5
    code, out, _ = run("ladder", FILE, "--no-plot")
    assert code == 0
    assert "Per cent of what is read." in out
    assert "CoG" not in out
    assert run("undo", FILE)[0] == 0
    assert (lab / FILE).read_bytes() == before


def test_what_is_printed_and_reported_knows_no_fmd_and_no_campaign(lab, run):
    code, out, _ = run("compare", FILE, "--out", "out")
    assert code == 0
    assert "floor-" in out
    assert "FMD" not in out
    assert sorted(path.name for path in (lab / "out").glob("*.png")) == [
        "compare-errors.png",
        "compare-lab-channels.png",
        "compare-runs.png",
    ]
    assert run("report", FILE, "--no-diagnosis", "--out", "page.html")[0] == 0
    html = (lab / "page.html").read_text(encoding="utf-8")
    page = plain_words(re.sub(r"<script.*?</script>|<[^>]+>", " ", html, flags=re.S))
    sheet = html.partition('id="functions"')[2]
    assert 'class="plot"' in sheet.partition("</section>")[0]  # all six functions, drawn
    assert "held against 1 data set of 2 runs" in page
    assert "misses what was measured by" in page
    assert "No inertia was identified: that takes motions of a base" in page


BRIEF = ("--candidate", "modulus", "--candidate", "point-mass")


@pytest.mark.parametrize("only", [BRIEF, pytest.param((), id="all families", marks=pytest.mark.proof)])
def test_a_table_of_modes_is_told_by_mode_and_without_a_frequency_of_its_mean(tmp_path, three_floors, run, only):
    K, M = matrices(HIDDEN)
    squares, shapes = np.linalg.eigh(K / M[0, 0])
    hertz = ", ".join(f'"{f:.6g} +/- {f / 1000:.3g} Hz"' for f in np.sqrt(squares) / (2 * np.pi))
    rows = ", ".join(str([round(float(x), 6) for x in shape]) for shape in shapes.T)
    (tmp_path / FILE).write_text(three_floors(), encoding="utf-8")
    (tmp_path / "table.toml").write_text(
        'format = 1\nkind = "modal-table"\narticle = "frame"\nsensors = ["floor-1:x", "floor-2:x", "floor-3:x"]\n'
        f"frequencies = [{hertz}]\nshapes = [{rows}]\nshapes_deviation = 0.01\n",
        encoding="utf-8",
    )
    code, out, err = run("compare", FILE, "table.toml", "--out", "out")
    assert code == 0, err
    assert "frequency in mode 3 of table frequencies" in plain_words(out)
    assert "nan" not in out
    assert not re.search(r"mode \d of table frequencies, [\d.]+ Hz", out)
    code, out, err = run("diagnose", FILE, "table.toml", *only)
    assert code == 0, err
    assert "modulus:legs-2" in out
    assert " MAC" in out  # what analysts deliver, beside what is missing


@pytest.mark.parametrize(
    ("right", "wrong", "words"),
    [
        ("band", "bands", ("bands", "band")),
        ('article = "frame"\nband', 'article = "tower"\nband', ("tower", FILE)),
        ("floor-3:x", "floor-4:x", ("floor-4", "floor-3")),
        ("three.csv", "four.csv", ("four.csv",)),
        ("section", "sections", ("sections", "section")),
        ('fixed = ["foot"]', 'fixed = ["feet"]', ("feet", "foot")),
    ],
)
def test_what_cannot_be_used_is_refused_by_name(lab, refused, right, wrong, words):
    whole = (lab / FILE).read_text(encoding="utf-8")
    (lab / FILE).write_text(whole.replace(right, wrong), encoding="utf-8")
    text = plain_words(refused("compare", FILE))
    for word in words:
        assert word in text


@pytest.mark.parametrize("command", ["compare", "diagnose", "report"])
def test_without_data_and_without_a_test_in_the_model_it_says_what_to_name(lab, three_floors, refused, command):
    (lab / FILE).write_text(three_floors(), encoding="utf-8")
    assert "the model names no [[test]]" in refused(command, FILE)


LEAGUE = """format = 1
[[set]]
name = "made"
study = "lab.toml"
expected = "the second storey is softer"
tuned_on = false
[[set]]
name = "elsewhere"
study = "none.toml"
expected = "nothing"
tuned_on = true
"""


def test_the_league_diagnoses_what_is_here_and_says_what_is_not(lab, run, answer, monkeypatch):
    monkeypatch.setenv("MASSLINE_DATA", os.environ.get("MASSLINE_DATA", ""))  # the command sets it
    (lab / "made").mkdir()
    (lab / "league.toml").write_text(LEAGUE, encoding="utf-8")
    found = answer("league", "--data", ".", "--studies", ".")
    assert found["absent"] == ["elsewhere"]
    made = found["sets"]["made"]
    assert (made["verdict"], made["accepted"], made["tuned_on"]) == ("ambiguous", ["modulus:legs-2"], False)
    assert made["error_after_percent"] < made["error_before_percent"] / 5


def test_a_line_of_the_league_is_short_and_its_sentences_stand_below():
    """All that was expected and said stood in one cell of eight lines; where there is no error before, there is no column."""
    entry = RealSet(name="made", study=Path("lab.toml"), expected="the storey is softer", tuned_on=False)
    text = League(results=(Result(entry=entry, verdict="nothing", said="NOTHING IS MISSING", after=9.5e-11),)).document().text(80)
    (line,) = [line for line in text.splitlines() if line.startswith(" made ")]
    assert line.split() == ["made", "nothing", "0", "no"]
    assert "made: expected: the storey is softer. Said: NOTHING IS MISSING." in text


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (LEAGUE.replace("expected", "hoped", 1), "hoped"),
        (LEAGUE.replace('study = "lab.toml"\n', ""), "study"),
        (LEAGUE.replace("format = 1", "format = 7"), "format"),
    ],
)
def test_a_league_that_cannot_be_read_is_refused_by_key(lab, refused, monkeypatch, text, words):
    monkeypatch.setenv("MASSLINE_DATA", os.environ.get("MASSLINE_DATA", ""))
    (lab / "league.toml").write_text(text, encoding="utf-8")
    assert words in refused("league", "--data", ".", "--studies", ".")


def test_a_set_that_nobody_knows_and_data_that_are_not_there_are_refused(lab, refused, monkeypatch):
    monkeypatch.setenv("MASSLINE_DATA", os.environ.get("MASSLINE_DATA", ""))
    (lab / "league.toml").write_text(LEAGUE, encoding="utf-8")
    assert "There are made, elsewhere" in plain_words(refused("league", "mode", "--data", ".", "--studies", "."))
    assert "docs/league.md" in refused("league", "--data", ".", "--studies", ".")


@pytest.mark.proof  # comparing/test_correlation.py says both of a few modes; a study in fifteen lines is the lab's above
@pytest.mark.parametrize(
    ("study", "said"),
    [
        ("footbridge", "mode 1 and mode 2 have changed places"),
        *(
            (study, "MAC does not see frequencies")
            for study in ("shear-building", "three-storey-frame", "shear-building-weights")
        ),
    ],
)
def test_a_study_of_real_data_is_fifteen_lines_that_compare(study, said, root, data, run, monkeypatch):
    monkeypatch.setenv("MASSLINE_DATA", str(data))
    path = root / "examples" / "league" / f"{study}.toml"
    code, out, err = run("compare", str(path))
    assert code == 0, err
    assert "nominal error" in out
    assert "FMD" not in out
    assert said in plain_words(out)  # what analysts deliver stands beside the sigmas, and where it is green and wrong it is said


def bars_of_footbridge(found: dict) -> None:
    assert found["accepted"] == ["support-stiffness:y1"]
    assert found["first"][:2] == ["support-stiffness:y1", "support-stiffness:y2"]
    assert found["error_after_percent"] < found["error_before_percent"] / 2


def bars_of_three_storey_frame(found: dict) -> None:
    assert "connection-compliance:all@every:beta" in found["accepted"] or "connection-compliance:every:beta" in found["class"]
    assert not any(id.startswith("point-mass") for id in found["accepted"])
    assert found["error_after_percent"] < 10


def bars_of_shear_building(found: dict) -> None:
    assert "gravity-stiffness" in found["accepted"]
    assert not any(id.startswith("point-mass") for id in found["accepted"])
    assert "walls-1" in found["left"]


def bars_of_shear_building_weights(found: dict) -> None:
    named = set(found["accepted"])
    assert {"point-mass:floor-1", "point-mass:floor-2"} < named
    assert any(id.startswith("connection-compliance") for id in named)
    assert "point-mass:floor-3" not in named
    assert found["error_after_percent"] < found["error_before_percent"] / 4


@pytest.mark.proof
@pytest.mark.parametrize(
    "bars", [bars_of_footbridge, bars_of_three_storey_frame, bars_of_shear_building, bars_of_shear_building_weights]
)
def test_of_a_real_set_the_league_names_what_is_expected_and_says_what_is_left(data, root, answer, monkeypatch, bars):
    monkeypatch.setenv("MASSLINE_DATA", os.environ.get("MASSLINE_DATA", ""))
    name = bars.__name__.removeprefix("bars_of_")
    found = answer("league", name, "--data", str(data), "--studies", str(root / "examples" / "league"))["sets"][name]
    assert found["verdict"] == "unknown"  # not by these effects alone
    assert found["left"]
    bars(found)


@pytest.mark.proof
def test_all_bicycles_and_tools_are_as_published(data, root, answer, monkeypatch):
    monkeypatch.setenv("MASSLINE_DATA", os.environ.get("MASSLINE_DATA", ""))
    bicycles = [f"bicycle_{name}" for name in ("browser", "fisher", "pista", "yellow")]
    tools = ["tool_allen_key", "tool_box_wrench", "tool_machinist_hammer"]
    found = answer("league", *bicycles, *tools, "--data", str(data), "--studies", str(root / "examples" / "league"))["sets"]
    assert [one["verdict"] for one in found.values()] == [*["nothing"] * 6, "unknown"]
    assert all(found[name]["error_after_percent"] < 1e-8 for name in bicycles)


def test_bicycles_and_tools_stand_in_the_same_table(data, root, answer, run, monkeypatch):
    monkeypatch.setenv("MASSLINE_DATA", os.environ.get("MASSLINE_DATA", ""))
    where = ["bicycle_pista", "tool_machinist_hammer", "--data", str(data), "--studies", str(root / "examples" / "league")]
    found = answer("league", *where)["sets"]
    assert [one["verdict"] for one in found.values()] == ["nothing", "unknown"]
    assert found["bicycle_pista"]["error_after_percent"] < 1e-8
    assert "CoG y" in found["tool_machinist_hammer"]["left"]  # of two materials, taken as one density
    printed = plain_words(run("league", *where)[1])
    for words in ("not one density", "Iyy as published", "1760.0 standard deviations"):
        assert words in printed


def test_periods_that_do_not_give_what_is_published_are_said(data, root, tmp_path, answer, monkeypatch):
    monkeypatch.setenv("MASSLINE_DATA", os.environ.get("MASSLINE_DATA", ""))
    shipped = root / "examples" / "league"
    for name in ("bicycle-pista.toml", "bicycle-pista-published.toml"):
        (tmp_path / name).write_text(
            (shipped / name).read_text(encoding="utf-8").replace('Iyy = { value = "0.1', 'Iyy = { value = "0.2')
        )
    entry = (shipped / "league.toml").read_text(encoding="utf-8").partition('name = "bicycle_pista"')[2].partition("[[set]]")[0]
    (tmp_path / "league.toml").write_text('format = 1\n[[set]]\nname = "bicycle_pista"' + entry, encoding="utf-8")
    made = answer("league", "--data", str(data), "--studies", str(tmp_path))["sets"]["bicycle_pista"]
    assert made["verdict"] == "unknown"
    assert "beyond its tolerance" in made["said"]
