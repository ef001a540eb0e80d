"""`massline compare` to its exit code, on spectra that its own prediction made: what is tested is the way, not physics."""

import json
from dataclasses import replace

import numpy as np
import pytest

from geometry.dynamic_mass import LEVELS, MOTIONS
from identification import campaign_file
from validation.model.model import Model
from validation.model.model_file import text as model_text
from validation.prediction.series import predictions


@pytest.fixture(scope="session")
def files(tmp_path_factory, meaningless) -> tuple[str, str]:
    """A model file and a campaign of disc and Cuboid whose cover-x1 reads 5 % too much."""
    folder, rng, campaign = tmp_path_factory.mktemp("compare"), np.random.default_rng(0), meaningless()
    model = Model(source="model.toml", title="disc and cuboid", article="fmd+disc+cuboid")
    (folder / "model.toml").write_text(model_text(model), encoding="utf-8")
    (made,) = predictions(model, [campaign])
    cross = 0.03 * (rng.standard_normal((6, 6)) + 1j * rng.standard_normal((6, 6)))
    u = ((np.eye(6) + cross) * np.array([LEVELS[axis] for axis in MOTIONS]))[:, None, :, None]
    read = (made.at({"accelerometer-gain:cover-x1": 0.05}, derivatives=False).rows @ u)[..., 0]
    shape = (6, read.shape[1], len(campaign.table))
    values = np.zeros(shape, dtype=complex)
    values[..., [campaign.table.names.index(name) for name in made.measured.channels]] = read
    values += 2e-4 * np.abs(values) * (rng.standard_normal(shape) + 1j * rng.standard_normal(shape))
    recordings = {
        one.name: replace(campaign.recordings[one.name], values=own) for one, own in zip(campaign.runs, values, strict=True)
    }
    campaign_file.write(folder / "test", replace(campaign, recordings=recordings))
    return str(folder / "model.toml"), str(folder / "test")


@pytest.mark.proof  # every picture; test_shown.py draws them, tests/answers holds JSON and exit code
def test_json_pictures_and_exit_code(files, answer, tmp_path):
    found = answer("compare", *files, "--hold-out", "gamma", "--out", "found")
    assert found["worst"][0]["channel"] == "cover-x1"
    assert found["worst"][0]["campaign"] == "test"
    assert found["absurd_tolerances"][0]["name"] == "accelerometer-gain:cover-x1"
    assert found["tolerance_z2"] > 2 * found["tolerance_z2_expected"]
    assert found["held_out_error_percent"] is not None
    assert json.loads((tmp_path / "found" / "compare.json").read_text(encoding="utf-8")) == found
    assert len(list((tmp_path / "found").glob("*.png"))) == 5


@pytest.mark.parametrize(
    ("model", "more", "said"),
    [
        (None, ["--hold-out", "zz"], "'zz'"),
        (None, ["--band", "16", "4"], "--band"),
        (None, ["nowhere"], "no such file or folder"),
        (None, ["--effects-from", "nowhere"], "nowhere"),
        (None, ["--effects-from", "nowhere", "--effects-from", "elsewhere"], "nowhere"),  # each of them is read, in order
        ("/campaign.toml", [], "model file"),
    ],
)
def test_bad_input_ends_with_2_and_says_what(files, refused, model, more, said):
    assert said in refused("compare", files[1] + model if model else files[0], files[1], *more)


def test_a_few_lines_are_said_to_be_few(files, run):
    code, printed, said = run("compare", *files, "--band", "4", "8", "--json")
    assert code == 0, said
    assert any(one.startswith("only 9 lines lie in the band of test") for one in json.loads(printed)["warnings"])
