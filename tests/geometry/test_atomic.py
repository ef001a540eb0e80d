"""A file is there whole or not at all, and nothing else is left beside it."""

import os
from pathlib import Path

import pytest

from geometry.atomic import probe, probe_folder, write_folder, write_text, write_with


def test_text_arrives_as_written_in_folders_that_did_not_exist(tmp_path: Path) -> None:
    path = tmp_path / "a" / "b" / "table.md"
    write_text(path, "Θ = 1 kg m²\n")
    assert path.read_text(encoding="utf-8") == "Θ = 1 kg m²\n"
    assert [entry.name for entry in path.parent.iterdir()] == ["table.md"]


@pytest.mark.parametrize("interruption", [OSError("disk full"), KeyboardInterrupt()])
@pytest.mark.parametrize("before", [None, "old"])
def test_an_interruption_leaves_the_old_file_or_none(tmp_path: Path, interruption: BaseException, before: str | None) -> None:
    path = tmp_path / "picture.png"
    if before is not None:
        path.write_text(before)

    def half(temporary: Path) -> None:
        temporary.write_text("half of i")
        raise interruption

    with pytest.raises(type(interruption)):
        write_with(path, half)
    assert [entry.read_text() for entry in tmp_path.iterdir()] == ([] if before is None else [before])


def test_a_folder_replaces_another_as_a_whole(tmp_path: Path) -> None:
    folder = tmp_path / "a" / "campaign"
    for name in ("old", "new"):
        write_folder(folder, lambda new, name=name: write_text(new / name, name))  # type: ignore[misc]
        assert [entry.name for entry in folder.iterdir()] == [name]
    assert [entry.name for entry in folder.parent.iterdir()] == ["campaign"]


@pytest.mark.parametrize("interruption", [OSError("disk full"), KeyboardInterrupt()])
@pytest.mark.parametrize("before", [False, True])
@pytest.mark.parametrize("when", ["filling", "renaming"])
def test_an_interruption_leaves_the_old_folder_or_none(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, interruption: BaseException, before: bool, when: str
) -> None:
    folder, rename = tmp_path / "campaign", Path.rename
    if before:
        write_folder(folder, lambda new: write_text(new / "old", "old"))

    def half(new: Path) -> None:
        write_text(new / "half", "of it")
        if when == "filling":
            raise interruption

    def stopped(path: Path, target: Path) -> Path:
        if path.name == "new":
            raise interruption
        return rename(path, target)

    monkeypatch.setattr(Path, "rename", stopped)
    with pytest.raises(type(interruption)):
        write_folder(folder, half)
    assert [str(path.relative_to(tmp_path)) for path in sorted(tmp_path.rglob("*"))] == (
        ["campaign", "campaign/old"] if before else []
    )


def test_the_writer_sees_the_ending_that_it_chooses_its_format_by(tmp_path: Path) -> None:
    seen: list[str] = []
    write_with(tmp_path / "x.step", lambda temporary: seen.append(temporary.suffix))
    assert seen == [".step"]


def test_others_may_read_what_was_written(tmp_path: Path) -> None:
    write_text(tmp_path / "x.txt", "x")
    assert (tmp_path / "x.txt").stat().st_mode & 0o777 == 0o644


def test_a_link_stays_a_link_and_its_file_is_replaced(tmp_path: Path) -> None:
    real, link = tmp_path / "real.txt", tmp_path / "link.txt"
    real.write_text("old")
    link.symlink_to(real)
    write_text(link, "new")
    assert link.is_symlink()
    assert real.read_text() == "new"


def test_what_is_no_regular_file_is_left_alone(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    with pytest.raises(OSError, match="no regular file"):
        write_text(pipe, "x")
    assert pipe.is_fifo()


@pytest.mark.parametrize("name", ["", "folder"])
def test_an_error_names_the_path_that_was_given(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "folder").mkdir()
    monkeypatch.chdir(tmp_path)
    with pytest.raises(OSError, match="this is a folder") as caught:
        write_text(Path(name), "x")
    assert caught.value.filename == str(Path(name))
    assert [entry.name for entry in tmp_path.iterdir()] == ["folder"]


def test_what_can_be_written_is_tried_without_a_trace(tmp_path: Path) -> None:
    (tmp_path / "there.txt").write_text("old")
    for name in ("there.txt", "new.txt", "folder/new.txt"):
        probe(tmp_path / name)
    assert [entry.read_text() for entry in tmp_path.iterdir()] == ["old"]


@pytest.mark.parametrize("name", ["missing/deep/x.txt", "file/x.txt", "device", "folder"])
def test_what_cannot_be_written_is_known_beforehand(tmp_path: Path, name: str) -> None:
    (tmp_path / "file").write_text("")
    (tmp_path / "folder").mkdir()
    (tmp_path / "device").symlink_to(os.devnull)
    with pytest.raises(OSError, match=r"\S"):
        probe(tmp_path / name)


@pytest.mark.parametrize("folder", ["/dev/null", "/proc/nothing"])
def test_a_folder_that_takes_no_file_is_known_beforehand(folder: str) -> None:
    with pytest.raises(OSError, match=r"\S"):
        probe_folder(Path(folder))


def test_below_the_working_folder_several_folders_may_be_missing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    probe_folder(Path("out") / "swing" / "deeper")
    assert not list(tmp_path.iterdir())
