"""The built-in articles by name, the stacks of them (``fmd+disc+cuboid``, ``fmd+clumod-4`` ...), and their named places."""

from collections.abc import Callable, Mapping
from functools import cache, partial
from itertools import pairwise
from types import MappingProxyType
from typing import Literal

import numpy as np

from geometry.article import Article, prefixes, rectangle, stacked
from geometry.articles import parts
from geometry.articles.parts import FOUR_BLADES, ONE_BLADE, Dimensions, build_clumod, changed_files, load
from geometry.errors import BadInput
from geometry.frames import Array, Pose
from geometry.toml_file import nearest

_BUILDERS: dict[str, tuple[str, Callable[[Dimensions], Article]]] = {
    "cuboid": ("cuboid", parts.build_cuboid),
    "disc": ("disc", parts.build_disc),
    "fmd": ("fmd", parts.build_fmd),
    "clumod-1": ("clumod", partial(build_clumod, ONE_BLADE)),
    "clumod-4": ("clumod", partial(build_clumod, FOUR_BLADES)),
}
"""By name: the dimension file of an article and what builds it."""

NAMES = tuple(_BUILDERS)
"""Built-in articles that a stack can be made of."""

SETUPS = ("fmd+disc+cuboid", "fmd+clumod-1", "fmd+clumod-4")
"""The set-ups of the paper's tests, bottom to top."""


def built_in(name: str, changes: Mapping[str, float] = MappingProxyType({})) -> Article:
    """The built-in article or stack called `name`, parts joined by "+" from bottom to top; frame of the lowest part.

    `changes` are the user's own dimensions, ``{"fmd.load_cell.moving_fraction": 0.6}``; see `geometry.articles.parts`.

    Raises
    ------
    BadInput : a part that does not exist, one on which nothing can be mounted in the middle of the stack, a dimension that
        does not exist, is not of this stack or makes no body.
    """
    return _built(name, tuple(changes.items()))


@cache
def _built(name: str, given: tuple[tuple[str, float], ...]) -> Article:
    parts, changes = name.split("+"), dict(given)
    _require_known(parts, name)
    used = {_BUILDERS[part][0] for part in parts}
    for file in sorted(changed_files(changes) - used):
        problem = f"a dimension of {file!r} was given, but {name} is made of {', '.join(sorted(used))}"
        raise BadInput(f"article {name}", file, problem, "Name a dimension of a part of the article")
    articles = []
    for part in parts:
        file, build = _BUILDERS[part]
        dimensions = load(file, changes)
        try:
            articles.append(build(dimensions))
        except ValueError as error:
            if isinstance(error, BadInput) or not changes:
                raise
            listed = ", ".join(f"{key}={value:g}" for key, value in given)
            problem = f"no body has the dimensions {listed}: {error}"
            raise BadInput(f"article {part}", "", problem, "Check the sizes and their unit") from error
    for lower, upper in pairwise(articles):
        if lower.seat is None:
            problem = f"nothing can be mounted on {lower.name}, found {upper.name} above it"
            raise BadInput(f"article {name}", "", problem, f"Name the stack from bottom to top, for example {SETUPS[0]}")
    return stacked(*articles)


def dimension_files(name: str) -> tuple[str, ...]:
    """The dimension files of the built-in article or stack called `name`, each once.

    Raises
    ------
    BadInput : a part that does not exist.
    """
    parts = name.split("+")
    _require_known(parts, name)
    return tuple(dict.fromkeys(_BUILDERS[part][0] for part in parts))


def changes_of(name: str, changes: Mapping[str, float]) -> dict[str, float]:
    """Those of `changes` that speak of a part of the built-in article or stack called `name`.

    Raises
    ------
    BadInput : a part that does not exist.
    """
    own = dimension_files(name)
    return {key: value for key, value in changes.items() if changed_files({key: value}) <= set(own)}


def _require_known(parts: list[str], whole: str) -> None:
    for part in parts:
        if part not in _BUILDERS:
            remedy = f"{nearest(part, NAMES)}Known are {', '.join(NAMES)}, joined by +, and files"
            raise BadInput(f"article {whole}", "", f"no built-in article is called {part!r}", remedy)


# Places of the built-in articles by name, where something is measured, mounted or tied: `flange`, `hub-3`, `lower-1+`, `top` ...
#
# The names on Clumod are those of the campaign folder: the middle of the flange's upper side, the middle of every hub, the mast's
# upper end, and the tips of the blades that are there, with the sign of the axis that the tip points along; all on the axis of
# the mast or in the mid-plane of the blade. On the others: `cover` is the middle of the FMD's cover plate, on top, and `cover-1`
# to `cover-4` are its corners; `disc` the middle of the disc's upper side; `top` and `top-1` to `top-4` middle and corners of the
# Cuboid's. Corners are numbered counter-clockwise from +x +y, like the load cells.

Places = dict[str, Array]
"""By name (3,) [m]."""


def locations(
    name: str, changes: Mapping[str, float] = MappingProxyType({}), *, origin: Literal["lowest", "top"] = "lowest"
) -> Places:
    """Every named place of the built-in article or stack `name`, (3,) [m] in the frame of its lowest or of its top article.

    The places of a second article of one kind carry it as a prefix, as its parts do: ``disc-2/disc``.

    Raises
    ------
    BadInput : what `geometry.articles.built_in` refuses.
    """
    poses = seats(name, changes)
    own = poses[-1].inverse if origin == "top" else Pose()
    parts = name.split("+")
    return {
        place if prefix == part else f"{prefix}/{place}": (own @ pose).apply(position)
        for part, prefix, pose in zip(parts, prefixes(parts), poses, strict=True)
        for place, position in _own(part, changes).items()
    }


def seats(name: str, changes: Mapping[str, float] = MappingProxyType({})) -> list[Pose]:
    """Where the frame of every article of the stack `name` sits in that of the lowest one, bottom to top.

    Raises
    ------
    BadInput : what `geometry.articles.built_in` refuses.
    """
    built_in(name, changes)
    parts = name.split("+")
    poses = [Pose()]
    for part in parts[:-1]:
        poses.append(poses[-1] @ (built_in(part, changes_of(part, changes)).seat or Pose()))
    return poses


def _own(part: str, changes: Mapping[str, float]) -> Places:
    """The places of one article in its own frame."""
    (file,) = dimension_files(part)
    d = load(file, changes)
    if part == "cuboid":
        return _upper_side("top", d["size"], d["size"][2])
    if part == "disc":
        return {"disc": _above(d["height"])}
    if part == "fmd":
        size = d["cover_plate"]["size"]
        return _upper_side("cover", size, d["load_cell"]["height"] / 2 + size[2])
    # Hubs of Clumod stay on the mast when their blade is taken off; tips do not
    found = {"flange": _above(d["flange"]["height"])}
    found |= {f"hub-{number}": _above(blade["z"]) for number, blade in enumerate(d["blade"], start=1)}
    found["mast-top"] = _above(d["mast"]["top"])
    for blade in d["blade"]:
        if blade["name"] in (ONE_BLADE if part == "clumod-1" else FOUR_BLADES):
            along = np.array({"x": [1.0, 0.0, 0.0], "y": [0.0, 1.0, 0.0]}[blade["axis"]]) * blade["length"] / 2
            for sign in "+-":
                found[f"{blade['name']}{sign}"] = _above(blade["z"]) + float(f"{sign}1") * along
    return found


def _upper_side(name: str, size: list[float], height: float) -> Places:
    corners = {f"{name}-{number}": np.array([x, y, height]) for number, (x, y) in enumerate(rectangle(*size[:2]), start=1)}
    return {name: _above(height), **corners}


def _above(height: float) -> Array:
    return np.array([0.0, 0.0, height])
