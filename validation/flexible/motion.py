"""How any point of an article moves in the modes of its model: on beams with their section, in solids with the nodes around it.

A beam's section stays plane and rigid, so a point moves as its foot on the axis does, plus the rotation there crossed with its
arm; between nodes the axis follows a cubic whose slopes are the rotations, as in the elements (Przemieniecki, chapter 5).
"""

from __future__ import annotations

import numpy as np

from fem.structure import Structure
from geometry.arrays import Array, Integers
from geometry.article import Article, Part
from geometry.shapes import Box
from validation.flexible.places import distance

NEIGHBOURS = 4
"""Nodes of a solid model whose motions are averaged, weighted with the inverse square of their distances."""

ON_THE_AXIS = 5e-3
"""Nodes farther from a part's axis than this share of its length belong to something that is fastened to it."""


BEYOND_THE_ENDS = 0.05
"""Nodes so far beyond the ends of a part, as a share of its length, still lead it: a mast is held by the node of its flange."""


def displacement(structure: Structure, shapes: Array, article: Article | None, points: Array, parts: Integers) -> Array:
    """Displacement (n, 3, m) of `points` (n, 3) [m] in `shapes` (N, m); `parts` (n,) are their counted parts of `article`."""
    if article is None or not has_rotations(structure):
        return _among_nodes(structure, shapes, points)
    moved = np.empty((len(points), 3, shapes.shape[1]))
    for number in np.unique(parts):
        there = parts == number
        moved[there] = _with_section(structure, shapes, article.counted_parts[number], points[there])
    return moved


def has_rotations(structure: Structure) -> bool:
    """Whether every point turns as well as moves, its rotations following its translations."""
    after = structure.translations + 3
    if not after.size or after.max() >= structure.rigid.shape[0]:
        return False
    turns = structure.rigid[after]
    return bool(np.allclose(turns, np.hstack([np.zeros((3, 3)), np.eye(3)])))


def node_displacement(structure: Structure, shapes: Array) -> Array:
    """Displacement (p, 3, m) of the structure's own points in `shapes` (N, m)."""
    return np.asarray(shapes[structure.translations])


def _among_nodes(structure: Structure, shapes: Array, points: Array) -> Array:
    from scipy.spatial import cKDTree

    apart, nodes = cKDTree(structure.points).query(points, k=min(NEIGHBOURS, len(structure.points)))
    apart, nodes = np.reshape(apart, (len(points), -1)), np.reshape(nodes, (len(points), -1))
    weights = 1 / np.maximum(apart, 1e-9) ** 2
    weights /= weights.sum(axis=1, keepdims=True)
    return np.asarray(np.einsum("pk,pkim->pim", weights, node_displacement(structure, shapes)[nodes]))


def _with_section(structure: Structure, shapes: Array, part: Part, points: Array) -> Array:
    """Motion (n, 3, m) of `points` of one part with the sections of its axis, or with the nearest node where it has none."""
    origin, axis, length = _axis(part)
    arms = structure.points - origin
    along = arms @ axis
    beside = np.linalg.norm(arms - np.outer(along, axis), axis=1)
    near = (beside <= ON_THE_AXIS * length) & (distance(part, structure.points) <= BEYOND_THE_ENDS * length)
    nodes = np.flatnonzero(near)
    if len(nodes) == 0:
        nodes = np.array([np.argmin(np.linalg.norm(structure.points - points.mean(axis=0), axis=1))])
    s, first = np.unique(np.round(along[nodes], 9), return_index=True)
    nodes = nodes[first]
    place = np.clip((points - origin) @ axis, s[0], s[-1])
    moved, turned = _on_axis(shapes, structure.translations[nodes], s, place, axis)
    feet = structure.points[nodes[0]] + np.outer(place - s[0], axis)
    return moved + np.cross(turned, (points - feet)[:, :, None], axis=1)


def _on_axis(shapes: Array, translations: Integers, s: Array, place: Array, axis: Array) -> tuple[Array, Array]:
    """Displacement and rotation (n, 3, m) at `place` (n,) along an axis whose nodes lie at `s`."""
    from scipy.interpolate import CubicHermiteSpline

    u, turn = shapes[translations], shapes[translations + 3]
    if len(s) == 1:
        return np.repeat(u, len(place), axis=0), np.repeat(turn, len(place), axis=0)
    stretch = np.gradient(np.einsum("pim,i->pm", u, axis), s, axis=0)
    e = axis[None, :, None]
    slopes = np.cross(turn, e, axis=1) + stretch[:, None, :] * e
    k = np.clip(np.searchsorted(s, place, side="right") - 1, 0, len(s) - 2)
    share = ((place - s[k]) / (s[k + 1] - s[k]))[:, None, None]
    return np.asarray(CubicHermiteSpline(s, u, slopes)(place)), (1 - share) * turn[k] + share * turn[k + 1]


def _axis(part: Part) -> tuple[Array, Array, float]:
    """A point of the part's axis [m], its direction, and the part's length along it [m]: of the largest solid."""
    largest = max(part.shape.solids, key=lambda placed: placed.primitive.volume)
    pose, primitive = part.pose @ largest.pose, largest.primitive
    if isinstance(primitive, Box):
        k = int(np.argmax(primitive.size))
        return pose.position, pose.rotation[:, k], float(primitive.size[k])
    return pose.position, pose.rotation[:, 2], primitive.height
