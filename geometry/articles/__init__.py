"""The built-in articles by name, and the stacks of them: ``cuboid``, ``fmd+disc+cuboid``, ``fmd+clumod-4`` ..."""

from collections.abc import Callable, Mapping
from functools import partial
from itertools import pairwise
from types import MappingProxyType

from geometry.article import Article, stacked
from geometry.articles import parts
from geometry.articles.parts import FOUR_BLADES, ONE_BLADE, Dimensions, build_clumod, changed_files, load
from geometry.errors import BadInput
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
    parts = name.split("+")
    _require_known(parts, name)
    used = {_BUILDERS[part][0] for part in parts}
    for file in sorted(changed_files(changes) - used):
        raise BadInput(
            source=f"article {name}",
            field=file,
            problem=f"a dimension of {file!r} was given, but {name} is made of {', '.join(sorted(used))}",
            remedy="Name a dimension of a part of the article",
        )
    articles = []
    for part in parts:
        file, build = _BUILDERS[part]
        dimensions = load(file, changes)
        try:
            articles.append(build(dimensions))
        except ValueError as error:
            if isinstance(error, BadInput) or not changes:
                raise
            given = ", ".join(f"{key}={value:g}" for key, value in changes.items())
            problem = f"no body has the dimensions {given}: {error}"
            raise BadInput(source=f"article {part}", problem=problem, remedy="Check the sizes and their unit") from error
    for lower, upper in pairwise(articles):
        if lower.seat is None:
            raise BadInput(
                source=f"article {name}",
                problem=f"nothing can be mounted on {lower.name}, found {upper.name} above it",
                remedy=f"Name the stack from bottom to top, for example {SETUPS[0]}",
            )
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
            raise BadInput(
                source=f"article {whole}",
                problem=f"no built-in article is called {part!r}",
                remedy=f"{nearest(part, NAMES)}Known are {', '.join(NAMES)}, joined by +, and files",
            )
