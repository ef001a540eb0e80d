"""`massline correct`: a whole new folder in the old one's formats, the old one untouched."""

import json
from dataclasses import replace
from hashlib import sha256
from pathlib import Path

import numpy as np
import pytest

from identification import campaign_file
from identification.campaign import Campaign
from identification.files import files


@pytest.fixture
def folder(tested, run) -> Path:
    """A campaign of two short runs in the working folder of `run`."""
    campaign_file.write("test", shortened(tested("force-gain:fmd-z2=0.08")))
    return Path("test")


def shortened(campaign: Campaign) -> Campaign:
    runs = campaign.runs[:2]
    return replace(campaign, runs=runs, recordings={one.name: campaign.recordings[one.name] for one in runs})


def digests(folder: Path) -> dict[str, str]:
    return {path.name: sha256(path.read_bytes()).hexdigest() for path in sorted(folder.iterdir())}


def test_the_copy_is_the_campaign_without_the_fault(folder, run, tested):
    before = digests(folder)
    code, printed, said = run("correct", "test", "force-gain:fmd-z2=0.08", "--out", "clean")
    assert (code, said) == (0, "massline: wrote clean.\n")
    assert "fmd-z2" in printed
    assert "test is as it was; the copy is without force-gain:fmd-z2=0.08" in printed
    assert digests(folder) == before
    assert set(digests(Path("clean"))) == set(before)
    made = campaign_file.read("clean")
    assert made.notes.endswith("corrected: force-gain:fmd-z2=0.08 taken out (multiplied by 0.925926)")
    for name, recording in made.recordings.items():
        np.testing.assert_allclose(recording.values, tested().recordings[name].values, rtol=1e-13, atol=1e-12)  # divided out


@pytest.mark.parametrize("ending", [".uff", ".csv", ".mat"])
def test_files_keep_their_format_and_their_name(run, tested, ending):
    campaign = shortened(tested("polarity:fmd-z2"))
    campaign_file.write("first", campaign, ending=ending)
    Path("test/raw").mkdir(parents=True)
    for one in campaign.runs:
        Path(f"first/{one.name}{ending}").rename(f"test/raw/take {one.name}{ending}")
    text = Path("first/campaign.toml").read_text()
    for one in campaign.runs:
        text = text.replace(f'file = "{one.name}{ending}"', f'file = "raw/take {one.name}{ending}"')
    Path("test/campaign.toml").write_text(text)
    assert run("correct", "test", "polarity:fmd-z2", "--out", "clean")[0] == 0
    made = campaign_file.read("clean")
    assert [one.file for one in made.runs] == [f"raw/take {one.name}{ending}" for one in campaign.runs]
    for name, recording in made.recordings.items():
        clean = tested().recordings[name].values
        np.testing.assert_allclose(recording.values, clean, rtol=1e-11, atol=1e-12)  # ASCII files hold 13 digits


def test_units_of_the_files_stay(run, tested):
    campaign = shortened(tested("unit:cover-z3=0.102"))
    units = {"acceleration": "g", "force": "kN"}
    channels = tuple(replace(c, unit=units[c.quantity]) for c in campaign.table.channels)
    campaign_file.write("test", replace(campaign, table=replace(campaign.table, channels=channels)))
    assert run("correct", "test", "unit:cover-z3=0.102", "--out", "clean")[0] == 0
    made = campaign_file.read("clean")
    assert {c.unit for c in made.table.channels} == {"g", "kN"}
    for name, recording in made.recordings.items():
        np.testing.assert_allclose(recording.values, tested().recordings[name].values, rtol=1e-12)


@pytest.mark.parametrize(
    ("stated", "real", "size"), [("m/s^2", "g", 9.80665), ("g", "m/s^2", 1 / 9.80665), ("g", "mm/s^2", 1e-3 / 9.80665)]
)
def test_a_unit_can_be_named_whatever_the_file_states(run, tested, stated, real, size):
    campaign = shortened(tested())
    channels = tuple(replace(c, unit=stated) if c.name == "cover-z3" else c for c in campaign.table.channels)
    campaign_file.write("test", replace(campaign, table=replace(campaign.table, channels=channels)))
    assert run("correct", "test", f"unit:cover-z3={real}", "--out", "clean")[0] == 0
    made = campaign_file.read("clean")
    for name, recording in made.recordings.items():
        np.testing.assert_allclose(
            recording.channel("cover-z3"), size * campaign.recordings[name].channel("cover-z3"), rtol=1e-12
        )


def test_several_faults_and_json(folder, run):
    code, printed, _ = run(
        "correct", "test", "force-gain:fmd-z2=0.08", "accelerometer-position:cover-z3:x=0.01", "--out", "clean", "--json"
    )
    assert code == 0
    said = json.loads(printed)
    assert [one["id"] for one in said["corrected"]] == ["force-gain:fmd-z2", "accelerometer-position:cover-z3:x"]
    (channel,) = said["corrected"][0]["channels"]
    assert channel["rms_before"] / channel["rms_after"] == pytest.approx(1.08)
    places = [campaign_file.read_description(one).table for one in ("test", "clean")]
    k = places[0].names.index("cover-z3")
    shift = places[1].channels[k].places[0].position - places[0].channels[k].places[0].position
    np.testing.assert_allclose(shift, [0.01, 0.0, 0.0], atol=1e-12)


def test_nothing_is_written_over(folder, run, refused):
    run("correct", "test", "polarity:fmd-z1", "--out", "clean")
    before = digests(Path("clean"))
    assert "clean: `--out`: it is there already and not empty" in refused("correct", "test", "polarity:fmd-z2", "--out", "clean")
    assert digests(Path("clean")) == before
    assert run("correct", "test", "polarity:fmd-z2", "--out", "clean", "--force")[0] == 0
    assert digests(Path("clean")) != before
    Path("papers").mkdir()
    Path("papers/thesis.txt").write_text("years of work")
    code, _, said = run("correct", "test", "polarity:fmd-z2", "--out", "papers", "--force")
    assert (code, "it holds no campaign.toml" in said) == (2, True)
    assert Path("papers/thesis.txt").exists()


@pytest.mark.parametrize("out", ["test", "test/clean", "."])
def test_the_folder_that_is_read_is_never_changed(folder, refused, out):
    before = digests(folder)
    assert "--out" in refused("correct", "test", "polarity:fmd-z1", "--out", out, "--force")
    assert digests(folder) == before


def test_a_folder_around_the_one_that_is_read_is_not_replaced(folder, run):
    Path("outer").mkdir()
    folder.rename("outer/test")
    Path("outer/campaign.toml").write_text("a campaign around another")
    code, _, said = run("correct", "outer/test", "polarity:fmd-z1", "--out", "outer", "--force")
    assert (code, "it would change outer/test, which is only read" in said) == (2, True)
    assert campaign_file.read("outer/test")


@pytest.mark.parametrize(
    ("effect", "says"),
    [
        ("force-gain:fmd-z9=0.1", "EFFECT: `force-gain:fmd-z9`: no force channel is called 'fmd-z9'. Did you mean fmd-z4?"),
        ("force-gain:cover-z1=0.1", "no force channel is called 'cover-z1'"),
        ("force-gian:fmd-z1=0.1", "no effect is called 'force-gian'. Did you mean force-gain?"),
        ("force-gain:fmd-z1", "its value [1] is missing"),
        ("force-gain:fmd-z1=80", "its size [1] must be between -0.9 and 9, found 80"),
        ("unit:cover-z3=lbf", "neither a factor nor a unit of cover-z3"),
        ("modulus:mast=0.1", "modulus:mast: cannot be taken out of a record: it changes the structure"),
        ("noise:fmd-z1=3", "noise:fmd-z1: cannot be taken out of a record: it is random"),
    ],
)
def test_what_cannot_be_corrected_is_said_before_anything_is_read(folder, refused, monkeypatch, effect, says):
    monkeypatch.setattr(campaign_file, "read", lambda *_, **__: pytest.fail("signals were read"))
    assert says in refused("correct", "test", effect, "--out", "clean")
    assert not Path("clean").exists()


def test_an_interrupted_copy_is_none(folder, run, monkeypatch):
    written = []

    def interrupted(path, signals):
        written.append(path)
        if len(written) == 2:
            raise KeyboardInterrupt

    monkeypatch.setattr(files, "write", interrupted)
    assert run("correct", "test", "polarity:fmd-z1", "--out", "clean")[0] == 130
    assert [path.name for path in Path().iterdir()] == ["test"]
