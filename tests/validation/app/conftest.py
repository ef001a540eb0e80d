"""The workbench as a user has it: the command in a process, Chromium before it, and what both leave behind."""

import asyncio
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest

SHOTS = Path("out/workbench")
PATIENCE = 180_000
"""Milliseconds that a page may take to do what it was asked: a machine that does many things at once is slow, not wrong."""

ADDRESS = re.compile(rb"http://([\w.:]+)/\?token=(\S+)")


@dataclass(kw_only=True)
class Workbench:
    """A running `massline app`."""

    process: subprocess.Popen[bytes]
    host: str
    token: str

    @property
    def address(self) -> str:
        return f"http://{self.host}/?token={self.token}"

    @property
    def port(self) -> int:
        return int(self.host.rpartition(":")[2])

    def descendants(self) -> list[int]:
        """The processes below the door, zombies aside."""
        return _below(self.process.pid)

    def windows(self) -> list[int]:
        """The processes of windows, without what they have started."""
        return _children(self.process.pid)

    def interrupted(self) -> int:
        """The exit code after Ctrl-C."""
        self.process.send_signal(signal.SIGINT)
        return self.process.wait(timeout=20)


def _below(pid: int) -> list[int]:
    return [each for child in _children(pid) for each in (child, *_below(child))]


def _children(pid: int) -> list[int]:
    found: list[int] = []
    for listed in Path(f"/proc/{pid}/task").glob("*/children"):
        with suppress(OSError):  # the thread has ended meanwhile
            found += [child for word in listed.read_text().split() if alive(child := int(word))]
    return found


def alive(pid: int) -> bool:
    """Whether the process runs; one that ended and waits to be collected does not."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


@pytest.fixture(scope="session", name="until")
def _until() -> Callable[..., bool]:
    return until


@pytest.fixture(scope="session", name="alive")
def _alive() -> Callable[[int], bool]:
    return alive


def until(claim: Callable[[], bool], seconds: float = 15.0) -> bool:
    """Whether `claim` comes true in time."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if claim():
            return True
        time.sleep(0.05)
    return claim()


@pytest.fixture(scope="session")
def start_app(tmp_path_factory) -> Iterator[Callable[..., Workbench]]:
    """`massline app` with arguments, in a folder of its own; ended with the tests."""
    running: list[Workbench] = []

    def started(*arguments: str, **environment: str) -> Workbench:
        folder = tmp_path_factory.mktemp("app")
        program = "from validation.cli.main import main; main()"
        process = subprocess.Popen(
            [sys.executable, "-P", "-c", program, "app", "--no-browser", *arguments],
            cwd=folder,
            env={**os.environ, "PYTHONUNBUFFERED": "1", "TMPDIR": str(folder), **environment},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
        )
        said = b""
        while (match := ADDRESS.search(said)) is None:
            line = process.stdout.readline()
            assert line, f"the app ended: {said.decode()}"
            said += line
        bench = Workbench(process=process, host=match[1].decode(), token=match[2].decode())
        running.append(bench)
        return bench

    yield started
    for bench in running:
        if bench.process.poll() is None:
            bench.interrupted()
        said = bench.process.stdout.read().decode()
        bench.process.stdout.close()
        assert "did not start" not in said, said


@pytest.fixture(scope="session")
def series(gain) -> tuple[str, str]:
    """A model, and the smallest test with something in it that the model does not know."""
    return str(gain / "model.toml"), str(gain / "gain")


@dataclass(kw_only=True)
class Heard:
    """What a page said that it should not have, and whom it asked."""

    said: list[str] = field(default_factory=list)
    asked: set[str] = field(default_factory=set)


@pytest.fixture(scope="module")
def visit(chromium) -> Iterator[Callable[..., Any]]:
    """A new browser, as if on another machine, with a page in it; its console must stay clean and it must ask nobody else."""
    contexts: list[tuple[Any, Heard, str]] = []

    def visited(bench: Workbench, *, width: int = 1366, height: int = 768, dark: bool = False) -> Any:
        context = chromium.new_context(
            viewport={"width": width, "height": height}, color_scheme="dark" if dark else "light", accept_downloads=True
        )
        heard = Heard()
        contexts.append((context, heard, bench.host))
        context.on("page", lambda page: _listen(page, heard))
        page = context.new_page()
        page.set_default_timeout(PATIENCE)
        page.goto(bench.address)
        return page

    yield visited
    for context, heard, host in contexts:
        context.close()
        assert not heard.said, f"the console is not clean: {heard.said}"
        assert {_host(address) for address in heard.asked} <= {host}, f"asked elsewhere: {heard.asked}"


def _listen(page: Any, heard: Heard) -> None:
    page.on("console", lambda message: heard.said.append(message.text) if message.type in ("error", "warning") else None)
    page.on("pageerror", lambda error: heard.said.append(str(error)))
    page.on("request", lambda request: heard.asked.add(request.url))
    page.on("websocket", lambda socket: heard.asked.add(socket.url))


def _host(address: str) -> str:
    named = address.removeprefix("blob:")  # a download that the page made names the page
    return named.split("/")[2] if named.startswith(("http", "ws")) else named.split(":")[0]


@pytest.fixture(scope="session")
def shot() -> Callable[[Any, str], None]:
    """Keeps a picture of a page under out/workbench."""

    def kept(page: Any, name: str) -> None:
        SHOTS.mkdir(parents=True, exist_ok=True)
        page.screenshot(path=str(SHOTS / f"{name}.jpg"), type="jpeg", quality=90)  # quicker than PNG, several times

    return kept


RESTS = """([scheme, paper]) => document.querySelector(`.v-theme--${scheme}`)
    && [...document.querySelectorAll(".js-plotly-plot")].every((one) => one._fullLayout?.paper_bgcolor === paper)
    && [...document.querySelectorAll("canvas.view")].every((one) => one.dataset.shown)
    && document.getAnimations().every((one) => !(one instanceof CSSTransition) || one.playState !== "running")"""
"""Whether page and figures have taken their colours, and nothing fades any more."""

PAPER = {"light": "#ffffff", "dark": "#171b22"}


@pytest.fixture(scope="session")
def looked(script, shot) -> Callable[[Any, str], None]:
    """``looked(page, state)``: light and dark on a laptop, and once on a large screen, every text stands out, every control has
    a name and nothing has to be scrolled sideways; a picture is kept of each. It ends with the other colours: the next state
    begins with them."""

    def look(page: Any, state: str) -> None:
        now = "dark" if page.evaluate("matchMedia('(prefers-color-scheme: dark)').matches") else "light"
        other = {"light": "dark", "dark": "light"}[now]
        for width, height, scheme in ((1366, 768, now), (1366, 768, other), (1920, 1080, other)):
            page.set_viewport_size({"width": width, "height": height})
            page.emulate_media(color_scheme=scheme)
            page.wait_for_function(RESTS, arg=[scheme, PAPER[scheme]])
            where = f"{state}-{scheme}-{width}"
            shot(page, where)
            assert page.evaluate(script("contrast")) == [], where
            assert page.evaluate(script("unlabelled")) == [], where
            assert page.evaluate("document.documentElement.scrollWidth <= innerWidth"), where
        page.set_viewport_size({"width": 1366, "height": 768})

    return look


@pytest.fixture(autouse=True)
def _loops_of_their_own(monkeypatch) -> None:
    """The browser's driver has a loop running in this thread for all of the session: others run in a thread of their own."""
    run = asyncio.run

    def alone(main: Any) -> Any:
        with ThreadPoolExecutor(1) as pool:
            return pool.submit(run, main).result()

    monkeypatch.setattr(asyncio, "run", alone)
