"""`Part` and `Article`: what is mounted, bottom to top, each part with its shape, its material and its place."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from geometry.frames import Pose
from geometry.materials import Material
from geometry.shapes import Shape


@dataclass(frozen=True, eq=False, kw_only=True)
class Part:
    """One body of one material.

    Attributes
    ----------
    name : unique within its article
    material : what it is made of
    shape : its drawing, in the part's own frame
    pose : where that frame sits in the article's frame
    counted : False for what belongs in the picture but does not move with the article (the fixed half of a load cell)
    """

    name: str
    material: Material
    shape: Shape
    pose: Pose = field(default_factory=Pose)
    counted: bool = True


@dataclass(frozen=True, eq=False, kw_only=True)
class Article:
    """A test article or a stack of them.

    Attributes
    ----------
    name : as on the command line, bottom to top, joined by "+"
    parts : all bodies, in the article's frame (the own frame of the lowest one)
    seat : where the next article's frame sits when it is stacked on this one; None when nothing can stand on it
    note : one sentence on what the geometry rests on (drawing, assumption, reconstruction)
    """

    name: str
    parts: tuple[Part, ...]
    seat: Pose | None = None
    note: str = ""

    def __post_init__(self) -> None:
        names = [part.name for part in self.parts]
        doubled = sorted({name for name in names if names.count(name) > 1})
        if doubled:
            raise ValueError(f"`parts` must have unique names, found {', '.join(doubled)} more than once")

    @property
    def counted_parts(self) -> tuple[Part, ...]:
        """The parts whose mass belongs to the article."""
        return tuple(part for part in self.parts if part.counted)


def placed(article: Article, pose: Pose) -> Article:
    """`article` with its frame put at `pose` of an outer frame; the result is expressed in the outer frame."""
    parts = tuple(replace(part, pose=pose @ part.pose) for part in article.parts)
    return replace(article, parts=parts, seat=None if article.seat is None else pose @ article.seat)


def stacked(*articles: Article) -> Article:
    """`articles` on top of one another, lowest first, in the frame of the lowest.

    Part names gain their article as a prefix, ``disc/plate``, when more than one article is stacked; a second disc is ``disc-2``.

    Raises
    ------
    ValueError : an article that nothing can stand on is not the top one.
    """
    if len(articles) == 1:
        return articles[0]
    pose: Pose | None = Pose()
    parts: list[Part] = []
    for article, prefix in zip(articles, prefixes([article.name for article in articles]), strict=True):
        if pose is None:
            raise ValueError(f"`articles`: nothing can be mounted on {parts[-1].name.split('/')[0]}, found {article.name}")
        there = placed(article, pose)
        parts += [replace(part, name=f"{prefix}/{part.name}") for part in there.parts]
        pose = there.seat
    return Article(
        name="+".join(article.name for article in articles),
        parts=tuple(parts),
        seat=pose,
        note=" ".join(dict.fromkeys(article.note for article in articles if article.note)),
    )


def prefixes(names: Sequence[str]) -> list[str]:
    """What the parts of a stack of `names` are prefixed with, bottom to top: the names, numbered from the second of a kind on."""
    before = [names[:index].count(name) for index, name in enumerate(names)]
    return [f"{name}-{count + 1}" if count else name for name, count in zip(names, before, strict=True)]


def seat_at(height: float) -> Pose:
    """A seat on the axis at `height` [m] above the article's origin, axes parallel."""
    return Pose(position=np.array([0.0, 0.0, height]))
