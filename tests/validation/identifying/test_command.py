"""`massline identify` from folder to result, on a rigid block whose inertia is known: short sweeps, no elastic terms."""

import json
from dataclasses import replace
from pathlib import Path

import pytest
from numpy.testing import assert_allclose

from geometry.errors import CheckFailed
from geometry.inertia import Inertia
from identification import campaign_file
from identification import identify as identification_identify
from identification.campaign import Campaign
from identification.identify import Identification, identify
from validation.cli import main
from validation.identify.request import IdentifyOptions, ready
from validation.report import identify as report_identify

QUICK = ("--modes", "0", "--no-study", "--band", "5", "25")


@pytest.fixture(scope="module")
def series(own_campaign, tmp_path_factory) -> Path:
    """The block of the example, the same called an FMD with nothing on it, one run twice instead of another, other hardware."""
    made: Campaign = own_campaign["campaign"]()
    place = tmp_path_factory.mktemp("series")
    campaign_file.write(place / "block", made)
    campaign_file.write(place / "bare", replace(made, article="fmd"))
    campaign_file.write(place / "twice", replace(made, recordings={**made.recordings, "gamma": made.recordings["x"]}))
    campaign_file.write(place / "other", replace(made, hardware="lab/2"))
    return place


@pytest.fixture(scope="module")
def done(series) -> Identification:
    """The driver's own result on the block."""
    return identify(ready(IdentifyOptions(campaign=str(series / "block"), modes="0", band=(5.0, 25.0), study=False)).request)


@pytest.fixture
def driven(done, monkeypatch) -> None:
    """The driver answers every request with what it found on the block."""
    monkeypatch.setattr(
        "validation.identify.identify.identify",
        lambda request, progress: replace(done, request=request, tares=(done.article,) * len(request.tares)),
    )


@pytest.fixture
def block(own_campaign) -> Inertia:
    return own_campaign["BLOCK"]


@pytest.mark.usefixtures("driven")
def test_a_rigid_block_is_found_within_its_intervals_and_everything_is_kept(series, block, run, tmp_path, monkeypatch):
    monkeypatch.setattr(
        report_identify, "full", lambda title, curves, path, note: path.touch()
    )  # 72 panels, which a test of `massline dynamic-mass` draws
    code, out, err = run("identify", str(series / "block"), *QUICK, "--json", "--out", str(tmp_path / "kept"))
    assert code == main.DONE, err
    printed = json.loads(out)
    assert json.loads((tmp_path / "kept" / "identify.json").read_text()) == printed
    assert (printed["article"], printed["origin"]) == ("fmd+disc+cuboid", "F")
    assert any("FMD" in words for words in printed["warnings"])
    low, high = printed["interval95"]["mass_kg"]
    assert low < block.mass < high
    for key, true in (("cog_mm", 1e3 * block.cog), ("moi_cog_kgm2", block.moments_cog)):
        for (low, high), value in zip(printed["interval95"][key], true, strict=True):
            assert low < value < high, key
    pictures = sorted(path.name.removeprefix("identify-fmd+disc+cuboid-") for path in (tmp_path / "kept").glob("*.png"))
    assert pictures == ["dynamic-mass-6x6.png", "dynamic-mass.png", "lines.png", "residuals.png", "shares.png"]
    assert str(tmp_path / "kept" / "identify.json") in err


@pytest.mark.usefixtures("driven")
def test_a_tare_makes_it_the_article_alone_in_its_own_frame_or_in_one_that_is_kept_for_validate(series, answer, block):
    printed = answer("identify", str(series / "block"), "--tare", str(series / "bare"), *QUICK)
    assert (printed["article"], printed["origin"]) == ("disc+cuboid", "article")
    assert_allclose(printed["inertia"]["cog_mm"][2], 1e3 * block.cog[2] - 45, atol=1)
    assert printed["settings"]["tares"][0]["known"] is None
    printed = answer("identify", str(series / "block"), *QUICK, "--frame", "0 0 100 mm; z 90 deg")
    assert_allclose(printed["inertia"]["cog_mm"], [0, 0, 0], atol=2)
    assert_allclose(printed["inertia"]["moi_cog_kgm2"][0], block.moments_cog[1], rtol=0.02)
    assert printed["frame"]["origin"] == "0 0 0.1 m"


def test_a_motion_that_no_run_drives_and_a_band_too_narrow_for_the_study_are_named(series, refused):
    err = refused("identify", str(series / "twice"), *QUICK)
    assert "twice: `run`: no run drives gamma; runs x and gamma are the same recording" in " ".join(err.split())
    err = refused("identify", str(series / "block"), "--band", "5", "5.5")
    assert err.startswith("massline: --band: 5 to 5.5 Hz is too narrow for the band study")
    assert "--no-study" in err


def test_a_joint_fit_that_fails_does_not_hide_the_plain_result(series, answer, done, monkeypatch):
    def fails(*_, **__):
        raise CheckFailed("it does not settle")

    monkeypatch.setattr(identification_identify, "calibrated", fails)
    said = answer("identify", str(series / "block"), *QUICK)
    assert said["result"] == "plain"
    assert "self_calibrated" not in said
    assert_allclose(said["inertia"]["mass_kg"], done.plain.inertia.mass, rtol=1e-9)
    assert any("it does not settle" in text for text in said["warnings"])
    assert len([text for text in said["warnings"] if "moving part of the FMD" in text]) == 1
    # Eqs. 1 and 4 on the raw spectra of the rigid block say the same, and every accelerometer has others that stand in for it
    assert_allclose(said["plain"]["from_raw_spectra_about_f"]["m"], done.plain.inertia.mass, rtol=1e-3)
    assert [one["lost"] for one in said["losing_a_sensor"]] == [[]] * 8


@pytest.mark.usefixtures("driven")
def test_other_hardware_is_refused_without_being_asked_for_and_said_with_it(series, run, refused):
    asked = ("identify", str(series / "block"), "--tare", str(series / "other"), *QUICK)
    err = refused(*asked)
    assert "lab/2" in err
    assert "--any-hardware" in err
    code, out, _ = run(*asked, "--any-hardware")
    assert code == main.DONE
    assert "on other hardware, which takes no FMD off: its moving part is in the result" in " ".join(out.split())


def test_ctrl_c_leaves_no_half_written_folder(series, run, tmp_path, monkeypatch):
    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr("validation.identify.identify.identify", interrupted)
    code, out, err = run("identify", str(series / "block"), *QUICK, "--out", str(tmp_path / "kept"))
    assert (code, out) == (main.INTERRUPTED, "")
    assert "interrupted" in err
    assert not (tmp_path / "kept").exists()
