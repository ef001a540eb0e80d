"""What `massline app` was asked, checked at the door, and how it travels to the process of a window."""

import ctypes
import os
import signal
import sys
import threading
import time
from contextlib import suppress
from dataclasses import dataclass, field
from ipaddress import ip_address
from pathlib import Path
from typing import TYPE_CHECKING

from geometry import toml_file
from geometry.errors import BadInput

if TYPE_CHECKING:
    from validation.study import Options

LOOPBACK = "127.0.0.1"

LINGER = 20.0
"""Seconds that everything stays when the last page was closed: enough to open it again that was closed by mistake."""


@dataclass(frozen=True, kw_only=True)
class StartOptions:
    """What every new window begins with; nothing of it makes an empty page.

    Attributes
    ----------
    example : name of a built-in example, None for none
    asked : what a study is opened with, paths absolute; its model is empty where none is named
    """

    example: str | None = None
    asked: "Options | None" = None

    @property
    def effects_from(self) -> tuple[str, ...]:
        """Folders with effects of the user's own."""
        return () if self.asked is None else self.asked.effects_from


@dataclass(frozen=True, kw_only=True)
class WorkbenchOptions:
    """The options as typed.

    Attributes
    ----------
    opened : what every window begins with
    port : of the door; 0 lets the system choose
    host : address that the door listens on
    browser : whether the system's browser is opened
    linger : seconds that the door stays when the last page is closed; None for ever
    """

    opened: StartOptions = field(default_factory=StartOptions)
    port: int = 0
    host: str = LOOPBACK
    browser: bool = True
    linger: float | None = LINGER


def opened(
    example: str | None,
    model: str | None,
    data: tuple[str, ...],
    *,
    hold_out: tuple[str, ...] = (),
    band: tuple[float, float] | None = None,
    method: str = "full-record",
    effects_from: tuple[str, ...] = (),
) -> StartOptions:
    """The arguments of the command as one noun, with absolute paths, because a window works in a folder of its own.

    Raises
    ------
    BadInput : an example beside a model or one that nobody knows, a model without data, a path that is not there.
    """
    if example is not None:
        from validation.app.opening import EXAMPLES

        known = [one.name for one in EXAMPLES]
        if example not in known:
            raise BadInput("--example", "", f"there is none called {example}", f"Known are {', '.join(known)}")
    if example is not None and model is not None:
        problem = f"an example brings its own model and data, found MODEL {model} beside it"
        raise BadInput("--example", "", problem, "Give one of the two")
    if model is not None and not data and Path(model).exists() and not toml_file.holds(Path(model), "test"):
        remedy = "Name a campaign folder or the file of a test"
        raise BadInput("DATA", "", f"nothing stands behind the model {model}, and it names no [[test]]", remedy)
    from validation.study import Options

    asked = Options(
        model="" if model is None else _absolute(model),
        data=tuple(_absolute(path) for path in data),
        hold_out=hold_out,
        band=band,
        method=method,
        effects_from=tuple(_absolute(path) for path in effects_from),
    )
    return StartOptions(example=example, asked=asked)


def is_loopback(host: str) -> bool:
    """Whether only this machine reaches `host`."""
    if host == "localhost":
        return True
    try:
        return ip_address(host).is_loopback
    except ValueError:
        return False


def _absolute(path: str) -> str:
    if not Path(path).exists():
        raise BadInput(path, "", "there is no such file or folder", "Check the path")
    return str(Path(path).absolute())


# What every answer tells the browser: take nothing from elsewhere, guess no types, show this page in no other.


SECURITY = {
    # Vue compiles the page's templates in the browser, which needs `unsafe-eval`; nothing that a user's file says is ever part of
    # a template. Styles are set by the widgets themselves.
    "Content-Security-Policy": "; ".join(
        (
            *("default-src 'none'", "script-src 'self' 'unsafe-eval'", "style-src 'self' 'unsafe-inline'"),
            *("img-src 'self' data: blob:", "font-src 'self' data:", "connect-src 'self'"),
            *("frame-ancestors 'none'", "base-uri 'self'", "form-action 'none'"),
        )
    ),
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
}

NEVER_KEPT = {"Cache-Control": "no-store"}

DOOR_SECRET = "X-Massline-Door"
"""What the door says to a window's own server, and nobody else knows."""


# A process that does not outlive the one that started it.
#
# Two ends are watched. The starter holds the other end of standard input: when it closes, by a clean end or by a crash, this
# process ends its whole group, workers included. And where the system knows it (Linux), the kernel itself ends this process
# with the thread that started it. No process is left even when the starter was killed in the middle of a computation.


PR_SET_PDEATHSIG = 1
"""`prctl(2)`: the signal that this process gets when its parent dies."""


def tied() -> None:
    """Tie this process, the leader of its group, to the one that holds the other end of its standard input."""
    if sys.platform == "linux":
        ctypes.CDLL(None, use_errno=True).prctl(PR_SET_PDEATHSIG, signal.SIGTERM)
    signal.signal(signal.SIGTERM, lambda *_: end_group())
    threading.Thread(target=_wait_for_the_end, name="lifeline", daemon=True).start()


PR_SET_CHILD_SUBREAPER = 36
"""`prctl(2)`: processes whose parent ends become children of this one, not of the first process of the system."""


def adopting() -> None:
    """Let what a window leaves behind come to this process, which `collect` takes away; the first process may not do that."""
    if sys.platform == "linux":
        ctypes.CDLL(None, use_errno=True).prctl(PR_SET_CHILD_SUBREAPER, 1)


COLLECTS = 2.0
"""[s] within which processes that were killed are gone."""


def collect(group: int) -> None:
    """Wait for the processes of a `group` that was ended, so that none stays in the table of processes."""
    end = time.monotonic() + COLLECTS
    with suppress(ChildProcessError):
        while time.monotonic() < end:
            if os.waitid(os.P_PGID, group, os.WEXITED | os.WNOHANG) is None:
                time.sleep(0.01)


def end_group() -> None:
    """End this process and all that it started, at once; what the session keeps is on disk already."""
    os.killpg(os.getpgrp(), signal.SIGKILL)


def _wait_for_the_end() -> None:
    # An unbuffered read of its own: the buffered one of `sys.stdin` would hold a lock when the interpreter ends.
    while os.read(0, 4096):
        pass
    end_group()
