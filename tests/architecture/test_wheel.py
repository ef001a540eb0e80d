"""The wheel holds the packages with their data, the licence, and nothing else; installed, it is used as its users do."""

import os
import re
import subprocess
import sys
import tarfile
import venv
import zipfile
from email.parser import Parser
from importlib.metadata import Distribution, distribution
from pathlib import Path, PurePosixPath

import pytest
import trimesh
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

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
    assert members(wheel)[False] == {"massline_command.py", *(path.relative_to(root).as_posix() for path in files)}


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


def test_the_sdist_makes_the_same_wheel(wheel: zipfile.ZipFile, root: Path, tmp_path: Path) -> None:
    build = [sys.executable, "-P", "-m", "hatchling", "build", "--directory", str(tmp_path)]
    subprocess.run([*build, "--target", "sdist"], cwd=root, capture_output=True, check=True)
    with tarfile.open(next(tmp_path.glob("massline-*.tar.gz"))) as packed:
        packed.extractall(tmp_path / "unpacked", filter="data")
    (source,) = (tmp_path / "unpacked").iterdir()
    subprocess.run([*build, "--target", "wheel"], cwd=source, capture_output=True, check=True)
    assert members(zipfile.ZipFile(next(tmp_path.glob("massline-*.whl")))) == members(wheel)


def core() -> dict[str, Distribution]:
    """What `pip install massline` brings by name: what the core asks for, and what that asks for."""
    found: dict[str, Distribution] = {}
    asked = [Requirement(one) for one in distribution("massline").requires or ()]
    while asked:
        one = asked.pop()
        name = canonicalize_name(one.name)
        if name in found or (one.marker is not None and not one.marker.evaluate({"extra": ""})):
            continue
        found[name] = distribution(name)
        asked += [Requirement(more) for more in found[name].requires or ()]
    return found


@pytest.fixture(scope="module")
def installed(wheel: zipfile.ZipFile, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An environment that holds the wheel, installed by pip, and of the locked packages the core alone; its `bin`."""
    folder = tmp_path_factory.mktemp("installed")
    venv.create(folder, with_pip=True, symlinks=True)
    python = folder / "bin" / "python"
    # Isolated: what the tests have on their path is not what this environment has
    pip = [str(python), "-I", "-m", "pip", "install", "--quiet", "--no-index", "--no-deps", "--no-compile"]
    subprocess.run([*pip, str(wheel.filename)], check=True, capture_output=True)
    (site,) = folder.glob("lib/python3*/site-packages")
    for one in core().values():
        for name in {file.parts[0] for file in one.files or () if ".." not in file.parts and file.parts[0] != "__pycache__"}:
            if not (site / name).exists():
                (site / name).symlink_to(Path(str(one.locate_file(name))))
    return folder / "bin"


def use(installed: Path, *command: str, folder: Path, path: Path | None = None) -> subprocess.CompletedProcess[str]:
    """Run a program of the environment in `folder`, `path` first on Python's."""
    clean = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON") and key != "VIRTUAL_ENV"}
    environment = clean | ({"PYTHONPATH": str(path)} if path else {})
    line = [str(installed / command[0]), *command[1:]]
    return subprocess.run(line, cwd=folder, env=environment, capture_output=True, text=True, check=False)


def test_the_installed_command_knows_its_version_and_reads_a_mesh(installed: Path, tmp_path: Path) -> None:
    assert use(installed, "massline", "--version", folder=tmp_path).stdout.startswith("massline, version 0.1.0")
    trimesh.creation.box((0.1, 0.2, 0.3)).export(tmp_path / "brick.stl")
    done = use(installed, "massline", "reference", "brick.stl", "--material", "steel", "--unit", "m", folder=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert re.search(r"47\.1\d*", done.stdout)  # [kg] 7850 kg/m³ x 0.006 m³


def test_the_installed_package_hands_on_its_names(installed: Path, tmp_path: Path) -> None:
    program = "from massline import Study, built_in, compare, reference; print(built_in('cuboid').name)"
    done = use(installed, "python", "-c", program, folder=tmp_path)
    assert (done.returncode, done.stdout, done.stderr) == (0, "cuboid\n", "")


@pytest.mark.parametrize(
    ("command", "extra"),
    [
        (("reference", "clumod-1"), "cad"),
        (("modes", "clumod-1", "--model", "solid"), "gpl"),
        (("app", "--no-browser"), "app"),
    ],
    ids=lambda one: one if isinstance(one, str) else one[0],
)
def test_an_installed_command_that_lacks_its_extra_says_which(
    installed: Path, command: tuple[str, ...], extra: str, tmp_path: Path
) -> None:
    done = use(installed, "massline", *command, folder=tmp_path)
    assert done.returncode == 2
    assert f"massline[{extra}]" in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize("name", PACKAGES[1:])
@pytest.mark.parametrize("kind", ["package", "folder"])
def test_a_foreign_package_of_one_of_our_names_is_told_first(installed: Path, name: str, kind: str, tmp_path: Path) -> None:
    """A package that stands before ours; a folder without `__init__.py` comes after every package and hides nothing."""
    other = tmp_path / "other" / name
    other.mkdir(parents=True)
    if kind == "package":
        (other / "__init__.py").write_text("VALUE = 1\n", encoding="utf-8")
    done = use(installed, "massline", "--version", folder=tmp_path, path=tmp_path / "other")
    if kind == "folder":
        assert (done.returncode, done.stderr) == (0, "")
        return
    assert done.returncode == 2
    assert done.stderr.startswith(f"massline: another package bears a name of massline's and stands before it: {name} is {other}")
    assert "Traceback" not in done.stderr
