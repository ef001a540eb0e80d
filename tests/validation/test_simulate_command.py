"""`massline simulate`: what is written where, whole or not at all and over nothing, what is shown and what is sealed."""

import json
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from identification import campaign_file
from validation.cli import main
from validation.effects.catalogue import FAMILIES
from validation.virtual_test import simulate

Run = Callable[..., tuple[int, str, str]]

FAST = ("--octaves-per-minute", "240", "--band", "8", "32", "--rate", "256", "--model", "rigid")


def simulated(run: Run, *arguments: str) -> str:
    code, out, err = run("simulate", *arguments, *FAST)
    assert code == main.DONE, err
    return out


@pytest.fixture(scope="module")
def once(tmp_path_factory) -> Path:
    """The folder above ``made``, a virtual test of seed 0."""
    folder = tmp_path_factory.mktemp("simulate")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        assert main.run(["simulate", "fmd+cuboid", "--out", "made", *FAST]) == main.DONE
    return folder


@pytest.fixture
def made(once, run) -> Path:
    """A copy of it in the folder in which the command runs."""
    shutil.copytree(once, Path(), dirs_exist_ok=True)
    return Path("made")


def truth(path: str) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(Path(path).read_text(encoding="utf-8"))
    return found


def test_a_campaign_that_check_finds_nothing_wrong_with_and_its_truth_beside(run):
    out = simulated(run, "fmd+disc+cuboid", "--out", "made", "--seed", "7", "--effect", "force-gain:fmd-z2=0.08")
    assert run("check", "made")[0] == main.DONE
    assert sorted(path.name for path in Path().iterdir()) == ["made", "made.truth.json"]
    campaign = campaign_file.read("made")
    assert [one.name for one in campaign.runs] == ["x", "y", "z", "alpha", "beta", "gamma"]
    assert len(campaign.table) == 22
    found = truth("made.truth.json")
    assert (found["kind"], found["seed"]) == ("virtual test", 7)
    assert found["effects"] == [{"id": "force-gain:fmd-z2", "value": {"": 0.08}}]
    assert "force-gain:fmd-z2" in out and "Drawn from seed 7" in out  # noqa: PT018
    text = Path("made", "campaign.toml").read_text(encoding="utf-8")
    assert "force-gain" not in text and "seed" not in text  # noqa: PT018


def test_sealed_nothing_of_the_truth_is_beside_in_the_campaign_or_shown(run):
    Path("safe").mkdir()
    arguments = ("fmd+disc+cuboid", "--out", "made", "--seed", "7", "--sealed", "safe/t.json", "--effect", "polarity:fmd-z2")
    out = simulated(run, *arguments)
    assert sorted(path.name for path in Path().iterdir()) == ["made", "safe"]
    assert truth("safe/t.json")["effects"] == [{"id": "polarity:fmd-z2", "value": {}}]
    text = "".join(path.read_text(encoding="utf-8") for path in Path("made").glob("*.toml"))
    shutil.rmtree("made")
    _, told, err = run("simulate", *arguments, *FAST, "--json")
    for said in (out, text, told, err):
        assert "polarity" not in said
        assert "seed" not in said
    assert set(json.loads(told)["campaigns"][0]) & {"effects", "seed"} == set()


def test_json_says_what_check_says_and_what_was_planted(run, answer):
    code, out, _ = run("simulate", "fmd+cuboid", "--out", "made", *FAST, "--json", "--effect", "gravity=0", "--levels", "1,0.5")
    assert code == main.DONE
    (one,) = json.loads(out)["campaigns"]
    checked = answer("check", "made")
    assert [r["name"] for r in one["runs"]] == [r["name"] for r in checked["runs"]]
    assert [(c["name"], c["position_m"]) for c in one["channels"]] == [(c["name"], c["position_m"]) for c in checked["channels"]]
    assert one["effects"] == [{"id": "gravity", "value": 0.0, "unit": "1"}]
    assert (one["campaign"], one["truth"], one["seed"]) == ("made", "made.truth.json", 0)


def test_levels_are_runs_of_one_campaign_and_each_states_its_own(run):
    simulated(run, "fmd+cuboid", "--out", "made", "--levels", "1,0.5", "--noise", "1e-6", "--mains", "off", "--cross", "0")
    campaign = campaign_file.read("made")
    stated = {one.name: one.excitation.figure("level") for one in campaign.runs if one.excitation}
    assert len(stated) == 12
    assert (stated["x"], stated["x-at-0.5"]) == (2.5, 1.25)
    full, half = (campaign.recordings[name].values for name in ("x", "x-at-0.5"))
    assert_allclose(np.max(np.abs(half[:, 3])), 0.5 * np.max(np.abs(full[:, 3])), rtol=1e-5)  # of the noise that is left


def test_a_series_shares_its_hardware_and_has_a_folder_and_a_truth_each(run):
    simulated(run, "fmd+disc+cuboid", "fmd+cuboid", "--out", "series", "--seed", "5")
    names = ["fmd+cuboid", "fmd+cuboid.truth.json", "fmd+disc+cuboid", "fmd+disc+cuboid.truth.json"]
    assert sorted(path.name for path in Path("series").iterdir()) == names
    one, other = (campaign_file.read_description(f"series/{name}") for name in names[::2])
    assert one.hardware == other.hardware != ""
    tolerances = [truth(f"series/{name}")["tolerances"] for name in names[1::2]]
    assert tolerances[0]["force-gain:fmd-z1"] == tolerances[1]["force-gain:fmd-z1"] != 0.0
    simulated(run, "fmd+disc+cuboid", "--out", "other", "--seed", "6")
    assert campaign_file.read_description("other").hardware != one.hardware


def test_a_sealed_series_has_its_truths_in_a_folder_and_an_empty_folder_is_a_place(run):
    Path("series").mkdir()
    simulated(run, "fmd+disc+cuboid", "fmd+cuboid", "--out", "series", "--sealed", "safe")
    assert sorted(path.name for path in Path("safe").iterdir()) == ["fmd+cuboid.truth.json", "fmd+disc+cuboid.truth.json"]
    assert sorted(path.name for path in Path("series").iterdir()) == ["fmd+cuboid", "fmd+disc+cuboid"]


@pytest.mark.parametrize("form", ["uff", "csv", "mat"])
def test_every_format_holds_the_same_in_units_that_were_asked_for(run, made, form):
    simulated(run, "fmd+cuboid", "--out", "other", "--format", form, "--unit", "g", "--unit", "kN")
    one, other = (campaign_file.read(name) for name in (made, "other"))
    assert {channel.unit for channel in other.table.channels} == {"g", "kN"}
    assert {path.suffix for path in Path("other").iterdir()} == {".toml", f".{form}"}
    for name, recorded in one.recordings.items():
        scale = np.max(np.abs(recorded.values))
        assert_allclose(other.recordings[name].values, recorded.values, rtol=0, atol=1e-11 * scale)  # 13 digits in UFF


def test_without_tolerances_noise_and_hum_a_rigid_block_is_m_a(run):
    simulated(run, "fmd+disc+cuboid", "--out", "made", "--tolerances", "off", "--noise", "off", "--mains", "off")
    campaign, drawn = campaign_file.read("made"), truth("made.truth.json")
    mass = drawn["fmd"]["mass_kg"] + drawn["article"]["about_F"]["mass_kg"]
    z, names = campaign.recordings["z"].values, campaign.table.names
    force = z[:, [names.index(f"fmd-z{k}") for k in range(1, 5)]].sum(axis=1)
    motion = z[:, [names.index(f"cover-z{k}") for k in range(1, 5)]].mean(axis=1)
    assert_allclose(force @ motion / (motion @ motion), mass, rtol=1e-3)  # cells that give a little
    assert not np.any([value for key, value in drawn["tolerances"].items() if key != "fmd-inertia"])


def test_what_would_be_a_dead_channel_is_refused(refused):
    silent = ("--tolerances", "off", "--noise", "off", "--mains", "off", "--cross", "0")
    err = refused("simulate", "fmd+cuboid", "--out", "made", *silent, *FAST)
    assert "--noise: without noise, hum and cross motion nothing moves table-z1 in the run x" in err
    assert list(Path().iterdir()) == []


@pytest.mark.parametrize(("effect", "more"), [("point-mass:top=0.5", 0.5), ("appendage:z=m:0.05,f:21,zeta:0.01", 0.0)])
def test_the_true_article_has_what_was_fastened_to_it_and_not_what_swings(run, made, effect, more):
    simulated(run, "fmd+cuboid", "--out", "other", "--effect", effect)
    mass, plain = (truth(f"{name}.truth.json")["article"]["own_frame"]["mass_kg"] for name in ("other", made))
    assert mass - plain == pytest.approx(more, abs=1e-9)


def test_a_dimension_of_ones_own_changes_the_article(run, made):
    simulated(run, "fmd+cuboid", "--out", "own", "--set", "cuboid.threads.depth_mm=200")
    masses = [truth(f"{name}.truth.json")["article"]["own_frame"]["mass_kg"] for name in ("own", made)]
    holes = 4 * np.pi / 4 * 0.0068**2 * (0.200 - 0.020)
    assert masses[1] - masses[0] == pytest.approx(2700 * holes, rel=0.01)  # of aluminium, whose density is no even number


@pytest.mark.parametrize(
    ("pattern", "runs"),
    [
        (("--pattern", "multi"), 6),
        (("--pattern", "diagonal"), 12),
        pytest.param((), 6, marks=pytest.mark.proof),
        pytest.param(("--runs", "12"), 12, marks=pytest.mark.proof),
    ],
)
def test_patterns_have_their_runs(run, pattern, runs):
    simulated(run, "fmd+cuboid", "--out", "made", *pattern)
    assert len(campaign_file.read_description("made").runs) == runs


def test_what_its_truth_vouches_for_is_made_again_and_nothing_else_is_touched(run, made):
    before = simulate.digests(made)
    simulated(run, "fmd+cuboid", "--out", "made")
    assert simulate.digests(made)["x.h5"] == before["x.h5"]
    simulated(run, "fmd+cuboid", "--out", "made", "--seed", "2")
    assert simulate.digests(Path("made"))["x.h5"] != before["x.h5"]
    assert "in place of the virtual test that was there" in run("simulate", "fmd+cuboid", "--out", "made", *FAST)[2]
    Path("made", "notes.txt").write_text("mine")
    code, out, err = run("simulate", "fmd+cuboid", "--out", "made", *FAST)
    assert (code, out) == (main.BAD_INPUT, "")
    assert "made: `--out`: it is there, and not empty, and no virtual test that its truth vouches for" in err
    assert Path("made", "notes.txt").read_text() == "mine"


@pytest.mark.parametrize("break_it", ["change a file", "remove a file", "remove the truth", "another truth"])
def test_a_folder_that_is_not_as_its_truth_says_stays(run, made, break_it):
    if break_it == "change a file":
        Path("made", "campaign.toml").write_text(Path("made", "campaign.toml").read_text().replace("Virtual", "Real"))
    elif break_it == "remove a file":
        Path("made", "x.h5").unlink()
    elif break_it == "remove the truth":
        Path("made.truth.json").unlink()
    else:
        Path("made.truth.json").write_text('{"kind": "virtual test", "files_sha256": {}}')
    before = simulate.digests(Path("made"))
    assert run("simulate", "fmd+cuboid", "--out", "made", *FAST)[0] == main.BAD_INPUT
    assert simulate.digests(Path("made")) == before


def test_a_file_that_is_no_truth_is_not_overwritten(refused):
    Path("thesis.json").write_text("[1]")
    err = refused("simulate", "fmd+cuboid", "--out", "made", "--sealed", "thesis.json", *FAST)
    assert "thesis.json is there and is no truth of a virtual test" in err
    assert (Path("thesis.json").read_text(), Path("made").exists()) == ("[1]", False)


@pytest.mark.parametrize("interruption", [KeyboardInterrupt(), OSError("disk full")])
def test_interrupted_while_writing_nothing_is_left_half_written(run, monkeypatch, interruption):
    def half(folder, *_, **__):
        (folder / "x.h5").write_text("half of i")
        raise interruption

    monkeypatch.setattr(campaign_file, "write", half)
    code, _, err = run("simulate", "fmd+cuboid", "--out", "made", *FAST)
    assert code == (main.INTERRUPTED if isinstance(interruption, KeyboardInterrupt) else main.BAD_INPUT)
    assert err.strip().startswith("massline: ")
    assert list(Path().iterdir()) == []


@pytest.mark.proof  # a process and seconds of it; test_interrupts.py ends others, below it is interrupted while it writes
def test_ctrl_c_ends_it_at_once_and_leaves_nothing(tmp_path, keyboard):
    entry = (sys.executable, "-P", "-c", "from validation.cli.main import main; main()")
    arguments = ("simulate", "fmd+clumod-4", "--out", "made", "--octaves-per-minute", "0.5", "--levels", "1,0.9,0.8")
    with subprocess.Popen([*entry, *arguments], cwd=tmp_path, stderr=subprocess.PIPE, encoding="utf-8") as process:
        time.sleep(4.0)
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=60)
    assert process.returncode == main.INTERRUPTED, err
    assert "Traceback" not in err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["fmd+cubod"], "no built-in article is called 'cubod'. Did you mean cuboid?"),
        (["clumod-1"], "the virtual shaker measures by the FMD, which must be the lowest of the stack"),
        (["fmd+cuboid", "fmd+cuboid"], "it is named twice"),
        (["fmd+cuboid", "--effect", "force-gian:fmd-z1=2"], "Did you mean force-gain?"),
        (["fmd+cuboid", "--effect", "force-gain:fmd-z9=2"], "no force channel is called 'fmd-z9'"),
        (["fmd+cuboid", "--effect", "force-delay:fmd-z1=20"], "must be between -0.1 and 0.1, found 20"),
        (["fmd+cuboid", "--effect", "sweep-bias"], "it arises where spectra are made of a record"),
        (["fmd+cuboid", "--effect", "rope-mass=0.3"], "it is an error of a pendulum"),
        (["fmd+cuboid", "--effect", "point-mass:mast-top=1"], "fmd+cuboid has no place 'mast-top'"),
        (
            ["fmd+cuboid", "--effect", "joint-compliance:lateral=1e-13"],
            "--effect: `flange.compliance`: for what it holds it must",
        ),
        (["fmd+cuboid", "--effect", "point-mass:top=-900"], "would have a negative mass in some direction"),
        (["fmd+cuboid", "--seed", "-1"], "--seed: must not be negative, found -1"),
        (["fmd+cuboid", "--levels", "0"], "--levels: a level must lie above 0"),
        (["fmd+cuboid", "--levels", "-1"], "--levels: a level must lie above 0"),
        (["fmd+cuboid", "--levels", "1,,2"], "--levels: a number is expected, found ''"),
        (["fmd+cuboid", "--levels", "1,1.0"], "--levels: one of them stands there twice"),
        (["fmd+cuboid", "--levels", "nan"], "--levels: a number is expected, found 'nan'"),
        (["fmd+cuboid", "--unit", "kg"], "no unit of acceleration or force is called 'kg'"),
        (["fmd+cuboid", "--unit", "g", "--unit", "m/s^2"], "g and m/s^2 are both units of acceleration"),
        (["fmd+cuboid", "--format", "hdf"], "--format: must be one of h5, uff, csv, mat, found 'hdf'"),
        (["fmd+cuboid", "--pattern", "swep"], "Did you mean sweep?"),
        (["fmd+cuboid", "--pattern", "multi", "--runs", "12"], "--runs: the pattern multi has 6 runs, found 12"),
        (["fmd+cuboid", "--tolerances", "-1"], "--tolerances: must lie between 0 and 100, found -1"),
        (["fmd+cuboid", "--noise", "loud"], "--noise: a number is expected, found 'loud'"),
        (["fmd+cuboid", "--cross", "0.9"], "--cross: must lie between 0 and 0.25, found 0.9"),
        (["fmd+cuboid", "--rate", "40"], "--rate: it drives up to 32 Hz, beyond the Nyquist frequency of 20 Hz"),
        (["fmd+cuboid", "--band", "5", "3"], "--band: a band goes from above 0 Hz up to a higher frequency"),
        (["fmd+cuboid", "--octaves-per-minute", "0.01"], "--octaves-per-minute: a sweep of this band takes"),
        (["fmd+cuboid", "--model", "solid"], "--model: must be one of beam, rigid, found 'solid'"),
        (["fmd+cuboid", "--damping", "3"], "a damping ratio must be at least 0 and below 1, found 3"),
        (["fmd+cuboid", "--set", "disc.height_mm=10"], "no article here has a part 'disc'"),
        (["fmd+cuboid", "--sealed", "made/t.json"], "lies in the campaign folder"),
        (["fmd+cuboid", "--sealed", "no/such/folder/t.json"], ""),
    ],
)
def test_what_cannot_be_is_refused_before_anything_is_computed(refused, arguments, says):
    if not says:
        arguments, says = [*arguments[:-1], str(Path().resolve().parents[-1] / "no" / "such" / "t.json")], "--sealed: "
    assert says in refused("simulate", *arguments, "--out", "made")
    assert list(Path().iterdir()) == []


def test_a_file_or_a_full_folder_is_no_place_for_a_campaign(refused):
    Path("file").write_text("mine")
    Path("full").mkdir()
    Path("full", "data.csv").write_text("mine")
    for name, says in (
        ("file", "file is a file, and several"),
        ("full", "it is there, and not empty"),
        (".", "runs in this folder"),
    ):
        assert says in refused("simulate", "fmd+cuboid", "--out", name, *FAST)


def test_the_list_of_effects_names_every_family_and_needs_nothing_else(run):
    code, out, _ = run("simulate", "--list-effects")
    assert code == main.DONE
    for name in (name for name, family in FAMILIES.items() if family.plant):
        assert f" {name}" in out
