"""A fleet of nominally equal articles: which differs, by what, and how they scatter."""

import json
import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import massline
from geometry.errors import BadInput
from validation.cli import main
from validation.diagnose import diagnose, fleet
from validation.diagnose.diagnosis import EffectEstimate
from validation.diagnose.fleet import ERROR, Fleet, Member, MemberAnswer, Numbers
from validation.report.fleet import FleetPage

GAIN = "force-gain:fmd-z2"


def numbers(values: np.ndarray, mountings: int = 1, laboratories: int = 1) -> Numbers:
    """Of articles with so many mountings each, which are measured in so many laboratories in turn."""
    n = len(values)
    return Numbers(values=values, articles=np.arange(n) // mountings, laboratories=np.arange(n) % laboratories)


def test_equal_articles_are_said_to_differ_in_as_few_fleets_as_promised_and_outliers_are_found() -> None:
    random = np.random.default_rng(3)
    for articles in (5, 15):
        false = sum(bool(numbers(random.normal(size=articles)).different()) for _ in range(400))
        assert false <= 400 * fleet.FALSE_ALARM + 3 * (400 * fleet.FALSE_ALARM) ** 0.5
    values = random.normal(size=200)
    values[[7, 90, 151]] += (9, -9, 12)
    found = numbers(values).different()
    assert set(found) == {"7", "90", "151"}
    assert found["90"] < 0
    assert numbers(np.zeros(9)).different() == {}


def test_contributions_of_articles_mountings_and_laboratories_are_told_where_they_can_be() -> None:
    random = np.random.default_rng(8)
    told = []
    for _ in range(40):
        article, laboratory = random.normal(size=(10, 1, 1)), 3 * random.normal(size=(1, 4, 1))
        values = (article + laboratory + 0.2 * random.normal(size=(10, 4, 2))).ravel()
        index = np.indices((10, 4, 2)).reshape(3, -1)
        told.append(Numbers(values=values, articles=index[0], laboratories=index[1]).contributions())
        if len(told) == 1:
            moved = Numbers(values=100 * values + 7, articles=index[0], laboratories=index[1]).contributions()
            for name, size in told[0].items():
                assert moved[name] == pytest.approx(100 * size, rel=1e-3)
    squares = {name: np.mean([one[name] ** 2 for one in told]) for name in told[0]}
    assert squares["articles"] == pytest.approx(1.0, rel=0.2)
    assert squares["laboratories"] == pytest.approx(9.0, rel=0.5)
    assert squares["mountings"] == pytest.approx(0.04, rel=0.05)
    values = random.normal(size=12)
    alone = numbers(values).contributions()
    assert alone["mountings"] is None
    assert alone["laboratories"] is None
    assert alone["articles"] == pytest.approx(np.std(values, ddof=1), rel=1e-3)


def answered(gains: Sequence[float], mountings: int = 1) -> list[MemberAnswer]:
    """Members with these sizes of one effect, in per cent."""
    asked = massline.Options(model="model.toml")
    return [
        MemberAnswer(
            member=Member(name=f"sn-{k}", article=f"sn-{k // mountings}", laboratory="A", asked=asked),
            verdict="nothing",
            said="NOTHING IS MISSING.",
            error=1.0,
            sizes={GAIN: EffectEstimate(key="", value=gain / 100, unit="1", low=gain / 100 - 0.01, high=gain / 100 + 0.01)},
        )
        for k, gain in enumerate(gains)
    ]


def test_a_page_says_which_differs_by_what_and_what_has_no_size_in_words() -> None:
    gains = np.random.default_rng(5).normal(scale=0.4, size=24)
    members = answered([*gains, 8.0, 8.2], mountings=2)
    members[4] = replace(members[4], verdict="unknown", said="UNKNOWN: something is missing.")
    members[6] = replace(members[6], verdict="mistake", accepted=("polarity:cover-1x",), said="A MISTAKE in the data.")
    members[8] = replace(members[8], verdict="refused", said="run x: no samples.", error=None, sizes={})
    found = Fleet.of(members, [GAIN])
    text = FleetPage(found=found).document().text()
    first, *others = found.differences
    assert (first.article, first.of) == ("sn-12", GAIN)
    assert first.value == pytest.approx(0.081)
    assert [one.article for one in others] == ["sn-2", "sn-3"]
    assert "sn-12, sn-2 and sn-3 of 13 differ." in text
    assert re.search(r"sn-12 +\+8\.1 ", text)
    assert "Nothing can be said of sn-8" in text
    scatter = {one.of: one for one in found.scatter}
    assert scatter[GAIN].mountings == pytest.approx(0.004, rel=0.5)
    assert scatter[GAIN].stated == pytest.approx(0.01 / 1.645, rel=1e-3)
    assert scatter[ERROR].articles == 0
    assert FleetPage(found=found).sizes().checked().data
    assert "None of 12 articles differs." in FleetPage(found=Fleet.of(answered(gains, 2), [GAIN])).document().text()


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A model, and three articles of which one has a channel that reads too much; one is no campaign at all."""
    folder = tmp_path_factory.mktemp("fleet")
    quick = ("--octaves-per-minute", "120", "--band", "4", "32")
    assert main.run(["model", "fmd+cuboid", "--out", str(folder / "model.toml")]) == main.DONE
    for name, seed, fault in (("sn-1", 5, "0"), ("sn-2", 6, "0.08")):
        out = str(folder / "each" / name)
        (folder / "each").mkdir(exist_ok=True)
        gain = ("--effect", f"{GAIN}={fault}")
        assert main.run(["simulate", "fmd+cuboid", "--out", out, "--seed", str(seed), *quick, *gain]) == main.DONE
    broken = folder / "each" / "sn-3"
    broken.mkdir()
    (broken / "campaign.toml").write_text("format = 1\n")
    return folder


def asked(folder: Path) -> list[str]:
    of = ["diagnose", str(folder / "model.toml"), "--each", str(folder / "each")]
    return [*of, "--candidate", GAIN, "--band", "4", "6", "--out", str(folder / "out")]


def test_each_is_diagnosed_and_sized_and_the_page_and_json_are_written(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main.run([*asked(folder), "--jobs", "1"]) == main.DONE
    said = capsys.readouterr().out
    assert "3 mountings of 3 articles" in said
    assert "Nothing can be said of sn-3" in said
    kept = json.loads((folder / "out" / "fleet.json").read_text())
    first, second, third = kept["members"]
    assert (first["accepted"], second["accepted"], third["verdict"]) == ([], [GAIN], "refused")
    assert first["sizes"][GAIN]["value"] == pytest.approx(0.0, abs=0.03)
    assert second["sizes"][GAIN]["value"] == pytest.approx(0.08, abs=0.03)
    page = (folder / "out" / "fleet.html").read_text()
    assert "<h1" in page
    assert GAIN in page


@pytest.mark.proof
def test_several_processes_say_the_same_bit_for_bit_and_what_was_done_is_not_done_again(
    folder: Path, capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = []
    for jobs, cache in (("1", "one"), ("2", "two"), ("1", "two")):
        monkeypatch.setenv("MASSLINE_CACHE", str(tmp_path / cache))
        with monkeypatch.context() as patched:
            if found[1:]:
                patched.setattr(diagnose, "diagnosed", None)
                patched.setattr(fleet, "fit_with", None)
            assert main.run([*asked(folder), "--jobs", jobs, "--json"]) == main.DONE
        found.append(capsys.readouterr().out)
    assert found[0] == found[1] == found[2]

    members = Member.below(folder / "each", massline.Options(model=str(folder / "model.toml"), candidates=(GAIN,), band=(4, 6)))
    many = massline.diagnose_many([one.asked for one in members], processes=2)
    assert isinstance(many[2], BadInput)
    assert isinstance(many[1], massline.Diagnosis)
    alone = massline.diagnose(massline.Study.open(folder / "model.toml", members[1].asked.data, band=(4, 6)), only=[GAIN])
    assert str(alone) == str(many[1])
    assert alone.accepted[0].evidence == many[1].accepted[0].evidence


@pytest.mark.parametrize(
    ("more", "said"),
    [
        (("--each", "nowhere"), "there is no such folder"),
        (("--each", "."), "there is no campaign folder and no test file below it"),
        (("--jobs", "2"), "there is one diagnosis"),
        (("--each", ".", "--auto"), "one model stands for all"),
        (("--each", ".", "--jobs", "2", "--scheduler", "tcp://localhost:1"), "Leave out one of the two"),
        (("--each", "."), "--each"),
    ],
)
def test_what_cannot_be_asked_of_a_fleet_is_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], more: Sequence[str], said: str
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main.run(["diagnose", "model.toml", *more]) == main.BAD_INPUT
    assert said in capsys.readouterr().err
