"""The built-in examples: virtual tests with an effect that their model does not know, simulated at first use and kept.

They lie in the user's cache (`fem.solid.cache.folder`), made by the very functions behind `massline simulate` and `massline
model`; the same every time. Nothing is shipped, and the folder may be deleted at any time.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

Progress = Callable[[str, float], None]


@dataclass(frozen=True, kw_only=True)
class Example:
    """A story to begin with.

    Attributes
    ----------
    name : by which it is picked
    title : in a few words
    words : what there is to see, a sentence or two; the effect that is hidden is not said
    articles : stacks that stand on the shaker, one a campaign
    effects : that are hidden, as on a command line
    octaves_per_minute, band, seed, rate : of the virtual test
    hold_out : runs that no fit sees
    """

    name: str
    title: str
    words: str
    articles: tuple[str, ...]
    effects: tuple[str, ...]
    octaves_per_minute: float
    band: tuple[float, float] = (4.0, 32.0)
    seed: int = 3
    rate: float = 1024.0
    hold_out: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Series:
    """A model and data that belong together.

    Attributes
    ----------
    model : path of the model file
    data : campaign folders and measurement files
    hold_out : runs that are predicted, never fitted
    band : [Hz]; None for that of the data
    title : in a few words
    """

    model: str
    data: tuple[str, ...]
    hold_out: tuple[str, ...] = ()
    band: tuple[float, float] | None = None
    title: str = ""


def examples() -> tuple[Example, ...]:
    """All of them, the quickest first."""
    raise NotImplementedError


def series(name: str, progress: Progress | None = None) -> Series:
    """The files of the example `name`, made now where they are not there yet.

    Raises
    ------
    BadInput : no example is called so, with the nearest.
    OSError : the cache cannot be written.
    """
    raise NotImplementedError
