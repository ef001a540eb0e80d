"""One process at a time changes a ladder: what it reads is what it writes on.

The lock is the operating system's, on the folder of the model, so that no file is left behind and a process that dies holds
nothing. Where folders cannot be locked (Windows, some network drives), the ladder is still read again right before it is written.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path


@contextmanager
def locked(path: Path) -> Iterator[None]:
    """Alone with the file `path` and what lies beside it, for a few milliseconds; others wait. Not to be asked for twice."""
    try:
        folder = os.open(path.resolve().parent, os.O_RDONLY)
    except OSError:  # a folder that cannot be opened is reported by whoever reads or writes in it
        yield
        return
    try:
        with suppress(ImportError, OSError):
            from fcntl import LOCK_EX, flock

            flock(folder, LOCK_EX)
        yield
    finally:
        os.close(folder)
