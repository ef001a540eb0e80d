"""What runs in the worker of a desk: one verb, its progress written down, its end said in words."""

from __future__ import annotations

import os
import signal
import sys
import threading
import time
import traceback
from collections.abc import Callable
from dataclasses import replace
from multiprocessing.connection import Connection
from pathlib import Path
from types import FrameType
from typing import Any

from geometry.errors import BadInput, CheckFailed
from validation.desk.desk import Asked, Desk, opened
from validation.desk.jobs import ADD, COMPARE, DIAGNOSE, DONE, REPORT, Job, failed, job, tell

Progress = Callable[[str, float], None]

OFTEN = 0.15
"""Seconds between two words on how far the work is."""

LOG = "job.log"
"""Where what nobody foresaw is written down, for whoever mends it."""


def work(folder: str, kind: str, asked: dict[str, Any], watch: Connection) -> None:
    """The whole life of a worker."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the one who started it, and who ends it
    signal.signal(signal.SIGTERM, _ended)
    threading.Thread(target=_end_with, args=(watch,), daemon=True).start()
    began = time.monotonic()
    of = Desk(folder=Path(folder), asked=Asked(model="", data=()))  # what it was asked is read where a fault is told
    known = job(of)
    told = _Told(of, Job(kind=kind, asked=asked, before=known.before if known else ""))
    try:
        _verb(kind)(opened(folder), asked, told.hear)
        end = replace(told.job, state=DONE, share=1.0)
    except (BadInput, CheckFailed) as error:
        end = failed(of, told.job, str(error))
    except OSError as error:
        end = failed(of, told.job, f"{error.filename or 'a file'}: {error.strerror or error}")
    except Exception as error:
        _logged(of)
        problem = f"the program failed where nobody foresaw it ({type(error).__name__}: {error})"
        end = failed(of, told.job, f"{problem}; nothing is lost. {of.folder / LOG} says where")
    tell(of, replace(end, seconds=time.monotonic() - began))


def _verb(kind: str) -> Callable[[Desk, dict[str, Any], Progress], object]:
    """By kind; modules are imported when they are needed."""
    from validation.desk import climbing, comparing, diagnosing, saving

    return {
        COMPARE: lambda of, asked, told: comparing.compared(of, told),
        DIAGNOSE: lambda of, asked, told: diagnosing.diagnosed(of, tuple(asked.get("candidates", ())), told),
        ADD: lambda of, asked, told: climbing.added(of, asked["effect"], progress=told),
        REPORT: lambda of, asked, told: saving.reported(of, asked["to"], told),
    }[kind]


class _Told:
    """Progress, written down now and then."""

    def __init__(self, of: Desk, job: Job) -> None:
        self.desk, self.job, self._began, self._last = of, job, time.monotonic(), 0.0

    def hear(self, what: str, share: float) -> None:
        """Take note that `share` of `what` is done."""
        moment = time.monotonic()
        another = what != self.job.what
        self.job = replace(self.job, what=what, share=min(max(share, 0.0), 1.0), seconds=moment - self._began)
        if another or moment - self._last >= OFTEN:
            self._last = moment
            tell(self.desk, self.job)


def _ended(number: int, frame: FrameType | None) -> None:
    """Put down what is held, temporary files among it, and go."""
    sys.exit(128 + number)


def _end_with(watch: Connection) -> None:
    """End when the process at the other end of the pipe does, however that came."""
    try:
        watch.recv()
    except (EOFError, OSError):
        os.kill(os.getpid(), signal.SIGTERM)
        time.sleep(0.5)
        os._exit(1)


def _logged(of: Desk) -> None:
    Path(of.folder / LOG).write_text(traceback.format_exc(), encoding="utf-8")
