"""Labels that do not cover one another: each takes the first free place around its anchor."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array

STEPS = (1.0, 1.8, 2.8, 4.0, 6.0, 9.0)
"""Distances that are tried, in units of the label's own."""

TURNS = np.radians([0, 25, -25, 50, -50, 80, -80, 120, -120, 160, -160])
"""Directions that are tried, from the wished one."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Label:
    """A text with the place it belongs to.

    Attributes
    ----------
    text : what is written; may hold mathematics between dollar signs
    anchor : (2,) [pixel], what it names, from the upper left corner
    wish : (2,), the direction in which it would like to stand, of any length
    extent : width and height of the text [pixel]
    gap : least distance between anchor and the text's middle [pixel]
    """

    text: str
    anchor: Array
    wish: Array
    extent: tuple[float, float]
    gap: float
    colour: str


def arranged(labels: Sequence[Label], taken: Iterable[tuple[Array, tuple[float, float]]] = ()) -> list[Array]:
    """The middle (2,) [pixel] of every label; `taken` are middles and extents of what is there already."""
    boxes = list(taken)
    places = []
    for label in labels:
        place = _first_free(label, boxes)
        boxes.append((place, label.extent))
        places.append(place)
    return places


def _first_free(label: Label, boxes: list[tuple[Array, tuple[float, float]]]) -> Array:
    """The first candidate that covers nothing; the wished place when there is none."""
    candidates = [_candidate(label, step, turn) for step in STEPS for turn in TURNS]
    free = (place for place in candidates if not any(_cover(place, label.extent, *box) for box in boxes))
    return next(free, candidates[0])


def _candidate(label: Label, step: float, turn: float) -> Array:
    c, s = np.cos(turn), np.sin(turn)
    length = float(np.linalg.norm(label.wish))
    wish = label.wish / length if length > 0 else np.array([1.0, 0.0])
    direction = np.array([c * wish[0] - s * wish[1], s * wish[0] + c * wish[1]])
    reach = label.gap * step + np.abs(direction) @ np.array(label.extent) / 2
    return np.asarray(label.anchor + reach * direction)


def _cover(a: Array, size_a: tuple[float, float], b: Array, size_b: tuple[float, float]) -> bool:
    return bool(np.all(np.abs(a - b) < (np.array(size_a) + np.array(size_b)) / 2))
