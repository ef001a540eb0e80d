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

from tools.doctor import BROWSERS, INSTALL_BROWSER, LIBRARIES, install_line, installed, main, missing, report
from validation.report import page

TARGETS = ("help", "setup", "demo", "test", "proof", "check", "bench", "blind", "lock", "clean")


def test_this_machine_lacks_nothing_that_the_wheels_open_but_a_library_that_does_not_exist() -> None:
    assert missing() == ()
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


@pytest.mark.parametrize("variable", [None, "no-such-browser"])
def test_without_a_browser_the_doctor_notes_it_once_and_ends_as_with_one(
    variable: str | None, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    monkeypatch.delenv(page.BROWSER, raising=False)
    program = tmp_path / BROWSERS[-1]
    program.write_text("#!/bin/sh\n", encoding="utf-8")
    program.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path))
    assert main([]) == 0
    assert capsys.readouterr().err == ""
    if variable is None:
        program.unlink()
    else:
        monkeypatch.setenv(page.BROWSER, variable)
    assert main([]) == 0
    said = capsys.readouterr().err
    assert said.count("note: no browser") == said.count(INSTALL_BROWSER) == 1
    assert main(["--packages"]) == 0
    assert capsys.readouterr() == ("", "")


def test_the_doctor_looks_for_the_browsers_that_the_report_is_printed_by() -> None:
    assert page.NAMES == BROWSERS


def test_the_page_of_install_names_the_system_libraries_and_the_browser(root: Path) -> None:
    text = (root / "docs" / "install.md").read_text(encoding="utf-8")
    assert install_line() in text
    assert f"{INSTALL_BROWSER}    # for the workbench's tests and PDF" in text


def test_submissions_are_judged_by_the_suite_and_the_proof(root: Path) -> None:
    script = (root / ".ci" / "run").read_text(encoding="utf-8")
    left_out = set(re.findall(r"not (\w+)", "".join(re.findall(r"-m '(.*?)'", script))))
    assert left_out == {"proof", "fast"}
    assert {"make check", "export CI=true"} <= {line.strip() for line in script.splitlines()}
    assert 'make proof ARGS="--within ' in script
    assert "pytest --quiet -m fast tests/fem" in script


def test_where_ci_is_set_a_skip_fails_and_says_what_is_missing(root: Path, tmp_path: Path) -> None:
    test = "import pytest\n\n@pytest.fixture\ndef gauge():\n    pytest.skip('no gauge')\n\ndef test_it(gauge):\n    pass\n"
    (tmp_path / "test_it.py").write_text(test, encoding="utf-8")
    (tmp_path / "conftest.py").write_text((root / "tests" / "conftest.py").read_text(encoding="utf-8"), encoding="utf-8")
    for ci, ends, said in (("", 0, "1 skipped"), ("true", 1, "nothing is skipped where CI is set, but Skipped: no gauge")):
        command = [sys.executable, "-P", "-m", "pytest", "-p", "no:cacheprovider", str(tmp_path)]
        done = subprocess.run(command, env={**os.environ, "CI": ci}, capture_output=True, text=True, check=False, cwd=tmp_path)
        assert (done.returncode, said in done.stdout) == (ends, True), done.stdout


@pytest.mark.parametrize(
    ("options", "ran", "left"),
    [
        (("-n2", "--within", "0"), [], {"0", "1", "2", "3"}),
        (("-n0", "--within", "60", "--begin-at", "6"), ["2", "3", "0", "1"], set()),
    ],
    ids=["two processes without time", "one process in time"],
)
def test_what_has_not_begun_in_time_is_left_out_and_named(
    root: Path, tmp_path: Path, options: tuple[str, ...], ran: list[str], left: set[str]
) -> None:
    test = "import pytest\n\n@pytest.mark.parametrize('k', range(4))\ndef test_it(k):\n    pass\n"
    (tmp_path / "test_it.py").write_text(test, encoding="utf-8")
    (tmp_path / "conftest.py").write_text((root / "tests" / "conftest.py").read_text(encoding="utf-8"), encoding="utf-8")
    command = [sys.executable, "-P", "-m", "pytest", "-p", "no:cacheprovider", "-vv", str(tmp_path), *options]
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=tmp_path)
    assert done.returncode == 0, done.stdout
    assert re.findall(r"test_it\[(\d)\] PASSED", done.stdout) == ran
    assert set(re.findall(r"^test_it.py::test_it\[(\d)\]$", done.stdout, re.MULTILINE)) == left
    assert ("4 left out: 0 s were over" in done.stdout) == bool(left)


def test_of_what_pip_says_only_ignored_locations_are_kept_from_the_screen(root: Path, tmp_path: Path) -> None:
    python = tmp_path / "python"
    ignored = "WARNING: Location 'file:///empty/' is ignored: it is neither a file nor a directory."
    python.write_text(f'#!/bin/sh\necho "$@"\necho "{ignored}" >&2\necho "ERROR: No space" >&2\nexit 3\n', encoding="utf-8")
    python.chmod(0o755)
    command = ["/bin/sh", str(root / "tools/pip.sh"), str(python), "install", "massline"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.stdout.endswith("install massline\n")
    assert (done.returncode, done.stderr) == (3, "ERROR: No space\n")


@pytest.mark.parametrize("target", TARGETS)
def test_the_makefile_has_the_target_and_says_what_it_does(target: str, root: Path) -> None:
    assert re.search(rf"^{target}:[^#\n]*## \S", (root / "Makefile").read_text(encoding="utf-8"), re.MULTILINE)


def pythons(folder: Path, **versions: str) -> Path:
    """A search path with the tools of the setup and Pythons that say they are of `versions`; with 1 after it: no ensurepip."""
    tools = folder / "bin"
    tools.mkdir()
    for name in ("sh", "dirname", "sed"):
        (tools / name).symlink_to(f"/bin/{name}" if Path(f"/bin/{name}").exists() else f"/usr/bin/{name}")
    for name, version in versions.items():
        program = tools / name.replace("_", ".")
        number, code = f"{version} 0".split()[:2]
        cases = f"*%d.%d*) echo {number}; exit;; *ensurepip*) exit {code};;"
        program.write_text(f'#!/bin/sh\ncase "$2" in {cases} esac\nexit 7\n', encoding="utf-8")
        program.chmod(0o755)
    return tools


def test_of_the_pythons_on_the_path_the_newest_that_has_a_lock_is_taken(root: Path, tmp_path: Path) -> None:
    tools = pythons(tmp_path, python3_10="3.10", python3_11="3.11", python3_13="3.13", python3_14="3.14 1", python3="3.12")
    run = set_up(root, tmp_path, path=tools)
    assert run.returncode == 7  # of the stand-in, which is no Python
    assert f"{tools}/python3.14 is passed over: it cannot make virtual environments" in run.stderr
    assert f"Python 3.13 ({tools}/python3.13), the newest of 3.11 3.12 3.13 3.14 found on the path" in run.stderr


def test_a_python_that_is_named_is_taken_or_refused_with_those_that_have_a_lock(root: Path, tmp_path: Path) -> None:
    tools = pythons(tmp_path, python3_10="3.10", python3_12="3.12", python3_13="3.13")
    said = {name: set_up(root, tmp_path, path=tools, python=name) for name in ("python3.12", "python3.10", "python4")}
    assert "Python 3.12, because PYTHON=python3.12 says so." in said["python3.12"].stderr
    assert "PYTHON=python3.10 is Python 3.10, and requirements.lock is for 3.11 3.12 3.13 3.14" in said["python3.10"].stderr
    assert "PYTHON=python4 cannot be started as a Python" in said["python4"].stderr
    assert [run.returncode for run in said.values()] == [7, 1, 1]


def test_the_python_of_an_environment_that_is_there_is_kept(root: Path, tmp_path: Path) -> None:
    tools = pythons(tmp_path, python3_12="3.12", python3_14="3.14")
    (tmp_path / "venv" / "bin").mkdir(parents=True)
    (tools / "python3.12").rename(tmp_path / "venv" / "bin" / "python")
    run = set_up(root, tmp_path, path=tools)
    assert run.returncode == 7
    assert run.stderr == ""


def test_where_no_python_will_do_the_setup_says_what_to_install(root: Path, tmp_path: Path) -> None:
    tools = pythons(tmp_path, python3="3.10")
    run = set_up(root, tmp_path, path=tools)
    assert run.returncode == 1
    assert "No Python of 3.11 3.12 3.13 3.14 is found" in run.stderr
    assert "apt-get install python3.11 python3.11-venv" in run.stderr
    (tmp_path / "lame").mkdir()
    run = set_up(root, tmp_path, path=pythons(tmp_path / "lame", python3_11="3.11 1"))
    assert run.returncode == 1
    assert "apt-get install python3.11-venv" in run.stderr


def set_up(root: Path, folder: Path, *, path: Path, python: str = "") -> subprocess.CompletedProcess[str]:
    """Run the setup into `folder`/venv with the search path `path`, `python` named."""
    environment = {**os.environ, "PATH": str(path), "PYTHON": python}
    command = ["/bin/sh", str(root / "tools/setup.sh"), str(folder / "venv")]
    return subprocess.run(command, env=environment, capture_output=True, text=True, check=False)


def test_the_lock_satisfies_what_the_project_asks_for(root: Path) -> None:
    pattern = re.compile(r"^([a-z0-9._-]+)==(\S+)", re.MULTILINE)
    locked = {canonicalize_name(name): version for name, version in pattern.findall((root / "requirements.lock").read_text())}
    project = tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = [one for name in ("dev", "cad", "fem", "gpl", "pictures", "app") for one in project["optional-dependencies"][name]]
    wanted = [Requirement(line) for line in (*project["dependencies"], *extras)]
    assert [str(want) for want in wanted if locked.get(canonicalize_name(want.name), "0") not in want.specifier] == []
