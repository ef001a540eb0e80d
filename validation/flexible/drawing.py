"""The modes of a flexible model as bodies that move: the CAD's own surface, carried by the model."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from fem.structure import Structure
from geometry.arrays import Array
from geometry.article import Article
from geometry.errors import BadInput
from validation.flexible.model import Flexible
from validation.flexible.modes_table import words
from validation.flexible.motion import displacement
from validation.pictures.bodies import DrawnBody, drawn_bodies
from validation.pictures.mode_sheet import DrawnMode
from validation.pictures.moving import MovingBody, bendable, sharp_edges

Moved = tuple[DrawnBody, npt.NDArray[np.int64], Array]
"""A body, its sharp edges, and the displacement (n, 3, m) of its vertices."""

CHORD = 5e-4
"""Chord error [m] of the drawn surface: these pictures are small."""

PIECES = 30
"""Sides of triangles are at most the article's diagonal over this."""


def drawn_modes(model: Flexible, numbers: Sequence[int]) -> tuple[DrawnMode, ...]:
    """The modes `numbers` (from 1) of `model`, ready to be drawn.

    Raises
    ------
    BadInput : a mode that was not computed, or a model of which no surface is known.
    """
    if model.drawn is None or model.structure is None:
        raise BadInput(
            source=model.article,
            field="--shapes",
            problem=f"the {model.model} model gives frequencies and participations, but no shape that could be drawn",
            remedy="Draw the beam or the solid model",
        )
    count = len(model.modes.frequency)
    for number in numbers:
        if not 1 <= number <= count:
            raise BadInput(
                source="--mode",
                problem=f"modes 1 to {count} were computed, found {number}",
                remedy="Choose one of them, or compute more with --count",
            )
    chosen = np.array(numbers, dtype=np.intp) - 1
    shapes = model.modes.shapes[:, chosen]
    said = words(model)
    bodies = moved_bodies(model, shapes)
    return tuple(
        DrawnMode(
            number=number,
            frequency=float(model.modes.frequency[number - 1]),
            text=said[number - 1].text,
            bodies=tuple(
                MovingBody(name=body.name, vertices=body.vertices, faces=body.faces, edges=edges, displacement=u[:, :, k])
                for body, edges, u in bodies
            ),
        )
        for k, number in enumerate(numbers)
    )


def moved_bodies(model: Flexible, shapes: Array) -> tuple[Moved, ...]:
    """The surface of every part of `model`, and how it moves in `shapes` (N, m); none of a model whose surface is not known."""
    if model.drawn is None or model.structure is None:
        return ()
    structure, article = model.structure, model.article_of_primitives
    return tuple(_moved(structure, article, number, body, shapes) for number, body in enumerate(_surfaces(model)))


def _surfaces(model: Flexible) -> tuple[DrawnBody, ...]:
    """The surface of every counted part, fine enough to bend."""
    drawn = _users(model.drawn) if model.article_of_primitives is None else drawn_bodies(model.article_of_primitives, CHORD)
    counted = [body for body in drawn if body.counted]
    longest = float(np.linalg.norm(np.ptp(np.concatenate([body.vertices for body in counted]), axis=0))) / PIECES
    return tuple(bendable(body, longest) for body in counted)


def _users(article: Any) -> tuple[DrawnBody, ...]:
    return tuple(
        DrawnBody(name=part.name, material=part.material.name, vertices=part.mesh.vertices, faces=part.mesh.faces)
        for part in article.parts
    )


def _moved(structure: Structure, article: Article | None, part: int, body: DrawnBody, shapes: Array) -> Moved:
    owner = np.full(len(body.vertices), part, dtype=np.intp)
    return body, sharp_edges(body), displacement(structure, shapes, article, body.vertices, owner)
