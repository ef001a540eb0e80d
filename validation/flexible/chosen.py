"""Which models of an article are set side by side."""

from __future__ import annotations

from pathlib import Path

from fem.users_model.reading import is_model
from geometry.errors import BadInput
from validation.flexible.model import MODELS

DEFAULT = "beam"
"""The model of an article for which none is asked."""


def chosen(name: str, model: str | None, against: str | None = None) -> tuple[str, ...]:
    """The models of the article `name` that are set side by side; `model` is None where the user gave none.

    Raises
    ------
    BadInput : a model asked for of a file that is one itself, or the same model twice.
    """
    if model is not None and is_model(name):
        raise BadInput(
            source=name,
            field="--model",
            problem=f"is a model of your own already, of which no {model} model can be made",
            remedy="Leave it out; to set both side by side name the article first and your model behind --against",
        )
    first = DEFAULT if model is None else model
    if against is None:
        return (first,)
    same_file = is_model(first) and is_model(against) and Path(first).resolve() == Path(against).resolve()
    if not is_model(name) and (against == first or same_file):
        raise BadInput(
            source=name,
            field="--against",
            problem=f"would set the {against} model beside itself",
            remedy=f"Name another model: {', '.join(m for m in MODELS if m != first)}, or a file with one of your own",
        )
    return first, against
