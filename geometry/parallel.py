"""The same work on many things at a time, by processes of this machine or of others: the one door to Dask's `distributed`."""

import inspect
import logging
import platform
import signal
import sys
import threading
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from tempfile import TemporaryDirectory
from types import ModuleType
from typing import Any, Generic, TypeVar

from geometry import cache
from geometry.errors import BadInput

Task = TypeVar("Task")
Result = TypeVar("Result")

CONNECTING = "20s"
"""How long a scheduler has to answer, as Dask writes times."""

SETTINGS = {
    "distributed.admin.large-graph-warning-threshold": "1TB",  # a study in memory travels with its records
    "distributed.scheduler.worker-ttl": None,  # a factorisation may hold the interpreter for minutes
    "distributed.scheduler.worker-saturation": 1.0,  # a process has one task: of what it dies no other that waits there is blamed
    "distributed.worker.profile.enabled": False,
    "distributed.nanny.pre-spawn-environ.MALLOC_TRIM_THRESHOLD_": None,  # else a third of the time goes into giving memory back
}
"""Of Dask, for processes that are started here. Its defaults give each one BLAS thread, so that digits do not depend on it."""


@dataclass(frozen=True)
class SameCode(Generic[Task, Result]):
    """The function `work` where the code is that of whoever asks; `made_by` is its digest."""

    work: Callable[[Task], Result]
    made_by: str

    @staticmethod
    def of(work: Callable[..., Any]) -> str:
        """Digest of the code that answers: massline's, and the file of `work`."""
        return cache.code() + cache.content([inspect.getfile(work)])

    def __call__(self, one: Task) -> Result:
        if self.of(self.work) != self.made_by:
            problem = f"the worker on {platform.node()} has another version of massline's code"
            raise BadInput("--scheduler", "", problem, "Install the same on all machines, and start their workers anew")
        return self.work(one)


class WorkerLost(RuntimeError):
    """A task whose process died each time that it was tried."""


def finished(
    work: Callable[[Task], Result], tasks: Iterable[Task], *, processes: int = 0, scheduler: str = ""
) -> Iterator[tuple[Task, Result | WorkerLost]]:
    """Each of `tasks` with what `work` makes of it, as they are finished; `WorkerLost` where its process died every time.

    Answers are those of a plain loop, bit for bit: the same function of the same thing, in the same code, by one thread. A
    process that dies takes nothing with it that was handed out before, and another does what it was doing. Whoever stops early
    (an interruption, an exception) ends what was begun; keeping what was handed out is for the caller.

    Parameters
    ----------
    work : a function of a module, found under its name by every process
    processes : of this machine; 0 for one a core. One works in the process that asks
    scheduler : address of a Dask scheduler whose workers do it instead; empty for none

    Raises
    ------
    BadInput : no scheduler answers there, or its workers have other code.
    Exception : whatever `work` raises.
    """
    from joblib import cpu_count

    listed = list(tasks)
    processes = min(processes or cpu_count(), len(listed))
    if not scheduler and processes <= 1:
        for one in listed:
            yield one, work(one)
        return
    if not listed:
        return
    from distributed import KilledWorker, as_completed

    with _client(scheduler, processes) as client:
        checked = SameCode(work, SameCode.of(work))
        futures = {client.submit(checked, one, pure=False): one for one in listed}
        try:
            for future in as_completed(list(futures), loop=client.loop, raise_errors=False):
                one, error = futures.pop(future), future.exception()
                if isinstance(error, KilledWorker):
                    yield one, WorkerLost(f"its process died {error.allowed_failures + 1} times")
                elif error is not None:
                    raise error
                else:
                    yield one, future.result()
                future.release()
        finally:
            client.cancel(list(futures))


@contextmanager
def _client(scheduler: str, processes: int) -> Iterator[Any]:
    """Dask's client of the `scheduler`, or of so many `processes` here, to which nobody else can send work."""
    import dask
    from distributed import Client, LocalCluster, WorkerPlugin

    class Child(WorkerPlugin):  # type: ignore[misc]
        """Ctrl-C is for the process that asks, which ends its workers; these end what their tasks had started."""

        def setup(self, worker: Any) -> None:
            if threading.current_thread() is threading.main_thread():
                signal.signal(signal.SIGINT, signal.SIG_IGN)

        def teardown(self, worker: Any) -> None:
            import psutil

            for child in psutil.Process().children(recursive=True):
                child.terminate()

    with ExitStack() as stack:
        if scheduler:
            try:
                client = Client(scheduler, timeout=CONNECTING, set_as_default=False)
            except (OSError, ValueError) as error:
                remedy = "Start one with `dask scheduler`, and workers with `dask worker ADDRESS`; name it as tcp://HOST:8786"
                raise BadInput("--scheduler", scheduler, f"no Dask scheduler answers there ({error})", remedy) from None
            yield stack.enter_context(client)
            return
        stack.enter_context(dask.config.set(SETTINGS))
        # What is sent stands in modules: a process that began with the script of whoever asks would run it once more
        stack.callback(sys.modules.__setitem__, "__main__", sys.modules["__main__"])
        sys.modules["__main__"] = ModuleType("__main__")
        folder = stack.enter_context(TemporaryDirectory(prefix="massline-workers-"))
        cluster = LocalCluster(
            n_workers=processes,
            threads_per_worker=1,
            host="127.0.0.1",
            security=True,  # nobody else of this machine may send work
            memory_limit=None,
            dashboard_address=None,
            local_directory=folder,
            silence_logs=logging.CRITICAL,
        )
        stack.enter_context(cluster)
        client = stack.enter_context(Client(cluster, set_as_default=False))
        client.register_plugin(Child())
        yield client
