"""What a picture draws: closed meshes with a name, a material, and whether their mass counts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array, frozen
from geometry.article import Article

CHORD = 1e-4
"""Chord error [m] of drawn surfaces: less than a pixel for anything that fills a picture."""


@dataclass(frozen=True, eq=False, kw_only=True)
class DrawnBody:
    """One body of a picture.

    Attributes
    ----------
    name : as in the article
    material : name of the material; bodies of one material share a colour
    vertices : (n, 3) [m], in the article's frame
    faces : (k, 3), indices of the vertices of each triangle
    counted : False for what is drawn but does not belong to the inertia
    """

    name: str
    material: str
    vertices: Array
    faces: npt.NDArray[np.int64]
    counted: bool = True

    def __post_init__(self) -> None:
        vertices = np.asarray(self.vertices)
        object.__setattr__(self, "vertices", frozen(vertices, (len(vertices), 3), "vertices"))
        faces = np.array(self.faces, dtype=np.int64)
        if faces.ndim != 2 or faces.shape[1] != 3 or faces.min(initial=0) < 0 or faces.max(initial=0) >= len(vertices):
            raise ValueError(f"`faces` must be (k, 3) indices of {len(vertices)} vertices, found shape {faces.shape}")
        faces.setflags(write=False)
        object.__setattr__(self, "faces", faces)


def drawn_bodies(article: Article, chord: float = CHORD) -> tuple[DrawnBody, ...]:
    """Every part of `article`, counted or not, tessellated with chord error `chord` [m], in the article's frame."""
    from geometry.cad.tessellation import tessellate

    meshes = [(part, tessellate(part, chord)) for part in article.parts]
    return tuple(
        DrawnBody(name=part.name, material=part.material.name, vertices=mesh.vertices, faces=mesh.faces, counted=part.counted)
        for part, mesh in meshes
    )
