"""`massline diagnose` on what it cannot use: exit code 2, and words that say what, where, and what to do."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from geometry.dynamic_mass import MOTIONS
from identification import campaign_file
from identification.campaign import Campaign, Recording, Run
from validation.model.model import Model
from validation.model.model_file import text as model_text
from validation.virtual_test.layout import mavis

Run_ = Callable[..., tuple[int, str, str]]

CELLS = np.array([[0.12, 0.12, 0.0], [-0.12, 0.12, 0.0], [-0.12, -0.12, 0.0], [0.12, -0.12, 0.0]])
FREQUENCY = np.linspace(4.0, 16.0, 25)


def campaign(runs: tuple[str, ...] = MOTIONS, seed: int = 0) -> Campaign:
    """Spectra that mean nothing: what is refused is refused before they are looked at."""
    table, rng = mavis(CELLS, {}).table, np.random.default_rng(seed)
    shape = (len(table), len(FREQUENCY))
    recorded = {
        name: Recording(
            names=table.names,
            values=(rng.standard_normal(shape) + 1j * rng.standard_normal(shape)).T,
            frequency=FREQUENCY,
            source=name,
        )
        for name in runs
    }
    return Campaign(
        title="test",
        article="fmd+disc+cuboid",
        hardware="lab/1",
        table=table,
        runs=tuple(Run(name=name, file="", axis=name) for name in runs),
        recordings=recorded,
    )


@pytest.fixture(scope="module")
def drawn(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """``cuboid`` with six runs, ``again`` with the same, ``short`` with one, and a model."""
    folder = tmp_path_factory.mktemp("bad")
    for name, runs in {"cuboid": MOTIONS, "again": MOTIONS, "short": ("x",)}.items():
        campaign_file.write(folder / name, campaign(runs))
    model = Model(source="model.toml", title="disc and cuboid", article="fmd+disc+cuboid")
    (folder / "model.toml").write_text(model_text(model), encoding="utf-8")
    return folder


@pytest.fixture
def made(drawn: Path, run: Run_) -> Path:
    """A copy of it where the command runs."""
    shutil.copytree(drawn, Path(), dirs_exist_ok=True)
    return Path("model.toml")


def refused(run: Run_, *arguments: str) -> str:
    code, printed, error = run("diagnose", "model.toml", *arguments)
    assert (code, printed) == (2, ""), error
    assert "Traceback" not in error
    return " ".join(error.split())


def changed(folder: str, old: str, new: str) -> None:
    path = Path(folder) / campaign_file.NAME
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new, 1), encoding="utf-8")


def test_campaigns_of_two_hardwares_contradict_one_another(made: Path, run: Run_) -> None:
    changed("again", "lab/1", "lab/2")
    said = refused(run, "cuboid", "again")
    assert "lab/2" in said
    assert "lab/1" in said
    assert "campaign.hardware" in said


def test_campaigns_whose_pick_ups_sit_elsewhere_contradict_one_another(made: Path, run: Run_) -> None:
    changed("again", "position = [0.26", "position = [0.36")
    said = refused(run, "cuboid", "again")
    assert "table-z1" in said
    assert "campaign.hardware" in said


def test_a_frame_moved_with_its_channels_contradicts_nothing_and_one_moved_alone_does(made: Path, run: Run_) -> None:
    changed("again", "origin = [0.0, 0.0, 0.0]\nlength", "origin = [0.0, 0.0, 0.02]\nlength")
    said = refused(run, "cuboid", "again")
    assert "again/campaign.toml" in said


def test_an_article_that_the_model_does_not_know_is_named(made: Path, run: Run_) -> None:
    changed("again", "fmd+disc+cuboid", "fmd+clumod-4")
    changed("cuboid", "fmd+disc+cuboid", "fmd+clumod-1")
    said = refused(run, "cuboid", "again")
    assert "model.article" in said
    assert "of which no campaign has a part" in said


def test_one_run_is_too_few(made: Path, run: Run_) -> None:
    said = refused(run, "short")
    assert "too few: 1 in all (x of short)" in said


def test_a_name_to_hold_out_that_does_not_exist_meets_the_nearest(made: Path, run: Run_) -> None:
    said = refused(run, "cuboid", "--hold-out", "gama")
    assert "'gama'" in said
    assert "gamma" in said


def test_holding_everything_out_leaves_nothing(made: Path, run: Run_) -> None:
    assert "nothing is left to fit" in refused(run, "cuboid", "--hold-out", "cuboid")


@pytest.mark.parametrize(
    ("candidate", "said"),
    [
        ("force-gian", "no effect is called 'force-gian' Did you mean force-gain"),
        ("force-gain:fmd-z9", "no force channel is called 'fmd-z9'"),
        ("force-gain:fmd-z2=0.08", "it has a size, which is what is looked for"),
        ("modulus:mast", "no part is called 'mast'"),
        ("point-mass:mast-top", "no place is called 'mast-top'"),
        ("force-gain:fmd-z2:x", "force-gain:fmd-z2:x"),
        ("polarity:fmd-z2", "mistakes are looked for in every diagnosis"),
        ("pendulum-damping", "of the kind 'pendulum'"),
        ("noise:fmd-z2", "of the kind 'processing'"),
        ("friction:flange:x", "every axis was driven at one level"),
        ("saturation", "one level cannot see saturation"),
        ("modulus", "is no effect that could act on these data"),
    ],
)
def test_a_candidate_that_cannot_be_looked_for_says_why(candidate: str, said: str, made: Path, run: Run_) -> None:
    assert said in refused(run, "cuboid", "--candidate", candidate).replace(". ", " ")


@pytest.mark.parametrize(
    ("more", "said"),
    [
        (["--band", "16", "4"], "--band"),
        (["nowhere"], "no such file or folder"),
        (["cuboid"], "is named twice"),
        (["--effects-from", "nowhere"], "nowhere"),
        (["--out", "model.toml"], "--out"),
    ],
)
def test_options_are_read_as_everywhere(more: list[str], said: str, made: Path, run: Run_) -> None:
    assert said in refused(run, "cuboid", *more)


@pytest.mark.parametrize("more", [["--hold-out", "z"], ["--band", "4", "16"], ["--auto"]])
def test_what_needs_a_campaign_is_refused_without_one(more: list[str], made: Path, run: Run_) -> None:
    said = refused(run, "clumod-4-weighing", *more)
    assert "there is no campaign among DATA" in said
    assert more[0] in said


def test_files_alone_are_checked_as_beside_campaigns(made: Path, run: Run_) -> None:
    assert "no such file or folder" in refused(run, "nowhere.toml")
    assert "is named twice" in refused(run, "clumod-4-weighing", "clumod-4-weighing")
    assert "Name its folder" in refused(run, "cuboid/campaign.toml")


def test_files_alone_get_the_answer_that_they_can_give(run: Run_) -> None:
    model = Model(source="model.toml", title="four blades", article="fmd+clumod-4")
    Path("model.toml").write_text(model_text(model), encoding="utf-8")
    code, printed, error = run("diagnose", "model.toml", "clumod-4-weighing")
    assert code == 0, error
    assert "47.4" in printed
