"""Every command line that README.md or a page under docs shows is one that works.

Convention: command lines stand in fenced blocks marked ``sh``, one a line.

- Lines that begin with ``massline`` are run, those of one page in order and in one temporary directory, so a line may use what
  an earlier one wrote. A copy of ``examples`` lies there, as in the root of the repository where a reader stands. Lines end with
  exit code 0, or with the one that a comment at their end states: ``# exit 1``.
- A line that names no file depends on no folder: where several pages show it, the first of them runs it for all.
- Lines that begin with ``python examples/`` run that script of the repository, likewise. Where one names ``../shared/data``, the
  real data lie there; the page is skipped where they are absent.
- Lines that begin with ``make`` must name a target that exists. They are not run here, since they run this.
- ``apt-get`` is that of the setup and of the doctor; ``git clone`` and ``cd`` are the reader's. Nothing else may be there.
"""

import os
import re
import shlex
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from tools.doctor import install_line

ROOT = Path(__file__).parents[2]
PAGES = (ROOT / "README.md", *sorted(ROOT.glob("docs/*.md")))


def command_lines(page: Path) -> list[str]:
    """The lines of all blocks marked ``sh``, without empty lines and whole-line comments."""
    blocks = re.findall(r"^```sh\n(.*?)^```", page.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    return [line.strip() for block in blocks for line in block.splitlines() if line.strip() and not line.startswith("#")]


def expected_exit(line: str) -> int:
    stated = re.search(r"# exit (\d)$", line)
    return int(stated.group(1)) if stated else 0


def claim(line: str) -> tuple[str, ...]:
    """What a line says: its words without the comment, and how it ends."""
    return (*shlex.split(line, comments=True), str(expected_exit(line)))


def run_before(page: Path) -> set[tuple[str, ...]]:
    """What lines without a file on the pages before `page` say."""
    lines = [line for earlier in PAGES[: PAGES.index(page)] for line in command_lines(earlier)]
    return {claim(line) for line in lines if "/" not in "".join(claim(line))}


def script(name: str, *arguments: str, code: Path, cwd: Path) -> subprocess.CompletedProcess[str]:
    """Run the repository's script `name` on the packages in `code`, in the folder `cwd`."""
    command, where = [sys.executable, str(ROOT / name), *arguments], {**os.environ, "PYTHONPATH": str(code)}
    return subprocess.run(command, cwd=cwd, env=where, capture_output=True, encoding="utf-8", check=False)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_massline_line_of_a_page_runs(
    page: Path,
    massline: Callable[..., subprocess.CompletedProcess[str]],
    code: Path,
    tmp_path: Path,
    request: pytest.FixtureRequest,
) -> None:
    here = tmp_path / "repository"
    shutil.copytree(ROOT / "examples", here / "examples")
    if any("../shared/data" in line for line in command_lines(page)):
        (tmp_path / "shared").mkdir()
        (tmp_path / "shared" / "data").symlink_to(request.getfixturevalue("data").resolve())
    known = run_before(page)
    for line in command_lines(page):
        program, *arguments = shlex.split(line, comments=True)
        if program in ("massline", "python") and claim(line) not in known:
            run = massline(*arguments, cwd=here) if program == "massline" else script(*arguments, code=code, cwd=here)
            assert run.returncode == expected_exit(line), f"$ {line}\n{run.stdout}{run.stderr}"


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_other_line_of_a_page_is_make_or_belongs_to_the_reader(page: Path) -> None:
    targets = re.findall(r"^([a-z]+):", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE)
    for line in command_lines(page):
        program, *arguments = shlex.split(line, comments=True)
        allowed = {
            "massline": True,
            "python": (ROOT / arguments[0]).parent == ROOT / "examples",
            "make": set(arguments) <= set(targets),
            "apt-get": line in (install_line(), "apt-get install python3.11 python3.11-venv make"),
            "git": arguments[:1] == ["clone"],
            "cd": True,
        }
        assert allowed.get(program, False), f"{page.name}: {line}"


def test_the_readme_shows_the_two_commands_and_the_command_line() -> None:
    lines = command_lines(PAGES[0])
    assert {"make demo", "make test"} <= {line.partition("#")[0].strip() for line in lines}
    assert any(line.startswith("massline") for line in lines)
