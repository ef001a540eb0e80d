"""Two commands that are asked of the same campaign say the same of it, problems first, and one cause once."""

import json
import re
import shutil

import numpy as np
import pytest

from validation.cli import main

SIMULATED = ("--seed", "3", "--octaves-per-minute", "120", "--rate", "256", "--band", "8", "16")


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    folder = tmp_path_factory.mktemp("made")
    assert main.run(["simulate", "fmd+cuboid", *SIMULATED, "--out", str(folder / "test")]) == 0
    assert main.run(["model", "fmd+cuboid", "--out", str(folder / "model.toml")]) == 0
    return folder


@pytest.fixture
def campaign(made, tmp_path):
    """The file of its description; what is changed there is read by the next command."""
    shutil.copytree(made, tmp_path, dirs_exist_ok=True)
    return tmp_path / "test" / "campaign.toml"


def change(campaign, pattern, new):
    text, count = re.subn(pattern, new, campaign.read_text(encoding="utf-8"))
    assert count
    campaign.write_text(text, encoding="utf-8")


def checked(run):
    code, out, _ = run("check", "test")
    return code, " ".join(out.split())


def test_gravity_of_no_place_on_earth_is_doubted_by_check_and_refused_by_compare(run, refused, campaign):
    change(campaign, r"gravity = 9\.81", "gravity = 9.0")
    code, said = checked(run)
    assert code == 1
    assert "`environment.gravity` 9 m/s² is met nowhere on Earth" in said
    assert "`environment.gravity`: is 9 m/s^2" in refused("compare", "model.toml", "test")
    change(campaign, r"gravity = 9\.0", "gravity = 0.0")
    assert checked(run)[0] == 0


def test_an_article_that_nobody_knows_is_said_by_check_and_refused_by_compare(run, refused, campaign):
    change(campaign, r'article = "fmd\+cuboid"', 'article = "cubiod"')
    code, said = checked(run)
    assert code == 0  # an article of somebody's own is nothing wrong
    assert "Article cubiod is not built in: a model file has it in [fe_model] or [structure.own]. Did you mean cuboid?" in said
    assert "is cubiod, which is not built in" in refused("compare", "model.toml", "test")


def test_five_runs_are_compared_and_check_says_what_they_are_good_for(run, refused, campaign):
    head, *runs = campaign.read_text(encoding="utf-8").split("[[run]]")
    campaign.write_text(head + "".join(f"[[run]]{one}" for one in runs if 'axis = "gamma"' not in one), encoding="utf-8")
    code, said = checked(run)
    assert code == 1
    assert "found 5 runs; no run drives gamma: no dynamic mass is measured" in said
    code, out, _ = run("compare", "model.toml", "test", "--band", "10", "10.3")
    assert code == 0
    assert "no dynamic mass is measured" in " ".join(out.split())
    assert "found 5 runs; no run drives gamma" in refused("identify", "test", "--no-study")


@pytest.mark.parametrize("factor", [1e3, 1e2])
def test_millimetres_in_a_file_of_metres_are_named_once_and_before_every_table(run, refused, campaign, factor):
    def larger(one):
        return f"position = [{', '.join(f'{factor * float(x):g}' for x in one[1].split(','))}]"

    change(campaign, r"position = \[([^]]*)\]", larger)
    if factor > 100:
        for command in (("check", "test"), ("compare", "model.toml", "test"), ("identify", "test")):
            assert 'is m, and puts the channels 540 m apart. Write length_unit = "mm"' in refused(*command)
        return
    code, out, _ = run("check", "test")
    told = [line for line in out.splitlines() if line.strip().startswith(("warning", "problem"))]
    assert code == 1
    assert len(told) == 1
    assert "with unit m it is 54 m long" in told[0]
    assert out.index(told[0]) < out.index(" channel ")


def test_noise_that_is_stated_too_small_everywhere_is_one_warning(run, campaign):
    change(campaign, r"noise_rms = .*", "noise_rms = 1e-4")
    code, out, _ = run("check", "test", "--json")
    (warning,) = json.loads(out)["warnings"]
    assert code == 1
    assert "22 of 22 channels read up to" in warning
    assert warning.endswith("check cable and range, or correct noise_rms")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("diagnose", "test", "model.toml"), "MODEL comes first"),
        (("report", "test", "model.toml", "--out", "r.html"), "MODEL comes first"),
        (("add", "model.toml", "test"), "the effect stands before DATA"),
        (("diagnose", "model.toml", "model.toml"), "it is a model file, where a measurement is needed"),
        (
            ("correct", "model.toml", "polarity:fmd-z2", "--out", "new"),
            "it is a model file, where the folder of a campaign is needed",
        ),
    ],
)
def test_what_was_mistaken_is_said_at_every_door(refused, campaign, arguments, words):
    assert words in refused(*arguments)


@pytest.mark.parametrize(
    "arguments",
    [
        ("compare", "model.toml", "test"),
        ("diagnose", "model.toml", "test"),
        ("identify", "test"),
        ("pretest", "fmd+cuboid"),
        ("ladder", "model.toml"),
        ("simulate", "fmd+cuboid"),
        ("correct", "test", "polarity:fmd-z2"),
        ("swing", "cuboid"),
    ],
    ids=lambda arguments: arguments[0],
)
def test_what_is_named_like_a_page_or_is_a_file_is_no_folder(refused, campaign, arguments):
    said = refused(*arguments, "--out", "out/x.html")
    assert "x.html is named like a file, and several are written into a folder. Name a new folder;" in said
    assert not (campaign.parents[1] / "out").exists()
    (campaign.parents[1] / "taken").write_text("a file")
    assert "--out: taken is a file, and several are written into a folder" in refused(*arguments, "--out", "taken")


def test_coordinates_are_asked_of_a_structure_that_has_none(refused, tmp_path):
    """A mistake of who asks, and no failed check of the model: it had ended with 1."""
    np.savez(tmp_path / "pair.npz", stiffness=[[3e4, -1e4], [-1e4, 1e4]], mass=np.eye(2))
    (tmp_path / "pair.toml").write_text(
        'format = 1\nmodel = { title = "Two masses", article = "pair" }\n'
        '[fe_model]\nkind = "matrices"\nfile = "pair.npz"\nunits = "m-kg-N-s"\nsupport = "ground"\n'
        "places = { low = { dof = [0, -1, -1] }, high = { dof = [1, -1, -1] } }\n"
        '[[test]]\nkind = "modal-table"\narticle = "pair"\nfrequencies = [12.0, 29.0]\nfrequency_deviation = 0.01\n'
    )
    said = refused("add", "pair.toml", "point-mass:@0,0,0.2")
    assert (
        "pair.toml: `@0,0,0.2`: has no known motion: the structure has no coordinates. A place is named there: low, high" in said
    )
    said = refused("add", "pair.toml", "point-mass:hihg")
    assert "`point-mass:hihg`: nothing is called 'hihg' there. Did you mean high? It has low, high" in said
