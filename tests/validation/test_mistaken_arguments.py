"""Arguments that stand in each other's place, or that are forgotten, are said to be that."""

import pytest


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("compare", "series", "m.toml"), "it is the folder of a campaign, where a file is needed. MODEL comes first"),
        (("identify", "m.toml"), "it is a model file without a [[test]], no measurement"),
        (("compare", "m.toml", "m.toml"), "it is a model file, where a measurement is needed"),
        (("check", "m.toml"), "it is a model file without a [[test]], no measurement"),
        (("compare", "H.unv", "m.toml"), "it is a universal file, a measurement, where a file in TOML is needed. MODEL"),
        (("identify", "deck.inp"), "it is a deck of a finite-element program. Describe its structure first"),
        (("model", "bar.msh"), "it is a mesh, which does not say what it is made of. Describe its structure first: [fe_model]"),
        (("check", "none.uff"), "none.uff: there is no such file. Check the path"),
        (("check", "hammer"), "hammer/test.toml: `article`: is missing"),
        (("identify", "hammer"), "hammer/test.toml: `article`: is missing"),
        (("compare", "m.toml", "hammer"), "hammer/test.toml: `files`: one of `file` and `files` is needed"),
        (
            ("check", "blows"),
            "nor a test.toml that says where 1.csv and 1 more were driven and read. Write test.toml beside them",
        ),
        (("compare", "m.toml", "blows"), 'files = [{ path = "1.csv", drive = "tip:z" }, ...], responses = ["tip:z", "root:z"]'),
        (("compare", "hammer/test.toml", "m.toml"), "where a model file is needed. MODEL comes first and DATA behind it"),
        (
            ("correct", "hammer", "force-gain:tip-z=0.1", "--out", "o"),
            "it is no campaign, of whose records alone",
        ),
        (("correct", "hammer/test.toml", "unit:tip-z=9.8", "--out", "o"), "`massline add MODEL EFFECT hammer/test.toml`"),
        (
            ("report", "m.toml", "series", "--out", "x.pdf"),
            "a report, of which --pdf prints a PDF beside it, is written",
        ),
        (("reference", "m.toml"), "this is a model file, not what is read here"),
        (("modes", "study.toml"), "this is a model file, not what is read here. Name the structure that it names: tower.toml"),
        (("add", "m.toml", "series"), "the effect stands before DATA"),
        (("excite", "fmd", "--axis", "rx"), "Did you mean alpha?"),
        (("excite", "fmd", "--axis", "ry"), "Did you mean beta?"),
        (("excite", "fmd", "--axis", "Yaw"), "Did you mean gamma?"),
    ],
)
def test_what_was_mistaken_is_said(refused, run, tmp_path, arguments, words):
    run("model", "fmd+clumod-1", "--out", "m.toml")
    (tmp_path / "H.unv").write_text("    -1\n", encoding="utf-8")
    (tmp_path / "deck.inp").write_text("*NODE\n", encoding="utf-8")
    (tmp_path / "bar.msh").write_text("$MeshFormat\n", encoding="utf-8")
    for name in ("series", "hammer", "blows"):
        (tmp_path / name).mkdir()
    for name in ("1.csv", "2.csv"):
        (tmp_path / "blows" / name).write_text("time,force,tip\n0,0,0\n", encoding="utf-8")
    (tmp_path / "hammer" / "test.toml").write_text('format = 1\nkind = "response-functions"\n', encoding="utf-8")
    own = 'model = { title = "", article = "tower" }\nstructure = { own = { tower = "tower.toml" } }\n'
    (tmp_path / "study.toml").write_text(own, encoding="utf-8")
    (tmp_path / "series" / "campaign.toml").write_text("format = 1\n", encoding="utf-8")
    assert words in refused(*arguments)
