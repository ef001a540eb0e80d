"""Long work on the page: a line that says what is done, how far it is, and a button that ends it."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Awaitable, Callable
from typing import Any

from validation.app.bench import Bench
from validation.desk import jobs
from validation.desk.jobs import CANCELLED, DONE, FAILED, Job

PACE = 0.15
"""Seconds between two looks at a worker."""

WORDS = {
    jobs.COMPARE: "Comparing",
    jobs.DIAGNOSE: "Diagnosing",
    jobs.ADD: "Adding",
    jobs.REPORT: "Writing the report",
}


Following = Callable[[Bench], Awaitable[None]]


async def unchanged(bench: Bench) -> None:
    """What a job that only adds to what is found leaves to be done when it is ended early."""


def start(bench: Bench, kind: str, then: Following, left: Following = unchanged, **asked: Any) -> None:
    """Let a worker begin; `then` follows when it is done. While one works no other begins.

    `left` follows when it was cancelled or failed, and brings the page to what is there.
    """
    if bench.desk is None or bench.worker is not None:
        return
    bench.state.failure, bench.state.ready = "", None
    bench.worker = jobs.start(bench.desk, kind, **asked)
    _tell(bench, bench.worker.job())
    bench.begin(_watched(bench, then, left))


async def cancel(bench: Bench) -> None:
    """End the worker now. Nobody looks at it while it dies: that would be told as a failure."""
    if bench.worker is not None and bench.ending is None:
        bench.ending = asyncio.ensure_future(asyncio.to_thread(bench.worker.cancel))


def teller(bench: Bench, words: str) -> Callable[[str, float], None]:
    """What work in a thread calls to say how far it is; a thread cannot be cancelled."""
    loop, began = asyncio.get_running_loop(), time.monotonic()

    def show(what: str, share: float) -> None:
        bench.state.job = _line(f"{words}: {what}", share, time.monotonic() - began, cancellable=False)
        bench.state.flush()

    show("...", 0.0)
    return lambda what, share: None if loop.is_closed() else (loop.call_soon_threadsafe(show, what, share), None)[1]


async def _watched(bench: Bench, then: Following, left: Following) -> None:
    worker = bench.worker
    if worker is None:
        return
    job = worker.job()
    while not job.ended:
        await asyncio.sleep(PACE)
        job = worker.job() if bench.ending is None else await bench.ending
        _tell(bench, job)
    bench.worker, bench.ending, bench.state.job = None, None, None
    await (then if job.state == DONE else left)(bench)
    if job.state == FAILED:
        bench.state.failure = f"{WORDS[job.kind]} failed: {job.error}"
    if job.state == CANCELLED:
        bench.state.ready = {"text": f"{WORDS[job.kind]} was cancelled; {job.said or 'nothing has changed'}.", "links": []}
    bench.state.flush()


def _tell(bench: Bench, job: Job) -> None:
    bench.state.job = None if job.ended else _line(f"{WORDS[job.kind]}: {job.what}", job.share, job.seconds, cancellable=True)
    bench.state.flush()


def _line(text: str, share: float, seconds: float, *, cancellable: bool) -> dict[str, Any]:
    percent = round(100 * min(max(share, 0.0), 1.0))
    return {"text": text, "percent": percent, "seconds": round(seconds), "cancellable": cancellable}
