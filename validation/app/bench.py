"""What one window holds while it is open: the desk, what was computed for it, and the threads in which anything slow happens.

Everything of worth lies in the desk's folder; a window that was closed and is opened again by its address takes it up from
there.
"""

from __future__ import annotations

import asyncio
import sys
import traceback
from collections.abc import Awaitable, Callable, Coroutine
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

from geometry.errors import BadInput, CheckFailed
from validation.app.asked import Opened

if TYPE_CHECKING:
    from validation.desk.comparing import Compared
    from validation.desk.desk import Desk
    from validation.desk.jobs import Job, Worker
    from validation.desk.sliders import Effect
    from validation.desk.whatif import Table, WhatIf
    from validation.pictures.turntable import Turntable

P = ParamSpec("P")
T = TypeVar("T")


@dataclass(kw_only=True)
class Bench:
    """A window.

    Attributes
    ----------
    state : what the page shows, trame's
    folder : of this window; desks lie in it
    opened : what the command line asked to begin with
    desk : what is worked on, None before something is open
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
    """

    state: Any
    folder: Path
    opened: Opened
    desk: Desk | None = None
    compared: Compared | None = None
    table: Table | None = None
    effects: dict[str, Effect] = field(default_factory=dict)
    worker: Worker | None = None
    ending: asyncio.Future[Job] | None = None
    turntable: Turntable | None = None
    sizes: dict[str, float] = field(default_factory=dict)
    wanted: str | None = None
    tried: WhatIf | None = None
    exact: bool = True
    drags: int = 0
    views: int = 0
    dragging: asyncio.Task[None] | None = None
    tasks: set[asyncio.Task[None]] = field(default_factory=set)
    # One thread each: a desk computes one thing at a time, and OpenGL wants to be spoken to by one thread only.
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
