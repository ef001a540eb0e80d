"""The built-in articles by name, and the stacks of them: ``cuboid``, ``fmd+disc+cuboid``, ``fmd+clumod-4`` ..."""

from __future__ import annotations

import difflib
from collections.abc import Callable
from itertools import pairwise

from geometry.article import Article, stacked
from geometry.articles import clumod, cuboid, disc, fmd
from geometry.errors import BadInput

_BUILDERS: dict[str, Callable[[], Article]] = {
    "cuboid": cuboid.build,
    "disc": disc.build,
    "fmd": fmd.build,
    "clumod-1": clumod.one_blade,
    "clumod-4": clumod.four_blades,
}

NAMES = tuple(_BUILDERS)
"""Built-in articles that a stack can be made of."""

SETUPS = ("fmd+disc+cuboid", "fmd+clumod-1", "fmd+clumod-4")
"""The set-ups of the paper's tests, bottom to top."""


def built_in(name: str) -> Article:
    """The built-in article or stack called `name`, parts joined by "+" from bottom to top; frame of the lowest part.

    Raises
    ------
    BadInput : a part that does not exist, or one on which nothing can be mounted in the middle of the stack.
    """
    articles = [_one(part, name) for part in name.split("+")]
    for lower, upper in pairwise(articles):
        if lower.seat is None:
            raise BadInput(
                source=f"article {name}",
                problem=f"nothing can be mounted on {lower.name}, found {upper.name} above it",
                remedy=f"Name the stack from bottom to top, for example {SETUPS[0]}",
            )
    return stacked(*articles)


def _one(part: str, whole: str) -> Article:
    if part in _BUILDERS:
        return _BUILDERS[part]()
    near = difflib.get_close_matches(part, NAMES, n=1)
    raise BadInput(
        source=f"article {whole}",
        problem=f"no built-in article is called {part!r}",
        remedy=(f"Did you mean {near[0]}? " if near else "") + f"Known are {', '.join(NAMES)}, joined by +, and files",
    )
