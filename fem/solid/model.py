"""The solid model of any article: mesh, matrices and base in one `Structure`, remembered from one run to the next."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fem.solid import cache, packed, soundness
from fem.solid.bodies import AnyArticle, Body, bodies
from fem.solid.elasticity import Matrices, assemble
from fem.solid.layers import foot_height, hexahedra
from fem.solid.mesh import SolidMesh
from fem.solid.sizing import LARGEST, Sizing
from fem.solid.tetrahedra import FINER, tetrahedra
from fem.structure import Structure
from geometry.arrays import Integers
from geometry.article import Article
from geometry.errors import BadInput, CheckFailed
from geometry.frames import rigid_transformation
from geometry.materials import Material

PLATE_SIZE, FOOT_SIZE = 0.035, 0.04
"""Width of a hexahedron [m] in plates and, at the least, in the foot, before it is divided by the fineness."""


def structure(
    article: AnyArticle,
    *,
    size: float | None = None,
    fineness: float = 1.0,
    refinement: float = 1.0,
    largest: int = LARGEST,
    cached: bool = True,
) -> Structure:
    """`article` as a solid on its mounting face, the plane z = min of its counted parts, about its origin.

    A tube with plates on a flange is meshed with hexahedra (`fem.solid.layers`), everything else with curved tetrahedra.

    Parameters
    ----------
    article : a built-in article or stack, or a user's own from STEP files (`geometry.user_article.load`)
    size : largest edge of an element [m]; by default what thickness asks for, see `fem.solid.sizing`
    fineness : all sizes, given or not, are divided by it
    refinement : size at re-entrant edges relative to what it is beside them, at most 1
    largest : degrees of freedom that are refused when exceeded
    cached : whether mesh and matrices may come from disk and are kept there

    Raises
    ------
    BadInput : a material that is not elastic, a body without a solid, bodies that overlap or are not joined to the base, no face
        to be held at, too many degrees of freedom, a size that is none.
    CheckFailed : no valid mesh.
    """
    sizing = Sizing(size=size, fineness=fineness, refinement=refinement, largest=largest)
    found = bodies(article)
    made = _hexahedra(article, sizing) or mesh(found, sizing, cached=cached)
    return of_mesh(made, {body.name: body.material for body in found}, cached=cached)


def _hexahedra(article: AnyArticle, sizing: Sizing) -> SolidMesh | None:
    """Hexahedra of an article that consists of a foot and a tube with plates, None of any other."""
    if not isinstance(article, Article) or (cut := foot_height(article.counted_parts)) is None:
        return None
    failures: list[str] = []
    for finer in FINER:
        size = (sizing.size or PLATE_SIZE) / (finer * sizing.fineness)
        foot = max(size, FOOT_SIZE / (finer * sizing.fineness))
        try:
            made = hexahedra(article.counted_parts, sizes=(foot, size), cuts=(cut,))
        except CheckFailed as failure:
            failures.append(str(failure))
            continue
        _require_affordable(article, made, size, sizing.largest)
        return made
    raise CheckFailed(f"no valid mesh of hexahedra after {len(FINER)} attempts: {failures[-1]}", failures=tuple(failures))


def _require_affordable(article: Article, made: SolidMesh, size: float, largest: int) -> None:
    unknowns = 3 * len(made.points)
    if unknowns > largest:
        raise BadInput(
            source=f"article {article.name}",
            problem=f"hexahedra of {1e3 * size:.3g} mm make {unknowns} degrees of freedom, {largest} are allowed",
            remedy="Use larger elements, or allow more",
        )


def mesh(found: tuple[Body, ...], sizing: Sizing, *, cached: bool = True) -> SolidMesh:
    """Tetrahedra of the bodies `found`, from disk when they are there.

    Raises
    ------
    BadInput, CheckFailed : as `fem.solid.tetrahedra.tetrahedra`.
    """
    name = cache.key("tetrahedra", {"bodies": [[body.name, body.fingerprint] for body in found], "sizing": sizing.described})
    if cached and (kept := cache.load(name)) is not None:
        return packed.unpack_mesh(kept)
    made = tetrahedra(found, sizing)
    if cached:
        cache.store(name, packed.pack_mesh(made))
    return made


def of_mesh(mesh: SolidMesh, materials: Mapping[str, Material], *, cached: bool = True) -> Structure:
    """`mesh`, of tetrahedra or hexahedra, with the `materials` of its parts, held where it touches its lowest plane.

    Raises
    ------
    BadInput : a material that is not elastic, bodies not joined to the base, no face to be held at.
    CheckFailed : inverted elements.
    """
    held = soundness.base(mesh)
    soundness.require_connected(mesh)
    soundness.require_upright(mesh)
    matrices = _matrices(mesh, materials, cached)
    return Structure(
        stiffness=matrices.stiffness,
        mass=matrices.mass,
        rigid=np.vstack([rigid_transformation(point) for point in mesh.points]),
        held=_dofs(held).ravel(),
        points=mesh.points,
        translations=_dofs(np.arange(len(mesh.points))),
        part_stiffness=matrices.part_stiffness,
        loss_factors={name: made.loss_factor for name, made in materials.items() if made.loss_factor is not None},
    )


def _matrices(mesh: SolidMesh, materials: Mapping[str, Material], cached: bool) -> Matrices:
    """From disk or assembled, exactly symmetric either way."""
    if not cached:
        return packed.unpack_matrices(packed.pack_matrices(assemble(mesh, materials)), mesh.parts)
    moduli = [[materials[name].youngs_modulus, materials[name].poisson_ratio, materials[name].density] for name in mesh.parts]
    name = cache.key("matrices", {"mesh": cache.digest(packed.pack_mesh(mesh)), "materials": moduli})
    kept = cache.load(name)
    if kept is None:
        kept = packed.pack_matrices(assemble(mesh, materials))
        cache.store(name, kept)
    return packed.unpack_matrices(kept, mesh.parts)


def _dofs(nodes: Integers) -> Integers:
    """Degrees of freedom (n, 3) of `nodes` along x, y, z."""
    return np.asarray(3 * nodes[:, None] + np.arange(3), dtype=np.intp)
