"""What the hash of the code covers: everything that a figure can come from, and no face."""

from pathlib import Path

import pytest

from benchmarks.blind.keeping import FACES, hashed


@pytest.fixture(scope="module")
def covered(root: Path) -> set[str]:
    return {path.relative_to(root).as_posix() for path in hashed(root)}


@pytest.mark.parametrize("file", ["validation/diagnose/search.py", "fem/beam/articles.py", "geometry/articles/cuboid.toml"])
def test_a_file_that_figures_come_from_is_covered(file: str, root: Path, covered: set[str]) -> None:
    if not (root / file).exists():
        pytest.fail(f"{file} is no longer there: name another")
    assert file in covered


@pytest.mark.parametrize("face", FACES)
def test_a_face_is_there_and_not_covered(face: str, root: Path, covered: set[str]) -> None:
    assert (root / face).exists()
    assert not any(name.startswith(face) for name in covered)
