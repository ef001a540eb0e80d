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


def start(bench: Bench, kind: str, then: Callable[[Bench], Awaitable[None]], **asked: Any) -> None:
    """Let a worker begin; `then` follows when it is done. While one works no other begins."""
    if bench.desk is None or bench.worker is not None:
        return
    bench.state.failure, bench.state.ready = "", None
    bench.worker = jobs.start(bench.desk, kind, **asked)
    _tell(bench, bench.worker.job())
    bench.begin(_watched(bench, then))


async def cancel(bench: Bench) -> None:
    """End the worker now."""
    if bench.worker is not None:
        await asyncio.to_thread(bench.worker.cancel)


def teller(bench: Bench, words: str) -> Callable[[str, float], None]:
    """What work in a thread calls to say how far it is."""
    loop, began = asyncio.get_running_loop(), time.monotonic()

    def show(what: str, share: float) -> None:
        bench.state.job = _line(f"{words}: {what}", share, time.monotonic() - began)
        bench.state.flush()

    show("...", 0.0)
    return lambda what, share: None if loop.is_closed() else (loop.call_soon_threadsafe(show, what, share), None)[1]


async def _watched(bench: Bench, then: Callable[[Bench], Awaitable[None]]) -> None:
    worker = bench.worker
    if worker is None:
        return
    job = worker.job()
    while not job.ended:
        await asyncio.sleep(PACE)
        job = worker.job()
        _tell(bench, job)
    bench.worker, bench.state.job = None, None
    if job.state == FAILED:
        bench.state.failure = f"{WORDS[job.kind]} failed: {job.error}"
    if job.state == CANCELLED:
        bench.state.ready = {"text": f"{WORDS[job.kind]} was cancelled; nothing has changed.", "links": []}
    if job.state == DONE:
        await then(bench)
    bench.state.flush()


def _tell(bench: Bench, job: Job) -> None:
    bench.state.job = None if job.ended else _line(f"{WORDS[job.kind]}: {job.what}", job.share, job.seconds)
    bench.state.flush()


def _line(text: str, share: float, seconds: float) -> dict[str, Any]:
    return {"text": text, "percent": round(100 * min(max(share, 0.0), 1.0)), "seconds": round(seconds)}
