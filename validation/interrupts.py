"""Ctrl-C while libraries are being imported: heard at once, acted upon when the import is done.

An exception out of nowhere is more than the initialisation of a compiled library survives: it fails half-way, or takes the
process with it. Between imports an interruption is what it always is, a KeyboardInterrupt.
"""

from __future__ import annotations

import _thread
import signal
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

PATIENCE = 0.05
"""Seconds between two looks at whether the import is done."""

_IMPORTING = "<frozen importlib"

_listening = threading.Event()


@contextmanager
def held_while_importing() -> Iterator[None]:
    """Inside the block, SIGINT raises KeyboardInterrupt as always, but never inside an import.

    Does nothing outside the main thread, which alone hears signals, and where somebody else listens to SIGINT already.
    """
    listening = threading.current_thread() is threading.main_thread()
    if not listening or signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
        yield
        return
    signal.signal(signal.SIGINT, _heard)
    _listening.set()
    try:
        yield
    finally:
        _listening.clear()
        signal.signal(signal.SIGINT, signal.default_int_handler)


def _heard(number: int, frame: FrameType | None) -> None:
    if not _importing(frame):
        signal.default_int_handler(number, frame)
    _thread.start_new_thread(_again, ())  # takes no lock, unlike threading.Timer, so it may start anywhere


def _importing(frame: FrameType | None) -> bool:
    while frame is not None:
        if frame.f_code.co_filename.startswith(_IMPORTING):
            return True
        frame = frame.f_back
    return False


def _again() -> None:
    time.sleep(PATIENCE)
    if not _listening.is_set():  # and not whether the handler is this one: what runs inside may have put its own around it
        return  # the command has ended meanwhile, and there is nothing to interrupt
    if sys.platform == "win32":
        _thread.interrupt_main()
    else:
        signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGINT)  # ends a wait in the main thread as well
