"""The cache gives back what was put in or nothing, whatever happened to its files, and is never in the way."""

import os
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from fem import modes as fem_modes
from fem.damping import Damping
from fem.solid import model, tetrahedra
from geometry import atomic, cache
from geometry.article import Article, Box, Part, Shape, material, upright

ARRAYS = {"a": np.arange(1000.0), "names": np.array(["x", "yz"]), "empty": np.zeros((0, 3)), "count": np.array(3)}


@pytest.fixture(autouse=True)
def there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "kept"
    monkeypatch.setenv("MASSLINE_CACHE", str(folder))
    return folder


@pytest.fixture
def entry(there: Path) -> Path:
    """A whole entry and its file."""
    cache.store("entry", ARRAYS)
    return there / "entry.npz"


def test_what_is_stored_comes_back_and_nothing_else(entry: Path) -> None:
    assert cache.load("nothing") is None
    found = cache.load("entry")
    assert set(found) == set(ARRAYS)
    for name, array in ARRAYS.items():
        assert_array_equal(found[name], array)
        assert found[name].dtype == array.dtype


def damage(path: Path) -> None:
    content = bytearray(path.read_bytes())
    content[len(content) // 4] ^= 0xFF
    path.write_bytes(content)


def swap(path: Path) -> None:
    cache.store("another", ARRAYS)
    path.with_name("another.npz").replace(path)


def forge(path: Path) -> None:
    """The right name and digest, other numbers: what a wrong digest looks like."""
    np.savez(path, **{**ARRAYS, "a": np.ones(1000), "massline-key": np.array("entry"), "massline-digest": cache.digest(ARRAYS)})


SPOILERS: dict[str, Callable[[Path], object]] = {
    "shortened": lambda path: path.write_bytes(path.read_bytes()[:-100]),
    "emptied": lambda path: path.write_bytes(b""),
    "damaged": damage,
    "foreign": lambda path: np.savez(path, a=np.zeros(3)),
    "text": lambda path: path.write_text("not an archive", encoding="utf-8"),
    "pickled": lambda path: np.savez(path, a=np.array([{"an": "object"}], dtype=object)),
    "another": swap,
    "forged": forge,
    "a folder": lambda path: (path.unlink(), path.mkdir()),
}


@pytest.mark.parametrize("spoilt", SPOILERS)
def test_a_file_that_is_not_whole_and_its_own_is_ignored(spoilt: str, entry: Path) -> None:
    SPOILERS[spoilt](entry)
    assert cache.load("entry") is None


def test_an_interrupted_write_leaves_nothing(there: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(np, "savez", interrupted)
    with pytest.raises(KeyboardInterrupt):
        cache.store("entry", ARRAYS)
    assert list(there.iterdir()) == []


def test_a_full_disk_is_no_error(there: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(np, "savez", full)
    cache.store("entry", ARRAYS)
    assert cache.load("entry") is None
    assert list(there.iterdir()) == []


def test_a_folder_that_cannot_be_made_is_no_error(there: Path) -> None:
    there.write_text("a file where the folder should be", encoding="utf-8")
    cache.store("entry", ARRAYS)
    assert cache.load("entry") is None


def test_a_read_only_folder_is_no_error(there: Path, entry: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(*_: object, **__: object) -> None:
        raise PermissionError(30, "Read-only file system")

    monkeypatch.setattr(os, "utime", refused)
    monkeypatch.setattr(atomic, "write_with", refused)
    cache.store("second", ARRAYS)
    assert cache.load("entry") is not None
    assert cache.load("second") is None


def test_the_entries_unused_for_longest_go_first(there: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for age, name in ((30, "oldest"), (20, "middle"), (10, "young")):
        cache.store(name, ARRAYS)
        os.utime(there / f"{name}.npz", (time.time() - age,) * 2)
    assert cache.load("oldest") is not None  # used now
    monkeypatch.setattr(cache, "LARGEST", int(3.5 * (there / "young.npz").stat().st_size))
    cache.store("newest", ARRAYS)
    assert {path.stem for path in there.iterdir()} == {"oldest", "young", "newest"}


def test_more_than_fits_is_not_stored(there: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cache, "LARGEST", 1000)
    cache.store("entry", ARRAYS)
    assert not there.exists()


def test_what_a_killed_process_left_goes_after_a_day(there: Path, entry: Path) -> None:
    left, fresh = there / ".entry-abc.npz", there / ".entry-def.npz"
    for path in (left, fresh):
        path.write_bytes(b"half")
    os.utime(left, (time.time() - 2 * cache.ABANDONED,) * 2)
    cache.store("entry", ARRAYS)
    assert not left.exists()
    assert fresh.exists()


def test_the_folder_follows_the_environment(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert cache.folder() == tmp_path / "kept"
    monkeypatch.delenv("MASSLINE_CACHE")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert cache.folder() == tmp_path / "massline"
    monkeypatch.setenv("XDG_CACHE_HOME", "relative")  # to be ignored, the XDG Base Directory Specification says
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    assert cache.folder() == tmp_path / "home" / ".cache" / "massline"


def test_a_key_changes_with_everything_that_goes_in(monkeypatch: pytest.MonkeyPatch) -> None:
    plain = cache.key("mesh", {"size": 0.1})
    assert plain == cache.key("mesh", {"size": 0.1})
    others = [cache.key("mesh", {"size": 0.10000000000000002}), cache.key("modes", {"size": 0.1})]
    monkeypatch.setattr("importlib.metadata.version", lambda library: "another")
    cache.versions.cache_clear()
    others.append(cache.key("mesh", {"size": 0.1}))
    cache.versions.cache_clear()
    assert len({plain, *others}) == 4


def beam(length: float = 0.1, made_of: str = "steel") -> Article:
    shape = Shape(solids=(upright(Box(size=np.array([0.02, 0.02, length])), bottom=0.0),))
    return Article(name="beam", parts=(Part(name="beam", material=material(made_of), shape=shape),))


def test_a_second_run_meshes_and_solves_nothing_and_finds_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    first = model.structure(beam(), size=0.03)
    modes = model.fixed_base(first, 4)

    def never(*_: object, **__: object) -> None:
        raise AssertionError("made again")

    for module, name in ((model, "tetrahedra"), (model, "assemble"), (fem_modes, "fixed_base")):
        monkeypatch.setattr(module, name, never)
    second = model.structure(beam(), size=0.03)
    again = model.fixed_base(second, 4)
    assert abs(first.stiffness - second.stiffness).nnz == 0
    assert abs(first.mass - second.mass).nnz == 0
    for field in ("frequency", "participation", "residual", "shapes", "structural", "damping_ratio"):
        assert_array_equal(getattr(again, field), getattr(modes, field))


@pytest.mark.parametrize("change", [{"length": 0.11}, {"made_of": "aluminium"}])
def test_another_article_is_made_anew(change: dict[str, object]) -> None:
    plain = model.structure(beam(), size=0.03)
    other = model.structure(beam(**change), size=0.03)
    assert other.rigid_mass[0, 0] != pytest.approx(plain.rigid_mass[0, 0], rel=0.01)


def test_another_limit_finds_the_same_mesh(monkeypatch: pytest.MonkeyPatch) -> None:
    model.structure(beam(), size=0.03)
    monkeypatch.setattr(tetrahedra, "_attempt", None)
    model.structure(beam(), size=0.03, largest=200_000)


def test_other_damping_finds_the_same_modes() -> None:
    structure = model.structure(beam(), size=0.03)
    plain, damped = (model.fixed_base(structure, 3, damping=Damping(ratio=ratio)) for ratio in (0.0, 0.02))
    assert_array_equal(plain.frequency, damped.frequency)
    assert_array_equal(damped.damping_ratio, np.full(3, 0.02))
    assert not plain.damping_ratio.any()


@dataclass(frozen=True)
class Asked:
    """What an answer may depend on."""

    band: tuple[float, float]
    sizes: np.ndarray


class Counter:
    """Says how often it was asked."""

    asked = 0

    def __call__(self) -> int:
        self.asked += 1
        return self.asked


def test_an_answer_is_made_once_for_the_same_question() -> None:
    count = Counter()
    first, same = (cache.answer(count, "count", Asked((1.0, 2.0), np.arange(3))) for _ in range(2))
    other = cache.answer(count, "count", Asked((1.0, 2.0), np.arange(1, 4)))
    assert (first, same, other) == (1, 1, 2)


def test_an_answer_of_other_code_is_made_again(monkeypatch: pytest.MonkeyPatch) -> None:
    count = Counter()
    cache.answer(count, "count")
    monkeypatch.setattr(cache, "code", lambda: "another")
    assert cache.answer(count, "count") == 2


def test_an_answer_that_another_user_could_have_written_is_not_read(there: Path) -> None:
    count = Counter()
    cache.answer(count, "count")
    there.chmod(0o777)
    assert cache.answer(count, "count") == 2


@pytest.mark.parametrize("spoilt", ["shortened", "emptied", "damaged", "foreign"])
def test_a_damaged_answer_is_made_again(spoilt: str, there: Path) -> None:
    count = Counter()
    cache.answer(count, "count")
    SPOILERS[spoilt](next(there.iterdir()))
    assert cache.answer(count, "count") == 2


def test_what_an_answer_raises_is_not_kept(there: Path) -> None:
    def refused() -> None:
        raise ValueError("not now")

    with pytest.raises(ValueError, match="not now"):
        cache.answer(refused, "count")
    assert not there.exists()


def test_the_content_of_a_folder_is_that_of_its_files_and_their_names(tmp_path: Path) -> None:
    one, other, renamed, changed = (tmp_path / name for name in ("one", "other", "renamed", "changed"))
    for folder, name, text in ((one, "a", "x"), (other, "a", "x"), (renamed, "b", "x"), (changed, "a", "y")):
        folder.mkdir()
        (folder / name).write_text(text, encoding="utf-8")
    assert cache.content([one]) == cache.content([other])
    assert len({cache.content([folder]) for folder in (one, renamed, changed)}) == 3
