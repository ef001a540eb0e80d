"""Campaign folders and measurement files together: told apart, and refused where they contradict each other."""

from collections.abc import Callable
from dataclasses import replace

import pytest

from geometry.errors import BadInput
from identification import campaign_file
from validation.estimation.problem import Problem
from validation.model.model import Model
from validation.model.model_file import of_text
from validation.model.model_file import text as model_text
from validation.study import Data, read_data, resolved_names


@pytest.fixture
def model() -> Model:
    return of_text(model_text(Model(source="model.toml", title="a model", article="fmd+clumod-1")), "model.toml")


@pytest.fixture
def folder(tmp_path, meaningless) -> Callable[..., str]:
    def write(name: str, article: str = "fmd+clumod-1", hardware: str = "lab/1") -> str:
        campaign_file.write(tmp_path / name, meaningless(title=name, article=article, hardware=hardware))
        return str(tmp_path / name)

    return write


WEIGHING = """
format = 1
kind = "weighing"
[article]
name = "clumod-1"
[balance]
resolution = "0.01 kg"
[[reading]]
gross = "32.95 +/- 0.02 kg"
"""


def refused(paths: list[str], model: Model) -> str:
    with pytest.raises(BadInput) as error:
        read_data(paths, model)
    return str(error.value)


def test_folders_are_campaigns_and_files_are_measurements(folder, model, tmp_path):
    (tmp_path / "scale.toml").write_text(WEIGHING)
    found = read_data([folder("one"), str(tmp_path / "scale.toml")], model)
    assert [one.article for one in found.campaigns] == ["fmd+clumod-1"]
    assert found.classical == (str(tmp_path / "scale.toml"),)


def test_the_truth_beside_a_simulated_campaign_is_no_data(folder, model, tmp_path):
    truth = tmp_path / "one.truth.json"
    truth.write_text('{"kind": "virtual test"}', encoding="utf-8")
    with pytest.raises(BadInput, match=r"this is the truth beside a simulated campaign.*Leave it out"):
        read_data([folder("one"), str(truth)], model)


def test_the_same_folder_twice_is_refused_however_it_is_written(folder, model):
    one = folder("one")
    assert "is the same as" in refused([one, f"{one}/../one"], model)
    assert "named twice" in refused([one, one], model)


def test_one_article_on_two_fmds_is_refused_by_name(folder, model):
    said = refused([folder("one"), folder("two", hardware="lab/2")], model)
    assert "lab/1" in said
    assert "lab/2" in said


def test_what_is_no_campaign_is_refused_with_what_to_name(model, tmp_path, folder):
    (tmp_path / "scale.toml").write_text(WEIGHING)
    assert "no campaign" in refused([str(tmp_path / "scale.toml")], model)
    one = folder("campaign-one")
    assert f"Did you mean {one}" in refused([str(tmp_path / "campaign-oen")], model)
    one = folder("one")
    assert f"Name its folder, {one}" in refused([f"{one}/campaign.toml"], model)


def test_a_campaign_may_be_held_out_by_its_folder(by_hand, folder):
    one = campaign_file.read(folder("one"))
    data = Data(campaigns=(replace(one, recordings={}),))
    problem = Problem((by_hand.test(name="one"),))
    assert resolved_names(problem, data, [one.source, "x"]) == ("one", "x")
