"""Ctrl-C while exudyn integrates: kept until exudyn has stopped, and then raised.

Exudyn looks for signals in the middle of a step. An exception that it finds there stays set while it calls back, and the first
thing that Python does in the callback then fails with a SystemError that nobody meant. So nothing is raised while it runs: what
the handler of SIGINT raises is kept, and the next callback ends the run.
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

BeforeStep = Callable[[Any, float], bool]
"""Exudyn's callback before every step, with the system and the time [s] at its end; False ends the run."""


class Kept:
    """What was raised meanwhile, if anything."""

    reason: BaseException | None = None


@contextmanager
def kept() -> Iterator[Kept]:
    """Inside the block, what the handler of SIGINT raises is kept; it is raised at the end of the block, whatever else happened.

    Does nothing outside the main thread, which alone hears signals, and where no Python function listens to SIGINT.

    Raises
    ------
    BaseException : what the handler raised, KeyboardInterrupt as a rule.
    """
    found, before = Kept(), signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or not callable(before):
        yield found
        return
    handler: Callable[[int, FrameType | None], Any] = before

    def keep(number: int, frame: FrameType | None) -> None:
        try:
            handler(number, frame)
        except BaseException as reason:
            found.reason = reason

    signal.signal(signal.SIGINT, keep)
    try:
        yield found
    finally:
        signal.signal(signal.SIGINT, handler)
        if found.reason is not None:
            raise found.reason from None


def integrated(system: Any, settings: Any, before_step: BeforeStep | None = None) -> bool:
    """Whether exudyn integrated `system` to the end of `settings`; `before_step` and Ctrl-C may stop it.

    Raises
    ------
    KeyboardInterrupt : Ctrl-C, once exudyn has stopped.
    Exception : exudyn gave up; it raises errors of several kinds.
    """
    with kept() as interruption:

        def ask(system: Any, time: float) -> bool:
            return interruption.reason is None and (before_step is None or before_step(system, time))

        system.SetPreStepUserFunction(ask)
        return bool(system.SolveDynamic(settings))


def is_interruption(error: BaseException | None) -> bool:
    """Whether `error` is what exudyn made of a Ctrl-C: it has a KeyboardInterrupt behind it, or its name in the text."""
    while error is not None:
        if isinstance(error, KeyboardInterrupt) or "KeyboardInterrupt" in str(error):
            return True
        error = error.__cause__ or error.__context__
    return False
