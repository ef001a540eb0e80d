"""A single-axis shaker: accelerometers on base and article, five other motions of the base that nobody measured."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from geometry.errors import BadInput
from identification import campaign_file
from identification.campaign import Campaign
from validation.cli import main
from validation.prediction.series import UNMEASURED, with_unmeasured

MODEL = 'format = 1\nmodel = { title = "Mast on a shaker", article = "fmd+clumod-1" }\n'
POINTS = ("mast-top:x", "mast-top:y", "mast-top:z", "flange:x", "flange:y", "flange:z")
CROSS = {"x": 1.0, "y": 0.03, "z": -0.02, "alpha": 0.02, "beta": -0.03, "gamma": 0.02}
"""How the base moves besides what it does in the virtual laboratory's own runs, as shares of the driven motion: 5 % in all."""


def shaken(of: Campaign, stated: float) -> Campaign:
    """What a single-axis shaker would have recorded: runs along six axes added in the shares of `CROSS`, without any cell."""
    kept = [k for k, one in enumerate(of.table.channels) if one.name == "table-x1" or one.group == "article"]
    one = of.recordings["x"]
    least = min(len(run) for run in of.recordings.values())
    whole = sum(share * of.recordings[axis].values[:least] for axis, share in CROSS.items())
    table = replace(of.table, channels=tuple(of.table.channels[k] for k in kept))
    recording = replace(one, names=tuple(channel.name for channel in table.channels), values=np.asarray(whole)[:, kept])
    return replace(of, table=table, runs=(of.run("x"),), recordings={"x": recording}, cross_motion=stated)


@pytest.fixture(scope="module")
def simulated(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Campaign]:
    made: dict[str, Campaign] = {}

    def of(effect: str) -> Campaign:
        if effect not in made:
            folder = tmp_path_factory.mktemp("six") / "axes"
            points = [part for point in POINTS for part in ("--response", point)]
            hidden = ["--effect", effect] if effect else []
            quick = ["--octaves-per-minute", "60", "--band", "8", "20", "--rate", "256", "--seed", "5"]
            assert main.run(["simulate", "fmd+clumod-1", *quick, *points, *hidden, "--out", str(folder)]) == 0
            made[effect] = campaign_file.read(folder)
        return made[effect]

    return of


@pytest.fixture
def lab(tmp_path: Path, simulated: Callable[[str], Campaign], monkeypatch: pytest.MonkeyPatch) -> Callable[..., None]:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "lab.toml").write_text(MODEL, encoding="utf-8")

    def written(effect: str = "", stated: float = 0.1) -> None:
        campaign_file.write(tmp_path / "test", shaken(simulated(effect), stated))

    return written


def test_without_their_size_unmeasured_motions_are_refused(lab, refused, capsys):
    lab(stated=0.0)
    capsys.readouterr()  # of the virtual test
    assert "base motions x, y, z, alpha, beta, gamma cannot be told" in refused("compare", "lab.toml", "test")


def test_a_sound_test_on_a_single_axis_shaker_is_explained_by_motions_of_the_stated_size(lab, answer):
    lab()
    found = answer("compare", "lab.toml", "test")
    assert [one["verdict"] for one in found["errors"]][1:3] == ["good", "good"]
    assert "nan" not in str(found["worst"])
    assert {one for one in found["maps"][0]["channels"] if one.startswith(UNMEASURED)} == {
        f"{UNMEASURED}{axis}" for axis in ("y", "z", "alpha", "beta", "gamma")
    }


def test_motions_that_are_said_to_be_far_smaller_than_they_are_show(lab, answer):
    lab(stated=0.01)
    found = answer("compare", "lab.toml", "test")
    assert found["fitted_chi2_per_dof"] > 1.5
    assert "failed" in [one["verdict"] for one in found["errors"]]


def test_diagnose_refuses_it_in_words(lab, refused, capsys):
    lab()
    capsys.readouterr()
    text = " ".join(refused("diagnose", "lab.toml", "test").split())
    assert "`campaign.cross_motion`: is stated" in text
    assert "massline compare" in text


def test_runs_along_two_axes_and_a_base_that_nobody_reads_are_refused(simulated):
    whole = replace(simulated(""), cross_motion=0.03)
    with pytest.raises(BadInput, match="its runs are driven along"):
        with_unmeasured(whole)
    lone = shaken(simulated(""), 0.03)
    blind = replace(lone.table, channels=lone.table.channels[1:])
    with pytest.raises(BadInput, match="no accelerometer on the base reads along x"):
        with_unmeasured(replace(lone, table=blind, recordings={}))
