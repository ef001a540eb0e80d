"""The solid model of any article: mesh, matrices and base in one `Structure`, remembered from run to run; mesh convergence."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
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
from geometry.frames import Array, Integers, rigid_transformation

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
    sizing = Sizing(size=size, fineness=fineness, refinement=refinement, largest=largest)
    found = bodies(article)
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
            raise BadInput(source=f"article {article.name}", problem=problem, remedy="Use larger elements, or allow more")
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


# Mesh convergence: how far the finest mesh is from what ever finer ones would give.
#
# Eigenfrequencies of a conforming family of meshes fall towards their limits as f(h) = f + C h^p, each in its place of the
# ordered list (the min-max principle). Three sizes give p, the observed rate, and f by Richardson's extrapolation; smooth modes
# of quadratic elements have p = 4 and re-entrant edges pull it down to about 1. Where three values show no such fall, no rate
# is claimed and the distance is estimated with p = 1, on the safe side (Roache, Verification and Validation in Computational
# Science and Engineering, chapter 5).

BAR = 1e-3
"""Relative distance from the limit that a mode may have, where no other is given for its part."""

BLADE_BAR = 2e-3
"""Of the bending modes of thin blades."""

RATES = (0.2, 8.0)
"""Rates that can be told from three sizes; beyond, something else than h is changing."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Convergence:
    """Eigenfrequencies over the size of the elements.

    Attributes
    ----------
    size : (k,) [m], or any measure in proportion to it, from coarse to fine
    unknowns : (k,) degrees of freedom of the structures
    frequency : (k, n) [Hz]
    rate : (n,) observed p of the three finest; NaN where they show none
    extrapolated : (n,) [Hz]
    distance : (n,) relative distance of the finest from the extrapolated
    bar : (n,) what it may be
    part : part with the largest share of the strain energy, mode by mode
    """

    size: Array
    unknowns: tuple[int, ...]
    frequency: Array
    rate: Array
    extrapolated: Array
    distance: Array
    bar: Array
    part: tuple[str, ...]

    @property
    def converged(self) -> bool:
        """Whether every mode is within its bar."""
        return bool(np.all(self.distance <= self.bar))

    @property
    def verdict(self) -> str:
        """In a sentence."""
        worst = int(np.argmax(self.distance / self.bar))
        mode = f"mode {worst + 1} at {self.frequency[-1, worst]:.4g} Hz ({self.part[worst] or 'no part'})"
        found = f"is {self.distance[worst]:.2%} from its limit, {self.bar[worst]:.2%} allowed"
        beyond = int(np.sum(self.distance > self.bar))
        if not beyond:
            return f"converged: all {len(self.bar)} modes are within their bars; the worst, {mode}, {found}"
        count = f"{beyond} of {len(self.bar)} modes are beyond their bars"
        return f"not converged: {count}; the worst, {mode}, {found}; take a finer mesh"


def convergence_study(
    model: Callable[[float], Structure],
    sizes: Sequence[float],
    count: int = 10,
    *,
    bars: Mapping[str, float] = MappingProxyType({}),
    factoriser: str | None = None,
) -> Convergence:
    """Frequencies of `model` at every one of `sizes`, which it is called with from coarse to fine.

    Parameters
    ----------
    model : structure of a given element size, tetrahedra or hexahedra
    sizes : at least three, each smaller than the one before
    count : of modes
    bars : allowed distance of modes that strain this part most; `BAR` for all others

    Raises
    ------
    BadInput : fewer than three sizes, or not descending.
    """
    h = np.asarray(sizes, dtype=np.float64)
    if len(h) < 3 or np.any(np.diff(h) >= 0) or h[-1] <= 0:
        problem = f"needs three or more positive sizes, from coarse to fine, found {h.tolist()}"
        raise BadInput(source="convergence study", field="sizes", problem=problem, remedy="Give for example 30, 20 and 14 mm")
    frequency, unknowns = [], []
    for size in h:
        structure = model(float(size))
        modes = fixed_base(structure, count, factoriser=factoriser)
        frequency.append(modes.frequency)
        unknowns.append(len(structure.free))
    # The part that each mode strains most; empty names for a structure without parts
    if not structure.part_stiffness:
        parts = tuple("" for _ in modes.frequency)
    else:
        names = tuple(structure.part_stiffness)
        energy = [np.einsum("ij,ij->j", modes.shapes, K @ modes.shapes) for K in structure.part_stiffness.values()]
        parts = tuple(names[int(k)] for k in np.argmax(np.array(energy), axis=0))
    return assessed(h, tuple(unknowns), np.array(frequency), parts, bars)


def assessed(
    size: Array, unknowns: tuple[int, ...], frequency: Array, part: tuple[str, ...], bars: Mapping[str, float]
) -> Convergence:
    """The study of known frequencies (k, n) at `size` (k,)."""
    found = [extrapolation(size[-3:], values) for values in frequency[-3:].T]
    rate, limit, error = (np.array(column) for column in zip(*found, strict=True))
    bar = np.array([bars.get(name, BAR) for name in part])
    return Convergence(
        size=size,
        unknowns=unknowns,
        frequency=frequency,
        rate=rate,
        extrapolated=limit,
        distance=error / limit,
        bar=bar,
        part=part,
    )


def extrapolation(size: Array, value: Array) -> tuple[float, float, float]:
    """Rate, limit and distance of the last of three values from it, for three descending sizes."""
    from scipy.optimize import brentq

    h1, h2, h3 = size / size[-1]
    coarse, fine = value[0] - value[1], value[1] - value[2]

    def ratio(p: float) -> float:
        return float((h1**p - h2**p) / (h2**p - h3**p) * fine - coarse)

    p = brentq(ratio, *RATES) if fine and ratio(RATES[0]) * ratio(RATES[1]) < 0 else np.nan
    error = abs(fine) / (h2 ** (1.0 if np.isnan(p) else p) - 1)
    return float(p), float(value[2] - np.copysign(error, fine)), float(error)
