"""What is handed over goes nowhere else, and everything that is wrong is told beside the file and field that has it."""

import shutil
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from geometry.errors import BadInput
from validation.app.opening import Fault, Handed, faults, of_error, received, sorted_out

MALICIOUS = (
    "../evil.toml",
    "a/../../evil.toml",
    "/etc/passwd",
    "\\\\server\\share\\x",
    "C:\\windows\\x",
    "..\\..\\evil",
    "a\x00b",
    "a/b\n/c",
    "..",
    ".",
    "",
    "a//../b",
    "con",
    "lpt1.txt",
    "x" * 300,
    "/".join("abcdefghij"),
    "trailing.",
    "what?.h5",
    "\ud800.h5",
    "<img src=x onerror=alert(1)>.h5",
)


@pytest.mark.parametrize("name", MALICIOUS)
def test_a_malicious_name_goes_nowhere(tmp_path, name):
    folder = tmp_path / "deep" / "desk"
    found = received(folder, [Handed(name=name, content=b"x")])
    assert [path for path in tmp_path.rglob("*") if path.is_file()] == []
    (fault,) = found.faults
    assert fault.grave
    assert fault.remedy
    assert fault.field.isprintable()


HIDDEN = (
    ".DS_Store",
    ".ssh/authorized_keys",
    "dir/.hidden",
    ".git/config",
    "a/.~lock.model.toml#",
    "a/Thumbs.db",
    "a\\desktop.ini",
)


@pytest.mark.parametrize("name", HIDDEN)
def test_what_a_system_hides_beside_the_users_files_is_passed_over_in_words(tmp_path, name):
    found = received(tmp_path / "desk", [Handed(name="a/x.h5", content=b"1"), Handed(name=name, content=b"2")])
    assert [path.name for path in tmp_path.rglob("*") if path.is_file()] == ["x.h5"]
    (fault,) = found.faults
    assert not fault.grave
    assert "passed over" in fault.problem
    assert fault.field == name


@pytest.mark.parametrize("name", ["a/../.ssh/config", "../.x", "/.x"])
def test_a_hidden_name_that_climbs_is_still_refused(tmp_path, name):
    found = received(tmp_path / "deep" / "desk", [Handed(name=name, content=b"x")])
    assert [path for path in tmp_path.rglob("*") if path.is_file()] == []
    assert found.faults[0].grave


@pytest.mark.parametrize("name", ["s/model.toml", "S/Model.toml"])
def test_a_file_that_was_mended_takes_the_place_of_the_one_before(tmp_path, block, name):
    """Handed over whole, with what did not change."""
    root = Path(block.model).parent
    others = [path for path in root.rglob("*") if path.is_file() and path.name != "model.toml"]
    rest = [Handed(name=f"s/{path.relative_to(root).as_posix()}", content=path) for path in others]
    assert received(tmp_path, [Handed(name="s/model.toml", content=b"[model"), *rest]).faults == ()
    again = received(tmp_path, [Handed(name=name, content=Path(block.model)), *rest])
    assert again.faults == ()
    assert [Path(path).name for path in again.models] == [Path(name).name]
    assert Path(again.models[0]).read_bytes() == Path(block.model).read_bytes()
    assert len(again.data) == 1
    assert not [one for one in faults(again.models[0], again.data) if one.grave]


def test_folders_are_kept_and_the_model_that_was_handed_over_last_comes_first(tmp_path, block):
    received(tmp_path, [Handed(name="a/model.toml", content=b"[model")])
    found = received(tmp_path, [Handed(name="b/model.toml", content=Path(block.model))])
    assert [Path(path).parent.name for path in found.models] == ["b", "a"]
    (tmp_path / "there").write_bytes(b"two")
    handed = [Handed(name="series/one/x.h5", content=b"one"), Handed(name="series\\one\\y.h5", content=tmp_path / "there")]
    found = received(tmp_path / "desk", handed)
    assert found.faults == ()
    assert (found.folder / "series" / "one" / "x.h5").read_bytes() == b"one"
    assert (found.folder / "series" / "one" / "y.h5").read_bytes() == b"two"


def test_a_file_that_replaces_another_counts_once(tmp_path):
    received(tmp_path, [Handed(name="a", content=b"x" * 60)], limit=100)
    found = received(tmp_path, [Handed(name="a", content=b"y" * 80), Handed(name="b", content=b"x" * 20)], limit=100)
    assert found.faults == ()
    assert (found.folder / "a").read_bytes() == b"y" * 80


@given(name=st.text(alphabet=st.sampled_from("ab./\\:.. \x00\u202e~$%"), max_size=24))
def test_no_name_leaves_the_folder(tmp_path_factory, name):
    around = tmp_path_factory.mktemp("around")
    received(around / "desk", [Handed(name=name, content=b"x")])
    files = [path for path in around.rglob("*") if path.is_file()]
    assert all(path.resolve().is_relative_to(around / "desk" / "given") for path in files)


@pytest.mark.parametrize("second", ["a/x.h5", "A/X.H5", "a/./x.h5", "a", "a/x.h5/y"])
def test_a_name_that_is_taken_is_refused(tmp_path, second):
    found = received(tmp_path, [Handed(name="a/x.h5", content=b"1"), Handed(name=second, content=b"2")])
    assert "already" in found.faults[0].problem
    assert (found.folder / "a" / "x.h5").read_bytes() == b"1"


def test_what_does_not_fit_is_refused_with_what_came_before_counted(tmp_path):
    received(tmp_path, [Handed(name="a", content=b"x" * 60)], limit=100)
    found = received(tmp_path, [Handed(name="b", content=b"x" * 60), Handed(name="c", content=b"x" * 40)], limit=100)
    assert [one.field for one in found.faults] == ["b"]
    assert (found.folder / "c").exists()


def test_a_dropped_series_is_told_apart_and_a_campaign_without_its_folder_is_one(tmp_path, block):
    root = Path(block.model).parent
    files = [path for path in root.rglob("*") if path.is_file()]
    found = received(tmp_path, [Handed(name=f"s/{path.relative_to(root).as_posix()}", content=path) for path in files])
    assert found.faults == ()
    assert found.models == (str(found.folder / "s" / "model.toml"),)
    assert found.data == (str(found.folder / "s" / "fmd+cuboid"),)
    folder, model = Path(block.data[0]), Path(block.model)
    found = received(tmp_path, [Handed(name=path.name, content=path) for path in (model, *folder.iterdir())])
    assert found.data == (str(found.folder),)
    assert found.models == (str(found.folder / "model.toml"),)


def test_a_folder_of_ones_own_is_looked_through_and_links_are_not_followed(tmp_path, block):
    (tmp_path / "link").symlink_to(Path(block.model).parent)
    (tmp_path / "weighing.toml").write_text('format = 1\nkind = "weighing"\n')
    (tmp_path / "notes.json").write_text("{}")
    found = sorted_out(tmp_path)
    assert (found.models, found.data) == ((), (str(tmp_path / "weighing.toml"),))
    with pytest.raises(BadInput, match="no such folder"):
        sorted_out(tmp_path / "nowhere")


def test_a_sound_series_has_no_grave_fault(block):
    heard: list[str] = []
    found = faults(block.model, block.data, progress=lambda what, share: heard.append(what))
    assert not any(one.grave for one in found)
    assert any("fmd+cuboid" in what for what in heard)


def test_no_fault_hides_the_next(tmp_path, block):
    model = tmp_path / "model.toml"
    model.write_text(Path(block.model).read_text().replace("[tolerances]", "[tolerances]\nsurplus = 1"))
    shutil.copytree(block.data[0], tmp_path / "one")
    described = tmp_path / "one" / "campaign.toml"
    text = described.read_text().replace('unit = "N"', 'unit = "cubits"', 1)
    described.write_text(text.replace('file = "x.h5"', 'file = "../x.h5"'))
    (tmp_path / "weighing.toml").write_text('format = 1\nkind = "weighing"\n')
    found = faults(str(model), [str(tmp_path / "one"), str(tmp_path / "weighing.toml"), str(tmp_path / "nowhere")])
    assert all(one.grave and one.problem and one.remedy for one in found if one.grave)
    said = {(Path(one.file).name, one.field) for one in found}
    assert ("model.toml", "tolerances.surplus") in said
    assert any(file == "campaign.toml" and "unit" in field for file, field in said)
    assert any("x" in field and file == "campaign.toml" for file, field in said)
    assert any(file == "weighing.toml" for file, _ in said)
    assert any(file == "nowhere" for file, _ in said)


def test_what_does_not_belong_together_is_a_fault_which_reads_as_a_refusal_does(tmp_path, block):
    model = tmp_path / "model.toml"
    model.write_text(Path(block.model).read_text().replace('article = "fmd+cuboid"', 'article = "fmd+clumod-1"'))
    (fault,) = [one for one in faults(str(model), block.data) if one.grave]
    assert fault.field == "model.article"
    error = BadInput("a.toml", "x", "is wrong", "Mend it")
    assert of_error(error).text == str(error).rstrip(".")
    assert Fault(file="a", field="", problem="odd", grave=False).text == "a: odd"
