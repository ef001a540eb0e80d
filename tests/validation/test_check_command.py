"""`massline check`: what is printed, what a program reads, what is drawn, and how it ends."""

import json
import re
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.dynamic_mass import LEVELS, MOTIONS
from geometry.frames import Pose
from geometry.sensors import Point
from identification import campaign_file, test_file
from identification.campaign import Campaign
from identification.response_functions import ResponseFunctions
from validation.cli import main
from validation.report.scenes import setups


@pytest.fixture(scope="module")
def campaign(own_campaign) -> Campaign:
    return own_campaign["campaign"]()


@pytest.fixture(scope="module")
def written(campaign, tmp_path_factory) -> Path:
    whole = tmp_path_factory.mktemp("written") / "own"
    campaign_file.write(whole, campaign)
    return whole


@pytest.fixture
def folder(written, tmp_path) -> Path:
    """The example's campaign; the command runs in the folder above it."""
    return Path(shutil.copytree(written, tmp_path / "own"))


@pytest.mark.usefixtures("folder")
def test_a_sound_campaign_ends_with_0_and_its_table_fits_a_page(run):
    code, out, err = run("check", "own")
    assert (code, err) == (main.DONE, "")
    assert "nothing is wrong with it" in out
    assert max(map(len, out.splitlines())) <= 132


def test_what_a_folder_holds_is_said_without_models(folder):
    program = "import sys; from validation.cli.main import run; run(['check', 'own']); print(*sys.modules, file=sys.stderr)"
    done = subprocess.run([sys.executable, "-c", program], cwd=folder.parent, capture_output=True, encoding="utf-8", check=True)
    assert "nothing is wrong with it" in done.stdout
    assert {name for name in done.stderr.split() if name.split(".")[0] in ("fem", "scipy") or "validation.model" in name} == set()


def test_an_axis_that_no_run_drives_and_a_run_that_is_another_one_are_named(run, folder):
    shutil.copy(folder / "x.h5", folder / "beta.h5")
    code, out, _ = run("check", "own")
    assert code == main.BAD_INPUT
    said = " ".join(out.split())
    assert "no run drives beta; runs x and beta are the same recording" in said
    assert "run beta says that it drives beta, but it drives x" in said


def test_an_inverted_channel_is_suspected_by_name_and_five_runs_name_the_axis_that_is_missing(run, campaign, tmp_path):
    k = campaign.table.names.index("cover-z1")
    sign = np.where(np.arange(len(campaign.table)) == k, -1.0, 1.0)
    turned = {name: replace(one, values=one.values * sign) for name, one in campaign.recordings.items()}
    campaign_file.write(tmp_path / "turned", replace(campaign, recordings=turned))
    code, out, _ = run("check", "turned")
    assert code == main.FAILED_CHECK
    assert "cover-z1" in next(text for text in out.split("warning: ") if "it looks as if" in text)
    left = {name: one for name, one in campaign.recordings.items() if name != "beta"}
    campaign_file.write(tmp_path / "five", replace(campaign, runs=[r for r in campaign.runs if r.name in left], recordings=left))
    code, out, _ = run("check", "five")
    assert code == main.FAILED_CHECK
    assert "five: six base motions take at least six runs, found 5 runs; no run drives beta" in " ".join(out.split())


@pytest.mark.usefixtures("folder")
def test_json_is_one_object_with_every_figure(run):
    code, out, err = run("check", "own", "--json")
    said = json.loads(out)
    assert (code, err) == (main.DONE, "")
    assert (said["usable"], said["problems"], said["warnings"]) == (True, [], [])
    assert len(said["channels"]) == 22
    for k, one in enumerate(said["runs"]):
        assert_allclose(one["level_m_s2_rad_s2"][k], LEVELS[MOTIONS[k]], rtol=0.01)  # blocks cut periods of the sweep
        assert one["level_share"][k] == 1.0
        assert (one["sampling_rate_hz"], one["samples"], one["duration_s"]) == (256.0, 1536, 6.0)
    z1 = next(one for one in said["channels"] if one["name"] == "fmd-z1")
    assert z1["noise_n_stated"] == 0.3
    assert_allclose(z1["noise_n_found"], 0.3, rtol=0.12)
    assert {one["rank"] for one in said["observability"].values()} == {6}


def test_warnings_end_with_1_and_are_printed(run, folder):
    with h5py.File(folder / "x.h5", "a") as file:
        samples = file["channels/cover-x1"][()]
        del file["channels/cover-x1"]
        file["channels/cover-x1"] = np.clip(samples, -2, 2)
    code, out, _ = run("check", "own")
    assert code == main.FAILED_CHECK
    assert "cover-x1 is clipped" in " ".join(out.split())
    assert "read the warnings first" in out
    code, out, _ = run("check", "own", "--json")
    assert code == main.FAILED_CHECK
    assert json.loads(out)["usable"]


def test_a_loud_channel_is_said(run, campaign, tmp_path):
    quiet = tuple(replace(c, noise_rms=0.1) if c.name == "fmd-z1" else c for c in campaign.table.channels)
    campaign_file.write(tmp_path / "own", replace(campaign, table=replace(campaign.table, channels=quiet)))
    code, out, _ = run("check", "own")
    assert code == main.FAILED_CHECK
    assert "fmd-z1 reads 2.8 times" in " ".join(out.split()) or "fmd-z1 reads 2.9 times" in " ".join(out.split())
    assert "check cable and range" in " ".join(out.split())


def test_what_a_loud_channel_reads_at_one_frequency_is_said_to_be_a_tone(run, campaign, tmp_path):
    k = campaign.table.names.index("fmd-z1")
    heard = dict(campaign.recordings)
    for name, one in heard.items():
        values = one.values.copy()
        values[:, k] += 2.0 * np.sin(2 * np.pi * 60.0 * np.arange(len(one)) / one.sampling_rate)
        heard[name] = replace(one, values=values)
    campaign_file.write(tmp_path / "own", replace(campaign, recordings=heard))
    code, out, _ = run("check", "own")
    assert code == main.FAILED_CHECK
    said = r"fmd-z1 reads \d+\.\d times .* 9\d % of it a tone at 60 Hz; check cable, screen and earth"
    assert re.search(said, " ".join(out.split()))


def test_every_problem_is_printed_and_ends_with_2(run, folder):
    (folder / "x.h5").unlink()
    (folder / "y.h5").write_bytes(b"nonsense")
    code, out, _ = run("check", "own")
    assert code == main.BAD_INPUT
    for words in ("problem 1: own/x.h5", "problem 2: own/y.h5", "cannot be used as it is: 2 problems"):
        assert words in out
    code, out, _ = run("check", "own", "--json")
    said = json.loads(out)
    assert (code, said["usable"]) == (main.BAD_INPUT, False)
    assert [one["file"] for one in said["problems"]] == ["own/x.h5", "own/y.h5"]
    assert [one["read"] for one in said["runs"]] == [False, False, True, True, True, True]


def test_everything_wrong_with_the_description_is_printed(run, folder):
    text = (folder / "campaign.toml").read_text(encoding="utf-8")
    text = text.replace("format = 1", "format = 9").replace('axis = "y"', 'axis = "yy"')
    (folder / "campaign.toml").write_text(text, encoding="utf-8")
    code, out, _ = run("check", "own")
    assert code == main.BAD_INPUT
    assert "found 9" in out
    assert "found 'yy'" in out


@pytest.mark.parametrize("name", ["nowhere", "", "own/campaign.toml"])
@pytest.mark.usefixtures("folder")
def test_what_is_no_campaign_is_refused_in_one_sentence(refused, name):
    err = refused("check", name)
    assert err.startswith("massline: ")
    assert len(err.splitlines()) == 1


def test_spectra_are_described_without_levels(run, campaign, tmp_path):
    from identification.campaign import Recording
    from identification.spectra.line_spectra import full_record

    lines = np.linspace(4.0, 32.0, 57)
    recordings = {
        name: Recording(names=one.names, values=full_record(one.values, 256.0, lines), frequency=lines)
        for name, one in campaign.recordings.items()
    }
    campaign_file.write(tmp_path / "own", replace(campaign, recordings=recordings))
    code, out, _ = run("check", "own")
    assert code == main.DONE
    assert "4-32 Hz" in out
    assert "57 lines" in out
    assert "level realised" not in out


@pytest.mark.usefixtures("folder", "renderer")
def test_view_draws_a_map_under_out(run, tmp_path, monkeypatch):
    from PIL import Image

    from validation.report.scenes import setups

    monkeypatch.setattr(setups, "HEIGHT", 300)  # a ninth of the pixels, and of the time
    monkeypatch.setattr(setups, "COLUMNS", ((10, 130), (150, 240), (400, 240)))
    code, _, err = run("check", "own", "--view")
    assert (code, err) == (main.DONE, "massline: wrote out/sensors-own.png.\n")
    with Image.open(tmp_path / "out" / "sensors-own.png") as picture:
        pixels = np.asarray(picture.convert("RGB")).astype(int)
    for red, green, blue in ((36, 86, 196), (31, 138, 76), (200, 40, 60)):  # the legend's lines: table, cover, fmd
        assert np.sum(np.all(np.abs(pixels - [red, green, blue]) < 12, axis=-1)) > 100


def test_an_article_without_fmd_is_drawn_where_it_is_mounted_and_one_of_somebody_else_is_not(campaign):
    alone = replace(campaign, article="cuboid", mounting=Pose(position=np.array([0.0, 0.0, 0.25])))
    bodies, note = setups.bodies_of(alone)
    lowest = min(body.vertices[:, 2].min() for body in bodies)
    on_fmd, _ = setups.bodies_of(replace(campaign, article="fmd"))
    assert_allclose(lowest, 0.25, rtol=0, atol=1e-12)
    assert min(body.vertices[:, 2].min() for body in on_fmd) < 0
    assert "cuboid as built in" in note
    bodies, note = setups.bodies_of(replace(campaign, article="my-satellite.toml"))
    assert bodies == ()
    assert "my-satellite.toml is no built-in article" in note


def test_figures_of_a_campaign_that_another_program_wrote(answer, data):
    """Levels as its campaign.toml asks, cross motion of a few per cent, noise as stated: nothing was planted there."""
    for name in ("fmd+clumod-1", "fmd+disc+cuboid"):
        said = answer("check", str(data / "example_series" / name))
        for k, one in enumerate(said["runs"]):
            assert_allclose(one["level_m_s2_rad_s2"][k], one["excitation"]["level"], rtol=0.01)
            assert max(np.delete(one["level_share"], k)) < 0.15
            assert_allclose(one["duration_s"], 60000 / 564)
        for one in said["channels"]:
            key = "noise_m_s2" if one["quantity"] == "acceleration" else "noise_n"
            assert_allclose(one[f"{key}_found"], one[f"{key}_stated"], rtol=0.3)


def test_a_universal_file_says_what_it_holds_and_how_a_model_reads_it(run, tmp_path):
    lines = np.arange(4.0, 33.0, 0.5)
    test = ResponseFunctions(
        source="hammer.toml",
        title="hammer",
        article="frame",
        frequency=lines,
        values=np.exp(1j * np.outer(lines, np.arange(1, 9)))[None],
        drives=(Point(place="3", direction=(0, 0, -1)),),
        responses=tuple(Point(place=str(number), direction=(1, 0, 0)) for number in range(8)),
        band=(4.0, 32.0),
    )
    test_file.write(tmp_path / "hammer.unv", test_file.of_responses(test))
    code, out, err = run("check", "hammer.unv")
    assert (code, err) == (main.FAILED_CHECK, "")  # its nodes have no coordinates, and that is said
    assert "8 responses, 1 drive, acceleration" in out
    assert "along -z; read at" in out
    assert "and 2 more" in out
    _, _, table = out.partition("A model reads it by\n\n")
    assert run("check", "hammer.unv", "--json")[0] == main.FAILED_CHECK
    (tmp_path / "frame.toml").write_text(f'format = 1\nmodel = {{ title = "f", article = "fmd+clumod-1" }}\n\n{table}')
    assert "8 responses, 1 drive" in run("check", "frame.toml")[1]
    (tmp_path / "study.toml").write_text((tmp_path / "frame.toml").read_text().replace('article = "hammer"\nfile', "file"))
    for named in ("hammer.unv", "study.toml"):  # whose [[test]] leaves the article to the model
        assert "8 responses, 1 drive" in run("check", named)[1]
        assert "nobody says where node-4-z" in run("identify", named)[2]


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        ("H.csv", "f,a\n1,2\n", "it is neither a test's description nor a universal file. Describe the test"),
        (
            "mesh.unv",
            "    -1\n    15\n         1         0         0         0  0.0  0.0  0.0\n    -1\n",
            "neither response functions (dataset 58) nor modes",
        ),
    ],
)
def test_a_file_that_is_no_test_by_itself_says_what_to_do(run, tmp_path, name, text, said):
    (tmp_path / name).write_text(text)
    code, _, err = run("check", name)
    assert code == main.BAD_INPUT
    assert said in " ".join(err.split())


def test_a_folder_with_a_test_is_that_test(run, tmp_path):
    (tmp_path / "hung").mkdir()
    rows = "".join(f"{f},{100 - f**2},{f}\n" for f in range(1, 30))
    (tmp_path / "hung" / "a.csv").write_text(f"frequency,tip:z real,tip:z imag\n{rows}")
    head = 'format = 1\nkind = "response-functions"\narticle = "bar"\n'
    (tmp_path / "hung" / "test.toml").write_text(f'{head}file = "a.csv"\ndrive = "tip:z"\nresponses = ["tip:z"]\n')
    code, out, _ = run("check", "hung")
    assert (code, out) == (main.DONE, run("check", "hung/test.toml")[1])
    assert "1 response, 1 drive" in out
    bar = 'nodes = { root = "0 mm", tip = "300 mm" }\nfixed = ["root"]\nmembers = { bar = ["root", "tip"] }\n'
    bar += 'section = { width = "20 mm", thickness = "5 mm", across = "x" }\nmaterial = "steel"\n'
    (tmp_path / "bar.toml").write_text(f'format = 1\n[fe_model]\nkind = "frame"\n{bar}')
    assert run("model", "bar.toml", "--test", "hung", "--out", "study.toml")[0] == main.DONE
    assert 'file = "hung/a.csv"' in (tmp_path / "study.toml").read_text()
    (tmp_path / "m.toml").write_text(f'format = 1\nmodel = {{ title = "m", article = "bar" }}\n[fe_model]\nkind = "frame"\n{bar}')
    assert run("compare", "m.toml", "hung")[:2] == run("compare", "m.toml", "hung/test.toml")[:2]


def test_a_test_among_data_states_its_format(run, tmp_path):
    (tmp_path / "test.toml").write_text('kind = "modal-table"\narticle = "a"\nfrequencies = { values = [10.0] }\n')
    (tmp_path / "m.toml").write_text('format = 1\nmodel = { title = "m", article = "fmd+clumod-1" }\n')
    code, _, err = run("compare", "m.toml", "test.toml")
    assert code == main.BAD_INPUT
    assert "test.toml: `format`: is missing" in " ".join(err.split())


def test_a_shape_at_one_sensor_is_said_to_be_left_out_and_not_to_be_read(run, tmp_path):
    head = 'format = 1\nkind = "modal-table"\narticle = "a"\nfrequencies = [10.0, 20.0]\n'
    for name, shapes in (("one", 'sensors = ["tip:x"]\nshapes = [[1.0], [0.5]]'), ("two", TWO)):
        (tmp_path / f"{name}.toml").write_text(f"{head}{shapes}\n")
    said = {name: " ".join(run("check", f"{name}.toml")[1].split()) for name in ("one", "two")}
    assert "they are left out" in said["one"]
    assert "shapes read at" not in said["one"]
    assert "shapes read at tip along x, top along x" in said["two"]


TWO = 'sensors = ["tip:x", "top:x"]\nshapes = [[1.0, 0.5], [0.5, -1.0]]'
