"""`SolidMesh`: curved second-order cells with their part, whoever made them.

Tetrahedra have 10 nodes and hexahedra 27, both in scikit-fem's local order: vertices, edges, faces, interior. `LOCAL_TET10` and
`LOCAL_HEX27` say where in the reference cell each of them sits, so that a mesher can find its own order in them.
"""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np

from geometry.frames import Array, Integers, frozen

_VERTICES = ([0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1])
_EDGES = ([1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [0, 1, 1])
LOCAL_TET10 = frozen(np.vstack([_VERTICES, np.array(_EDGES) / 2]), (10, 3), "LOCAL_TET10")
"""Places of the nodes in the reference tetrahedron (10, 3)."""

_HEX = (
    "222 221 212 122 211 121 112 111 "  # 1 and 2 are the low and the high end, 0 the middle, of x, y and z
    "220 202 022 201 021 210 012 120 102 011 101 110 "
    "200 002 020 010 001 100 000"
)
_END = {"1": 0.0, "2": 1.0, "0": 0.5}
LOCAL_HEX27 = frozen([[_END[place] for place in node] for node in _HEX.split()], (27, 3), "LOCAL_HEX27")
"""Places of the nodes in the reference hexahedron (27, 3)."""

NODES_OF_A_CELL = (10, 27)


@dataclass(frozen=True, eq=False, kw_only=True)
class SolidMesh:
    """Cells of second order, conforming.

    Attributes
    ----------
    points : (p, 3) [m], in the article's frame; every one belongs to a cell
    cells : (c, 10) tetrahedra or (c, 27) hexahedra, indices into `points`
    part : (c,) index into `parts`
    parts : names of the parts
    """

    points: Array
    cells: Integers
    part: Integers
    parts: tuple[str, ...]

    def __post_init__(self) -> None:
        object.__setattr__(self, "points", frozen(self.points, (len(self.points), 3), "points"))
        if self.cells.shape[1] not in NODES_OF_A_CELL:
            raise ValueError(f"`cells` must have {' or '.join(map(str, NODES_OF_A_CELL))} nodes, found {self.cells.shape[1]}")
        if len(self.part) != len(self.cells):
            raise ValueError(f"`part` must name the part of every cell, found {len(self.part)} for {len(self.cells)} cells")


# One silent gmsh at a time, always put away again.
#
# gmsh is a single set of global variables. Its own handling of Ctrl-C ends the whole process and works in the main thread only,
# so it is switched off: an interruption is raised by Python as soon as gmsh returns.


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
