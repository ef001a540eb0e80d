"""One report of a small laboratory, made once: a Cuboid on the FMD, one load cell 8 % too high, weighed, under hostile titles."""

import re
import shutil
from base64 import b64decode
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from html.parser import HTMLParser
from pathlib import Path
from time import monotonic
from typing import Any

import numpy as np
import pytest

from validation.history.history import Body, Errors, HistoryPosition, Ladder, Version
from validation.report import reference
from validation.report.page import ReportOptions, reported, write
from validation.report.parts import Report
from validation.report.scenes import setups
from validation.study import Options

PIXEL = "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg=="

PATIENCE = 20.0
"""[s] that a page may take to answer."""

HOSTILE = "<img src=x onerror=alert(1)> ../../etc </script>"
"""A title that a page must show and never obey."""

SCALE = f"""
format = 1
kind = "results"
title = "Scale {HOSTILE}"
[article]
name = "cuboid"
[mass]
value = "12.090 +/- 0.010 kg"
"""


@dataclass(frozen=True, kw_only=True)
class Series:
    """Where the data lie."""

    model: Path
    campaign: Path
    scale: Path

    @property
    def data(self) -> tuple[str, str]:
        """As a command line names them."""
        return str(self.campaign), str(self.scale)

    @property
    def asked(self) -> Options:
        """As `massline compare` is asked, the z-sweep held out."""
        return Options(model=str(self.model), data=self.data, hold_out=("z",))


@pytest.fixture(scope="session")
def series(gain, tmp_path_factory) -> Series:
    """The laboratory's files."""
    folder = shutil.copytree(gain, tmp_path_factory.mktemp("laboratory") / "gain")
    model, campaign, scale = folder / "model.toml", folder / "gain", folder / "scale.toml"
    for path in (campaign / "campaign.toml", model):
        path.write_text(re.sub(r'^title = ".*"$', f'title = "{HOSTILE}"', path.read_text("utf-8"), flags=re.MULTILINE), "utf-8")
    limit = '[[requirement]]\nquantity = "mass"\nmax = "13 kg"\n\n[laboratory]'
    model.write_text(model.read_text("utf-8").replace("[laboratory]", limit, 1), "utf-8")
    scale.write_text(SCALE, "utf-8")
    return Series(model=model, campaign=campaign, scale=scale)


@pytest.fixture(scope="session")
def report(series, tmp_path_factory) -> Report:
    """Compared, diagnosed, identified and drawn; the ladder is made by hand."""
    with pytest.MonkeyPatch.context() as patch:  # pictures of articles and sensors have tests of their own, and take longest
        patch.setenv("MASSLINE_CACHE", str(tmp_path_factory.mktemp("dots")))  # that they are dots nobody else may learn
        for module, name in ((reference, "draw"), (setups, "sensor_map")):
            patch.setattr(module, name, lambda _, *given, **how: dot(given[-1]))
        found = reported(
            ReportOptions(compared=series.asked, by="A. Tester", command="massline report cuboid.toml gain"), quiet=True
        )
    return replace(found, standing=ladder(series.model))


@pytest.fixture(scope="session")
def page(report, tmp_path_factory) -> Path:
    """The report as a file."""
    path = tmp_path_factory.mktemp("page") / "report.html"
    write(report, path)
    return path


def dot(folder: Path) -> Path:
    """A picture of one pixel."""
    path = folder / "dot.png"
    path.write_bytes(b64decode(PIXEL))
    return path


def ladder(model: Path) -> HistoryPosition:
    """Two rungs, the second of which is better."""
    rungs = (_rung(0, None, 4.1, 396.0), _rung(1, 0, 0.7, 70.0))
    return HistoryPosition(path=model, text="", ladder=Ladder(rungs=rungs, current=1), rung=rungs[1])


def _rung(number: int, parent: int | None, plain: float, z2: float) -> Version:
    reference = np.array([12.09, 0.0, 0.0, 0.2, 0.166, 0.187, 0.031, 0.0, 0.0, 0.0])
    deviation = np.array([0.02, *3 * (2e-4,), *6 * (1e-3,)])
    body = Body(article="cuboid", values=reference + deviation, deviation=deviation, reference=reference)
    errors = Errors(
        nominal=2 * plain,
        plain=plain,
        held_out=1.2 * plain,
        chi2=900.0,
        degrees_of_freedom=1000,
        tolerance_z2=z2,
        tolerances=118,
        expected_z2=83.0,
        log_evidence=-100.0,
    )
    return Version(
        number=number,
        parent=parent,
        cause="start" if parent is None else "added",
        effect="" if parent is None else "force-gain:fmd-z2",
        model="",
        errors=errors,
        gain=None if parent is None else 174.3,
        bodies=(body,),
        verdict=() if parent is None else ("It is worth a parameter.",),
    )


@dataclass(kw_only=True)
class Table:
    """A table of the page: every cell as a number, where it says one with all its digits, and as it is shown."""

    caption: str = ""
    rows: list[list[str]] = field(default_factory=list)
    values: list[list[float | None]] = field(default_factory=list)

    def row(self, first: str) -> list[float | None]:
        """The numbers of the row that begins with `first`."""
        return next(values for row, values in zip(self.rows, self.values, strict=True) if row[0] == first)


class Page(HTMLParser):
    """What a test asks of a page: elements with their attributes, tables, and the text that is seen."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.tables: list[Table] = []
        self.seen: list[str] = []
        self._open: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = dict(attrs)
        self.elements.append((tag, given))
        if tag == "table":
            self.tables.append(Table())
        elif tag == "tr" and self.tables:
            self.tables[-1].rows.append([])
            self.tables[-1].values.append([])
        elif tag in ("td", "th") and self.tables:
            value = given.get("data-value")
            self.tables[-1].rows[-1].append("")
            self.tables[-1].values[-1].append(float(value) if value else None)
        if tag not in ("meta", "img", "br"):
            self._open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        while self._open and self._open.pop() != tag:
            pass

    def handle_data(self, data: str) -> None:
        if {"script", "style"} & set(self._open):
            return
        self.seen.append(data)
        if "table" in self._open and {"td", "th"} & set(self._open):
            self.tables[-1].rows[-1][-1] += data
        elif "caption" in self._open and "button" not in self._open:
            self.tables[-1].caption += data

    @property
    def text(self) -> str:
        """All that is seen."""
        return " ".join("".join(self.seen).split())

    def table(self, caption: str) -> Table:
        """That with `caption`."""
        return next(one for one in self.tables if one.caption == caption)


@pytest.fixture(scope="session")
def read(page) -> Page:
    """The page, parsed."""
    return Page(page.read_text("utf-8"))


@dataclass(kw_only=True)
class Opened:
    """The page in a browser, with everything that it complained of and asked for."""

    tab: Any

    def becomes(self, expression: str, value: object) -> None:
        """Wait until the page says `value`; its own policy allows no test to wait inside."""
        end = monotonic() + PATIENCE
        while (said := self.tab.evaluate(expression)) != value and monotonic() < end:
            self.tab.wait_for_timeout(50)
        assert said == value

    complaints: list[str] = field(default_factory=list)
    requests: list[str] = field(default_factory=list)


@contextmanager
def _opened(browser: Any, path: Path, **options: Any) -> Iterator[Opened]:
    """Open the page at `path` from the disk, and wait until all figures are drawn."""
    context = browser.new_context(**{"viewport": {"width": 1366, "height": 900}, **options})
    found = Opened(tab=context.new_page())
    found.tab.on("console", lambda said: found.complaints.append(said.text) if said.type in ("error", "warning") else None)
    found.tab.on("pageerror", lambda error: found.complaints.append(str(error)))
    found.tab.on("request", lambda one: found.requests.append(one.url))
    found.tab.goto(path.as_uri())
    found.tab.locator("html[data-drawn]").wait_for(state="attached", timeout=120_000)
    try:
        yield found
    finally:
        context.close()


@pytest.fixture(scope="session")
def opened(chromium) -> Callable[..., Any]:
    """``with opened(path, **options) as page``: the page in a tab of its own."""
    return lambda path, **options: _opened(chromium, path, **options)


@pytest.fixture(scope="session")
def parsed() -> Callable[[str], Page]:
    """``parsed(text)``: any page."""
    return Page


@pytest.fixture(scope="session")
def hostile() -> str:
    """The title of model, campaign and measurement."""
    return HOSTILE
