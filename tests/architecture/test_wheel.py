"""The wheel holds the four packages with their data, the licence, and nothing else."""

import subprocess
import sys
import zipfile
from email.parser import Parser
from pathlib import Path, PurePosixPath

import pytest

PACKAGES = ("massline", "geometry", "fem", "identification", "validation")


@pytest.fixture(scope="module")
def wheel(root: Path, tmp_path_factory: pytest.TempPathFactory) -> zipfile.ZipFile:
    """The wheel that hatchling builds of the working tree; it needs no network."""
    folder = tmp_path_factory.mktemp("wheel")
    build = [sys.executable, "-P", "-m", "hatchling", "build", "--target", "wheel", "--directory", str(folder)]
    subprocess.run(build, cwd=root, capture_output=True, check=True)
    (file,) = folder.glob("massline-*-py3-none-any.whl")
    return zipfile.ZipFile(file)


def members(wheel: zipfile.ZipFile) -> dict[bool, set[str]]:
    """Names in the wheel: those of its metadata (True, without their folder) and all others (False)."""
    names = [PurePosixPath(name) for name in wheel.namelist()]
    inside = {name for name in names if name.parts[0].endswith(".dist-info")}
    return {True: {str(PurePosixPath(*name.parts[1:])) for name in inside}, False: {str(name) for name in set(names) - inside}}


def test_it_holds_exactly_the_files_of_the_four_packages(wheel: zipfile.ZipFile, root: Path) -> None:
    files = [path for package in PACKAGES for path in (root / package).rglob("*") if path.is_file() and path.suffix != ".pyc"]
    assert members(wheel)[False] == {path.relative_to(root).as_posix() for path in files}


def test_its_files_are_code_types_and_data(wheel: zipfile.ZipFile) -> None:
    endings = {PurePosixPath(name).suffix or PurePosixPath(name).name for name in members(wheel)[False]}
    assert endings == {".py", ".toml", ".typed", ".css", ".js", ".html", ".svg"}
    assert {f"{package}/py.typed" for package in PACKAGES} <= members(wheel)[False]


def test_its_metadata_are_complete_and_carry_the_licence(wheel: zipfile.ZipFile) -> None:
    assert members(wheel)[True] == {"METADATA", "RECORD", "WHEEL", "entry_points.txt", "licenses/LICENSE"}


def test_it_asks_for_python_3_11_to_3_14_and_names_its_licence(wheel: zipfile.ZipFile) -> None:
    (name,) = [name for name in wheel.namelist() if name.endswith("/METADATA")]
    metadata = Parser().parsestr(wheel.read(name).decode("utf-8"))
    assert metadata["License-Expression"] == "MIT"
    assert metadata["Requires-Python"] == "<3.15,>=3.11"
