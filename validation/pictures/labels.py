"""Labels that do not cover one another: each takes the first free place around its anchor."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain, count

import numpy as np

from geometry.arrays import Array

STEPS = (1.0, 1.8, 2.8, 4.0, 6.0, 9.0)
"""Distances that are tried first, in units of the label's own; then ever farther ones, `FARTHER` apart."""

FARTHER = 2.0

TURNS = np.radians([0, 25, -25, 50, -50, 80, -80, 120, -120, 160, -160])
"""Directions that are tried, from the wished one."""

Box = tuple[Array, tuple[float, float]]
"""Middle (2,), and width and height [pixel]."""


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


def arranged(labels: Sequence[Label], taken: Iterable[Box] = (), room: Box | None = None) -> list[Array]:
    """The middle (2,) [pixel] of every label.

    No two labels cover one another and none covers what is `taken`. A label lies within `room` as long as that has a free place
    for it in one of the directions tried; None is a page without end.
    """
    boxes = list(taken)
    places = []
    for label in labels:
        place = _first_free(label, boxes, room)
        boxes.append((place, label.extent))
        places.append(place)
    return places


def _first_free(label: Label, boxes: list[Box], room: Box | None) -> Array:
    """The first candidate that covers nothing: within `room`, or else outside of it, where there is always one."""
    within = () if room is None else _candidates(label, range(1, 2 + int(sum(room[1]) / (FARTHER * label.gap))))
    candidates = chain((place for place in within if room and _lies_in(place, label.extent, room)), _candidates(label, count(1)))
    return next(place for place in candidates if not any(_cover(place, label.extent, *box) for box in boxes))


def _candidates(label: Label, rounds: Iterable[int]) -> Iterator[Array]:
    """Places around the anchor, the nearest first; after `STEPS` come as many farther ones as `rounds` has."""
    steps = chain(STEPS, (STEPS[-1] + FARTHER * k for k in rounds))
    return (_candidate(label, step, turn) for step in steps for turn in TURNS)


def _candidate(label: Label, step: float, turn: float) -> Array:
    c, s = np.cos(turn), np.sin(turn)
    length = float(np.linalg.norm(label.wish))
    wish = label.wish / length if length > 0 else np.array([1.0, 0.0])
    direction = np.array([c * wish[0] - s * wish[1], s * wish[0] + c * wish[1]])
    reach = label.gap * step + np.abs(direction) @ np.array(label.extent) / 2
    return np.asarray(label.anchor + reach * direction)


def _cover(a: Array, size_a: tuple[float, float], b: Array, size_b: tuple[float, float]) -> bool:
    return bool(np.all(np.abs(a - b) < (np.array(size_a) + np.array(size_b)) / 2))


def _lies_in(place: Array, extent: tuple[float, float], room: Box) -> bool:
    return bool(np.all(np.abs(place - room[0]) <= (np.array(room[1]) - np.array(extent)) / 2))
