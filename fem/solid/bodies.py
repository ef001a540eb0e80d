"""What a solid model is made from: bodies that OCC can draw, each of one material with a stiffness.

A drawing of primitives (`geometry.article.Article`) and a user's STEP file (`geometry.user_article.UserArticle`) both end
here. The drawing itself is put off until a mesh is wanted; what a body's geometry is known by, its `fingerprint`, needs no
OCC.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fem.solid.elasticity import lame
from geometry.article import Article, Part
from geometry.errors import BadInput
from geometry.materials import Material
from geometry.shapes import Box, Placed
from geometry.user_article import UserArticle, UserPart

AnyArticle = Article | UserArticle


@dataclass(frozen=True, eq=False, kw_only=True)
class Body:
    """One part of an article on its way to a mesh.

    Attributes
    ----------
    name : of the part
    material : with modulus and Poisson's ratio
    write : writes its solid(s) as BREP in millimetres, in the article's frame, to a path
    fingerprint : hexadecimal digest of its geometry
    """

    name: str
    material: Material
    write: Callable[[Path], None]
    fingerprint: str


def bodies(article: AnyArticle) -> tuple[Body, ...]:
    """The counted parts of `article`.

    Raises
    ------
    BadInput : nothing counts; a part is a mesh without a solid; a material is not elastic.
    """
    found = (
        tuple(_drawn(part) for part in article.counted_parts)
        if isinstance(article, Article)
        else tuple(_imported(part) for part in article.parts)
    )
    if not found:
        raise BadInput(source=f"article {article.name}", problem="no part of it counts", remedy="Name an article with mass")
    for body in found:
        lame(body.material, body.name)
    return found


def _drawn(part: Part) -> Body:
    def write(path: Path) -> None:
        from geometry.cad.export import write_brep
        from geometry.cad.solids import solid

        write_brep(path, solid(part))

    described = {"pose": _numbers(part.pose), "solids": _placed(part.shape.solids), "voids": _placed(part.shape.voids)}
    digest = hashlib.sha256(json.dumps(described).encode()).hexdigest()
    return Body(name=part.name, material=part.material, write=write, fingerprint=digest)


def _imported(part: UserPart) -> Body:
    if part.solid is None:
        raise BadInput(
            source=part.source,
            problem=f"part {part.name} is a surface mesh, and the solid model needs the solid itself",
            remedy="Export it from the CAD as STEP",
        )

    def write(path: Path) -> None:
        from geometry.cad.export import write_brep

        write_brep(path, part.solid)

    from geometry.cad.export import brep_digest

    return Body(name=part.name, material=part.material, write=write, fingerprint=brep_digest(part.solid))


def _placed(placed: tuple[Placed, ...]) -> list[Any]:
    return [[type(p.primitive).__name__, *_size(p), *_numbers(p.pose)] for p in placed]


def _size(placed: Placed) -> list[str]:
    primitive = placed.primitive
    sizes = primitive.size.tolist() if isinstance(primitive, Box) else [primitive.diameter, primitive.height]
    return [float(size).hex() for size in sizes]


def _numbers(pose: Any) -> list[str]:
    return [float(number).hex() for number in np.append(pose.position, pose.rotation)]
