"""One process a window of the browser: started when its page is asked for, ended when its last page has been closed for a while.

trame keeps one state a server; two windows in one server would pull each other's sliders. Here each window has a server of its
own, in a process of its own, on a port of its own that answers nobody who does not know the door's secret.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import os
import signal
import sys
from dataclasses import asdict, dataclass, field
from pathlib import Path
from secrets import token_hex, token_urlsafe
from typing import TYPE_CHECKING

from geometry.errors import CheckFailed

if TYPE_CHECKING:
    from collections.abc import Callable, Coroutine

    from validation.app.asked import Opened

STARTS_WITHIN = 60.0
"""Seconds that a window's process may take until it answers: patience for a laptop that is busy."""

LINGERS = 3.0
"""Seconds that a process stays after its last page was closed; a reload asks for its page again in less than one."""

NEVER_OPENED = 120.0
"""Seconds after which a process ends that was asked for something and then got no page: a browser may be slow to load it all."""

MOST = 32
"""Processes at once."""


@dataclass(kw_only=True)
class Window:
    """A window's process, as the door sees it.

    Attributes
    ----------
    process : leader of a group of its own, its workers in it
    port : loopback port of its server
    pages : how many pages hold a websocket to it
    ends : what will end it, while no page is open
    """

    process: asyncio.subprocess.Process
    port: int
    pages: int = 0
    ends: asyncio.TimerHandle | None = None


@dataclass(kw_only=True)
class Windows:
    """All windows of a door, by their names.

    Attributes
    ----------
    home : folder that holds a folder for each window
    opened : what a new window begins with
    emptied : called when the last process has ended
    secret : what the door says to the servers of windows
    """

    home: Path
    opened: Opened
    emptied: Callable[[], None] = lambda: None
    secret: str = field(default_factory=lambda: token_urlsafe(32))
    _by_name: dict[str, asyncio.Task[Window]] = field(default_factory=dict)
    _spare: str = ""
    _given: set[str] = field(default_factory=set)
    _beside: set[asyncio.Task[None]] = field(default_factory=set)

    def ready(self) -> None:
        """Let a process start before its page is asked for: it then stands there at once."""
        self._spare = token_hex(9)
        self._by_name[self._spare] = asyncio.ensure_future(self._started(self._spare))

    def new(self) -> str:
        """The name of a window that no page has yet."""
        name, self._spare = self._spare or token_hex(9), ""
        self._given.add(name)
        return name

    def gave(self, name: str) -> bool:
        """Whether `name` is one of `new`: no process begins under a name that somebody thought of."""
        return name in self._given

    async def window(self, name: str) -> Window:
        """The window called `name`, its process started if there is none.

        Raises
        ------
        CheckFailed : it does not start, and its log says why; or there are too many.
        """
        task = self._by_name.get(name)
        if task is None or (task.done() and not _alive(task)):
            if sum(_alive(one) or not one.done() for one in self._by_name.values()) >= MOST:
                raise CheckFailed(f"{MOST} windows are open already; close one of them")
            task = asyncio.ensure_future(self._started(name))
            self._by_name[name] = task
        window = await asyncio.shield(task)
        if window.pages == 0:  # a reload that takes its time keeps the process with whatever it computes
            self._end_in(NEVER_OPENED, window)
        return window

    def is_open(self, name: str) -> bool:
        """Whether a page holds the window called `name`."""
        task = self._by_name.get(name)
        return task is not None and task.done() and _alive(task) and task.result().pages > 0

    def any_alive(self) -> bool:
        """Whether any window's process runs, or is about to."""
        return any(_alive(task) or not task.done() for task in self._by_name.values())

    def page_opened(self, window: Window) -> None:
        """A page has taken up its websocket."""
        window.pages += 1
        _cancel(window)

    def page_closed(self, window: Window) -> None:
        """A page has let go of it; the last one starts the clock."""
        window.pages -= 1
        if window.pages == 0:
            self._end_in(LINGERS, window)

    async def end(self) -> None:
        """End every window, and see all of them gone."""
        for task in self._by_name.values():
            if not task.done():
                task.cancel()
        await asyncio.gather(*(self._ended(task.result()) for task in self._by_name.values() if _alive(task)))

    def _end_in(self, seconds: float, window: Window) -> None:
        _cancel(window)
        window.ends = asyncio.get_running_loop().call_later(seconds, lambda: self._run(self._ended(window)))

    async def _started(self, name: str) -> Window:
        folder = self.home / name
        folder.mkdir(mode=0o700, exist_ok=True)
        process, port = await _spawned(folder, self.secret, self.opened)
        window = Window(process=process, port=port)
        self._run(self._watched(window))
        return window

    def _run(self, work: Coroutine[None, None, None]) -> None:
        """Run `work` beside everything else; the loop itself keeps no hold of it."""
        task = asyncio.ensure_future(work)
        self._beside.add(task)
        task.add_done_callback(self._beside.discard)

    async def _watched(self, window: Window) -> None:
        await window.process.wait()
        _cancel(window)
        _end_group(window.process)  # workers that a crash left behind
        if not self.any_alive():
            self.emptied()

    async def _ended(self, window: Window) -> None:
        _end_group(window.process)
        await window.process.wait()


async def _spawned(folder: Path, secret: str, opened: Opened) -> tuple[asyncio.subprocess.Process, int]:
    read_end, write_end = os.pipe()
    log = folder / "window.log"
    try:
        with log.open("ab") as heard:
            process = await asyncio.create_subprocess_exec(
                *(sys.executable, "-P", "-m", "validation.app.window", str(folder), str(write_end)),
                stdin=asyncio.subprocess.PIPE,
                stdout=heard,
                stderr=heard,
                pass_fds=(write_end,),
                start_new_session=True,  # Ctrl-C is the door's to hear; and a group of its own is ended as one
                env=_environment(),
            )
    finally:
        os.close(write_end)
    assert process.stdin is not None
    process.stdin.write(json.dumps({"secret": secret, "opened": asdict(opened)}).encode() + b"\n")
    try:
        return process, await _port(process, read_end, log)
    except BaseException:  # cancelled, too: nobody else knows this process yet
        _end_group(process)
        raise


async def _port(process: asyncio.subprocess.Process, read_end: int, log: Path) -> int:
    """The port that the new process says it listens on, once it does."""
    reader = asyncio.StreamReader()
    transport, _ = await asyncio.get_running_loop().connect_read_pipe(
        lambda: asyncio.StreamReaderProtocol(reader), os.fdopen(read_end, "rb")
    )
    try:
        said = await asyncio.wait_for(reader.readline(), STARTS_WITHIN)
    except TimeoutError:
        said = b""
    finally:
        transport.close()
    if not said:
        raise CheckFailed(f"the window's process did not start: {_last_line(log)}", log=log.read_text(errors="replace"))
    return int(said)


def _last_line(log: Path) -> str:
    lines = log.read_text(errors="replace").strip().splitlines()
    return lines[-1] if lines else "it said nothing"


def _environment() -> dict[str, str]:
    """This environment without what would configure the server behind the door's back, and with one thread a window."""
    kept = {key: value for key, value in os.environ.items() if not key.startswith(("TRAME_", "WSLINK_"))}
    return {**kept, "WSLINK_WS_COMPRESS": "0", "PYTHONUNBUFFERED": "1"}


def _alive(task: asyncio.Task[Window]) -> bool:
    if not task.done() or task.cancelled() or task.exception() is not None:
        return False
    return task.result().process.returncode is None


def _cancel(window: Window) -> None:
    if window.ends is not None:
        window.ends.cancel()
        window.ends = None


def _end_group(process: asyncio.subprocess.Process) -> None:
    with contextlib.suppress(ProcessLookupError, PermissionError):
        os.killpg(process.pid, signal.SIGKILL)
