"""Setting up a bare machine: what is missing is named with the line that installs it, and the targets that are promised exist."""

import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from tools.doctor import LIBRARIES, install_line, installed, main, missing, report

TARGETS = ("help", "setup", "demo", "test", "check", "bench", "blind", "lock", "clean")


def test_this_machine_lacks_nothing_that_the_wheels_open() -> None:
    assert missing() == ()


def test_a_library_that_does_not_exist_is_found_missing() -> None:
    assert not installed("libmassline-does-not-exist.so.1")


def test_every_missing_library_is_named_with_its_user_and_its_package() -> None:
    text = report(missing(lambda soname: soname not in {"libEGL.so.1", "libgomp.so.1"}))
    assert "libEGL.so.1" in text
    assert "pyvista" in text
    assert "libX11" not in text
    assert text.splitlines()[-1].strip() == "apt-get install --no-install-recommends libegl1 libgomp1"


def test_the_doctor_ends_with_1_only_when_something_is_missing(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([]) == 0
    monkeypatch.setattr("tools.doctor.missing", lambda: LIBRARIES[:1])
    assert main([]) == 1
    assert "libgl1" in capsys.readouterr().err
    assert main(["--packages"]) == 0
    assert capsys.readouterr().out == "libgl1\n"


def test_the_readme_names_the_system_libraries(root: Path) -> None:
    assert install_line() in (root / "README.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("target", TARGETS)
def test_the_makefile_has_the_target_and_says_what_it_does(target: str, root: Path) -> None:
    assert re.search(rf"^{target}:[^#\n]*## \S", (root / "Makefile").read_text(encoding="utf-8"), re.MULTILINE)


def test_without_python_3_11_the_setup_says_what_to_install(root: Path, tmp_path: Path) -> None:
    tools = tmp_path / "bin"
    tools.mkdir()
    for name in ("sh", "dirname"):
        (tools / name).symlink_to(f"/bin/{name}" if Path(f"/bin/{name}").exists() else f"/usr/bin/{name}")
    run = set_up(root, tmp_path, path=tools)
    assert run.returncode == 1
    assert "apt-get install python3.11 python3.11-venv" in run.stderr


def test_without_ensurepip_the_setup_says_what_to_install(root: Path, tmp_path: Path) -> None:
    lame = tmp_path / "bin" / "python3.11"
    lame.parent.mkdir()
    lame.write_text(f'#!/bin/sh\ncase "$2" in *ensurepip*) exit 1;; esac\nexec {sys.executable} "$@"\n', encoding="utf-8")
    lame.chmod(0o755)
    run = set_up(root, tmp_path, path=lame.parent, then=os.environ["PATH"])
    assert run.returncode == 1
    assert "apt-get install python3.11-venv" in run.stderr


def set_up(root: Path, folder: Path, *, path: Path, then: str = "") -> subprocess.CompletedProcess[str]:
    """Run the setup into `folder`/venv with the search path `path` and `then`."""
    environment = {**os.environ, "PATH": f"{path}:{then}".rstrip(":")}
    command = ["/bin/sh", str(root / "tools/setup.sh"), str(folder / "venv")]
    return subprocess.run(command, env=environment, capture_output=True, text=True, check=False)


def test_the_lock_satisfies_what_the_project_asks_for(root: Path) -> None:
    pattern = re.compile(r"^([a-z0-9._-]+)==(\S+)", re.MULTILINE)
    locked = {canonicalize_name(name): version for name, version in pattern.findall((root / "requirements.lock").read_text())}
    project = tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    wanted = [Requirement(line) for line in (*project["dependencies"], *project["optional-dependencies"]["dev"])]
    assert [str(want) for want in wanted if locked.get(canonicalize_name(want.name), "0") not in want.specifier] == []
