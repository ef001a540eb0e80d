"""Everything that README.md and the pages under docs show as code is run, read or checked here, block by block.

A fenced block has a language, and the language says what happens to it. There is no other kind, so a block that is added is run.

- ``sh``: command lines, one a line. ``massline ...`` and ``python examples/...`` are run, those of one page in order and in one
  folder, so a line may use what an earlier one wrote; ``massline app`` begins to serve, lets in and is ended. A copy of
  ``examples`` lies there, as in the root of the repository where a reader stands. Lines end with exit code 0, or with the one
  that a comment at their end states: ``# exit 1``. A line that names no file depends on no folder: where several pages show it,
  the first of them runs it for all. ``make`` must name a target and ``python -m benchmarks...`` a module; neither is run here,
  since they run this, or for hours. ``apt-get`` is that of the setup and the doctor; ``git clone`` and ``cd`` are the reader's.
- ``python``: a program, run where it stands between the commands, with the names that programs above it on the page have made.
- ``toml PATH``, ``python PATH``: a file that the reader writes, and a later command or program of the page reads; ``+PATH`` is
  appended to it. A path that exists in the repository shows that very file.
- ``math``: an equation, which the site sets; `test_site.py` fails where it cannot.
- ``output``: lines of what the block above printed, in order, ``...`` for what is left out. Words agree, numbers to the last
  digit shown or to a hundredth.

Where a page names ``../shared/data`` or ``MASSLINE_DATA``, the real data lie there; it is skipped where they are absent. Commands
within sentences must exist with every option that they are given.
"""

import json
import os
import re
import shlex
import shutil
import subprocess
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import click
import pytest

from tools.doctor import INSTALL_BROWSER, install_line
from tools.pages import Block, blocks, commands, indented, lines, links, pages, quoted
from validation.cli.main import COMMANDS, cli

ROOT = Path(__file__).parents[2]
PAGES = pages(ROOT)
FILES = ("toml", "python", "text")
LANGUAGES = ("sh", "output", "math", *FILES)
README_LINES = 60
"""[lines] One screen and a half."""
READERS = ("make", "apt-get", "git", "cd")
"""Programs of lines that are the reader's own."""

by_name = pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)

LONG = {
    *("base-excitation.md", "campaigns.md", "classical-measurements.md", "compare.md", "diagnose.md", "flexible-body.md"),
    *(
        "identification.md",
        "ladder.md",
        "own-effect.md",
        "reference-tables.md",
        "report.md",
        "tutorial.md",
        "commands.md",
        "python.md",
        "fleet.md",
        "league.md",
        "laboratories.md",
        "your-own-structure.md",
        "three-storey-frame.md",
    ),
    *("diagnose-pendulum.md", "own-article.md", "own-model.md", "verification.md", "virtual-tests.md", "model-file.md"),
}
"""Pages whose commands take two seconds of computing and more: they are run by `make proof`, the others by `make test`."""


@dataclass(frozen=True, kw_only=True)
class Shown:
    """What a page's process is asked, and what its blocks say that it prints.

    Attributes
    ----------
    steps : see `page_process.py`
    says : per ``output`` block the lines that it shows, and the steps from and to which the block above it reaches
    """

    steps: list[dict[str, Any]]
    says: list[tuple[Block, int, int]]


def expected_exit(line: str) -> int:
    stated = re.search(r"# exit (\d+)$", line)
    return int(stated.group(1)) if stated else 0


def claim(line: str) -> tuple[str, ...]:
    """What a line says: its words without the comment, and how it ends."""
    return (*shlex.split(line, comments=True), str(expected_exit(line)))


def run_before(page: Path) -> set[tuple[str, ...]]:
    """What lines without a file on the pages before `page` say."""
    found = [line for earlier in PAGES[: PAGES.index(page)] for line in commands(earlier)]
    return {claim(line) for line in found if "/" not in "".join(claim(line))}


def is_run(line: str) -> bool:
    return line.split()[0] not in READERS and not line.startswith("python -m benchmarks.")


def module(name: str) -> Path:
    """The file that ``python -m name`` runs."""
    folder = ROOT / name.replace(".", "/")
    return folder / "__main__.py" if folder.is_dir() else folder.with_suffix(".py")


def shown(page: Path) -> Shown:
    """The steps of `page` in order; a line whose output the page shows is never left to another page."""
    steps: list[dict[str, Any]] = []
    says: list[tuple[Block, int, int]] = []
    known, every, above = run_before(page), blocks(page), 0
    for block, following in zip(every, (*every[1:], None), strict=False):
        language, _, path = block.language.partition(" ")
        first, quoted_below = len(steps), following is not None and following.language == "output"
        if language == "sh":
            asked = [line for line in lines(block) if is_run(line) and (quoted_below or claim(line) not in known)]
            steps += [{"words": list(claim(line)[:-1]), "ends": expected_exit(line)} for line in asked]
        elif language == "python" and not path:
            steps.append({"python": block.text, "of": f"{page.name}:{block.line}", "ends": 0})
        elif path and (path.removeprefix("+").startswith("out/") or not (ROOT / path).is_file()):  # out/ is of whoever ran there
            steps.append({"file": path.removeprefix("+"), "text": block.text, "append": path.startswith("+"), "ends": 0})
        elif language == "output":
            says.append((block, above, first))
        if language != "output":
            above = first
    return Shown(steps=steps, says=says)


def done(
    page: Path, asked: list[dict[str, Any]], here: Path, apart: Callable[..., subprocess.CompletedProcess[str]]
) -> list[dict[str, Any]]:
    """What the steps of `page` printed and how they ended, in a process of its own."""
    answer = here.parent / "answer.json"
    program = Path(__file__).with_name("page_process.py").read_text(encoding="utf-8")
    around = {**os.environ, "MASSLINE_DATA": "../shared/data"}
    process = apart(str(ROOT), str(answer), program=program, cwd=here, env=around, input=json.dumps(asked))
    assert process.returncode == 0, f"{page.name}\n{process.stdout}{process.stderr}"
    answers: list[dict[str, Any]] = json.loads(answer.read_text(encoding="utf-8"))
    return answers


def agree(said: str, printed: str) -> bool:
    """Whether a line that a page shows is the line that was printed: words alike, numbers to the last digit or to a hundredth."""
    pairs = [re.split(r"(?<![\w.])([-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?)", plain(text)) for text in (said, printed)]
    if len(pairs[0]) != len(pairs[1]) or pairs[0][::2] != pairs[1][::2]:
        return False
    return all(
        abs(float(a) - float(b)) <= max(last_digit(a), 0.01 * abs(float(a))) * (1 + 1e-9)
        for a, b in zip(pairs[0][1::2], pairs[1][1::2], strict=True)
    )


def plain(line: str) -> str:
    """`line` with single blanks, and none inside brackets, where NumPy puts them to fill columns."""
    return re.sub(r"(?<=[\[(]) | (?=[\])])", "", " ".join(line.split()))


def last_digit(number: str) -> float:
    """What one unit of the last digit of a written number is worth."""
    digits, _, power = number.partition("e")
    return float(10.0 ** (int(power or 0) - len(digits.partition(".")[2])))


def unsaid(block: Block, printed: str) -> list[str]:
    """Lines of an ``output`` block that were not printed in that order."""
    left, missing = iter(printed.splitlines()), []
    for said in block.text.splitlines():
        if said.strip() not in ("", "...") and not any(agree(said, line) for line in left):
            missing.append(said)
    return missing


@pytest.mark.parametrize(
    "page", [pytest.param(one, marks=[pytest.mark.proof] * (one.name in LONG), id=one.name) for one in PAGES]
)
def test_everything_that_a_page_shows_runs_and_prints_what_it_says(
    page: Path, apart: Callable[..., subprocess.CompletedProcess[str]], tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    asked = shown(page)
    if not asked.steps:
        return
    here = tmp_path / "repository"
    shutil.copytree(ROOT / "examples", here / "examples")
    if re.search(r"\.\./shared/data|MASSLINE_DATA", json.dumps(asked.steps)):
        (tmp_path / "shared").mkdir()
        (tmp_path / "shared" / "data").symlink_to(request.getfixturevalue("data").resolve())
    answers = done(page, asked.steps, here, apart)
    for step, answer in zip(asked.steps, answers, strict=False):
        assert answer["code"] == step["ends"], f"{step}\n{answer['printed']}"
    for block, first, last in asked.says:
        printed = "".join(answer["printed"] for answer in answers[first:last])
        assert unsaid(block, printed) == [], f"{page.name}:{block.line}\n{printed}"


def unrun(page: Path) -> list[str]:
    """What is wrong with the blocks of `page`, so that nothing would run or read them."""
    every = blocks(page)
    fences = len(re.findall(r"^ {0,3}(?:```|~~~)", page.read_text(encoding="utf-8"), re.MULTILINE))
    found = [] if fences == 2 * len(every) else ["a fence is not closed, or does not stand at the line's beginning"]
    for block, above in zip(every, (None, *every), strict=False):
        language, _, path = block.language.partition(" ")
        wrong = {
            f"a block of {language or 'no language'} is run by nothing": language not in LANGUAGES,
            "name the file, as in ```toml out/model.toml": language in ("toml", "text") and not path,
            "only files have a name": bool(path) and language not in FILES,
            "the output of what?": language == "output" and (above is None or above.language == "output"),
        }
        found += [f"line {block.line}: {words}" for words, is_so in wrong.items() if is_so]
    return found


@by_name
def test_every_block_of_a_page_is_of_a_kind_that_is_run_or_read(page: Path) -> None:
    assert unrun(page) == [], page.name


@pytest.mark.parametrize(
    "text",
    [
        "```\nx = 1\n```\n",
        "```console\n$ ls\n```\n",
        "```toml\na = 1\n```\n",
        "```output\n3\n```\n",
        "```sh\nls\n",
        "- a\n  ```sh\n  ls\n  ```\n",
    ],
)
def test_a_block_that_nothing_would_run_is_found(text: str, tmp_path: Path) -> None:
    (tmp_path / "page.md").write_text(text, encoding="utf-8")
    assert unrun(tmp_path / "page.md") != []


@by_name
def test_a_file_on_a_page_is_read_by_what_follows_or_is_that_of_the_repository(page: Path) -> None:
    for number, block in enumerate(blocks(page)):
        path = block.language.partition(" ")[2]
        if path and not path.startswith("out/") and (ROOT / path).is_file():  # what lies in out/ somebody made here
            assert block.text == (ROOT / path).read_text(encoding="utf-8"), f"{page.name}:{block.line}: {path} has changed"
        elif path:
            name = Path(path.removeprefix("+"))
            later = "".join(one.text for one in blocks(page)[number + 1 :] if one.language in ("sh", "python"))
            read = f"{name}" in later or re.search(rf"{re.escape(str(name.parent))}(?![\w/.-])", later)
            assert read, f"{page.name}:{block.line}: nothing reads {path}"


@by_name
def test_lines_that_are_not_run_are_the_readers(page: Path) -> None:
    targets = re.findall(r"^([a-z]+):", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE)
    for line in commands(page):
        program, *arguments = shlex.split(line, comments=True)
        allowed = {
            "massline": True,
            "python": module(arguments[1]).is_file()
            if arguments[0] == "-m"
            else (ROOT / arguments[0]).parent == ROOT / "examples",
            "make": set(arguments) <= set(targets),
            "apt-get": line.partition("#")[0].strip()
            in (install_line(), INSTALL_BROWSER, "apt-get install python3.11 python3.11-venv make"),
            "git": arguments[:1] == ["clone"],
            "cd": True,
        }
        assert allowed.get(program, False), f"{page.name}: {line}"


def command(name: str) -> click.Command:
    found = cli.get_command(click.Context(cli), name)
    assert found is not None
    return found


@by_name
def test_commands_within_sentences_exist_with_their_options(page: Path) -> None:
    for words in quoted(page):
        program, *rest = words.split()
        if program == "massline" and re.fullmatch(r"[a-z-]+", rest[0] if rest else "") and rest[0][0] != "-":
            assert rest[0] in COMMANDS, f"{page.name}: {words}"
            known = {one for option in command(rest[0]).params for one in (*option.opts, *option.secondary_opts)} | {"--help"}
            asked = {word.partition("=")[0] for word in rest[1:] if word.startswith("--")}
            assert asked <= known, f"{page.name}: {words}"
        if program == "python" and rest[:1] == ["-m"]:
            assert module(rest[1]).is_file(), f"{page.name}: {words}"
        if program == "python" and rest[:1] and rest[0].endswith(".py"):
            assert (ROOT / rest[0]).is_file(), f"{page.name}: {words}"


@by_name
def test_what_is_indented_is_a_formula_or_a_quotation_and_no_command(page: Path) -> None:
    for line in indented(page):
        assert not re.match(r"\s+(\$|massline|python|pip|import|from|def)\b", line), f"{page.name}: {line}"


def test_the_readme_is_a_page_with_two_commands_one_picture_and_no_table_of_figures() -> None:
    found = [line.partition("#")[0].strip() for line in commands(PAGES[0])]
    assert found == ["make demo", "make test"]
    assert sum(link.picture for link in links(PAGES[0])) == 1
    assert len(PAGES[0].read_text(encoding="utf-8").splitlines()) <= README_LINES


def test_one_page_has_every_command_on_a_line() -> None:
    (page,) = (one for one in PAGES if one.name == "commands.md")
    found = {line.split()[1] for line in commands(page) if line.startswith("massline")}
    assert COMMANDS.keys() <= found


def test_a_new_block_is_run_and_what_it_says_is_held_against_what_it_prints(
    tmp_path: Path, apart: Callable[..., subprocess.CompletedProcess[str]]
) -> None:
    page = tmp_path / "page.md"
    page.write_text("```python\nprint('mass', 2.0 / 3, 'kg')\nraise SystemError('run')\n```\n", encoding="utf-8")
    (block,) = blocks(page)
    (answer,) = done(page, [{"python": block.text, "of": "page", "ends": 0}], tmp_path, apart)
    assert answer["code"] == -1
    assert "SystemError: run" in answer["printed"]
    said = [Block(language="output", text=f"{text}\n", line=1) for text in ("mass 0.667 kg", "mass 0.70 kg", "mass 0.667 g")]
    assert [bool(unsaid(one, answer["printed"])) for one in said] == [False, True, True]
