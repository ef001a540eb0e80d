"""What is seen of a mesh: faces of solids that no other shares, shells, and beams as lines, by the numbers of their nodes."""

import numpy as np

from fem.mesh import shells, solids
from fem.mesh.places import LINE, Elements
from geometry.frames import Integers

QUARTERS = {
    "tet": ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)),
    "wedge": ((0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)),
    "hex": ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)),
}
"""Corners of the faces of a solid element, by its shape."""


def skin(elements: Elements) -> tuple[Integers, Integers]:
    """Triangles (t, 3) and lines (l, 2) by the indices of their nodes; of an element with nodes along its edges the corners."""
    faces: dict[int, list[Integers]] = {3: [], 4: []}
    triangles, lines = [np.zeros((0, 3), dtype=np.int64)], [np.zeros((0, 2), dtype=np.int64)]
    for block in elements.blocks:
        if block.kind in solids.KINDS:
            for corners in QUARTERS[solids.shape(block.kind)]:
                faces[len(corners)].append(block.nodes[:, list(corners)])
        elif block.kind == LINE:
            lines.append(block.nodes)
        else:  # the triangles of a quadrangle are there twice, once by either diagonal
            own = shells.TRIANGLES[block.kind]
            count = round(sum(weight for _, weight in own))
            triangles += [block.nodes[:, list(corners)] for corners, _ in own[:count]]
    for found in faces.values():
        if found:
            every = np.vstack(found)
            _, first, times = np.unique(np.sort(every, axis=1), axis=0, return_index=True, return_counts=True)
            outer = every[first[times == 1]]
            triangles.append(outer[:, :3])
            if outer.shape[1] == 4:
                triangles.append(outer[:, [0, 2, 3]])
    return np.vstack(triangles), np.vstack(lines)
