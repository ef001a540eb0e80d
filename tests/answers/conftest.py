"""What massline answers, asked anew and beside what it answered when it was stored.

`commands.toml` says what is asked, `stored` holds what was answered: a folder a kind of series, a file a line. A command that is
meant to answer otherwise gets its answers stored anew, to be read in the difference that git shows:

    MASSLINE_RENEW_ANSWERS=1 python -m pytest tests/answers

Everything goes through the command line, so that the code behind it may move; the function `workbench` alone goes deeper.
"""

from __future__ import annotations

import asyncio
import base64
import gzip
import io
import json
import os
import pkgutil
import re
import shlex
import subprocess
import sys
import tomllib
import warnings
from collections.abc import Callable, Iterator
from contextlib import ExitStack, redirect_stderr, redirect_stdout
from dataclasses import dataclass, field
from functools import partial
from html.parser import HTMLParser
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any
from unittest.mock import patch

import numpy as np
import pytest

from validation.cli import main

HERE = Path(__file__).parent
STORED = HERE / "stored"
RENEW = "MASSLINE_RENEW_ANSWERS"

DIGITS = 9
"""Significant ones that are stored."""

RELATIVE = 1e-6
"""Of a number: an optimiser of least squares ends where its step is 1e-8 of itself. Another processor's kernels of linear algebra
(`OPENBLAS_CORETYPE=Sandybridge`) change the stored answers by up to 1e-7."""

OF_LARGEST = 1e-9
"""Of the largest number in the same array: a zero that is the difference of such numbers is as good as another."""

OF_WHOLE = 1e-8
"""Of a share, ratio or percentage, named so: a millionth of a per cent is nothing, however small the share is."""

OF_FIGURE = 1e-5
"""Of a number in the summary of a figure's series: six digits of what the page has in four bytes."""

OF_AXIS = 1e-9
"""[unit of the axis] Of a figure's series that is zero but for rounding: nobody sees it."""

NOTHING = 1e-15
"""[any unit] Two numbers below this are both zero."""

LOOSE = (
    ("verify", "", 1e-3),
    ("identify", r"checks\[\d+\]\.tolerances", 5e-3),
    ("diagnose", r"advice\[\d+\]\.expected_evidence_nats", 10.0),
)
"""Command, place in its JSON, and how near numbers have to be, since another processor's kernels change them by up to a third of
that: errors of `verify` are rounding, held by bars of its own; the others follow from directions that the data leave open."""

NUMBER = re.compile(r"(?<![\w.])[-+−]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?")
UNSTORED = {
    "<date>": re.compile(r"\d{4}-\d\d-\d\d[T ]\d\d:\d\d(?::\d\d(?:\.\d+)?)?(?:Z|[+-]\d\d:\d\d| UTC)?"),
    "<digest>": re.compile(r"\b[0-9a-f]{64}\b"),
    "<version>": re.compile(r"\b\d+(?:\.\d+){2,}\b"),
    "<system>": re.compile(r"\b(?:Linux|macOS|Windows)-\S+"),
    "<module>": re.compile(r"\b(?:geometry|fem|identification|validation)(?:\.[a-z_]+)+"),
}
"""What another day, folder or version changes, in the order in which it is replaced."""
RULE = re.compile(r"([─━═-])\1{2,}")


Apart = Callable[..., subprocess.CompletedProcess[str]]


@dataclass(frozen=True, eq=False, kw_only=True)
class Answer:
    """Of one line.

    Attributes
    ----------
    line : that was asked
    text : exit code and all that was printed, or the text of a file
    data : what JSON was printed; None for a page
    """

    line: str
    text: str
    data: Any = None


@dataclass(kw_only=True)
class Asking:
    """The lines of one kind, asked in a folder.

    Attributes
    ----------
    folder : that the lines run in
    root : the repository
    apart : runs each line in a process of its own where it is given
    """

    folder: Path
    root: Path
    apart: Apart | None = None
    places: dict[str, str] = field(init=False)

    def __post_init__(self) -> None:
        self.places = {str(self.folder.resolve()): "<folder>", str(self.folder): "<folder>", str(self.root): "<root>"}

    def answers(self, lines: list[str]) -> Iterator[Answer]:
        """One after the other."""
        kept: list[Any] = []
        for before, line in zip(("", *lines), lines, strict=False):
            again = line == f"{before} --json"
            kept = kept if again else []
            words = shlex.split(line.replace("{root}", str(self.root)))
            if words[0] == "show":
                yield self._shown(line, (self.folder / words[1]).read_text(encoding="utf-8"))
                continue
            if words[0] == "workbench":
                states = workbench(self.folder / "desk", words[1], words[2:])
                yield from (Answer(line=f"{line}: {step}", text="", data=self._clean(state)) for step, state in states.items())
                continue
            code, out, err = here(words, kept, again) if self.apart is None else in_process(self.apart, words)
            head = f"exit code {code}\n"
            if "--json" in words and out.startswith("{"):
                yield Answer(line=line, text=self._plain(head + err), data=self._clean(json.loads(out)))
            else:
                yield Answer(line=line, text=self._plain(head + out + err))
            if words[0] == "report" and "--out" in words and code == main.DONE:
                from_page = report((self.folder / words[words.index("--out") + 1]).read_text(encoding="utf-8"))
                yield Answer(line=f"figures of {line}", text="", data=self._clean(from_page[1]))
                yield Answer(line=f"text of {line}", text=self._plain(from_page[0]))

    def _shown(self, line: str, text: str) -> Answer:
        if line.endswith(".json"):
            return Answer(line=line, text="", data=self._clean(json.loads(text)))
        return Answer(line=line, text=self._plain(text))

    def _plain(self, text: str) -> str:
        """Without what another day, folder or version changes."""
        for place, name in self.places.items():
            text = text.replace(place, name)
        for name, pattern in UNSTORED.items():
            text = pattern.sub(name, text)
        return "\n".join(line.rstrip() for line in text.splitlines()) + "\n"

    def _clean(self, data: Any) -> Any:
        if isinstance(data, dict):
            return {key: self._clean(value) for key, value in data.items()}
        if isinstance(data, list):
            return [self._clean(value) for value in data]
        if isinstance(data, str):
            return self._plain(data)[:-1]
        return float(f"{data:.{DIGITS}g}") if isinstance(data, float) else data


MADE_ONCE = ("validation.report.compare.compared", "validation.report.pretest.findings")
"""Functions whose result a line and the same line with ``--json`` share. What `diagnose` finds massline keeps by itself."""


def here(words: list[str], kept: list[Any], again: bool) -> tuple[int, str, str]:
    """Exit code, output and errors of a command line in this process: importing the libraries takes longer than most lines.

    Results of `MADE_ONCE` are `kept`, and taken from there where the line is asked `again`.
    """
    out, err = io.StringIO(), io.StringIO()
    with redirect_stdout(out), redirect_stderr(err), warnings.catch_warnings(), ExitStack() as stack:
        stack.enter_context(patch.object(sys, "argv", ["massline", *words]))
        if words[0] == "report":  # pictures have tests of their own and take longest; an answer has their words
            for name in DRAWN:
                stack.enter_context(patch(name, dotted))
            dots = stack.enter_context(TemporaryDirectory())  # that they are dots nobody else may learn
            stack.enter_context(patch.dict(os.environ, MASSLINE_CACHE=dots))
        for name in MADE_ONCE:
            stack.enter_context(patch(name, partial(made_once, kept, again, pkgutil.resolve_name(name))))
        warnings.simplefilter("ignore", RuntimeWarning)  # as `main` does
        code = main.run(words)
    return code, out.getvalue(), err.getvalue()


DRAWN = ("validation.report.reference.draw", "validation.report.scenes.setups.sensor_map")
"""What draws articles and sensors for a report."""


def dotted(*given: Any, **how: Any) -> Path:
    """A picture of one pixel in the folder that is `given` last."""
    from PIL import Image

    path = Path(given[-1]) / "dot.png"
    Image.new("RGB", (1, 1)).save(path)
    return path


def made_once(kept: list[Any], again: bool, make: Callable[..., Any], *of: Any) -> Any:
    if again and kept:
        return kept.pop(0)
    found = make(*of)
    kept.append(found)
    return found


def in_process(apart: Apart, words: list[str]) -> tuple[int, str, str]:
    """The same in a process of its own."""
    done = apart(*words)
    return done.returncode, done.stdout, done.stderr


PAGE_ONLY = ("examples", "view", "view_label", "view_note", "view_far", "scheme", "live")
"""Of the workbench's state: what is not about the data, and pictures."""


def workbench(folder: Path, model: str, data: list[str]) -> dict[str, Any]:
    """What the page of `massline app` shows after compare, diagnose, add and undo, by step; figures as `report` has them.

    The only function here that knows what is behind the commands: the page has no other door than a browser.
    """
    from types import SimpleNamespace

    from validation.app import session, workers
    from validation.app.options import StartOptions
    from validation.app.panels import stands
    from validation.app.state import WindowState
    from validation.app.window import first_state

    class State(SimpleNamespace):
        def flush(self) -> None: ...

        def __getitem__(self, name: str) -> Any:
            return getattr(self, name)

    bench = WindowState(
        state=State(**first_state()), folder=folder.parent, opened=StartOptions(), session=session.begun(folder, model, data)
    )
    object.__setattr__(bench, "begin", lambda work: work.close())  # pictures of the structure and what-if are left out

    def shown() -> dict[str, Any]:
        asyncio.run(stands(bench))
        # By name: what a process asked of the page before decides the order in which trame has the rest
        state = {key: value for key, value in sorted(vars(bench.state).items()) if key not in PAGE_ONLY}
        return _shortened(json.loads(json.dumps(state, default=lambda one: one.tolist())))

    steps = {}
    for kind, asked in ((workers.COMPARE, {}), (workers.DIAGNOSE, {}), (workers.ADD, {"effect": "force-gain:fmd-z2"})):
        assert workers.start(bench.session, kind, **asked).wait().error == ""
        steps[kind] = shown()
    bench.session.undo()
    return {**steps, "undo": shown()}


class Text(HTMLParser):
    """The words of a page, one line a heading, paragraph, row or list item; scripts, styles and pictures apart."""

    LINES = frozenset(("h1", "h2", "h3", "h4", "p", "tr", "li", "section", "figure", "figcaption", "div", "summary", "pre"))

    def __init__(self) -> None:
        super().__init__()
        self.text: list[str] = []
        self.silent = ""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag in ("script", "style"):
            self.silent = tag
        elif tag == "section":
            self.text.append(f"\n\n# {dict(attrs).get('id')}\n")
        elif tag in self.LINES:
            self.text.append("\n")
        elif tag in ("td", "th"):
            self.text.append(" | ")
        elif tag == "img":
            self.text.append(f" [picture: {dict(attrs).get('alt')}] ")

    def handle_endtag(self, tag: str) -> None:
        if tag == self.silent:
            self.silent = ""
        elif tag in self.LINES:
            self.text.append("\n")

    def handle_data(self, data: str) -> None:
        if not self.silent:
            self.text.append(" ".join(data.split()) if not data.isspace() else " ")


def report(page: str) -> tuple[str, Any]:
    """The words of a report by section, and the data of its figures: of a long series of numbers what tells it from another."""
    reader = Text()
    reader.feed(page)
    lines = (" ".join(line.split()) for line in "".join(reader.text).splitlines())
    packed = re.search(r'id="packed-figures">([^<]*)<', page)
    assert packed is not None
    whole = json.loads(gzip.decompress(base64.b64decode(packed[1])))
    return "\n".join(line for line in lines if line) + "\n", _shortened(whole["figures"])


LONG = 12
"""Numbers in a row from which on a figure's series is told by its summary."""


def _shortened(data: Any) -> Any:
    if isinstance(data, dict) and set(data) >= {"dtype", "bdata"}:
        values = np.frombuffer(base64.b64decode(data["bdata"]), dtype=data["dtype"])
        return {**{key: value for key, value in data.items() if key != "bdata"}, **_summary(values)}
    if isinstance(data, dict):
        return {key: _shortened(value) for key, value in data.items()}
    if isinstance(data, list) and len(data) > LONG and all(isinstance(value, (int, float)) for value in data):
        return _summary(np.array(data, dtype=np.float64))
    return [_shortened(value) for value in data] if isinstance(data, list) else data


def _summary(values: Any) -> dict[str, Any]:
    """Of numbers in order; `slope` changes when they stand in another one."""
    known = np.asarray(values, dtype=np.float64)
    known = known[np.isfinite(known)]
    told = {"length": len(values), "finite": len(known)}
    if len(known) == 0:
        return told
    along = np.linspace(-1.0, 1.0, len(known))
    figures = {"first": known[0], "last": known[-1], "low": known.min(), "high": known.max()}
    figures |= {"rms": np.sqrt(np.mean(known**2)), "slope": np.mean(along * known)}
    return {**told, **{name: float(f"{value:.6g}") for name, value in figures.items()}}  # the page has four bytes a number


def kinds() -> dict[str, dict[str, Any]]:
    """What `commands.toml` asks, by kind, with its shorthands written out."""
    asked = tomllib.loads((HERE / "commands.toml").read_text(encoding="utf-8"))
    return {name: {**kind, "lines": _lines(kind["lines"], asked["quick"]["options"])} for name, kind in asked["kinds"].items()}


def _lines(written: list[str], quick: str) -> list[str]:
    lines: list[str] = []
    for line in written:
        whole = line.replace("{quick}", quick)
        lines += [whole.replace(" [--json]", end) for end in ("", " --json")] if "[--json]" in whole else [whole]
    return lines


def written(answer: Answer) -> str:
    """As a file of `stored`: the line, what was printed, and JSON with an entry of the outermost object a line."""
    if answer.data is None:
        return f"{answer.line}\n{answer.text}"
    entries = [f"{json.dumps(key)}: {compact(value)}" for key, value in answer.data.items()]
    return f"{answer.line}\n{answer.text}" + "{\n" + ",\n".join(entries) + "\n}\n"


def compact(value: Any) -> str:
    return json.dumps(value, ensure_ascii=False, separators=(",", ":"))


def read(path: Path) -> Answer:
    """The other way."""
    line, _, text = path.read_text(encoding="utf-8").partition("\n")
    if path.suffix == ".txt":
        return Answer(line=line, text=text)
    head, brace, data = text.partition("{\n")
    return Answer(line=line, text=head, data=json.loads(brace + data))


NAMED = {"figures": 2, "text": 2, "show": 1, "workbench": -1}
"""Which word of a line tells its file from others."""


def file_name(number: int, answer: Answer) -> str:
    words = answer.line.split()
    name = words[0] if words[0] not in ("figures", "text", "show", "workbench") else f"{words[0]}-{words[NAMED[words[0]]]}"
    return f"{number:02d}-{name.replace('/', '-')}.{'txt' if answer.data is None else 'json'}"


def store(folder: Path, answers: list[Answer]) -> None:
    """Replace what is stored of a kind."""
    folder.mkdir(parents=True, exist_ok=True)
    for old in folder.iterdir():
        old.unlink()
    for number, answer in enumerate(answers, 1):
        (folder / file_name(number, answer)).write_text(written(answer), encoding="utf-8")


@dataclass(frozen=True, kw_only=True)
class Differing:
    """Compares answers; `most` differences are told of one."""

    most: int = 12

    def between(self, stored: Answer, found: Answer) -> list[str]:
        """In words: where, what is stored and what was found; empty when they are the same."""
        if stored.line != found.line:
            return [f"line: stored of `{stored.line}`, found of `{found.line}`"]
        loose = {place: near for command, place, near in LOOSE if command == found.line.split()[0]}
        told = list(pages(stored.text, found.text, loose.get("", 0.0)))
        told += data("", stored.data, found.data, loose=loose)
        return [f"`{found.line}`: {one}" for one in told[: self.most]] + (
            [f"`{found.line}`: and {len(told) - self.most} more"] if len(told) > self.most else []
        )


def pages(stored: str, found: str, near: float = 0.0) -> Iterator[str]:
    """Of text: the same words in the same lines; numbers to a unit of their last digit, however wide columns are."""
    lines, other = stored.splitlines(), found.splitlines()
    if len(lines) != len(other):
        yield f"stored {len(lines)} lines, found {len(other)}"
    for number, (one, another) in enumerate(zip(lines, other, strict=False), 1):
        if not same_line(one, another, near):
            yield f"line {number}\n    stored: {one}\n    found:  {another}"


def same_line(stored: str, found: str, near: float) -> bool:
    if stored == found:
        return True
    words, other = (" ".join(NUMBER.sub("#", RULE.sub(r"\1", line)).split()) for line in (stored, found))
    numbers, others = NUMBER.findall(stored), NUMBER.findall(found)
    return words == other and all(same_printed(*pair, near) for pair in zip(numbers, others, strict=True))


def same_printed(stored: str, found: str, near: float) -> bool:
    """Within a unit of the last printed digit of the coarser one, and of many digits within rounding."""
    if stored == found or (re.fullmatch(r"[-+−]?\d+", stored) and re.fullmatch(r"[-+−]?\d+", found)):
        return stored == found
    unit = max(last_digit(stored), last_digit(found))
    return abs(value(stored) - value(found)) <= max((1 + 1e-9) * unit, RELATIVE * abs(value(stored)), near)


def value(printed: str) -> float:
    return float(printed.replace("−", "-"))


def last_digit(printed: str) -> float:
    mantissa, _, exponent = printed.lower().partition("e")
    return 10.0 ** (int(exponent or 0) - len(mantissa.partition(".")[2]))


def data(
    path: str, stored: Any, found: Any, near: float = NOTHING, relative: float = RELATIVE, loose: Any = None
) -> Iterator[str]:
    """Of JSON; numbers that are `near` each other are the same, whatever share of them that is; `loose` has others by place."""
    where = path or "all"
    if is_number(stored) and is_number(found):
        near = max(near, OF_WHOLE) if re.search(r"share|percent|ratio", path) else near
        near = max([near, *(other for place, other in (loose or {}).items() if re.match(place, path))])
        if abs(stored - found) > relative * max(abs(stored), abs(found)) + near:
            yield f"{where}: stored {stored!r}, found {found!r}"
    elif isinstance(stored, dict) and isinstance(found, dict):
        if list(stored) != list(found):
            lost, new = [key for key in stored if key not in found], [key for key in found if key not in stored]
            yield f"{where}: keys lost {lost}, new {new}" if lost or new else f"{where}: keys in another order: {list(found)}"
        if "slope" in stored and "rms" in stored:  # a series of a figure
            near, relative = OF_AXIS + OF_FIGURE * stored["rms"], OF_FIGURE
        for key in stored:
            if key in found:
                yield from data(f"{path}.{key}" if path else key, stored[key], found[key], near, relative, loose)
    elif isinstance(stored, list) and isinstance(found, list):
        if len(stored) != len(found):
            yield f"{where}: stored {len(stored)} entries, found {len(found)}"
        near = max(near, OF_LARGEST * largest(stored))
        for number, pair in enumerate(zip(stored, tied(stored, found), strict=False)):
            yield from data(f"{path}[{number}]", *pair, near, relative, loose)
    elif isinstance(stored, str) and isinstance(found, str):
        yield from (f"{where}: {one}" for one in pages(stored, found))
    elif type(stored) is not type(found) or stored != found:
        yield f"{where}: stored {stored!r}, found {found!r}"


def tied(stored: list[Any], found: list[Any]) -> list[Any]:
    """`found`, with entries put back that have changed places and have the same figures: two sides of a cuboid."""
    if not all(isinstance(one, dict) and {"id", "name"} & set(one) for one in (*stored, *found)):
        return found
    named = {_name(one): one for one in found}
    if len(named) != len(found) or named.keys() != {_name(one) for one in stored}:
        return found
    pairs = zip(stored, found, strict=True)
    return [other if list(data("", _figures(one), _figures(other))) else named[_name(one)] for one, other in pairs]


def _name(entry: dict[str, Any]) -> str:
    return str(entry.get("id", entry.get("name")))


def _figures(entry: dict[str, Any]) -> list[Any]:
    return [value for value in entry.values() if is_number(value)]


def largest(array: Any) -> float:
    """Of the numbers of a list of lists; the numbers of other entries are quantities of their own."""
    if isinstance(array, list):
        return max((largest(one) for one in array), default=0.0)
    return abs(array) if is_number(array) else 0.0


def is_number(one: Any) -> bool:
    return isinstance(one, (int, float)) and not isinstance(one, bool)


@pytest.fixture(scope="session")
def differing() -> Differing:
    return Differing()


@pytest.fixture
def ask(
    root: Path, tmp_path: Path, apart: Apart, quick_workers: None, monkeypatch: pytest.MonkeyPatch
) -> Callable[[str], list[Answer]]:
    """``ask(kind)``: the answers of today."""
    monkeypatch.chdir(tmp_path)

    def asked(kind: str) -> list[Answer]:
        of = kinds()[kind]
        for name, text in of.get("files", {}).items():
            (tmp_path / name).write_text(text, encoding="utf-8")
        if script := [word.replace("{root}", str(root)) for word in of.get("python", ())]:
            subprocess.run([sys.executable, "-P", *script], capture_output=True, check=True)
        return list(Asking(folder=tmp_path, root=root, apart=apart if of.get("process") else None).answers(of["lines"]))

    return asked


@pytest.fixture
def stored() -> Callable[[str], list[Answer]]:
    """``stored(kind)``: what was answered when it was stored."""
    return lambda kind: [read(path) for path in sorted((STORED / kind).iterdir())]


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    if "kind" in metafunc.fixturenames:
        asks = "ask" in metafunc.fixturenames
        marked = {name: [pytest.mark.proof] * (asks and kind.get("proof", False)) for name, kind in kinds().items()}
        metafunc.parametrize("kind", [pytest.param(name, marks=marks) for name, marks in marked.items()])


@pytest.fixture
def renewed() -> Callable[[str, list[Answer]], bool]:
    """``renewed(kind, answers)``: whether they were stored because whoever runs the tests wants it."""

    def stored_anew(kind: str, answers: list[Answer]) -> bool:
        if os.environ.get(RENEW):
            store(STORED / kind, answers)
        return bool(os.environ.get(RENEW))

    return stored_anew
