"""The solid model of any article: mesh, matrices and base in one `Structure`, remembered from run to run."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from fem import modes
from fem.damping import Damping
from fem.modes import Modes, Progress
from fem.solid import assembly
from fem.solid.assembly import SolidMesh, assemble
from fem.solid.hexahedra import foot_height, hexahedra
from fem.solid.tetrahedra import FINER, LARGEST_MESH, AnyArticle, Sizing, bodies, tetrahedra
from fem.structure import Sparse, Structure
from geometry import cache
from geometry.article import Article, Material
from geometry.errors import BadInput, CheckFailed
from geometry.frames import Integers, rigid_transformation

PLATE_SIZE, FOOT_SIZE = 0.035, 0.04
"""Width of a hexahedron [m] in plates and, at the least, in the foot, before it is divided by the fineness."""


def structure(
    article: AnyArticle,
    *,
    size: float | None = None,
    fineness: float = 1.0,
    refinement: float = 1.0,
    largest: int = LARGEST_MESH,
    cached: bool = True,
) -> Structure:
    """`article` as a solid on its mounting face, the plane z = min of its counted parts, about its origin.

    A tube with plates on a flange is meshed with hexahedra (`fem.solid.hexahedra`), everything else with curved tetrahedra.

    Parameters
    ----------
    article : a built-in article or stack, or a user's own from STEP files (`geometry.user_article.load`)
    size : largest edge of an element [m]; by default what thickness asks for, see `fem.solid.tetrahedra`
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
    sizing, found = Sizing(size=size, fineness=fineness, refinement=refinement, largest=largest), bodies(article)
    made = _hexahedra(article, sizing)
    if made is None:
        name = cache.key("tetrahedra", {"bodies": [[body.name, body.fingerprint] for body in found], "sizing": sizing.described})
        kept = cache.load(name) if cached else None
        made = tetrahedra(found, sizing) if kept is None else assembly.unpack_mesh(kept)
        if cached and kept is None:
            cache.store(name, assembly.pack_mesh(made))
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
        unknowns = 3 * len(made.points)
        if unknowns > sizing.largest:
            problem = f"hexahedra of {1e3 * size:.3g} mm make {unknowns} degrees of freedom, {sizing.largest} are allowed"
            raise BadInput(f"article {article.name}", "", problem, "Use larger elements, or allow more")
        return made
    raise CheckFailed(f"no valid mesh of hexahedra after {len(FINER)} attempts: {failures[-1]}", failures=tuple(failures))


def of_mesh(mesh: SolidMesh, materials: Mapping[str, Material], *, cached: bool = True) -> Structure:
    """`mesh`, of tetrahedra or hexahedra, with the `materials` of its parts, held where it touches its lowest plane.

    Raises
    ------
    BadInput : a material that is not elastic, bodies not joined to the base, no face to be held at.
    CheckFailed : inverted elements.
    """
    held = assembly.base(mesh)
    assembly.require_connected(mesh)
    assembly.require_upright(mesh)
    # From disk or assembled, exactly symmetric either way
    if not cached:
        matrices = assembly.unpack_matrices(assembly.pack_matrices(assemble(mesh, materials)), mesh.parts)
    else:
        moduli = [[materials[name].youngs_modulus, materials[name].poisson_ratio, materials[name].density] for name in mesh.parts]
        name = cache.key("matrices", {"mesh": cache.digest(assembly.pack_mesh(mesh)), "materials": moduli})
        kept = cache.load(name)
        if kept is None:
            kept = assembly.pack_matrices(assemble(mesh, materials))
            cache.store(name, kept)
        matrices = assembly.unpack_matrices(kept, mesh.parts)
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


def _dofs(nodes: Integers) -> Integers:
    """Degrees of freedom (n, 3) of `nodes` along x, y, z."""
    return np.asarray(3 * nodes[:, None] + np.arange(3), dtype=np.intp)


# Fixed-base modes of a large structure, remembered: what `fem.modes.fixed_base` takes minutes for is there at once next time.
#
# Only what the matrices alone decide is kept. Damping is worked out afresh, so that another loss factor finds the same modes.

_KEPT = ("frequency", "damping_ratio", "participation", "rigid_mass", "residual", "reference_point", "shapes", "viscous")


def fixed_base(
    structure: Structure,
    count: int = 30,
    *,
    damping: Damping | None = None,
    factoriser: str | None = None,
    progress: Progress | None = None,
) -> Modes:
    """`fem.modes.fixed_base` of `structure`, or the same from disk; arguments and errors are the same.

    Raises
    ------
    BadInput, CheckFailed : as `fem.modes.fixed_base`.
    """
    # All that the undamped modes depend on
    content = {
        **{f"stiffness-{name}": array for name, array in _arrays(structure.stiffness).items()},
        **{f"mass-{name}": array for name, array in _arrays(structure.mass).items()},
        "rigid": structure.rigid,
        "held": structure.held,
        "reference_point": structure.reference_point,
    }
    name = cache.key("modes", {"structure": cache.digest(content), "count": count})
    kept = cache.load(name)
    if kept is None:
        solved = modes.fixed_base(structure, count, damping=Damping(ratio=0.0), factoriser=factoriser, progress=progress)
        cache.store(name, {field: getattr(solved, field) for field in _KEPT})
    else:
        solved = Modes(**dict[str, Any](kept))
    return modes.with_damping(solved, structure, damping, factoriser=factoriser)


def _arrays(matrix: Sparse) -> dict[str, np.ndarray]:
    return {"data": matrix.data, "indices": matrix.indices, "starts": matrix.indptr}
