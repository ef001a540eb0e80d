"""A process that does not outlive the one that started it.

Two ends are watched. The starter holds the other end of standard input: when it closes, by a clean end or by a crash, this
process ends its whole group, workers included. And where the system knows it (Linux), the kernel itself ends this process
with the thread that started it. No process is left even when the starter was killed in the middle of a computation.
"""

from __future__ import annotations

import ctypes
import os
import signal
import sys
import threading

PR_SET_PDEATHSIG = 1
"""`prctl(2)`: the signal that this process gets when its parent dies."""


def tied() -> None:
    """Tie this process, the leader of its group, to the one that holds the other end of its standard input."""
    if sys.platform == "linux":
        ctypes.CDLL(None, use_errno=True).prctl(PR_SET_PDEATHSIG, signal.SIGTERM)
    signal.signal(signal.SIGTERM, lambda *_: end_group())
    threading.Thread(target=_wait_for_the_end, name="lifeline", daemon=True).start()


def end_group() -> None:
    """End this process and all that it started, at once; what the desk keeps is on disk already."""
    os.killpg(os.getpgrp(), signal.SIGKILL)


def _wait_for_the_end() -> None:
    # An unbuffered read of its own: the buffered one of `sys.stdin` would hold a lock when the interpreter ends.
    while os.read(0, 4096):
        pass
    end_group()
