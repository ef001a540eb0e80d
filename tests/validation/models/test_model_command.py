"""`massline model`: a file to start from, for every stack on the FMD and for what is the user's own."""

import json
import re
import runpy
from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest

from geometry import routes
from geometry.articles import NAMES, built_in
from geometry.errors import BadInput
from geometry.sensors import Tolerances
from identification.campaign_file import read_description
from validation.correct import CORRECTIONS
from validation.effects.catalogue import parse
from validation.model import model_file
from validation.model.model import KINDS, Added, StructureTolerances, require_pair
from validation.model.tolerance_classes import ROWS

STACKS = ("fmd", *(f"fmd+{name}" for name in NAMES if name != "fmd"), "fmd+disc+cuboid")


@pytest.mark.parametrize("article", STACKS)
def test_every_stack_on_the_fmd_has_one(run, article):
    code, printed, said = run("model", article)
    assert (code, said) == (0, "")
    model = model_file.of_text(printed, "m.toml")
    assert (model.article, model.fmd, model.effects) == (article, None, ())
    assert printed.count("#") > 20


def test_a_model_is_written_not_written_over_and_a_model_file_is_written_anew(run, refused):
    assert run("model", "fmd+clumod-1", "--out", "lab.toml")[::2] == (0, "massline: wrote lab.toml.\n")
    Path("lab.toml").write_text(Path("lab.toml").read_text().replace("delay_s = 2e-05 ", "delay_s = 5e-05 # ours"))
    assert "lab.toml: `--out`: it is there already" in refused("model", "fmd+clumod-4", "--out", "lab.toml")
    assert model_file.read("lab.toml").tolerances.delay == 5e-5
    assert run("model", "fmd+clumod-4", "--out", "lab.toml", "--force")[0] == 0
    assert model_file.read("lab.toml").article == "fmd+clumod-4"
    Path("mine.toml").write_text(
        "format = 1\n[model]\narticle = 'fmd+clumod-1'\n[[effect]]\nid = 'force-gain:fmd-z2'\nvalue = 0.08\nsd = 0.01\n"
    )
    code, printed, _ = run("model", "mine.toml")
    assert code == 0
    assert "# relative gain of a force channel\n[[effect]]" in printed
    assert dict(model_file.of_text(printed, "m").effects[0].deviation) == {"": 0.01}


def test_a_model_in_json_becomes_one_that_can_be_edited_and_figures_of_the_drawing_stand_in_its_comments(run):
    text, added = '{"format": 1, "model": {"article": "fmd"}}', Added(named=parse("polarity:fmd-z1"))
    Path("lab.json").write_text(text)
    with pytest.raises(BadInput, match=r"massline model lab\.json --out FILE\.toml writes it as TOML"):
        model_file.with_effect(text, added, "lab.json")
    assert run("model", "lab.json", "--out", "lab.toml")[0] == 0
    edited = model_file.with_effect(Path("lab.toml").read_text(), added)
    assert model_file.of_text(edited, "lab.toml").effects[0].named.id == "polarity:fmd-z1"
    # Taking the signs # away and the drawing out makes it a statement of one's own.
    text = run("model", "fmd")[1].replace('inertia = "drawing"\n', "")
    for key in ("mass_kg", "cog_mm", "moi_cog_kgm2", "poi_cog_kgm2"):
        text = text.replace(f"# {key}", key)
    stated, drawn = model_file.of_text(text, "m.toml").fmd, routes.inertia(built_in("fmd"))
    np.testing.assert_allclose(stated.parameters, drawn.parameters, rtol=2e-3, atol=1e-6)  # printed with four digits


def test_a_users_own_files_stand_on_the_fmd(run):
    folder = Path("models")
    folder.mkdir()
    (folder / "satellite.h5").touch()
    code, _, said = run("model", "models/satellite.h5", "--out", "models/lab.toml")
    assert (code, said) == (0, "massline: wrote models/lab.toml.\n")
    model = model_file.read("models/lab.toml")
    assert (model.article, model.own) == ("fmd+satellite", {"fmd+satellite": "models/satellite.h5"})
    assert '"fmd+satellite" = "satellite.h5"' in Path("models/lab.toml").read_text()
    (folder / "bracket.step").touch()
    assert '"fmd+bracket" = "models/bracket.step"' in run("model", "models/bracket.step")[1]


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["clumod-1"], "article clumod-1: a model file describes what stands on the FMD, which must be the lowest of the stack"),
        (["fmd+clumd-1"], "Did you mean clumod-1?"),
        (["none.h5"], "none.h5: there is no such file"),
        (["none.step"], "none.step: there is no such file or folder"),
        (["fmd", "--out", "lab.json"], "lab.json: `--out`: a model file is written as .toml, found .json"),
        (["broken.toml"], "broken.toml: it is not TOML"),
        (["wrong.toml"], "wrong.toml: `modell`: no such key"),
    ],
)
def test_what_makes_no_model_is_refused(refused, arguments, says):
    Path("broken.toml").write_text("format = \n")
    Path("wrong.toml").write_text("format = 1\n[model]\narticle = 'fmd'\n[modell]\n")
    assert says in refused("model", *arguments)


ROOT = Path(__file__).parents[3]
PAGE = (ROOT / "docs" / "model-file.md").read_text(encoding="utf-8")
EXAMPLE = ROOT / "examples" / "example_series.toml"


def test_the_example_says_what_nominal_json_says_and_belongs_to_the_campaigns_of_the_data(data):
    known, model = json.loads((data / "example_series" / "nominal.json").read_text()), model_file.read(EXAMPLE)
    np.testing.assert_allclose(model.fmd.mass_matrix, known["fmd"]["mass_matrix_about_F"], rtol=1e-6, atol=1e-9)  # 7 digits
    assert model.cell_stiffness is not None
    np.testing.assert_allclose(model.cell_stiffness, [known["cell_stiffness_N_per_m"][axis] for axis in "xyz"])
    assert model.damping_ratio == known["damping_ratio_expected"]
    assert f"within {100 * model.fmd_tolerance:.0f} %" in known["note"]
    campaigns = [read_description(data / "example_series" / name) for name in ("fmd+disc+cuboid", "fmd+clumod-1")]
    require_pair(model_file.read(EXAMPLE), campaigns)


def test_every_key_and_every_correction_is_on_the_page():
    names = [one.name for one in fields(StructureTolerances)] + ["class", *(row.key for row in ROWS)]
    tables = (*model_file.MODEL, *model_file.STRUCTURE, *model_file.LABORATORY, *model_file.FMD, *model_file.EFFECT, *KINDS)
    for key in (*names, *tables):
        assert re.search(rf"[`.]{key}[`\]= ]", PAGE), key
    assert {one.name for one in fields(Tolerances)} == {*(row.name for row in ROWS if row.of == "chain"), "fmd_inertia"}
    for family in CORRECTIONS:
        assert f"`{family}`" in PAGE, family


def test_a_model_of_ones_own_is_examined(run, root: Path) -> None:
    runpy.run_path(str(root / "examples" / "own_model.py"))["write"](Path("own"))
    code, printed, said = run("model", "--examine", "own/bracket.npz")
    assert code == 0
    assert "nothing is wrong with it" in printed
    with np.load("own/bracket.npz") as file:
        arrays = dict(file)
    arrays["coordinates"][4, 0] += 5.0
    np.savez("own/slipped.npz", **arrays)
    code, printed, said = run("model", "--examine", "own/slipped.npz")
    assert code == 1
    assert "1 finding, the first is node place" in said
    for words in ("node 105", "where", "how much", "to do", "Correct its coordinates"):
        assert words in printed
    code, printed, _ = run("model", "--examine", "--json", "own/slipped.npz")
    found = json.loads(printed)
    assert (code, found["sound"]) == (1, False)
    assert [one["check"] for one in found["findings"]] == ["node place"]
    assert set(found["findings"][0]) == {"check", "what", "where", "amount", "remedy"}


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--examine", "nowhere.npz"), "there is no such file"),
        (("--examine", "broken.npz"), "cannot be read"),
        (("--examine", "story.toml"), "no finite-element model"),
        (("--examine", "broken.npz", "--out", "lab.toml"), "writes no file"),
        (("--json", "fmd"), "Use it with --examine"),
    ],
)
def test_what_cannot_be_examined_is_refused(run, arguments: tuple[str, ...], words: str) -> None:
    Path("broken.npz").write_bytes(b"PK and no more")
    Path("story.toml").write_text("format = 1\n")
    code, _, said = run("model", *arguments)
    assert code == 2
    assert words in said


@pytest.mark.parametrize(("support", "article"), [("ground", "beam"), ("free", "beam"), ("base", "fmd+beam")])
def test_only_what_stands_on_a_base_is_put_on_the_fmd(run, refused, tmp_path, support, article):
    """A tower on the ground was called "tower on the FMD", and FEs without a test were told to bring one."""
    np.savez(tmp_path / "beam.npz", stiffness=np.diag([1.0, 2.0]), mass=np.eye(2))
    described = f'format = 1\n[fe_model]\nkind = "matrices"\nfile = "beam.npz"\nsupport = "{support}"\n'
    (tmp_path / "beam.toml").write_text(described)
    assert run("model", "beam.toml", "--out", "lab.toml")[0] == 0
    assert f'article = "{article}"' in (tmp_path / "lab.toml").read_text()
    assert "without --test, one to simulate" in refused("simulate", "beam.toml", "--out", "none")
    (tmp_path / "bare.toml").write_text(described.replace("[fe_model]\n", ""))
    for command in (
        ("reference",),
        ("compare",),
        ("check",),
        ("modes",),
        ("simulate", "--out", "none"),
        ("model",),
        ("model", "--examine"),
    ):
        said = refused(*command, "bare.toml")
        assert "bare.toml: `kind`: 'matrices' is a structure, whose keys belong below [fe_model]. Write the line" in said


def test_modes_of_what_is_no_article_say_what_it_is(run, refused, tmp_path):
    """Of a model file it was said that a CAD file has no dimensions."""
    assert run("model", "fmd", "--out", "lab.toml")[0] == 0
    assert "this is a model file, not what is read here" in refused("modes", "lab.toml")
    (tmp_path / "test.toml").write_text('format = 1\nkind = "modal-table"\narticle = "frame"\n')
    for command in ("modes", "model"):  # which had put it on the FMD
        assert "this is a measurement file, not what is read here" in refused(command, "test.toml")
    assert "it is the folder of a test, where a file is needed. MODEL comes first" in refused("compare", ".", "lab.toml")


def test_a_table_is_meant_as_that_of_the_model_only_if_it_has_one_of_its_keys(refused, tmp_path):
    """Of a frame without its table "Did you mean nodes?" was asked."""
    (tmp_path / "bare.toml").write_text(
        'format = 1\nnodes = { foot = "0 m", top = "1 m" }\nmembers = { leg = ["foot", "top"] }\n'
    )
    said = refused("compare", "bare.toml")
    assert "the table [model] is missing" in said
    assert "Did you mean" not in said


@pytest.mark.parametrize("stated", ["fe_model = 3\n", '[[fe_model]]\nkind = "frame"\n'])
def test_what_is_no_table_does_not_say_how_a_structure_stands(run, tmp_path, stated):
    (tmp_path / "beam.toml").write_text(stated)
    assert run("model", "beam.toml", "--out", "lab.toml")[0] == 0
    assert 'article = "fmd+beam"' in (tmp_path / "lab.toml").read_text()


def test_a_model_file_is_written_anew_into_any_folder_from_which_its_files_are_seen(
    run, refused, tmp_path, three_floors, monkeypatch
):
    """Beside it the test was lost, and elsewhere its structure was not found."""
    (tmp_path / "there").mkdir()
    (tmp_path / "there" / "frame.toml").write_text(three_floors(struck=True) + "band = [0.123456789012345, 50.0]\n")
    was = model_file.read("there/frame.toml")
    for out in ("there/anew.toml", "above.toml"):
        assert run("model", "there/frame.toml", "--out", out)[0] == 0
        now = model_file.read(out)
        assert [Path(path).resolve() for path in now.own.values()] == [tmp_path / "there" / "frame.toml"]
        assert (Path(out).parent / now.tests[0]["file"]).resolve() == tmp_path / "there" / "data.csv"
        assert [{**one, "file": ""} for one in now.tests] == [{**one, "file": ""} for one in was.tests]
    assert 'frame" = "there/frame.toml"' in run("model", "there/frame.toml")[1]
    (tmp_path / "elsewhere").mkdir()
    assert "there/data.csv does not lie in" in refused("model", "there/frame.toml", "--out", "elsewhere/anew.toml")
    for source in ("there/frame.toml", "above.toml"):
        said = refused("model", source, "--out", "there/frame.toml", "--force")
        assert "the structure that it describes would not be in it any more" in said
    monkeypatch.chdir(tmp_path / "elsewhere")  # from where nothing of it is seen
    code, printed, said = run("model", "../there/frame.toml")
    assert code == 0
    assert 'frame" = "frame.toml"' in printed
    assert 'file = "data.csv"' in printed
    assert "its files are named as from ../there, where it belongs" in said
    monkeypatch.chdir(tmp_path)
    (tmp_path / "there" / "frame.toml").write_text(three_floors())
    assert run("model", "there/frame.toml", "--out", "elsewhere/anew.toml")[0] == 0


@pytest.mark.parametrize(("support", "article"), [("ground", "beam"), ("base", "fmd+beam")])
def test_data_stand_as_the_description_beside_them_says(run, tmp_path, support, article):
    """What stands on the ground was put on the FMD, where the data and not their description was named."""
    np.savez(tmp_path / "beam.npz", stiffness=np.eye(2), mass=np.eye(2))
    described = f'format = 1\n[fe_model]\nkind = "matrices"\nunits = "m-kg-N-s"\nsupport = "{support}"\n'
    (tmp_path / "beam.toml").write_text(described)
    assert run("model", "beam.npz", "--out", "lab.toml")[0] == 0
    assert f'article = "{article}"' in (tmp_path / "lab.toml").read_text()


def test_a_study_is_examined_as_its_structure_and_how_exact_its_reduction_is(run, tmp_path, three_floors):
    (tmp_path / "frame.toml").write_text(three_floors())
    own = 'format = 1\nmodel = { title = "", article = "frame" }\nstructure = { own = { frame = "frame.toml" } }\n'
    table = '[[test]]\nkind = "modal-table"\nfrequencies = [3.0, 9.0, 13.0]\nsensors = ["floor-1:x"]\nshapes = [[1], [1], [1]]\n'
    (tmp_path / "study.toml").write_text(own + table)
    code, printed, said = run("model", "--examine", "study.toml")
    assert code == 0, said
    assert "nothing is wrong with it" in printed
    assert "its tests up to 13 Hz see" in printed
