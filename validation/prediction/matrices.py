"""`Matrices` of what stands on its base, or is held: the nominal modal basis, changed by effects and never re-diagonalised.

    x = (base, modes, static answers),  K = Phi^T K Phi,  M = | M_rigid  L |,  L = P^T Phi,
                                                              |   L^T    1 |

Beside the kept modes Phi holds static answers of the structure, orthonormal to them in the mass: to accelerations of the base, so
that the residual mass of the truncated modes needs no term of its own (`fem.static_answer`), and to the elastic
forces of every part in the modes of the band, so that a part that is softer, stiffer or lossier than drawn bends the modes as it
bends those of the structure itself (Kirsch, AIAA Journal 29, 1991: the first terms of the series in K^-1 dK are the basis of a
reanalysis). Structural damping stays what it is, S = sum of eta_p K_p beside K; places and parts see all coordinates.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np
import numpy.typing as npt

from fem import damping as damped
from fem.base_excitation import body
from fem.damping import Damping
from fem.factorisers import factorise
from fem.held_base import HeldBase, hold, restricted
from fem.modes import Modes
from fem.static_answer import static_shapes
from fem.structure import Sparse, Structure
from geometry.arrays import Array
from geometry.article import Article
from geometry.frames import rigid_transformation, rigid_transformation_6
from geometry.inertia import Inertia
from validation.effects.stages import Matrices
from validation.flexible.motion import displacement
from validation.flexible.places import nearest_part

BASE = 6

Places = Mapping[str, npt.ArrayLike]
"""(3,) [m] by name, in the article's frame."""

Rows = Mapping[str, Array]
"""(3, f) by place."""

NOWHERE: Places = MappingProxyType({})

BAND = 40.0
"""[Hz] Modes up to here are bent by what parts become; of those above only their own share counts."""

NOTICED = 3e-3
"""Size of an answer beside a mode's own at the top of the band, below which it is no coordinate."""

HEAVY = 0.01
"""Share of the whole mass that a place is made ready to bear."""

ONE_SHEET = ("-bottom", "-top")
"""Endings of parts that are one sheet of material, and one part by the words of the effects; the layer between is another."""


def of_structure(
    structure: Structure,
    modes: Modes,
    places: Places = NOWHERE,
    cog: npt.ArrayLike = (0.0, 0.0, 0.0),
    *,
    damping: Damping | None = None,
    article: Article | None = None,
) -> Matrices:
    """`structure` on its moving base, about the article's origin.

    Parameters
    ----------
    modes : of `structure`, shapes included
    places : (3,) [m] by name, in the article's frame
    cog : (3,) [m] of the article as drawn, from its origin
    damping : that of `modes`; by default the loss factors that the structure brings, as `fem.modes.fixed_base` takes it
    article : what is drawn; its beams' sections then carry the places, else the nodes nearest to them do

    Raises
    ------
    ValueError : modes without shapes, or of other damping.
    """
    free = hold(structure)
    rows = _displacement(structure, free, places, article)
    shapes = _basis(structure, free, modes, free.load, rows)
    own = _own(structure, free, modes, shapes, damping or damped.default(structure), rows)
    L = free.load.T @ shapes
    T = np.eye(BASE + len(own.mass))
    T[:BASE, :BASE] = rigid_transformation_6(modes.reference_point)
    mass = np.block([[structure.rigid_mass, L], [L.T, own.mass]])
    return Matrices(
        base=BASE,
        mass=_symmetric(T.T @ mass @ T),
        stiffness=_on_base(own.stiffness),
        viscous=_on_base(own.viscous),
        structural=_on_base(own.structural),
        places={name: np.hstack([rigid_transformation(at), own.places[name]]) for name, at in places.items()},
        parts={name: _on_base(share) for name, share in own.parts.items()},
        cog=np.asarray(cog, dtype=np.float64),
    )


def held(
    structure: Structure,
    modes: Modes,
    places: Places = NOWHERE,
    *,
    damping: Damping | None = None,
    article: Article | None = None,
) -> Matrices:
    """`structure` with its base held still; static answers to forces at all `places` are among the coordinates.

    Raises
    ------
    ValueError : modes without shapes, or of other damping.
    """
    free = hold(structure)
    rows = _displacement(structure, free, places, article)
    shapes = _basis(structure, free, modes, np.vstack([np.zeros((0, len(free.free))), *rows.values()]).T, rows)
    return _own(structure, free, modes, shapes, damping or damped.default(structure), rows)


def of_inertia(inertia: Inertia, places: Places = NOWHERE) -> Matrices:
    """A rigid body on its moving base, about the article's origin."""
    about = inertia.about(np.zeros(3))
    nothing = np.zeros((BASE, BASE))
    return Matrices(
        base=BASE,
        mass=about.mass_matrix,
        stiffness=nothing,
        viscous=nothing,
        structural=nothing,
        places={name: rigid_transformation(at) for name, at in places.items()},
        cog=about.cog,
    )


def of_modes(modes: Modes, cog: npt.ArrayLike = (0.0, 0.0, 0.0)) -> Matrices:
    """A body of which modal data alone are known: no places and no parts; further modes carry its residual mass.

    Raises
    ------
    BadInput : modes that take more mass than there is, in some direction.
    """
    made = body.of_modal_data("modal data", modes).reduced
    kept = slice(BASE, BASE + modes.frequency.size)
    stiffness, viscous, structural = (np.array(a) for a in (made.stiffness, made.viscous, made.structural))
    stiffness[kept, kept] = np.diag((2 * np.pi * modes.frequency) ** 2)
    viscous[kept, kept], structural[kept, kept] = modes.viscous, modes.structural
    return Matrices(
        base=BASE,
        mass=made.mass,
        stiffness=stiffness,
        viscous=viscous,
        structural=structural,
        cog=np.asarray(cog, dtype=np.float64),
    )


def _basis(structure: Structure, free: HeldBase, modes: Modes, loads: Array, rows: Rows) -> Array:
    """Kept modes and static answers beside them (f, n): to `loads` (f, k), then to what effects at parts and places will pull."""
    if len(modes.shapes) != structure.mass.shape[0]:
        raise ValueError(
            f"`modes` must bring shapes on all {structure.mass.shape[0]} degrees of freedom, found {len(modes.shapes)}"
        )
    shapes = modes.shapes[free.free]
    shapes = np.hstack([shapes, static_shapes(free.stiffness, free.mass, loads, shapes)])
    swinging = modes.shapes[free.free][:, modes.frequency <= BAND]
    pulls = [restricted(K, free.free) @ swinging for K in _parts(structure).values()]
    heavy = HEAVY * np.trace(structure.rigid_mass[:3, :3]) / 3 * (2 * np.pi * BAND) ** 2
    pulls += [heavy * row.T @ (row @ swinging) for row in rows.values()]
    bending = _noticed(free, np.hstack([np.zeros((len(free.free), 0)), *pulls]), shapes)
    return np.hstack([shapes, static_shapes(free.stiffness, free.mass, bending, shapes)]) if bending.size else shapes


def _noticed(free: HeldBase, forces: Array, shapes: Array) -> Array:
    """Those combinations (f, m) of `forces` whose static answers `shapes` do not nearly hold already."""
    if not forces.size:
        return forces
    static = factorise(free.stiffness, definite=True).solve(forces)
    left = static - shapes @ (shapes.T @ (free.mass @ static))
    square, directions = np.linalg.eigh(left.T @ (free.stiffness @ left))
    return np.asarray(forces @ directions[:, square > (NOTICED * 2 * np.pi * BAND) ** 2])


def _own(structure: Structure, free: HeldBase, modes: Modes, shapes: Array, damping: Damping, rows: Rows) -> Matrices:
    """Matrices on `shapes` (f, n) alone, the base held still."""
    n = modes.frequency.size
    S, C_u = damped.structural_matrix(damping, structure), damped.viscous_matrix(damping, structure)
    viscous = np.zeros((shapes.shape[1], shapes.shape[1])) if C_u is None else _congruent(restricted(C_u, free.free), shapes)
    viscous[:n, :n] += damped.per_mode(damping, 2 * np.pi * modes.frequency)
    structural = np.zeros_like(viscous) if S is None else _congruent(restricted(S, free.free), shapes)
    _require_same(viscous[:n, :n], modes.viscous)
    _require_same(structural[:n, :n], modes.structural)
    return Matrices(
        base=0,
        mass=_congruent(free.mass, shapes),
        stiffness=_congruent(free.stiffness, shapes),
        viscous=viscous,
        structural=structural,
        places={name: row @ shapes for name, row in rows.items()},
        parts={name: _congruent(restricted(K, free.free), shapes) for name, K in _parts(structure).items()},
    )


def _parts(structure: Structure) -> dict[str, Sparse]:
    """Stiffness of every part by the words of the effects."""
    parts: dict[str, Sparse] = {}
    for name, K in structure.part_stiffness.items():
        one = sheet(name)
        parts[one] = parts[one] + K if one in parts else K
    return parts


def sheet(part: str) -> str:
    """The part of the structure that `part` is one sheet of; itself where it is none."""
    for ending in ONE_SHEET:
        part = part.removesuffix(ending)
    return part


def _displacement(structure: Structure, free: HeldBase, places: Places, article: Article | None) -> dict[str, Array]:
    """(3, f) by place: what the free degrees of freedom move there."""
    if not places:
        return {}
    points = np.array([np.asarray(at, dtype=np.float64) for at in places.values()])
    parts = np.zeros(len(points), dtype=np.intp) if article is None else nearest_part(article, points)
    whole = displacement(structure, np.eye(free.size)[:, free.free], article, points, parts)
    return dict(zip(places, whole, strict=True))


def _require_same(found: Array, stated: Array) -> None:
    if not np.allclose(found, stated, rtol=1e-6, atol=1e-6 * np.abs(stated).max(initial=0.0)):
        raise ValueError("`damping` must be that of `modes`, found another modal matrix")


def _on_base(own: Array) -> Array:
    return np.pad(own, (BASE, 0))


def _congruent(matrix: Sparse, shapes: Array) -> Array:
    return _symmetric(shapes.T @ (matrix @ shapes))


def _symmetric(matrix: Array) -> Array:
    return np.asarray((matrix + matrix.T) / 2)
