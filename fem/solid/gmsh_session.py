"""One silent gmsh at a time, always put away again.

gmsh is a single set of global variables. Its own handling of Ctrl-C ends the whole process and works in the main thread only,
so it is switched off: an interruption is raised by Python as soon as gmsh returns.
"""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

_ALONE = threading.Lock()


@contextmanager
def session() -> Iterator[Any]:
    """The `gmsh` module, initialised with an empty model and nothing on the terminal; finalised at the end of the block.

    Raises
    ------
    RuntimeError : the host program has a gmsh of its own open, which would be overwritten.
    """
    import gmsh

    with _ALONE:
        if gmsh.isInitialized():
            raise RuntimeError("gmsh is in use by the calling program; call gmsh.finalize() before massline makes a mesh")
        gmsh.initialize(argv=[], readConfigFiles=False, interruptible=False)
        try:
            gmsh.option.setNumber("General.Terminal", 0)
            gmsh.option.setNumber("General.NumThreads", 1)
            yield gmsh
        finally:
            gmsh.finalize()
