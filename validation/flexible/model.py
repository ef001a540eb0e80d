"""From a name on the command line to a flexible model of it: beam, solid or exudyn, or what a user's own file holds."""

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fem.damping import DEFAULT_RATIO, Damping, damping_per_mode, equivalent_ratio
from fem.modes import Modes
from fem.user_model.reading import is_model, load
from geometry import toml_file
from geometry.article import Article, Box, Part, Placed
from geometry.articles import built_in, changes_of
from geometry.articles.parts import load as load_dimensions
from geometry.errors import BadInput
from geometry.frames import Array, Integers
from validation.model.setups import is_file
from validation.reference import reference
from validation.reference.reference import require_use

if TYPE_CHECKING:
    from fem.structure import Structure
    from geometry.user_article import UserArticle


MODELS = ("beam", "solid", "exudyn")

OWN = "own"
"""What the model in a user's own file is called."""

MOST_MODES = 500
"""More are no help: what they leave behind is in the residual."""


@dataclass(frozen=True, kw_only=True)
class FlexibleOptions:
    """How a flexible model is to be made.

    Attributes
    ----------
    count : how many modes to keep
    damping : None for what the model itself says: the loss factors of its parts, else one ratio for every mode
    size : element size of the solid model [m]; None for its own
    joints : whether local solid models correct the joints of Clumod's beams
    cells : whether the FMD's load cells are springs, of assumed stiffness
    material, unit : of the user's own CAD
    changes : the user's own dimensions of built-in articles, see `validation.reference.reference`
    """

    count: int = 20
    damping: Damping | None = None
    size: float | None = None
    joints: bool = False
    cells: bool = False
    material: str | None = None
    unit: str | None = None
    changes: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        require_count(self.count, "number of modes")


def require_count(count: int, source: str) -> None:
    """Refuse a number of modes that is none, or too large to be of use; `source` is what it was given as.

    Raises
    ------
    BadInput : it lies outside 1 to `MOST_MODES`.
    """
    if not 1 <= count <= MOST_MODES:
        remedy = "Ask for 20" if count < 1 else "What the modes beyond the last one kept contribute is in the residual mass"
        raise BadInput(source, "", f"must lie between 1 and {MOST_MODES}, found {count}", remedy)


@dataclass(frozen=True, eq=False, kw_only=True)
class Flexible:
    """An article with one flexible model of it.

    Attributes
    ----------
    article : its name
    model : one of `MODELS`, or `OWN`
    modes : fixed-base modes about the article's origin
    structure : what they were computed from; None where only modal data are known
    drawn : what the model is of, with its surface; None for a user's own model
    notes : what must be known to read the figures, each a sentence
    """

    article: str
    model: str
    modes: Modes
    structure: "Structure | None" = None
    drawn: "Article | UserArticle | None" = None
    notes: tuple[str, ...] = ()

    @property
    def article_of_primitives(self) -> Article | None:
        """What is drawn, if it is made of primitives: a built-in article or a stack of them."""
        return self.drawn if isinstance(self.drawn, Article) else None


def require_model(name: str, model: str, option: str = "--model") -> str:
    """Name of the `model` asked for, which must be one of `MODELS`, or a file with one, and able to describe the article `name`.

    Raises
    ------
    BadInput : it is not.
    """
    if is_model(name) and option == "--against":
        problem = f"of what a file of your own models, no {model} model can be made"
        raise BadInput(name, option, problem, "Name the built-in article or the STEP file first, and your model behind --against")
    if is_model(name) or is_model(model):
        return OWN
    toml_file.one_of(model, MODELS, source=f"article {name}", where=option)
    if not is_file(name):
        built_in(name)
        return model
    from geometry.user_article import require_file

    require_file(name)
    if model != "solid":
        article = "an" if model.startswith("e") else "a"
        problem = f"{article} {model} model is made of the dimensions of built-in articles, and a CAD file has none"
        remedy = "Use --model solid, which meshes any STEP file, or give a model of your own (.h5, .npz, .op4)"
        raise BadInput(name, option, problem, remedy)
    return model


def require_used(name: str, models: Collection[str], asked: FlexibleOptions) -> None:
    """Refuse what was `asked` for of the article `name` and none of `models` can use.

    Raises
    ------
    BadInput : a unit or a material of a built-in article, a dimension of a file, any of them of a model of the user's own,
        an element size without a solid model.
    """
    if is_model(name):
        given: dict[str, object] = {
            "--unit": asked.unit,
            "--material": asked.material,
            "--set": asked.changes,
            "--size": asked.size,
        }
        given |= {"--joints": asked.joints, "--cells": asked.cells}
        for option in (option for option, value in given.items() if value):
            raise BadInput(option, "", f"{name} is a model that states its own", "Leave it out")
        return
    require_use([name], reference.ArticleOptions(unit=asked.unit, material=asked.material, changes=asked.changes))
    for option, wanted, part in (("--joints", asked.joints, "clumod"), ("--cells", asked.cells, "fmd")):
        if wanted and (not {"beam", "exudyn"} & set(models) or part not in name):
            problem = f"beam models with {part} have it, found {name} as {' and '.join(models)}"
            raise BadInput(option, "", problem, "Leave it out, or name such an article and --model beam or exudyn")
    if asked.size is not None and "solid" not in models:
        problem = f"only the solid model has elements of a size, found {' and '.join(models)}"
        raise BadInput("--size", "", problem, "Leave it out, or add --model solid")


def flexible(name: str, model: str, asked: FlexibleOptions) -> Flexible:
    """The `model` of the article `name` with the modes asked for; either may be a file with a model of the user's own.

    Raises
    ------
    BadInput : no such article or model, or one that this model cannot describe.
    """
    if require_model(name, model) == OWN:
        # The model in a user's own file
        path = model if is_model(model) else name
        own_found = load(path)
        if isinstance(own_found.model, Modes):
            own_modes = _damped(own_found.model, asked.damping)
            return Flexible(article=own_found.name, model=OWN, modes=own_modes, notes=("Modal data as they were given.",))
        try:
            solved = replace(asked, damping=asked.damping or own_found.damping)
            found = _solved(own_found.name, OWN, own_found.model, None, solved)
            return replace(found, notes=(*found.notes, *own_found.notes))
        except BadInput as error:
            if asked.damping is not None or error.source != "damping":
                raise
            raise BadInput(path, error.field, error.problem, error.remedy) from None  # it is the file's
    if model == "solid":
        from fem.solid import model as solid
        from geometry import user_article

        article: Article | UserArticle
        if is_file(name):
            article = user_article.load(name, unit=asked.unit, material=asked.material)
        else:
            article = built_in(name, changes_of(name, asked.changes))
        structure = solid.structure(article, size=asked.size)
        found = _solved(article.name if is_file(name) else name, model, structure, article, asked)
        return replace(found, notes=(f"Solid model with {structure.mass.shape[0]} degrees of freedom.", *found.notes))
    from fem.beam import articles

    changes, added, notes = changes_of(name, asked.changes), dict[str, Any](), []
    if asked.joints:
        clumod = next(part for part in name.split("+") if part in articles.BLADES)
        added["joints"] = articles.joints(articles.BLADES[clumod], load_dimensions("clumod", changes_of(clumod, asked.changes)))
        notes.append("Joints of Clumod corrected by local solid models of its crossings and of the mast's foot.")
    if asked.cells:
        added["cells"] = articles.load_cells(changes_of("fmd", asked.changes))
        notes.append("Load cells of the FMD as springs of assumed stiffness; the base is below them.")
    drawn = built_in(name, changes)
    if model == "beam":
        found = _solved(name, model, articles.structure(name, changes, **added), drawn, asked)
        return replace(found, notes=(*notes, *found.notes))
    from fem.exudyn import linear

    modes = _damped(linear.modes(name, asked.count, changes, **added), asked.damping)
    own = "Modes of exudyn's own beam elements, by its own eigen-solution, extrapolated from two meshes."
    return Flexible(article=name, model=model, modes=modes, drawn=drawn, notes=(own, *notes))


def require_base(model: Flexible) -> None:
    """Refuse a `model` that no base can drive, because the ground holds it or nothing.

    Raises
    ------
    BadInput : it stands on the ground, or floats.
    """
    if model.structure is None or len(model.structure.held):
        return
    support = "ground" if model.structure.grounded else "free"
    problem = f'is "{support}": it has no base, about which a dynamic mass or a base motion could be'
    raise BadInput(model.article, "fe_model.support", problem, 'State support = "base" with the interface that is shaken')


def _damped(modes: Modes, damping: Damping | None) -> Modes:
    """`modes` with another damping, given per mode; as they are for None."""
    if damping is None:
        return modes
    omega = 2 * np.pi * modes.frequency
    C = damping_per_mode(damping, omega)
    ratio = equivalent_ratio(C, np.zeros_like(C), omega)
    return replace(modes, viscous=C, structural=np.zeros_like(C), damping_ratio=ratio, condensed=None)


def _solved(
    name: str, model: str, structure: "Structure", drawn: "Article | UserArticle | None", asked: FlexibleOptions
) -> Flexible:
    if model == "solid":
        from fem.solid.model import fixed_base  # remembers what takes minutes
    else:
        from fem.modes import fixed_base

    modes = fixed_base(structure, asked.count, damping=asked.damping)
    if asked.damping is not None:
        damping_notes: tuple[str, ...] = ()
    elif structure.loss_factors and structure.part_stiffness:
        listed = ", ".join(f"{name} {eta:g}" for name, eta in structure.loss_factors.items())
        damping_notes = (f"Damping from the loss factors of the parts: {listed}.",)
    else:
        damping_notes = (f"Damping: {100 * DEFAULT_RATIO:g} % in every mode, assumed.",)
    return Flexible(article=name, model=model, modes=modes, structure=structure, drawn=drawn, notes=damping_notes)


# Are two models of the same body? A comparison of different ones says so before anything else.


SAME = 0.01
"""Share by which the masses of two models of one article may differ."""


def another_body(first: Flexible, second: Flexible) -> str:
    """A sentence with the masses of both where they differ by more than `SAME`; empty where they do not."""
    masses = [float(model.modes.rigid_mass[0, 0]) for model in (first, second)]
    if abs(masses[1] - masses[0]) <= SAME * max(masses):
        return ""
    said = " and ".join(
        f"{mass:.4g} kg ({one.model} model of {one.article})" for mass, one in zip(masses, (first, second), strict=True)
    )
    return f"These are different bodies: {said}; what follows compares them all the same."


# Which models of an article are set side by side.


DEFAULT = "beam"
"""The model of an article for which none is asked."""


def chosen(name: str, model: str | None, against: str | None = None) -> tuple[str, ...]:
    """The models of the article `name` that are set side by side; `model` is None where the user gave none.

    Raises
    ------
    BadInput : a model asked for of a file that is one itself, or the same model twice.
    """
    if model is not None and is_model(name):
        remedy = "Leave it out; to set both side by side name the article first and your model behind --against"
        raise BadInput(name, "--model", f"the file is a model of your own already, of which no {model} model can be made", remedy)
    first = DEFAULT if model is None else model
    if against is None:
        return (first,)
    same_file = is_model(first) and is_model(against) and Path(first).resolve() == Path(against).resolve()
    if not is_model(name) and (against == first or same_file):
        remedy = f"Name another model: {', '.join(m for m in MODELS if m != first)}, or a file with one of your own"
        raise BadInput(name, "--against", f"the {against} model would stand beside itself", remedy)
    return first, against


# Which part a point of a model belongs to. Beams' nodes lie on axes, not in material: primitives are asked without voids.


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
    # To a millimetre, as places are stated: where two parts touch both are equally near, and the smaller comes first
    distances = np.array([np.round(distance(parts[k], points), 3) for k in by_size])
    return np.asarray(np.take(by_size, np.argmin(distances, axis=0)), dtype=np.intp)


def _outside(placed: Placed, points: Array) -> Array:
    own = placed.pose.inverse.apply(points)
    primitive = placed.primitive
    if isinstance(primitive, Box):
        beyond = np.maximum(np.abs(own) - np.asarray(primitive.size) / 2, 0)
        return np.asarray(np.linalg.norm(beyond, axis=1))
    radial = np.maximum(np.hypot(own[:, 0], own[:, 1]) - primitive.diameter / 2, 0)
    return np.asarray(np.hypot(radial, np.maximum(np.abs(own[:, 2]) - primitive.height / 2, 0)))
