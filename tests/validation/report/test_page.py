"""The page says what the commands say, shows what data have, obeys no title and asks nobody for anything."""

import json
import re
import shlex
import tomllib
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from identification.campaign import Instrument
from validation.estimation.verdicts import STANDS_OUT
from validation.history.history import Body, digest
from validation.model.model import Requirement
from validation.output import to_json
from validation.report import diagnose, identify, page
from validation.report.document import Figures
from validation.report.page import SECTIONS, html
from validation.study import Options

SAME = 1e-12
"""Figures are the same, but for the last digit of a unit."""

LOADS = ("src", "href", "data", "action", "srcset", "poster", "formaction", "xlink:href")
"""Attributes by which an element may ask for something."""


def test_every_section_is_there_once_the_contents_lead_to_it_and_controls_and_pictures_have_names(read):
    ids = {given.get("id") for _, given in read.elements}
    links = [given["href"] for tag, given in read.elements if tag == "a" and given.get("href", "").startswith("#")]
    every = {name for name, _, _ in SECTIONS} - {"functions"}  # which a base test has not
    assert ids >= every
    assert {f"#{name}" for name in every} <= set(links)
    assert {link.removeprefix("#") for link in links} <= ids
    ids = [given["id"] for _, given in read.elements if given.get("id")]
    assert len(ids) == len(set(ids))
    assert all(given.get("alt") for tag, given in read.elements if tag == "img")
    assert all(given.get("aria-label") for _, given in read.elements if given.get("role") in ("img", "region"))
    assert all(given.get("scope") for tag, given in read.elements if tag == "th")


def test_nothing_on_the_page_leads_out_of_it(read, page):
    asked = [given[name] or "" for _, given in read.elements for name in LOADS if given.get(name)]
    assert asked
    assert all(one.startswith(("#", "data:image/png;base64,")) for one in asked)
    policy = next(given["content"] for tag, given in read.elements if given.get("http-equiv") == "Content-Security-Policy")
    assert "default-src 'none'" in policy
    style = re.search(r"<style>(.*?)</style>", page.read_text("utf-8"), re.DOTALL)
    assert "url(" not in style.group(1)
    assert "@import" not in style.group(1)


def test_titles_of_others_are_shown_to_the_letter_and_make_no_element(read, hostile):
    assert read.text.count(hostile) >= 3  # model, campaign, measurement
    assert not [given for tag, given in read.elements if given.get("onerror") or given.get("src") == "x"]


def test_the_summary_has_five_sentences_with_verdicts(page):
    summary = re.search(r'<ol class="summary">(.*?)</ol>', page.read_text("utf-8"), re.DOTALL)
    items = re.findall(r"<li>(.*?)</li>", summary.group(1), re.DOTALL)
    assert len(items) == 5
    assert "FAILED" in items[1]
    assert "MISSING: force-gain:fmd-z2" in items[3]


def test_errors_and_spots_are_those_of_compare(read, series, run):
    code, out, _ = run("compare", str(series.model), *series.data, "--hold-out", "z", "--json")
    assert code == 0
    said = json.loads(out)
    errors = read.table("The four errors")
    pairs = {
        "nominal error": "nominal_error_percent",
        "plain error": "plain_error_percent",
        "fitted error, χ² per degree of freedom": "fitted_chi2_per_dof",
        "its prior penalty, the sum of z² of the tolerances": "tolerance_z2",
        "held-out error": "held_out_error_percent",
    }
    assert_allclose([errors.row(name)[1] for name in pairs], [said[key] for key in pairs.values()], rtol=SAME)
    spots = read.table("The worst spots")
    worst = [one for one in said["worst"] if one["sigma"] >= STANDS_OUT]  # chance makes the others
    assert 0 < len(worst) < len(said["worst"])
    assert [row[1:4] for row in spots.values[1:]] == [[one["sigma"], one["percent"], one["frequency_hz"]] for one in worst]
    assert [row[-1] for row in spots.rows[1:]] == [one["text"] for one in worst]


def test_causes_are_those_of_diagnose(read, report):
    assert report.diagnosis is not None
    said = to_json(report.diagnosis)
    assert said["settings"]["hold_out"] == ["z"]
    shown = read.table("Causes that were tried, the best first").row("force-gain:fmd-z2")
    (found,) = said["accepted"]
    assert shown[1] == found["evidence_nats"]
    assert_allclose([shown[k] for k in (3, 4, 5)], [100 * one for one in (found["value"], *found["interval90"])], atol=0.06)
    assert found["text"] in read.text
    assert said["next_measurement"] in read.text
    before = read.table("The errors before and after what was found is added").row("plain error, fitted data")
    told = [said["errors"]["plain_before_percent"], said["errors"]["plain_after_percent"]]
    assert before[2:] == told


@pytest.mark.proof  # an identification beside the report's; the stored answers have both
def test_identified_inertia_is_that_of_identify(read, series, answer):
    said = answer("identify", str(series.campaign), "--no-study")
    table = next(one for one in read.tables if one.caption.startswith("fmd+cuboid: mass, CoG and inertia,"))
    mass = table.row("Mass m")
    best = said[said["result"].replace("-", "_")]
    assert_allclose(mass[7], best["inertia"]["mass_kg"], rtol=SAME)
    assert_allclose(mass[8], max(abs(end - mass[7]) for end in best["interval95"]["mass_kg"]), rtol=1e-9)


def test_the_reference_is_that_of_reference_with_the_weighing_beside_it(read, run):
    code, out, _ = run("reference", "cuboid", "--json")
    assert code == 0
    routes = json.loads(out)["articles"]["cuboid"]["routes"]
    table = read.table("cuboid: mass, CoG and inertia")
    mass = table.row("Mass m")
    assert_allclose(mass[2:5], [routes[name]["mass_kg"] for name in ("occ", "trimesh", "pinocchio")], rtol=1e-12)
    assert mass[5:] == [12.09, 0.01]
    assert table.row("CoG z")[5:] == [None, None]
    outside = read.table("cuboid: deviation from the reference and verdict").row("Mass m")
    assert_allclose(outside[5], (12.09 - mass[2]) / 0.01, atol=0.01)


def test_the_ladder_shows_every_rung_and_where_everything_comes_from_is_said(read, report, series):
    rungs = read.table("Rungs")
    assert [row[0] for row in rungs.rows[1:]] == ["0", "1 (here)"]
    assert [row[4] for row in rungs.values[1:]] == [4.1, 0.7]
    inputs = read.table("Inputs")
    assert [row[1] for row in inputs.rows[1:]] == [digest(str(path)) for path in (series.model, series.campaign, series.scale)]
    for program in ("massline", "numpy", "Python", "plotly"):
        assert re.search(rf"Versions: .*\b{program} \d", read.text)
    assert [row[0] for row in read.table("Settings").rows[1:]] == ["random numbers", "spectra", "band [Hz]", "held out"]
    assert "massline report cuboid.toml gain" in read.text
    assert "none: the same data give the same answer" in read.text


def test_the_files_that_a_study_names_are_inputs_and_those_that_these_name(tmp_path):
    (tmp_path / "bridge.bdf").write_text("BEGIN BULK\n")
    (tmp_path / "bridge.toml").write_text('[fe_model]\nkind = "mesh"\nfile = "bridge.bdf"\nunits = "m-kg-N-s"\n')
    (tmp_path / "before.toml").write_text("frequencies = [3.1]\n")
    (tmp_path / "after.toml").write_text('before = "before.toml"\nfrequencies = [3.0]\n')
    (tmp_path / "study.toml").write_text('[structure]\nown = { bridge = "bridge.toml" }\n[[test]]\nfile = "nowhere.csv"\n')
    asked = Options(model=str(tmp_path / "study.toml"), data=(str(tmp_path / "after.toml"), str(tmp_path / "before.toml")))
    made = page.provenance(page.ReportOptions(compared=asked, diagnosis=False))
    told = {Path(one.path).name: one.digest for one in made.inputs}
    assert list(told) == ["study.toml", "after.toml", "before.toml", "bridge.toml", "bridge.bdf"]
    assert told["bridge.bdf"] == digest(str(tmp_path / "bridge.bdf"))


def test_code_of_the_user_and_the_browser_that_prints_are_said(series, tmp_path, monkeypatch):
    (tmp_path / "mine.py").write_text("FAMILY = None")
    (tmp_path / "browser").write_text("#!/bin/sh\necho Brow 7.1\n")
    (tmp_path / "browser").chmod(0o755)
    monkeypatch.setattr(page, "SOURCES", {"mine": str(tmp_path / "mine.py"), "theirs": "entry point theirs"})
    monkeypatch.setenv(page.BROWSER, str(tmp_path / "browser"))
    made = page.provenance(page.ReportOptions(compared=series.asked, pdf=True, diagnosis=False))
    assert made.inputs[-1].path == str(tmp_path / "mine.py")
    assert made.settings["effects of the user's own"] == [f"mine ({tmp_path}/mine.py)", "theirs (entry point theirs)"]
    assert made.versions["browser that prints"] == "Brow 7.1"
    words = ["massline", "report", str(series.model), *series.data, "--hold-out", "z", "--no-diagnosis"]
    assert shlex.split(made.command) == words


def test_every_library_that_reads_computes_or_draws_has_its_version(root):
    project = tomllib.loads((root / "pyproject.toml").read_text("utf-8"))["project"]
    extras = [one for name in ("cad", "fem", "pictures", "app") for one in project["optional-dependencies"][name]]
    declared = [*project["dependencies"], *extras]
    names = {re.split(r"[<>=~ \[]", one)[0] for one in declared}
    faces = {"click", "rich", *(one for one in names if one.startswith("trame"))}
    assert names - faces <= set(page.PROGRAMS)


def test_what_nobody_asked_for_is_said_instead_of_shown(report, parsed):
    bare = replace(
        report, diagnosis=None, not_diagnosed="--no-diagnosis", standing=None, articles=(), campaigns=report.campaigns[:0]
    )
    page = parsed(html(bare))
    ids = {given.get("id") for _, given in page.elements}
    assert "It was not looked for: --no-diagnosis." in page.text
    assert not ids & {"articles", "sensors", "condition", "inertia", "ladder"}
    assert ids >= {"modes", "dynamic-mass", "where", "missing", "provenance"}
    assert "spectra" not in dict(page.table("Settings").rows)


def test_what_is_said_is_said_once_and_options_of_commands_are_no_findings(report, parsed):
    remark = "pick-up z1 is loose"
    told = replace(report.diagnosis, remarks=(remark,), text="")
    assert told.detectable or told.known_better or told.ranking
    page = parsed(html(replace(report, comparison=replace(report.comparison, remarks=(remark,)), diagnosis=told)))
    found = page.text.rpartition("Provenance")[0]
    assert found.count(remark) == 1
    assert "--json" not in found
    assert "JSON and CSV" not in found
    assert not re.search("Χ|of 1 runs|those of data", found)


@pytest.mark.parametrize("verdict", ["nothing", "unknown", "ambiguous", "several", "mistake"])
def test_every_verdict_has_its_page(report, verdict, parsed):
    found = report.diagnosis
    alike = ("force-gain:fmd-z2", "cell-stiffness:2z") if verdict == "ambiguous" else ()
    accepted = () if verdict in ("nothing", "unknown") else found.accepted
    told = replace(found, verdict=verdict, accepted=accepted, equivalence_class=alike)
    page = parsed(diagnose.html(replace(report, diagnosis=told), Figures()))
    assert any(one.caption == "The errors before and after what was found is added" for one in page.tables)
    assert any(one.caption == "What these data cannot tell apart" for one in page.tables) == bool(alike)


def body(mass: float) -> Body:
    """A Cuboid that is identified to 1 % of its mass and to a tenth of the rest."""
    reference = np.array([12.09, 0.0, 0.0, 0.2, 0.166, 0.187, 0.031, 0.0, 0.0, 0.0])
    deviation = np.array([0.12, *3 * (1e-3,), 0.016, 0.018, 0.003, *3 * (0.001,)])
    values = reference + np.array([mass - 12.09, *3 * (5e-4,), *6 * (1e-4,)])
    return Body(article="cuboid", values=values, deviation=deviation, reference=reference)


def test_the_inertia_with_the_effects_of_the_model_stands_first_in_summary_and_section(report, parsed):
    comparison = replace(report.comparison, effects=("force-gain:fmd-z2",))
    page = html(replace(report, comparison=comparison, identified=(body(12.2),)))
    summary = page[page.index('<ol class="summary">') : page.index("</ol>", page.index('<ol class="summary">'))]
    said = parsed(summary[summary.rindex("<li>") :]).text
    first, raw = (
        said.index("with the effects of the model: cuboid weighs 12.20 ± 0.24 kg (95 %), the model 12.09"),
        said.index("raw"),
    )
    assert first < raw < said.index("fmd+cuboid, the FMD's moving part included, weighs")
    assert "all ten values inside their intervals" in said
    tables = parsed(page).tables
    captions = [one.caption for one in tables]
    own = "cuboid, with the effects of the model: mass, CoG and inertia"
    records = next(one for one in captions if one.startswith("fmd+cuboid: mass, CoG and inertia,"))
    assert records.endswith("raw records")
    assert captions.index(own) < captions.index(records)
    mass = tables[captions.index(own)].row("Mass m")
    assert_allclose(mass[2:6], [12.2, 1.959964 * 0.12, 12.09, 0.11], rtol=1e-6)


def test_a_drawing_is_known_as_well_as_the_laboratory_says(report):
    (part,) = report.campaigns

    def tolerances(share):
        model = replace(report.model, mounting=replace(report.model.mounting, inertia=share))
        drawn = identify.drawing_beside(part.findings, model, [])
        return np.array([[one.value, one.tolerance or 0.0] for one in drawn.values])

    exact, admitted = tolerances(0.0), tolerances(0.002)
    wide = 1.959964 * 0.002 * np.abs(exact[:, 0])
    wide[[1, 2, 3, 7, 8, 9]] = 0.0  # where the CoG lies the share does not say
    assert wide[0] > 0
    assert_allclose(admitted[:, 1], np.hypot(exact[:, 1], wide), rtol=1e-6)


def test_an_inertia_outside_its_interval_is_said_so(report, parsed):
    page = html(replace(report, identified=(body(13.2),)))
    assert (
        "with the model, which has no effects: cuboid weighs 13.20 ± 0.24 kg (95 %), the model 12.09, OUTSIDE"
        in parsed(page).text
    )
    assert "1 of the ten values outside their intervals" in parsed(page).text


def test_a_cause_that_the_model_lacks_is_said_beside_the_inertia_that_does_not_know_it(read):
    assert "Nothing of this knows force-gain:fmd-z2 yet, which the model lacks: massline add adds it." in read.text


def test_why_no_inertia_was_identified_with_the_effects_is_said(report, parsed):
    text = parsed(html(replace(report, not_identified="the fit ended nowhere"))).text
    assert text.count("With the effects of the model no inertia was identified: the fit ended nowhere") == 2


def test_what_is_required_is_judged_by_the_whole_interval_and_what_nobody_stated_is_a_line_to_write_on(report, parsed):
    stated = {"mass": (11.9, 12.5), "cog_z": (None, 0.19), "moi_xx": (0.17, None)}  # inside; wholly outside; within the interval
    asked = tuple(Requirement(quantity=name, low=low, high=high) for name, (low, high) in stated.items())
    model = replace(report.model, requirements=asked, article="fmd+cuboid", revision="B")
    narrow = replace(body(12.2), deviation=np.array([0.12, *3 * (1e-3,), 0.016, 0.018, 0.003, *3 * (0.001,)]))
    page = html(replace(report, model=model, identified=(narrow,)))
    rows = {row[0]: row for row in next(one for one in parsed(page).tables if "Requirements" in one.caption).rows}
    assert [rows[name][-2] for name in ("Mass m", "CoG z", "MoI Θxx")] == ["PASS", "FAIL", "OPEN"]
    assert "1 of 3 met" in page
    head = page[page.index("<header") : page.index('class="signatures"')]
    assert head.count('class="blank"') >= 4  # place, operator, serial number, date: the campaign of the tests states none


def test_an_instrument_that_was_due_before_the_test_is_said_so(report, parsed):
    part = report.campaigns[0]
    tools = (Instrument(name="cell", due="2026-03-01"), Instrument(name="logger", due="2027-03-01"))
    tested = replace(part.campaign, date="2026-03-31", operator="B. Tester", instruments=tools)
    text = html(replace(report, campaigns=(replace(part, campaign=tested),)))
    assert text.count("its calibration had run out") == 1
    assert "B. Tester" in parsed(text).text


@pytest.mark.parametrize(
    ("read", "percents", "words"),
    [
        (["acceleration", "force"], 3.0, "misses the measured forces by 3 % "),
        (
            ["acceleration"],
            3.0,
            "misses what was measured by 3 % ",
        ),  # a table that shakes, with nothing below: "forces" had been said
        ([], 0.0, "misses what was measured by no more than noise makes, 0 % "),
    ],
)
def test_what_was_missed_is_what_was_read_and_a_zero_says_what_it_means(read, percents, words):
    table = SimpleNamespace(channels=[SimpleNamespace(quantity=one) for one in read])
    plain = SimpleNamespace(percent=percents, verdict="good")
    found = SimpleNamespace(errors=(None, plain, None, None), evaluation=SimpleNamespace(plain=plain, held_out=None))
    campaigns = [SimpleNamespace(campaign=SimpleNamespace(table=table))] if read else []
    said = page.ReportSummary(report=SimpleNamespace(comparison=found, campaigns=campaigns)).errors()
    assert f"With the sensors as calibrated it {words}" in said
