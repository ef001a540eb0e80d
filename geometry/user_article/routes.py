"""The routes from a user's files to inertia, and whether they agree.

Solids from STEP go two ways: OCC integrates the B-rep, trimesh a closed mesh of it with a stated chord
error. Meshes are already what trimesh integrates, exactly, and there is no second opinion on them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import combinations

import numpy as np

from geometry.agreement import Agreement, held_together, missing_mass, rounding, single
from geometry.arrays import Array
from geometry.errors import BadInput
from geometry.inertia import Inertia
from geometry.mesh import inertia_unchecked
from geometry.mesh.checks import SLIVER
from geometry.mesh.self_intersection import shared_volume
from geometry.user_article.nouns import UserArticle, UserPart

NOTHING = 1e-3
"""Share of the smaller of two parts that their meshes may have in common before it is worth a warning."""


def inertias(article: UserArticle) -> Mapping[str, Inertia]:
    """Inertia of `article` about its origin by route: "trimesh", and before it "occ" when every part is a solid."""
    by_mesh = sum((inertia_unchecked(part.mesh, part.material.density) for part in article.parts), _NOTHING)
    return {"occ": _by_occ(article), "trimesh": by_mesh} if article.exact else {"trimesh": by_mesh}


def agreement(article: UserArticle, found: Mapping[str, Inertia]) -> Agreement:
    """Hold "occ" against "trimesh", to rounding and to what the chord error of the curved faces can make."""
    if "occ" not in found:
        return single("one route only: a mesh is integrated exactly as it is, and nothing else is known of it")
    exact = rounding(found["occ"])
    return held_together(found, {"occ": exact, "trimesh": exact + tessellation_error(article)})


def tessellation_error(article: UserArticle) -> Array:
    """What meshes of solids may be off by: bound on each of the ten parameters (10,), about the article's origin."""
    return sum((_missed(part) for part in article.parts if part.solid is not None), np.zeros(10))


def overlap_warnings(article: str, parts: tuple[UserPart, ...]) -> Iterator[str]:
    """A sentence for every two parts that share a sliver of volume, as meshes of curved surfaces in contact do.

    Raises
    ------
    BadInput : two parts share more than that; it would count in both materials.
    """
    for first, second in combinations(parts, 2):
        a, b = first.mesh, second.mesh
        if np.any(np.maximum(a.bounds[0], b.bounds[0]) >= np.minimum(a.bounds[1], b.bounds[1])):
            continue
        share = shared_volume(a, b) / min(a.volume, b.volume)
        said = f"parts {first.name} and {second.name} overlap: {share:.2%} of the smaller one counts twice"
        if share > SLIVER:
            raise BadInput(source=article, problem=said, remedy="Cut one by the other in the CAD, or correct its position")
        if share > NOTHING:
            yield said


def _by_occ(article: UserArticle) -> Inertia:
    from geometry.cad.brep import from_occ

    return sum((from_occ(part.solid, part.material.density) for part in article.parts), _NOTHING)


def _missed(part: UserPart) -> Array:
    """Bound on what a mesh within the chord error of the true surface misses or adds: a shell over the curved faces; (10,)."""
    from geometry.cad import step

    area, reach = step.curved_reach(part.solid)
    return missing_mass(part.material.density * area * part.chord, reach)


_NOTHING = Inertia(parameters=np.zeros(10))
