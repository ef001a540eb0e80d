"""Long work in a process of its own: what it does, how far it is, and its end, in one small file of the session.

A worker is started by `start`, writes ``job.json`` as it goes and its results into the session, and ends with the process that
started it, whatever happens to that (a pipe between both closes). `Worker.cancel` ends it within a second and takes away what it
left half-done. A rung that was written by work which did not come to its end is left again. One job a session at a time.
"""

import json
import multiprocessing
import os
import signal
import sys
import threading
import time
import traceback
from dataclasses import asdict, dataclass, replace
from multiprocessing.connection import Connection
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING, Any

from geometry.atomic import write_text
from geometry.errors import BadInput, CheckFailed
from validation.app.session import Session, digest, opened
from validation.history.history import read_text
from validation.output import json_text
from validation.study import Options

if TYPE_CHECKING:
    from multiprocessing.context import SpawnProcess


RUNNING, DONE, FAILED, CANCELLED = STATES = ("running", "done", "failed", "cancelled")

COMPARE, DIAGNOSE, ADD, REPORT = KINDS = ("compare", "diagnose", "add", "report")
"""What a worker can do: the verbs of a `validation.app.session.Session`."""

GRACE = 0.5
"""Seconds that a worker has to put down what it holds before it is killed."""

_at_work: "dict[Path, Worker]" = {}
"""By folder of a session, the worker that was started last."""


@dataclass(frozen=True, kw_only=True)
class Job:
    """What a worker does or did.

    Attributes
    ----------
    kind : of `KINDS`
    asked : its arguments, such as ``{"effect": "force-gain:fmd-z2"}``
    state : of `STATES`
    what : what it does now, in words
    share : of `what`, 0 to 1
    error : in words, for a person; empty unless it failed
    said : of one that was cancelled, a sentence on what became of the model; empty where nothing has changed
    before : digest of the model as it was when it began
    seconds : since it began, until it ended
    step_began : [s] after which it began with `what`
    """

    kind: str
    asked: dict[str, Any]
    state: str = RUNNING
    what: str = ""
    share: float = 0.0
    error: str = ""
    said: str = ""
    before: str = ""
    seconds: float = 0.0
    step_began: float = 0.0

    @property
    def ended(self) -> bool:
        """Whether nothing runs any more."""
        return self.state != RUNNING


class Worker:
    """A process at work for a session. Its session, its process, and the pipe whose end is its end."""

    def __init__(self, of: Session, kind: str, process: "SpawnProcess", watch: Connection) -> None:
        self.session, self.kind, self._process, self._watch = of, kind, process, watch
        self._cancelling = False

    @property
    def pid(self) -> int | None:
        """Of the process, for tests and logs."""
        return self._process.pid

    def job(self) -> Job:
        """How it stands; a process that died without a word is told as failed."""
        alive = self._process.is_alive()
        found = job(self.session) or Job(kind=self.kind, asked={})
        if alive or found.ended or self._cancelling:
            return found
        code = self._process.exitcode
        error = f"the worker ended by itself (exit code {code}) without saying why"
        if code is not None and code < 0:
            error = f"the worker was ended from outside (signal {-code}), most often because memory ran out"
        return _kept(self.session, failed(self.session, found, f"{error}; nothing is lost, try again"))

    def wait(self, seconds: float | None = None) -> Job:
        """Until it ended, or `seconds` are over."""
        self._process.join(seconds)
        return self.job()

    def cancel(self) -> Job:
        """End it now: within a second it is gone, and nothing half-done is left. What ended by itself stays as it ended."""
        self._cancelling = True  # whoever asks meanwhile, in another thread, finds it dead, and would call that a failure
        if self._process.is_alive():
            self._process.terminate()
            self._process.join(GRACE)
        if self._process.is_alive():
            self._process.kill()
            self._process.join()
        self._watch.close()
        found = job(self.session) or Job(kind=self.kind, asked={})
        swept(self.session)
        return found if found.ended else _kept(self.session, _cancelled(self.session, found))


def start(of: Session, kind: str, **asked: Any) -> Worker:
    """Begin to work for the session `of`; `asked` are the arguments of the verb, JSON values.

    Raises
    ------
    BadInput : a job of this session runs already.
    ValueError : there is no such kind.
    """
    if kind not in KINDS:
        raise ValueError(f"`kind` must be one of {', '.join(KINDS)}, found {kind!r}")
    running = _at_work.get(of.folder)
    if running is not None and not running.job().ended:
        raise BadInput("desk", "", f"it is at work already: {running.kind}", "Wait for it to end, or cancel it")
    context = multiprocessing.get_context("spawn")
    here, there = context.Pipe()

    began = Job(kind=kind, asked=dict(asked), what="starting", before=digest(read_text(of.model)))
    _kept(of, began)
    process = context.Process(target=work, args=(str(of.folder), kind, dict(asked), there), name=f"massline {kind}", daemon=True)
    process.start()
    there.close()
    _at_work[of.folder] = Worker(of, kind, process, here)
    return _at_work[of.folder]


def job(of: Session) -> Job | None:
    """The job that runs or that ran last, as its file says; None before there was one."""
    try:
        found = json.loads(of.job.read_text(encoding="utf-8"))
        return Job(**found)
    except (OSError, ValueError, TypeError):
        return None


def tell(of: Session, said: Job) -> None:
    """Write down how a job stands."""
    write_text(of.job, json_text(asdict(said)))


def recovered(of: Session) -> Job | None:
    """The last job of a session that is opened anew: one that ran when its window ended was cancelled by that."""
    found = job(of)
    if found is None or found.ended:
        return found
    swept(of)
    return _kept(of, _cancelled(of, found))


def swept(of: Session) -> None:
    """Take away files that a process which was ended had begun to write."""
    for folder in (of.folder, of.folder / "work", *(of.folder / "found").glob("*")):
        for path in folder.glob(".*"):
            if path.is_file():
                path.unlink(missing_ok=True)


def failed(of: Session, found: Job, error: str) -> Job:
    """`found` as one that failed with `error`, the model being as it was before."""
    said = _put_back(of, found)
    return replace(found, state=FAILED, error=f"{error}; {said}" if said else error)


def _cancelled(of: Session, found: Job) -> Job:
    said = _put_back(of, found)
    return replace(found, state=CANCELLED, said=said)


def _put_back(of: Session, found: Job) -> str:
    """Leave a rung that the work wrote before it ended; what is to be said of that."""

    if found.kind != ADD or not found.before:
        return ""
    try:
        return of.put_back(found.before)
    except (BadInput, OSError) as error:
        return f"the model could not be put back to where it was: {error}"


def _kept(of: Session, said: Job) -> Job:
    tell(of, said)
    return said


# What runs in the worker of a session: one verb, its progress written down, its end said in words.


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
    of = Session(folder=Path(folder), asked=Options(model=""))  # what it was asked is read where a fault is told
    known = job(of)
    told = _Told(of, Job(kind=kind, asked=asked, before=known.before if known else ""))
    try:
        session = opened(folder)
        if kind == COMPARE:
            session.compare(told.hear)
        elif kind == DIAGNOSE:
            session.diagnose(tuple(asked.get("candidates", ())), told.hear)
        elif kind == ADD:
            session.add(asked["effect"], told.hear)
        else:
            session.report(asked["to"], told.hear)
        end = replace(told.job, state=DONE, share=1.0)
    except (BadInput, CheckFailed) as error:
        end = failed(of, told.job, str(error))
    except OSError as error:
        end = failed(of, told.job, f"{error.filename or 'a file'}: {error.strerror or error}")
    except Exception as error:
        Path(of.folder / LOG).write_text(traceback.format_exc(), encoding="utf-8")
        problem = f"the program failed where nobody foresaw it ({type(error).__name__}: {error})"
        end = failed(of, told.job, f"{problem}; nothing is lost. {of.folder / LOG} says where")
    tell(of, replace(end, seconds=time.monotonic() - began))


class _Told:
    """Progress, written down now and then."""

    def __init__(self, of: Session, job: Job) -> None:
        self.session, self.job, self._began, self._last = of, job, time.monotonic(), 0.0

    def hear(self, what: str, share: float) -> None:
        """Take note that `share` of `what` is done."""
        moment = time.monotonic()
        another = what != self.job.what
        seconds = moment - self._began
        step_began = seconds if another else self.job.step_began
        self.job = replace(self.job, what=what, share=min(max(share, 0.0), 1.0), seconds=seconds, step_began=step_began)
        if another or moment - self._last >= OFTEN:
            self._last = moment
            tell(self.session, self.job)


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
