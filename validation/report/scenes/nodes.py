"""The nodes of a user's own mesh, coloured by what the data say of something that may sit there."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fem.mesh.places import Elements
from fem.structure import Structure
from geometry.frames import Array, Integers
from validation.diagnose.everywhere import MASS, RESONATOR, NodeScores
from validation.report.scenes.motion import DrawnMode, MovingBody, mode_sheet

WORDS = {
    MASS: "a mass",
    "cable:x": "a spring to the ground along x",
    "cable:y": "a spring to the ground along y",
    "cable:z": "a spring to the ground along z",
    RESONATOR: "a resonator",
}
"""What is looked for, in words."""

MEANS = "evidence over that of the best node"

NOTE = "Each node as if it alone were looked at. Grey: explains nothing."

THIN, SMALL = 0.004, 0.009
"""[share] of the structure's size: of the stick that stands for a beam, and of the mark of a node without elements."""

LEAST = 1.0
"""[nats] below which there is nothing to be coloured."""

_MARK = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], dtype=np.float64)
_SIDES = [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)]


@dataclass(frozen=True, eq=False, kw_only=True)
class Outline:
    """A structure as it is drawn: the skin of its elements and a stick a beam, or a mark a node where no elements are known.

    Attributes
    ----------
    vertices : (v, 3) [m]
    faces : (f, 3)
    owner : (v,) of the nodes that it was made with, the one that a vertex goes with; -1 for none
    """

    vertices: Array
    faces: Integers
    owner: Integers

    @classmethod
    def of(cls, structure: Structure, nodes: Array) -> "Outline":
        """`structure`, of which `nodes` (p, 3) [m] move."""
        elements = structure.elements
        if not isinstance(elements, Elements):
            vertices, faces = marks(nodes, SMALL * float(np.ptp(nodes, axis=0).max()))
            return cls(vertices=vertices, faces=faces, owner=np.repeat(np.arange(len(nodes)), 6))
        from scipy.spatial import cKDTree

        away, nearest = cKDTree(nodes).query(elements.points)
        size = float(np.ptp(elements.points, axis=0).max())
        owner = np.where(away < 1e-9 * size, nearest, -1)
        triangles, lines = elements.skin()
        along = elements.points[lines[:, 1]] - elements.points[lines[:, 0]]
        across = np.cross(
            along, np.where(np.abs(along[:, [0]]) < np.abs(along).max(axis=1, keepdims=True), [1.0, 0, 0], [0, 1.0, 0])
        )
        across *= THIN * size / np.maximum(np.linalg.norm(across, axis=1, keepdims=True), np.finfo(np.float64).tiny)
        other = np.cross(along, across) / np.maximum(np.linalg.norm(along, axis=1, keepdims=True), np.finfo(np.float64).tiny)
        corners = [across, -0.5 * across + 0.87 * other, -0.5 * across - 0.87 * other]
        sticks = np.stack([elements.points[lines[:, end]] + each for end in (0, 1) for each in corners], axis=1)
        own = [(0, 1, 4), (0, 4, 3), (1, 2, 5), (1, 5, 4), (2, 0, 3), (2, 3, 5)]
        begin = len(elements.points) + 6 * np.arange(len(lines))[:, None, None]
        return cls(
            vertices=np.vstack([elements.points, sticks.reshape(-1, 3)]),
            faces=np.vstack([triangles, (begin + np.array(own)).reshape(-1, 3)]).astype(np.int64),
            owner=np.concatenate([owner, np.repeat(owner[lines], 3, axis=1).ravel()]),
        )

    def carried(self, of_nodes: Array) -> Array:
        """(v, ...) what every vertex has of what the nodes have (p, ...); nothing where it goes with none."""
        known = self.owner.reshape(-1, *(1,) * (of_nodes.ndim - 1)) >= 0
        return np.asarray(np.where(known, of_nodes[np.maximum(self.owner, 0)], 0.0))

    def moving(self, name: str, of_nodes: Array) -> MovingBody:
        """With the displacement (p, 3) of its nodes, in any scale."""
        edges = np.zeros((0, 2), dtype=np.int64)
        moved = self.carried(of_nodes)
        return MovingBody(name=name, vertices=self.vertices, faces=self.faces, edges=edges, displacement=moved)


def marks(points: Array, size: float) -> tuple[Array, Integers]:
    """Vertices (6 p, 3) and faces of octahedra of `size` [m] at `points` (p, 3) [m]."""
    faces = (6 * np.arange(len(points))[:, None, None] + np.array(_SIDES)).reshape(-1, 3)
    return (points[:, None] + size * _MARK).reshape(-1, 3), faces.astype(np.int64)


def body_of(scores: NodeScores, kind: str) -> MovingBody:
    """The structure as it is drawn, its colours those of the evidence for `kind`; nodes that nothing moves have none."""
    evidence = np.maximum(scores.evidence[kind], 0.0)
    shown = evidence[:, None] * np.array([1.0, 0.0, 0.0])
    return Outline.of(scores.structure, scores.points).moving(scores.article, shown)


def draw_nodes(found: Sequence[NodeScores], path: Path) -> Path | None:
    """Write what the data say of every node of the structures `found`, a picture each kind; none where nothing explains anything.

    Raises
    ------
    CheckFailed : nothing can be rendered on this machine.
    """
    tiles: list[DrawnMode] = []
    for scores in found:
        for kind, evidence in scores.evidence.items():
            best = int(np.argmax(evidence))
            if evidence[best] < LEAST:
                continue
            x, y, z = 1e3 * scores.points[best]
            text = f"{evidence[best]:.1f} nats at ({x:.4g}, {y:.4g}, {z:.4g}) mm"
            heading = WORDS[kind] if len(found) == 1 else f"{scores.article}: {WORDS[kind]}"
            tiles.append(
                DrawnMode(number=len(tiles) + 1, frequency=0.0, text=text, bodies=(body_of(scores, kind),), heading=heading)
            )
    if not tiles:
        return None
    mode_sheet("Everywhere on the mesh", tiles, path, NOTE, swing=0.0, means=MEANS)
    return path
