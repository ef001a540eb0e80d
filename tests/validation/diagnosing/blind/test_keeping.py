"""What the hash of the code covers: everything that a figure can come from, and no face."""

from pathlib import Path

import pytest

from benchmarks.blind.keeping import ALSO, FACES, KEPT_AS, ROOMS, hashed
from tools import house


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
    assert {name for name in covered if name.startswith(face)} <= set(KEPT_AS)


def test_all_that_draws_and_asks_imports_is_covered(root: Path, covered: set[str]) -> None:
    found = house.modules(root, (*house.ROOMS, "benchmarks"))
    beside = {f"benchmarks.blind.{name.removesuffix('.py')}" for name in ALSO if "/" not in name} | {
        "benchmarks.cross_check_proof"
    }
    asking = [one for one in found if one in beside or one.startswith("benchmarks.blind.drawing")]
    reached = {to for one in asking for to in house.imports(found)[one] if to.split(".")[0] in ROOMS}
    files = {(root / to.replace(".", "/")).relative_to(root) for to in reached}
    assert "validation/diagnose/diagnose" in {file.as_posix() for file in files}
    assert {f"{file}.py" for file in files if (root / f"{file}.py").exists()} <= covered
