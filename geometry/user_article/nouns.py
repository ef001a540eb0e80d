"""`UserPart` and `UserArticle`: bodies as files have them, where `geometry.article` has drawings of primitives."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from geometry.materials import Material
from geometry.mesh.triangles import TriangleMesh


@dataclass(frozen=True, eq=False, kw_only=True)
class UserPart:
    """One body of one material, in the article's frame.

    Attributes
    ----------
    name : unique within its article
    material : what it is made of
    source : the file it came from
    mesh : its skin, closed and checked
    chord : [m], how far `mesh` may lie from the true surface: 0 when the mesh is what the file holds
    solid : its CadQuery solid [mm], when it came from a STEP file; else None
    """

    name: str
    material: Material
    source: str
    mesh: TriangleMesh
    chord: float = 0.0
    solid: Any = None


@dataclass(frozen=True, eq=False, kw_only=True)
class UserArticle:
    """A user's article.

    Attributes
    ----------
    name : of the article, or of its file
    parts : all bodies, in the article's frame
    note : one sentence on where the geometry comes from
    warnings : what a user should know before trusting the figures, each a sentence
    """

    name: str
    parts: tuple[UserPart, ...]
    note: str = ""
    warnings: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        names = [part.name for part in self.parts]
        doubled = sorted({name for name in names if names.count(name) > 1})
        if doubled:
            raise ValueError(f"`parts` must have unique names, found {', '.join(doubled)} more than once")

    @property
    def exact(self) -> bool:
        """Whether every part is a solid, so that its B-rep can be integrated exactly."""
        return all(part.solid is not None for part in self.parts)
