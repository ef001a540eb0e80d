"""From a name on the command line to a flexible model of it: by the beam, the solid or the exudyn route, or the user's own file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fem.damping import Damping
from fem.modes import Modes
from geometry import keys
from geometry.article import Article
from geometry.articles import built_in, changes_of
from geometry.errors import BadInput
from validation.article_reference import is_file

if TYPE_CHECKING:
    from fem.structure import Structure

MODELS = ("beam", "solid", "exudyn")

USERS_MODEL = "own"
"""What the model of a user's own file is called."""

USERS_ENDINGS = (".h5", ".hdf5", ".npz", ".op4", ".pch", ".f06")
"""Files that hold a user's own model, upper or lower case."""

MOST_MODES = 500
"""More are no help: what they leave behind is in the residual."""


@dataclass(frozen=True, kw_only=True)
class Asked:
    """How a flexible model is to be made.

    Attributes
    ----------
    count : how many modes to keep
    damping : None for what the model itself says: the loss factors of its parts, else one ratio for every mode
    size : element size of the solid model [m]; None for its own
    material, unit : of the user's own CAD
    changes : the user's own dimensions of built-in articles, see `validation.changed`
    """

    count: int = 20
    damping: Damping | None = None
    size: float | None = None
    material: str | None = None
    unit: str | None = None
    changes: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not 1 <= self.count <= MOST_MODES:
            raise BadInput(
                source="number of modes",
                problem=f"must lie between 1 and {MOST_MODES}, found {self.count}",
                remedy="What truncated modes contribute below the last one kept is in the residual mass",
            )


@dataclass(frozen=True, eq=False, kw_only=True)
class Flexible:
    """An article with one flexible model of it.

    Attributes
    ----------
    article : its name
    model : one of `MODELS`, or `USERS_MODEL`
    modes : fixed-base modes about the article's origin
    structure : what they were computed from; None where only modal data were given
    drawn : the article that the model is of; None for a user's own file
    notes : what must be known to read the figures, each a sentence
    """

    article: str
    model: str
    modes: Modes
    structure: Structure | None = None
    drawn: Article | None = None
    notes: tuple[str, ...] = ()


def require_model(name: str, model: str, option: str = "--model") -> str:
    """`model`, which must be one of `MODELS` and able to describe the article `name`.

    Raises
    ------
    BadInput : it is not.
    """
    keys.one_of(model, MODELS, source=f"article {name}", where=option)
    if is_users_model(name):
        return USERS_MODEL
    if is_file(name) and model != "solid":
        raise BadInput(
            source=name,
            field=option,
            problem=f"a {model} model is made of the dimensions of built-in articles, and a CAD file has none",
            remedy="Use --model solid, which meshes any STEP, or give your own model's modes or matrices (.h5, .npz, .op4)",
        )
    if not is_file(name):
        built_in(name)
    return model


def is_users_model(name: str) -> bool:
    """Whether `name` is a file with a user's own model."""
    return Path(name).suffix.lower() in USERS_ENDINGS


def flexible(name: str, model: str, asked: Asked) -> Flexible:
    """The `model` of the article `name` with the modes asked for.

    Raises
    ------
    BadInput : no such article or model, or one that this model cannot describe.
    """
    require_model(name, model)
    return _MAKERS[USERS_MODEL if is_users_model(name) else model](name, asked)


def _beam(name: str, asked: Asked) -> Flexible:
    from fem import beam

    changes = changes_of(name, asked.changes)
    return _solved(name, "beam", beam.structure(name, changes), built_in(name, changes), asked)


def _solid(name: str, asked: Asked) -> Flexible:
    from fem.solid import model

    options: dict[str, Any] = {} if asked.size is None else {"size": asked.size}
    article = built_in(name, changes_of(name, asked.changes))
    return _solved(name, "solid", model.structure(article, **options), article, asked)


def _solved(name: str, model: str, structure: Structure, drawn: Article | None, asked: Asked) -> Flexible:
    from fem.modes import fixed_base

    return Flexible(
        article=name,
        model=model,
        modes=fixed_base(structure, asked.count, damping=asked.damping),
        structure=structure,
        drawn=drawn,
    )


_MAKERS = {"beam": _beam, "solid": _solid}
