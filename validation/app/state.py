"""What one window holds while it is open: the session, what was computed for it, and the threads in which anything slow happens.

Everything of worth lies in the session's folder; a window that was closed and is opened again by its address takes it up from
there.
"""

import asyncio
import json
import shutil
import sys
import time
import traceback
from collections.abc import Awaitable, Callable, Coroutine, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from itertools import chain, count
from pathlib import Path
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

from geometry import cache
from geometry.atomic import write_text
from geometry.errors import BadInput, CheckFailed
from validation.app import workers
from validation.app.kept import copied
from validation.app.options import StartOptions
from validation.app.session import Session, is_session, opened
from validation.app.workers import CANCELLED, DONE, FAILED, Job
from validation.history import history
from validation.output import json_text

if TYPE_CHECKING:
    from validation.app.kept import Compared
    from validation.app.whatif import ReadyPredictions, TrialEffect, WhatIf
    from validation.app.workers import Worker
    from validation.report.scenes.turntable import Turntable


P = ParamSpec("P")
T = TypeVar("T")


@dataclass(kw_only=True)
class WindowState:
    """A window.

    Attributes
    ----------
    state : what the page shows, trame's
    folder : of this window; sessions lie in it
    opened : what the command line asked to begin with
    session : what is worked on, None before something is open
    compared : the comparison of the model as it stands
    table : predictions that stand ready for what-if
    effects : that can be tried, by id
    worker : the job that runs
    ending : its end, once it is cancelled
    turntable : what the view shows
    sizes : where the sliders of the chosen effect stand, by key
    wanted : the effect that was chosen last, with its size where one was said
    tried : what it would do, at every line
    exact : whether the sliders rest
    drags, views : how many curves and scenes have been sent
    positions : places without a name at which something was tried, as coordinates
    """

    state: Any
    folder: Path
    opened: StartOptions
    session: Session | None = None
    compared: "Compared | None" = None
    table: "ReadyPredictions | None" = None
    effects: "dict[str, TrialEffect]" = field(default_factory=dict)
    worker: "Worker | None" = None
    ending: asyncio.Future[Job] | None = None
    turntable: "Turntable | None" = None
    sizes: dict[str, float] = field(default_factory=dict)
    wanted: str | None = None
    tried: "WhatIf | None" = None
    exact: bool = True
    drags: int = 0
    views: int = 0
    positions: tuple[str, ...] = ()
    dragging: asyncio.Task[None] | None = None
    tasks: set[asyncio.Task[None]] = field(default_factory=set)
    # One thread each: a session computes one thing at a time, and OpenGL wants to be spoken to by one thread only.
    _computing: ThreadPoolExecutor = field(default_factory=lambda: ThreadPoolExecutor(1, "desk"))
    # A slider that moves on does not wait for what was computed where it rested.
    _resting: ThreadPoolExecutor = field(default_factory=lambda: ThreadPoolExecutor(1, "rest"))
    # What takes long and is no process gets a thread beside these.
    _aside: ThreadPoolExecutor = field(default_factory=lambda: ThreadPoolExecutor(1, "aside"))
    _drawing: ThreadPoolExecutor = field(default_factory=lambda: ThreadPoolExecutor(1, "view"))

    async def away(self, work: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> T:
        """`work` done beside the page, which goes on."""
        return await asyncio.get_running_loop().run_in_executor(self._computing, partial(work, *args, **kwargs))

    async def at_rest(self, work: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> T:
        """The same for what is computed exactly where a slider rests."""
        return await asyncio.get_running_loop().run_in_executor(self._resting, partial(work, *args, **kwargs))

    async def aside(self, work: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> T:
        """The same for what takes seconds: no click waits behind it."""
        return await asyncio.get_running_loop().run_in_executor(self._aside, partial(work, *args, **kwargs))

    async def drawn(self, work: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> T:
        """The same for pictures."""
        return await asyncio.get_running_loop().run_in_executor(self._drawing, partial(work, *args, **kwargs))

    def begin(self, work: Coroutine[Any, Any, None]) -> asyncio.Task[None]:
        """Let `work` run by itself; how it fails is told on the page."""
        task = asyncio.ensure_future(self.told(work))
        self.tasks.add(task)
        task.add_done_callback(self.tasks.discard)
        return task

    async def told(self, work: Awaitable[None]) -> None:
        """Await `work`; what goes wrong is said on the page in words, and nothing else stops."""
        try:
            await work
        except (BadInput, CheckFailed) as error:
            self.state.failure = str(error)
        except OSError as error:
            self.state.failure = f"{error.filename or 'file'}: {error.strerror or error}. Check the path and its permissions."
        except Exception:
            traceback.print_exc(file=sys.stderr)
            self.state.failure = (
                f"The workbench itself made a mistake; what is open is not lost. {self.folder / 'window.log'} says more."
            )
        self.state.flush()


# Long work on the page: a line that says what is done, how far it is, and a button that ends it.


PACE = 0.15
"""Seconds between two looks at a worker."""

WORDS = {
    workers.COMPARE: "Comparing",
    workers.DIAGNOSE: "Diagnosing",
    workers.ADD: "Adding",
    workers.REPORT: "Writing the report",
}


Following = Callable[[WindowState], Awaitable[None]]


async def unchanged(window: WindowState) -> None:
    """What a job that only adds to what is found leaves to be done when it is ended early."""


def start(window: WindowState, kind: str, then: Following, left: Following = unchanged, **asked: Any) -> None:
    """Let a worker begin; `then` follows when it is done. While one works no other begins.

    `left` follows when it was cancelled or failed, and brings the page to what is there.
    """
    if window.session is None or window.worker is not None:
        return
    window.state.failure, window.state.ready = "", None
    window.worker = workers.start(window.session, kind, **asked)
    _tell(window, window.worker.job())
    window.begin(_watched(window, then, left))


async def cancel(window: WindowState) -> None:
    """End the worker now. Nobody looks at it while it dies: that would be told as a failure."""
    if window.worker is not None and window.ending is None:
        window.ending = asyncio.ensure_future(asyncio.to_thread(window.worker.cancel))


def teller(window: WindowState, words: str) -> Callable[[str, float], None]:
    """What work in a thread calls to say how far it is; a thread cannot be cancelled."""
    loop, began, steps = asyncio.get_running_loop(), time.monotonic(), dict[str, float]()

    def show(what: str, share: float) -> None:
        seconds = time.monotonic() - began
        step = steps.setdefault(what, seconds)
        window.state.job = line(f"{words}: {what}", share, seconds, step, cancellable=False)
        window.state.flush()

    show("...", 0.0)
    return lambda what, share: None if loop.is_closed() else (loop.call_soon_threadsafe(show, what, share), None)[1]


async def _watched(window: WindowState, then: Following, left: Following) -> None:
    worker = window.worker
    if worker is None:
        return
    job = worker.job()
    while not job.ended:
        await asyncio.sleep(PACE)
        job = worker.job() if window.ending is None else await window.ending
        _tell(window, job)
    await asyncio.to_thread(worker.wait, workers.GRACE)  # it ends soon after its last word, and leaves nothing behind
    window.worker, window.ending, window.state.job = None, None, None
    await (then if job.state == DONE else left)(window)
    if job.state == FAILED:
        window.state.failure = f"{WORDS[job.kind]} failed: {job.error}"
    if job.state == CANCELLED:
        window.state.ready = {"text": f"{WORDS[job.kind]} was cancelled; {job.said or 'nothing has changed'}.", "links": []}
    window.state.flush()


def _tell(window: WindowState, job: Job) -> None:
    text = f"{WORDS[job.kind]}: {job.what}"
    window.state.job = None if job.ended else line(text, job.share, job.seconds, job.step_began, cancellable=True)
    window.state.flush()


TELLING = 0.05
"""Share of the work from which the time that is left is told."""

HALF_A_MINUTE = 90.0
"""[s] from which it is told in minutes."""


def line(text: str, share: float, seconds: float, step_began: float, *, cancellable: bool) -> dict[str, Any]:
    """How far work is: the `share` of its step that is done, and how long the rest of that takes at the same pace.

    Parameters
    ----------
    seconds, step_began : [s] since the work began, and when its step did
    """
    share = min(max(share, 0.0), 1.0)
    left = (seconds - step_began) * (1 - share) / share if share >= TELLING else None
    known = "" if left is None else f", about {left:.0f} s left" if left < HALF_A_MINUTE else f", about {left / 60:.1f} min left"
    words = f"{round(100 * share)} %{known}, {seconds:.0f} s so far"
    return {"text": text, "percent": round(100 * share), "words": words, "cancellable": cancellable}


# What of the page the next reload finds again.


OF_CURVES = ("campaign", "load", "motion", "drive", "response", "showing", "pair", "marked")
KEPT = (*OF_CURVES, "map_kind", "run", "tab", "scheme", "mode", "part")
"""State of the page, by name."""

SWITCHED = "switches.json"
"""The file of the cache with how curves were shown last, in any window."""


def keep_switches(how: Mapping[str, Any]) -> None:
    """Keep how curves are shown for windows to come; where there is no cache they begin as ever."""
    place = cache.folder()
    with suppress(OSError):
        if place is not None:
            (place / PLACE).mkdir(parents=True, exist_ok=True)
            write_text(place / PLACE / SWITCHED, json_text(dict(how)))


def kept_switches() -> dict[str, Any]:
    """How curves were shown last; empty where nobody changed anything, or the file is damaged."""
    place = cache.folder()
    with suppress(OSError, ValueError):
        found = json.loads((place / PLACE / SWITCHED).read_text(encoding="utf-8")) if place is not None else {}
        return found if isinstance(found, dict) else {}
    return {}


def keep(window: WindowState) -> None:
    """Keep it in the session."""
    if window.session is not None:
        if window.state.effect is None:
            chosen: str | None = None
        else:
            known = window.effects.get(window.state.effect["id"])
            chosen = window.wanted if known is None else known.written(window.sizes)
        window.session.keep_view({**{key: window.state[key] for key in KEPT}, "effect": chosen})


def kept(window: WindowState) -> str | None:
    """Put back what was kept; the effect that was chosen, with its size, comes back to be chosen again."""
    if window.session is None:
        return None
    found = window.session.view()
    window.state.update({key: found[key] for key in KEPT if key in found})
    effect = found.get("effect")
    return effect if isinstance(effect, str) else None


# What is kept of a window's work when the workbench ends and nobody has saved it: models with the rungs added to them.


SAVED = "rungs.saved"
"""The file of a session that says how many rungs were there when its model was opened, or downloaded last."""

PLACE = "workbench"
"""Folder of the cache."""


def saved(of: Session) -> None:
    """All rungs are in the user's hands: the model was opened just now, or downloaded."""
    (of.folder / SAVED).write_text(str(_rungs(of.folder)), encoding="utf-8")


def leaving_kept(home: Path, say: Callable[[str], None]) -> None:
    """Copy what is unsaved in the windows below `home` to the user's cache, and `say` where it is."""
    for folder in sorted(home.glob("*/desk-*")):
        if is_session(folder) and unsaved(folder):
            try:
                say(f"A model with effects added was not saved; it is kept in\n  {_copied(folder)}")
            except (BadInput, OSError) as error:
                say(f"A model with effects added was not saved, and cannot be kept: {error}")


def unsaved(folder: Path) -> bool:
    """Whether effects were added in the session of `folder` since."""
    try:
        known = int((folder / SAVED).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        known = 0
    return _rungs(folder) > max(known, 1)  # the first one is the model as it was opened


def _rungs(folder: Path) -> int:
    try:
        return len(history.read(history.path_beside(opened(folder).model)).rungs)
    except (OSError, BadInput):
        return 0


def _copied(folder: Path) -> Path:
    """The model with its ladder, files that were dropped, and a report, in a new folder of the cache.

    Raises
    ------
    BadInput : there is no cache, or the model cannot be read.
    OSError : it cannot be written there.
    """
    place = cache.folder()
    if place is None:
        raise BadInput("workbench", "", "there is no folder for a cache", "Set MASSLINE_CACHE")
    name = f"{folder.parent.name}-{folder.name}"
    to = next(
        one for one in (place / PLACE / f"{name}{end}" for end in chain([""], (f"-{k}" for k in count(1)))) if not one.exists()
    )
    for one in (*folder.parent.glob("drop-*"), folder / "saved"):
        if one.is_dir():
            shutil.copytree(one, to / one.name, dirs_exist_ok=True)
    model = opened(folder).model
    copied(model, to / model.name)
    return to / model.name
