"""Campaign folders: read and written whole, never changed, never left; every fault of the contract's last paragraph named."""

import hashlib
import os
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from geometry.errors import BadInput
from identification import campaign_file
from identification.campaign import Campaign
from identification.files import uff
from identification.files.files import Signals, StatedUnits

Change = Callable[[h5py.File], object]


def spoilt(folder: Path, change: Change, run: str = "x") -> list[BadInput]:
    """What is wrong with the campaign after `change` to the file of `run`."""
    with h5py.File(folder / f"{run}.h5", "a") as file:
        change(file)
    return list(campaign_file.examine(folder).problems)


def replaced(name: str, make: Callable[[np.ndarray], np.ndarray]) -> Change:
    """A change of the samples of the channel `name`."""

    def change(file: h5py.File) -> None:
        samples = file[f"channels/{name}"][()]
        del file[f"channels/{name}"]
        file[f"channels/{name}"] = make(samples)

    return change


@pytest.mark.parametrize("ending", [".h5", ".csv", ".uff", ".mat"])
def test_a_campaign_that_is_written_is_read_as_it_was(campaign: Campaign, tmp_path: Path, ending: str) -> None:
    few = replace(campaign, runs=campaign.runs[:2])
    campaign_file.write(tmp_path / "c", few, ending=ending)
    found = campaign_file.read(tmp_path / "c")
    assert found.table.names == campaign.table.names
    assert [run.file for run in found.runs] == [f"{run.name}{ending}" for run in few.runs]
    assert found.warnings == ()
    for run in few.runs:
        one, other = found.recordings[run.name], campaign.recordings[run.name]
        assert one.sampling_rate == other.sampling_rate
        # E20.12 in ASCII universal files, else to the last bit
        assert_allclose(one.values, other.values, rtol=5.1e-13 if ending == ".uff" else 0)


def test_units_are_converted_at_the_door_and_back(campaign: Campaign, tmp_path: Path) -> None:
    units = {"acceleration": "g", "force": "lbf"}
    table = replace(
        campaign.table, channels=tuple(replace(channel, unit=units[channel.quantity]) for channel in campaign.table.channels)
    )
    for ending in (".h5", ".uff"):
        folder = tmp_path / ending[1:]
        campaign_file.write(folder, replace(campaign, table=table, runs=campaign.runs[:1]), ending=ending)
        found = campaign_file.read(folder)
        # divided by the unit and multiplied again: two roundings, and E20.12 in the universal file
        assert_allclose(found.recordings["x"].values, campaign.recordings["x"].values, rtol=1e-12 if ending == ".uff" else 5e-16)
    with h5py.File(tmp_path / "h5" / "x.h5") as file:
        inside = file["channels/table-z1"][()]
    assert_allclose(inside * 9.80665, campaign.recordings["x"].channel("table-z1"), rtol=5e-16)


def test_reading_changes_nothing(folder: Path) -> None:
    def state() -> dict[str, tuple[str, int]]:
        return {
            entry.name: (hashlib.sha256(entry.read_bytes()).hexdigest(), entry.stat().st_mtime_ns) for entry in folder.iterdir()
        }

    before = state()
    for entry in folder.iterdir():
        entry.chmod(0o444)
    folder.chmod(0o555)
    try:
        campaign_file.read(folder)
    finally:
        folder.chmod(0o755)
    assert state() == before


def test_the_description_alone_is_read_without_the_signals(folder: Path) -> None:
    for entry in folder.glob("*.h5"):
        entry.unlink()
    described = campaign_file.read_description(folder)
    assert (len(described.table), len(described.runs), dict(described.recordings)) == (22, 6, {})


def test_what_is_there_is_never_overwritten(campaign: Campaign, folder: Path) -> None:
    with pytest.raises(BadInput, match="never overwritten"):
        campaign_file.write(folder, campaign)


def test_progress_may_end_the_work_and_leaves_no_campaign(campaign: Campaign, tmp_path: Path) -> None:
    def interrupt(share: float) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        campaign_file.write(tmp_path / "c", campaign, progress=interrupt)
    with pytest.raises(BadInput, match=r"holds no campaign\.toml"):
        campaign_file.read(tmp_path / "c")


def test_progress_runs_from_nothing_to_one(folder: Path) -> None:
    shares: list[float] = []
    campaign_file.read(folder, progress=shares.append)
    assert shares == sorted(shares)
    assert shares[-1] == 1.0


@pytest.mark.parametrize(
    ("change", "field", "words"),
    [
        (
            replaced("cover-z1", lambda x: np.where(np.arange(len(x)) == 7, np.nan, x)),
            "cover-z1",
            "1 samples that are NaN, the first is number 8",
        ),
        (replaced("cover-z1", lambda x: np.where(np.arange(len(x)) > 1, np.inf, x)), "cover-z1", "infinite"),
        (replaced("fmd-x12", lambda x: 0 * x + 3.5), "fmd-x12", "is dead: all 1536 samples are 3.5"),
        (replaced("fmd-x12", lambda x: 1e200 * x), "fmd-x12", "no sensor reads"),
        (replaced("fmd-x12", lambda x: x + 0j), "fmd-x12", "is complex"),
        (replaced("fmd-x12", lambda x: x[:-1]), "fmd-x12", "1535 samples"),
        (lambda file: file["channels"].move("cover-z1", "cover-zl"), "cover-z1", "Did you mean cover-zl"),
        (lambda file: file["channels"].move("cover-z1", "cover-zl"), "cover-zl", "not in campaign.toml"),
        (lambda file: file["channels"].copy("cover-z1", "cover-z9"), "cover-z9", "not in campaign.toml"),
        (lambda file: file.attrs.__delitem__("sampling_rate"), "sampling_rate", "found neither"),
    ],
)
def test_a_fault_of_a_file_names_file_channel_and_what_to_do(folder: Path, change: Change, field: str, words: str) -> None:
    found = spoilt(folder, change)
    hits = [one for one in found if one.field == field and words in str(one)]
    assert len(hits) == 1, [str(one) for one in found]
    assert hits[0].source.endswith("x.h5")
    assert hits[0].remedy


def test_all_that_is_wrong_with_a_folder_is_said_at_once(folder: Path) -> None:
    spoilt(folder, replaced("cover-z1", lambda x: 0 * x), run="x")
    spoilt(folder, replaced("fmd-z2", lambda x: np.nan * x), run="y")
    (folder / "gamma.h5").unlink()
    found = campaign_file.examine(folder)
    assert [Path(one.source).name for one in found.problems] == ["x.h5", "y.h5", "gamma.h5"]
    assert sorted(found.campaign.recordings) == ["alpha", "beta", "z"]
    with pytest.raises(BadInput, match="massline check` lists this and 2 more"):
        campaign_file.read(folder)


def test_a_clipped_channel_is_a_warning_with_its_name(folder: Path) -> None:
    assert spoilt(folder, replaced("cover-x1", lambda x: np.clip(x, -2.0, 2.0))) == []
    warnings = campaign_file.read(folder).warnings
    assert len(warnings) == 1
    assert "x.h5: cover-x1 is clipped" in warnings[0]


@pytest.mark.parametrize(
    ("without", "said"),
    [
        (("cover-x1", "cover-x2", "table-x1"), "the base motion x cannot be told"),
        (("fmd-z1", "fmd-z2", "fmd-z3", "fmd-z4"), "resultants f_z, t_x, t_y cannot be told"),
    ],
)
def test_a_table_that_leaves_motions_or_loads_unobservable_is_refused_by_their_names(
    campaign: Campaign, tmp_path: Path, without: tuple[str, ...], said: str
) -> None:
    kept = [k for k, name in enumerate(campaign.table.names) if name not in without]
    table, one = campaign.table.subset(kept), campaign.recordings["x"]
    few = replace(campaign, runs=campaign.runs[:1], recordings={"x": replace(one, names=table.names, values=one.values[:, kept])})
    campaign_file.write(tmp_path / "c", replace(few, table=table))
    (found,) = campaign_file.examine(tmp_path / "c").problems
    assert said in str(found)


def test_a_record_shorter_than_its_sweep_is_doubted(folder: Path) -> None:
    with h5py.File(folder / "x.h5", "a") as file:
        file.attrs["sampling_rate"] = 512.0
    warnings = campaign_file.read(folder).warnings
    assert any("x.h5: lasts 3.0 s where its sweep takes 4.0 s" in warning for warning in warnings)
    assert any("not recorded alike, found 256 Hz, 512 Hz" in warning for warning in warnings)


def test_a_unit_that_dataset_164_contradicts_is_named_with_both(campaign: Campaign, tmp_path: Path) -> None:
    campaign_file.write(tmp_path / "c", replace(campaign, runs=campaign.runs[:1]), ending=".uff")
    recorded = campaign.recordings["x"]
    wrong = Signals(
        source="made",
        samples={name: recorded.values[:, k] for k, name in enumerate(recorded.names)},
        sampling_rate=recorded.sampling_rate,
        units=dict.fromkeys(recorded.names, StatedUnits(length=0.0254, force=4.4482216152605, words="IN")),
    )
    uff.write(tmp_path / "c" / "x.uff", wrong)
    found = campaign_file.examine(tmp_path / "c").problems
    assert len(found) == 22
    force = next(one for one in found if one.field == "fmd-z1")
    assert "dataset 164" in force.problem
    assert "lbf" in force.problem
    assert "campaign.toml in N" in force.problem


def test_a_label_that_is_another_unit_is_named_with_both(campaign: Campaign, tmp_path: Path) -> None:
    campaign_file.write(tmp_path / "c", replace(campaign, runs=campaign.runs[:1]), ending=".uff")
    path = tmp_path / "c" / "x.uff"
    path.write_bytes(path.read_bytes().replace(b" m/s^2               ", b" g                   ", 1))
    found = campaign_file.examine(tmp_path / "c").problems
    assert [one.field for one in found] == ["table-z1"]
    assert "labelled g" in found[0].problem


class TestPaths:
    """A campaign is what lies in its folder: nothing reads beyond it."""

    def renamed(self, folder: Path, name: str) -> BadInput:
        text = (folder / "campaign.toml").read_text(encoding="utf-8")
        (folder / "campaign.toml").write_text(text.replace('file = "x.h5"', f"file = {name}"), encoding="utf-8")
        found = campaign_file.examine(folder).problems
        assert len(found) == 1
        return found[0]

    @pytest.mark.parametrize("name", ["../x.h5", "a/../../x.h5", "/etc/passwd.h5", "C:\\\\x.h5", "..\\\\x.h5", "\\u0000.h5"])
    def test_a_path_out_of_the_folder_is_refused(self, folder: Path, name: str) -> None:
        (folder.parent / "x.h5").write_bytes((folder / "x.h5").read_bytes())
        error = self.renamed(folder, f'"{name}"')
        assert error.field == "run.x.file"
        assert "inside the folder" in error.problem

    def test_a_file_in_a_folder_below_is_read(self, folder: Path) -> None:
        (folder / "below").mkdir()
        (folder / "x.h5").rename(folder / "below" / "x.h5")
        text = (folder / "campaign.toml").read_text(encoding="utf-8")
        (folder / "campaign.toml").write_text(text.replace('"x.h5"', '"below/x.h5"'), encoding="utf-8")
        assert len(campaign_file.read(folder).recordings) == 6

    @pytest.mark.parametrize("name", ["x.h5", "campaign.toml"])
    def test_links_are_not_followed(self, folder: Path, name: str) -> None:
        (folder / name).rename(folder.parent / name)
        (folder / name).symlink_to(folder.parent / name)
        assert "link" in str(campaign_file.examine(folder).problems[0])

    def test_a_folder_that_is_a_link_inside_is_not_followed(self, folder: Path) -> None:
        (folder / "below").symlink_to(folder.parent)
        assert "link 'below'" in str(self.renamed(folder, '"below/x.h5"'))

    @pytest.mark.parametrize("name", ["x.h5", "campaign.toml"])
    def test_a_pipe_does_not_hang_the_reader(self, folder: Path, name: str) -> None:
        (folder / name).unlink()
        os.mkfifo(folder / name)
        assert "a device or a pipe" in str(campaign_file.examine(folder).problems[0])

    def test_a_huge_file_and_a_folder_in_place_of_one_are_refused_before_they_are_read(self, folder: Path) -> None:
        with (folder / "x.h5").open("r+b") as file:
            file.truncate(3 * 2**30)  # sparse: no disk is filled
        (folder / "y.h5").unlink()
        (folder / "y.h5").mkdir()
        huge, no_file = map(str, campaign_file.examine(folder).problems)
        assert "3 GiB, more than 2" in huge
        assert "no regular file" in no_file

    def test_a_name_that_no_file_can_have_is_refused(self, folder: Path) -> None:
        said = str(self.renamed(folder, f'"{"x" * 300}.h5"'))
        assert "cannot be read" in said or "there is no such file" in said  # the second from Python 3.14 on

    @pytest.mark.parametrize("name", ["nowhere", "campaign/campaign.toml", "."])
    def test_what_is_no_campaign_is_refused(self, folder: Path, name: str) -> None:
        with pytest.raises(BadInput):
            campaign_file.read(folder.parent / name)


def test_channels_that_a_mat_file_cannot_tell_apart_are_refused(campaign: Campaign, tmp_path: Path) -> None:
    campaign_file.write(tmp_path / "c", replace(campaign, runs=campaign.runs[:1]), ending=".mat")
    text = (tmp_path / "c" / "campaign.toml").read_text(encoding="utf-8").replace('"cover-z2"', '"cover_z1"')
    (tmp_path / "c" / "campaign.toml").write_text(text, encoding="utf-8")
    assert "cannot tell them apart" in str(campaign_file.examine(tmp_path / "c").problems[0])


@pytest.mark.parametrize("name", ["../x", "a/b", ".hidden", "a\nb"])
def test_a_run_whose_name_is_no_file_name_is_refused_on_writing(campaign: Campaign, tmp_path: Path, name: str) -> None:
    runs = (replace(campaign.runs[0], name=name),)
    with pytest.raises(BadInput, match="name of a file"):
        campaign_file.write(tmp_path / "c", replace(campaign, runs=runs, recordings={name: campaign.recordings["x"]}))
    assert not list(tmp_path.iterdir())


def test_a_run_without_recording_is_refused_on_writing(campaign: Campaign, tmp_path: Path) -> None:
    with pytest.raises(BadInput, match="no recording"):
        campaign_file.write(tmp_path / "c", replace(campaign, recordings={}))


def test_campaigns_that_another_program_wrote_are_read(data: Path) -> None:
    """Figures of the folders' own campaign.toml and of nominal.json beside them."""
    folders = sorted(path.parent for path in (data / "example_series").glob("*/campaign.toml"))
    assert [folder.name for folder in folders] == ["fmd+clumod-1", "fmd+disc+cuboid"]
    for folder in folders:
        campaign = campaign_file.read(folder)
        assert campaign.warnings == ()
        assert campaign.article == folder.name
        assert {one.sampling_rate for one in campaign.recordings.values()} == {564.0}
        assert {one.values.shape for one in campaign.recordings.values()} == {(60000, 22)}
    with h5py.File(folders[0] / "x.h5") as file:
        assert_array_equal(campaign_file.read(folders[0]).recordings["x"].channel("fmd-z4"), file["channels/fmd-z4"][()])
