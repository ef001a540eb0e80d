"""Which part a point of a model belongs to. Beams' nodes lie on axes, not in material: primitives are asked without voids."""

from __future__ import annotations

import re

import numpy as np

from geometry.arrays import Array, Integers
from geometry.article import Article, Part
from geometry.shapes import Box, Placed

_LAYER = re.compile(r"-(?:bottom|silicone|top)$")
"""Bodies of a sandwich, which move as one blade."""


def family(part: str) -> str:
    """The name under which a part is spoken of: the layers of a sandwich are one blade."""
    return _LAYER.sub("", part)


def distance(part: Part, points: Array) -> Array:
    """How far `points` (n, 3) [m] lie outside the solids of `part`, voids filled; (n,) [m], 0 inside."""
    own = part.pose.inverse.apply(points)
    return np.asarray(np.min([_outside(placed, own) for placed in part.shape.solids], axis=0))


def nearest_part(article: Article, points: Array) -> Integers:
    """Index (n,) of the counted part that each of `points` (n, 3) [m] lies in or next to, the smallest of several."""
    parts = article.counted_parts
    by_size = sorted(range(len(parts)), key=lambda k: sum(placed.primitive.volume for placed in parts[k].shape.solids))
    # Rounded, so that the surfaces of two parts in contact are equally near and the smaller part comes first.
    distances = np.array([np.round(distance(parts[k], points), 7) for k in by_size])
    return np.asarray(np.take(by_size, np.argmin(distances, axis=0)), dtype=np.intp)


def _outside(placed: Placed, points: Array) -> Array:
    own = placed.pose.inverse.apply(points)
    primitive = placed.primitive
    if isinstance(primitive, Box):
        beyond = np.maximum(np.abs(own) - np.asarray(primitive.size) / 2, 0)
        return np.asarray(np.linalg.norm(beyond, axis=1))
    radial = np.maximum(np.hypot(own[:, 0], own[:, 1]) - primitive.diameter / 2, 0)
    return np.asarray(np.hypot(radial, np.maximum(np.abs(own[:, 2]) - primitive.height / 2, 0)))
