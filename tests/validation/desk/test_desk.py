"""A desk keeps what it was asked, survives what befalls it, and leaves the user's files alone."""

import json
from math import inf
from pathlib import Path

import numpy as np
import pytest

from geometry.errors import BadInput
from validation.app import kept, session
from validation.app.kept import moved
from validation.app.session import begun, opened
from validation.estimation.problem import Evaluation, Fit, Parameter, Share
from validation.model import model_file

OWN = """
[structure]
kind = "own"

[structure.own]  # mine
"fmd+box" = "models/box.h5"  # seen from here
"""


def test_a_desk_is_opened_as_it_was_begun(block, tmp_path):
    made = begun(tmp_path / "d", block.model, block.data, hold_out=("z",), band=(8, 12), method="full-record", title="<b>")
    assert opened(tmp_path / "d") == made
    assert made.asked.band == (8.0, 12.0)
    assert made.asked.hold_out == ("z",)
    assert made.title == "<b>"
    state = json.loads((made.folder / "desk.json").read_text())
    assert (state["format"], state["kind"]) == (1, "massline desk")


def test_a_run_that_is_held_out_is_no_file_that_happens_to_have_its_name(block, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "z").mkdir()
    (tmp_path / "here").symlink_to(block.data[0])
    made = begun(tmp_path / "d", block.model, ["here"], hold_out=("z", "here/"))
    assert made.asked.hold_out == ("z", str(Path(block.data[0]).resolve()))


def test_what_a_page_keeps_is_there_after_a_reload_unless_damaged_and_a_full_folder_is_no_new_desk(bare, block):
    assert bare.view() == {}
    bare.keep_view({"entry": [2, 4], "campaign": "é"})
    assert opened(bare.folder).view() == {"entry": [2, 4], "campaign": "é"}
    (bare.folder / "view.json").write_text("{")
    assert bare.view() == {}
    with pytest.raises(BadInput, match="not empty"):
        begun(bare.folder, block.model, block.data)


@pytest.mark.parametrize("text", ["", "[]", "{", '{"kind": "massline desk"}', '{"kind": "massline desk", "format": 1}'])
def test_a_damaged_desk_says_so(bare, text):
    (bare.folder / "desk.json").write_text(text)
    with pytest.raises(BadInput, match="desk"):
        opened(bare.folder)


def test_where_no_desk_is_none_is_opened_two_of_one_model_stay_apart_and_what_is_no_model_begins_none(tmp_path, block):
    with pytest.raises(BadInput, match="no desk here"):
        opened(tmp_path)
    assert not session.is_session(tmp_path)
    before = Path(block.model).read_bytes()
    one, other = (begun(tmp_path / name, block.model, block.data) for name in ("one", "other"))
    one.model.write_text(one.model.read_text() + "\n# mine\n")
    assert other.model.read_bytes() == before == Path(block.model).read_bytes()
    assert one.found != other.found
    (tmp_path / "model.toml").write_text("[model")
    with pytest.raises(BadInput, match="TOML"):
        begun(tmp_path / "d", tmp_path / "model.toml", block.data)
    assert not session.is_session(tmp_path / "d")


def test_the_users_own_models_are_found_from_the_working_copy(block, tmp_path):
    """Only the path changes: a comment behind it, and every other line, stay."""
    (tmp_path / "models").mkdir()
    (tmp_path / "models" / "box.h5").write_bytes(b"")
    text = Path(block.model).read_text().split("[structure]")[0].replace('"fmd+cuboid"', '"fmd+box"') + OWN.lstrip()
    (tmp_path / "model.toml").write_text(text)
    made = begun(tmp_path / "deep" / "d", tmp_path / "model.toml", block.data)
    assert model_file.read(made.model).own["fmd+box"] == str(tmp_path / "models" / "box.h5")
    assert made.model.read_text() == text.replace('"models/box.h5"', '"../../../models/box.h5"')
    assert moved(made.model.read_text(), made.model, tmp_path / "model.toml") == text


def test_paths_that_cannot_be_said_anew_are_refused(block, tmp_path):
    (tmp_path / "box.h5").write_bytes(b"")
    text = Path(block.model).read_text().split("[structure]")[0].replace('"fmd+cuboid"', '"fmd+box"')
    (tmp_path / "model.toml").write_text(f'{text}[structure]\nkind = "own"\nown = {{ "fmd+box" = "box.h5" }}\n')
    with pytest.raises(BadInput, match="one a line"):
        begun(tmp_path / "d", tmp_path / "model.toml", block.data)


def test_what_is_kept_comes_back_as_it_was_and_nothing_of_another_kind(tmp_path):
    parameter = Parameter(name="a", unit="kg", tolerance=inf, channels=(np.int64(3), 4), plausible=0.1)
    numbers = {"cost": inf, "chi2": np.float64(2.5), "tolerance_z2": 0.0, "log_evidence": -inf}
    arrays = {"offsets": np.array([0.25]), "covariance": np.array([[4.0]])}
    fit = Fit(parameters=(parameter,), degrees_of_freedom=3, tolerances=0, converged=False, ahead={"a": 1.5}, **arrays, **numbers)
    share = Share(percent=1.0, by_channel={"fmd-z1": 2.0})
    known = {"nominal": share, "plain": share, "held_out": None, "held_out_nominal": share, "plain_fit": fit, "fitted": fit}
    of = kept.KeptFits(before=Evaluation(**known, held_out_names=("z",)), after=Evaluation(**known))
    kept.write(tmp_path / "fits.npz", of)
    found = kept.read(kept.KeptFits, tmp_path / "fits.npz").before
    assert vars(found.nominal) == vars(share)
    assert (found.held_out, found.held_out_names) == (None, ("z",))
    assert {**vars(found.fitted), **arrays} == {**vars(fit), **arrays}
    for name, values in arrays.items():
        assert np.array_equal(getattr(found.fitted, name), values)
    assert list(kept.words(tmp_path / "fits.npz")) == ["before", "after"]
    with pytest.raises(session.DAMAGE):
        kept.read(kept.KeptSeries, tmp_path / "fits.npz")
