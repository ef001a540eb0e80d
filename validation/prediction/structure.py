"""`ReducedStructure`: a structure with its mesh on few coordinates, whether it stands, floats or is driven by its base."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.linalg import eigh
from scipy.sparse import csr_array

from fem import damping as fem_damping
from fem.damping import Damping, default_damping, symmetric
from fem.factorisers import Factor, factorise
from fem.modes import Modes, floating_shift, lowest, static_shapes
from fem.structure import LOOSE, Carrier, HeldBase, Sparse, Structure, gradients, hold, place_rows, position_of, restricted
from geometry.article import Article
from geometry.errors import BadInput, CheckFailed
from geometry.frames import Array, Integers, rigid_transformation, rigid_transformation_6
from geometry.inertia import Inertia
from validation.effects.effect import position
from validation.effects.families.layer_damping import LAYER
from validation.effects.stages import JointSprings, Kept, Matrices, Shares, each
from validation.flexible.model import nearest_part
from validation.flexible.modes import displacement

# `Matrices` of what stands on its base, or is held: the nominal modal basis, changed by effects and never re-diagonalised.
#
#     x = (base, modes, static answers),  K = Phi^T K Phi,  M = | M_rigid  L |,  L = P^T Phi,
#                                                               |   L^T    1 |
#
# Beside the kept modes Phi holds static answers of the structure, orthonormal to them in the mass: to accelerations of the base,
# so that the residual mass of the truncated modes needs no term of its own (`fem.modes`), and to the elastic forces of
# every part in the modes of the band, so that a part that is softer, stiffer or lossier than drawn bends the modes as it bends
# those of the structure itself (Kirsch, AIAA Journal 29, 1991: the first terms of the series in K^-1 dK are the basis of a
# reanalysis). Structural damping stays what it is, S = sum of eta_p K_p beside K; places and parts see all coordinates.

BASE = 6

Places = Mapping[str, npt.ArrayLike]
"""(3,) [m] by name, in the article's frame."""

Rows = Mapping[str, Array]
"""(3, f) by place."""

LEAST = float(np.finfo(np.float64).tiny)

SMALL = 1e-10
"""Share of the largest below which a spring or a mass is taken for none: rounding of what others computed."""

NOWHERE: Places = MappingProxyType({})

BAND = 40.0
"""[Hz] Modes up to here are bent by what parts become; of those above only their own share counts."""

HIGHEST = 50.0
"""[Hz] Modes above it answer quietly: their frequency, damping and participation are what was computed."""

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
    band: float = BAND,
) -> Matrices:
    """`structure` on its moving base, about the article's origin; its own places come along.

    Parameters
    ----------
    modes : of `structure`, shapes included
    places : (3,) [m] by name, in the article's frame
    cog : (3,) [m] of the article as drawn, from its origin
    damping : that of `modes`; by default the loss factors that the structure brings, as `fem.modes.fixed_base` takes it
    article : what is drawn; its beams' sections then carry the places, else the nodes nearest to them do
    band : [Hz] up to which effects on the structure are to be right

    Raises
    ------
    ValueError : modes without shapes, or of other damping.
    """
    free = hold(structure)
    rows = _displacement(structure, free, places, article)
    shapes = _basis(structure, free, modes, rows, band)
    used = damping or fem_damping.default_damping(structure)
    own = _on_shapes(structure, free, shapes, rows, modes.frequency, used, modes)
    return _driven(structure, own, _motions(structure, free, shapes), places, cog)


def _motions(structure: Structure, free: HeldBase, shapes: Array) -> Array:
    """(N, 6 + k) what all degrees of freedom move with a base about the article's origin, and by `shapes` (f, k)."""
    return np.hstack([structure.rigid @ rigid_transformation_6(structure.reference_point), free.expand(shapes)])


def _driven(
    structure: Structure, own: Matrices, moved: Array, places: Places = NOWHERE, cog: npt.ArrayLike = (0.0, 0.0, 0.0)
) -> Matrices:
    """What moves as `moved` (N, 6 + k), `own` its matrices while the base is held still."""
    carried = moved[:, :BASE]
    rides = {name: rigid_transformation(at) for name, at in places.items()}
    rides |= {name: row @ carried for name, row in structure.places.items()}

    def on_base(share: Array) -> Array:
        """(6 + k, 6 + k) of a share of the stiffness, which no rigid motion strains."""
        return np.pad(share, (BASE, 0))

    T66 = rigid_transformation_6(structure.reference_point)
    L = (structure.mass @ carried).T @ moved[:, BASE:]
    mass = np.block([[T66.T @ structure.rigid_mass @ T66, L], [L.T, own.mass]])
    return Matrices(
        base=BASE,
        mass=symmetric(mass),
        stiffness=on_base(own.stiffness),
        viscous=on_base(own.viscous),
        structural=on_base(own.structural),
        places={name: np.hstack([there, own.places[name]]) for name, there in rides.items()},
        parts=each(own.parts, on_base),
        cog=np.asarray(cog, dtype=np.float64),
        part_mass=each(_held(structure.part_mass, len(mass)), lambda share: _on_its_own(share, moved)),
        supports=own.supports,
        joints={name: replace(one, loads=np.pad(one.loads, ((0, 0), (BASE, 0)))) for name, one in own.joints.items()},
        sections=each(own.sections, lambda both: (on_base(both[0]), on_base(both[1]))),
        unresolved=each(own.unresolved, on_base),
        shells=own.shells,
        geometric=_congruent(sum(structure.geometric.values()), moved) if structure.geometric else np.zeros((0, 0)),
    )


def _basis(structure: Structure, free: HeldBase, modes: Modes, rows: Rows, band: float) -> Array:
    """Kept modes and static answers beside them (f, n): to accelerations of the base, then to what effects will pull."""
    shapes = _kept(structure, free, modes)
    shapes = np.hstack([shapes, static_shapes(free.stiffness, free.mass, free.load, shapes)])
    swinging = modes.shapes[free.free][:, modes.frequency <= band]
    pulls = [restricted(K, free.free) @ swinging for K in parts_of(structure).values()]
    heavy = HEAVY * np.trace(structure.rigid_mass[:3, :3]) / 3 * (2 * np.pi * band) ** 2
    pulls += [heavy * row.T @ (row @ swinging) for row in rows.values()]
    # Those combinations (f, m) of `forces` whose static answers `shapes` do not nearly hold already
    forces = np.hstack([np.zeros((len(free.free), 0)), *pulls])
    if not forces.size:
        bending = forces
    else:
        static = factorise(free.stiffness, definite=True).solve(forces)
        left = static - shapes @ (shapes.T @ (free.mass @ static))
        square, directions = np.linalg.eigh(left.T @ (free.stiffness @ left))
        bending = np.asarray(forces @ directions[:, square > (NOTICED * 2 * np.pi * band) ** 2])
    return np.hstack([shapes, static_shapes(free.stiffness, free.mass, bending, shapes)]) if bending.size else shapes


def _kept(structure: Structure, free: HeldBase, modes: Modes) -> Array:
    """(f, n) what the free degrees of freedom move in `modes`."""
    if len(modes.shapes) != structure.mass.shape[0]:
        raise ValueError(
            f"`modes` must bring shapes on all {structure.mass.shape[0]} degrees of freedom, found {len(modes.shapes)}"
        )
    return modes.shapes[free.free]


def _on_shapes(
    structure: Structure,
    free: HeldBase,
    shapes: Array,
    rows: Rows,
    frequency: Array,
    damping: Damping,
    modes: Modes | None = None,
    known: Matrices | None = None,
) -> Matrices:
    """Matrices on `shapes` (f, k) alone, the base held still; the first of them are the modes of `frequency` (n,).

    On the first of them they are `known`, of a base or of none; of the others nothing that is `unresolved` is looked for then.
    """
    n, few = frequency.size, slice(known.base if known else 0, None)

    def on_shapes(share: Sparse, old: Array | None = None) -> Array:
        own = restricted(share, free.free)
        return _on_its_own(own, shapes) if old is None else symmetric(_bordered(old[few, few], own, shapes))

    def by_name(shares: Mapping[str, Sparse], old: Mapping[str, Array]) -> Mapping[str, Array]:
        if isinstance(held := _held(shares, shapes.shape[1]), Shares):
            return each(held, on_shapes)
        return {name: on_shapes(share, old.get(name)) for name, share in held.items()}

    S, C_u = fem_damping.structural_matrix(damping, structure), fem_damping.viscous_matrix(damping, structure)
    viscous = np.zeros((shapes.shape[1], shapes.shape[1])) if C_u is None else _congruent(restricted(C_u, free.free), shapes)
    viscous[:n, :n] += fem_damping.damping_per_mode(damping, 2 * np.pi * frequency)
    structural = np.zeros_like(viscous) if S is None else on_shapes(S, known.structural if known else None)
    if modes is not None:
        _require_same(viscous[:n, :n], modes.viscous)
        _require_same(structural[:n, :n], modes.structural)
    squares = np.pad((2 * np.pi * frequency) ** 2, (0, shapes.shape[1] - n))
    if known is not None:
        unresolved = each(known.unresolved, lambda share: np.pad(share[few, few], (0, len(viscous) - len(share[few]))))
    else:
        unresolved = {} if structure.elements is None else _unresolved(structure.elements, free.expand(shapes), squares)
    K = structure.part_stiffness
    springs = {name: both for name in structure.joints if (both := joint_springs(structure, name)) is not None}
    whole = free.expand(shapes) if springs else shapes
    return Matrices(
        base=0,
        mass=on_shapes(structure.mass, known.mass if known else None),
        stiffness=on_shapes(structure.stiffness, known.stiffness if known else None),
        viscous=viscous,
        structural=structural,
        places={name: row @ shapes for name, row in rows.items()},
        parts=by_name(parts_of(structure), known.parts if known else {}),
        part_mass=by_name(structure.part_mass, known.part_mass if known else {}),
        supports=structure.supports,
        joints={
            name: JointSprings(loads=loads @ whole, stiffness=six, trace=float(np.trace(_congruent(K[name], whole))))
            for name, (loads, six) in springs.items()
        },
        sections=each(_held(structure.sections, shapes.shape[1]), lambda both: (on_shapes(both[0]), on_shapes(both[1]))),
        unresolved=unresolved,
        shells=() if structure.elements is None else tuple(_by_sheet(dict.fromkeys(structure.elements.shells, 0))),
        geometric=on_shapes(sum(structure.geometric.values())) if structure.geometric else np.zeros((0, 0)),
    )


WHOLE = 1e9
"""[B] that shares of parts on all coordinates may take, an eighth of what a structure of 300,000 degrees of freedom may; larger
ones are made of what the mesh has of a part whenever they are asked for. Held by test_any_structure.py."""


def _held(shares: Mapping[str, Kept], count: int) -> Mapping[str, Kept]:
    """`shares`, of which on `count` coordinates each is made once, or when it is asked for."""
    return shares if 8 * count**2 * len(shares) <= WHOLE else Shares(shares, shares.__getitem__)


def _unresolved(elements: Carrier, whole: Array, squares: Array) -> Mapping[str, Array]:
    """By part (k, k) how much too stiff the mesh is to shapes `whole` (n, k); see `fem.mesh.places.Elements.unresolved`."""
    sheets = _held(_by_sheet({name: (name,) for name in elements.parts}), whole.shape[1])
    if isinstance(sheets, Shares):
        return each(sheets, lambda names: np.sum(list(elements.unresolved(whole, squares, names).values()), axis=0))
    return _by_sheet(elements.unresolved(whole, squares))


def parts_of(structure: Structure) -> dict[str, Sparse]:
    """Stiffness of every part by the words of the effects."""
    return _by_sheet(structure.part_stiffness)


def _by_sheet(shares: Mapping[str, Any]) -> dict[str, Any]:
    """Shares of parts, those of the sheets of one laminate added up."""
    parts: dict[str, Any] = {}
    for name, share in shares.items():
        one = sheet(name) if f"{sheet(name)}{LAYER}" in shares else name
        parts[one] = parts[one] + share if one in parts else share
    return parts


def sheet(part: str) -> str:
    """The part of the structure that `part` is one sheet of; itself where it is none."""
    for ending in ONE_SHEET:
        part = part.removesuffix(ending)
    return part


def _displacement(structure: Structure, free: HeldBase, places: Places, article: Article | None) -> dict[str, Array]:
    """(3, f) by place, first `places`, then those of the structure itself: what the free degrees of freedom move there."""
    own = {name: np.asarray(row.toarray()[:, free.free]) for name, row in structure.places.items()}
    if not places:
        return own
    points = np.array([np.asarray(at, dtype=np.float64) for at in places.values()])
    parts = np.zeros(len(points), dtype=np.intp) if article is None else nearest_part(article, points)
    whole = displacement(structure, np.eye(free.size)[:, free.free], article, points, parts)
    return {**dict(zip(places, whole, strict=True)), **own}


def _require_same(found: Array, stated: Array) -> None:
    if not np.allclose(found, stated, rtol=1e-6, atol=1e-6 * np.abs(stated).max(initial=0.0)):
        raise ValueError("`damping` must be that of `modes`, found another modal matrix")


def _congruent(matrix: Sparse, shapes: Array) -> Array:
    return symmetric(shapes.T @ (matrix @ shapes))


# A basis for effects of any size: static answers to what they pull, and to what the modes leave over once they have pulled.
#
# An effect that changes K by dK turns a mode by the series x = phi - K^-1 dK phi + ..., and one that changes M by dM likewise
# with lambda dM (Kirsch, AIAA Journal 29, 1991). Its first term tells small sizes. Then every part, support and density is
# changed for good, and the modes on the basis leave r = (K + dK) phi - lambda (M + dM) phi, to which K^-1 r is the next answer,
# again and again, as an eigen-solver with a preconditioner goes on (A. V. Knyazev, SIAM Journal on Scientific Computing 23
# (2001), 517); in between Rayleigh's quotient is wrong by the square of what is left out. What springs few degrees of freedom,
# as supports and joints do, is pulled along each of its own springs, too. Every pull is measured by the change of a mode that
# it makes, so that one number says what may be left out. All is orthonormal in A = K, or in K + s M where the structure floats.
# Parts are answered one by one, beside the modes and what places ask for, and only what the modes of its changes have of its
# answers is put together: what a part costs does not grow with the number of the others.

LEFT_OUT = 1e-3
"""Share of the change that a pull makes, by energy, that may lie outside the basis."""

ORTHOGONAL = 1e-3
"""[1] Cosine beyond which a coordinate is not outside others. Held by test_blind_structures.py."""

FAR = (-0.6, 2.0)
"""Relative changes of a density to which the basis is made. Held by test_any_structure.py."""

FAR_MODULUS = (-0.97, *FAR)
"""Those of a modulus, which may fall to next to nothing. Held by test_part_nearly_gone.py."""

FAR_THICKNESS = (-0.4, 0.6)
"""Those of a thickness. Held by test_any_structure.py."""

FAR_SUPPORT = (-0.95, 20.0)
"""Those of a support's stiffness. Held by test_any_structure.py."""

ROUNDS = 3
"""[count] of times that what the modes leave over is answered, of each of these changes. Held by test_any_structure.py."""

SLIGHT = 0.03
"""Share of the largest change of a squared frequency below which a mode's is not measured. Held by test_any_structure.py."""

SURE = 1.5
"""[factor] on what is left over, for K^-1 is not that of the changed structure. Held by test_any_structure.py."""

FAINT = 1e-3
"""Share of a mode's energy below which a part is not measured by its own share."""

SOFTER = 0.1
"""[share] of a part's stiffness by which its change must be right in what places give. Held by test_blind_structures.py."""

FEW_SPRINGS = 24
"""Up to so many springs are pulled one by one."""

HEAVIEST = 0.1
"""Mass at a place, as a share of what the modes have there, at which its static answer must be right."""

REACH = 1.5
"""Modes up to so far above the band may come into it, and are bent too."""


def bent_far(
    structure: Structure,
    free: HeldBase,
    shapes: Array,
    frequency: Array,
    rows: Rows,
    band: float,
    shift: float = 0.0,
    factor: Factor | None = None,
) -> Array:
    """`shapes` (f, n) with static answers beside them that make effects of any size right up to `band` [Hz].

    Parameters
    ----------
    shapes : the modes of `frequency` (m,) first; all independent
    shift : [rad²/s²] s of A = K + s M
    factor : of A, if there is one already
    """
    A = free.stiffness + shift * free.mass if shift else free.stiffness
    factor = factor or factorise(A.tocsc(), definite=True)
    chosen = frequency <= max(REACH * band, frequency.min(initial=np.inf))  # what a place moves is told by a mode at least
    swinging, omega = shapes[:, : len(frequency)][:, chosen], 2 * np.pi * frequency[chosen]
    top, first = 2 * np.pi * band, shapes.shape[1]
    root = np.linalg.cholesky(shapes.T @ (A @ shapes))
    common = np.asarray(np.linalg.solve(root, shapes.T).T, dtype=np.float64)  # orthonormal in A, as all that is added

    def new(basis: Array, static: Array) -> Array:
        """What counts of `static` (f, c) outside `basis`: columns orthogonal in A, as long as they count."""
        left = static - basis @ (basis.T @ (A @ static))
        left -= basis @ (basis.T @ (A @ left))
        square, directions = np.linalg.eigh(left.T @ (A @ left))
        room = len(basis) - basis.shape[1]  # a small structure has no more than its degrees of freedom
        return np.asarray(left @ directions[:, (square > LEFT_OUT) & (np.arange(len(square)) >= len(square) - room)])

    def grown(basis: Array, more: Array) -> Array:
        """`basis` and what is `new` to it."""
        unit = more / np.sqrt(np.sum(more * (A @ more), axis=0))
        if np.abs(basis.T @ (A @ unit)).max(initial=0.0) > ORTHOGONAL:  # what is little of a large answer is rounding
            return grown(basis, new(basis, unit))
        return np.hstack([basis, unit])

    def swings(K: Array, M: Array) -> tuple[Array, Array]:
        """Squares of circular frequencies, ascending, and shapes of unit mass; static answers without mass swing at none."""
        share, shape = eigh(M, K + shift * M)
        share = np.maximum(share[::-1], np.finfo(np.float64).eps ** 2 * share[-1])
        return 1 / share - shift, shape[:, ::-1] / np.sqrt(share)

    for row in rows.values():
        moved = np.sum((row @ swinging) ** 2, axis=1)
        mass = 1 / np.maximum(moved, SMALL * moved.max() + LEAST)
        common = grown(common, new(common, np.asarray(factor.solve(row.T * top * np.sqrt(HEAVIEST * mass)))))
    answers = common[:, first:]  # of places, to which a change of a part answers again: most of what is read where little moves
    wholes = [(common.T @ (one @ common), one) for one in (free.stiffness, free.mass)]
    parts, none = parts_of(structure), csr_array(free.stiffness.shape)

    def answered(name: str) -> Array:
        """Answers (f, c) to all that may become of a part, beside modes and places."""
        basis, found = common, [common[:, :0]]

        def add(pull: Array) -> Array:
            nonlocal basis
            more = new(basis, np.asarray(factor.solve(pull), dtype=np.float64))
            basis = grown(basis, more)
            return more

        by_kind = (parts, structure.part_mass, structure.geometric)
        own, heavy, weighed = (restricted(of[name], free.free) if name in of else none for of in by_kind)
        both = [restricted(share, free.free) for share in structure.sections.get(name, ())]
        springs = _springs(own) if name in (*structure.supports, *structure.joints) else None
        if springs is not None:
            found.append(add(springs))
        elif answers.size and own.nnz:
            strain, directions = np.linalg.eigh(answers.T @ (own @ answers))
            found.append(add(SOFTER * own @ (answers @ directions[:, strain > LEFT_OUT])))
        stiff = [*both, weighed] if both or springs is not None else [own, weighed]
        for share, power in (*((share, 0) for share in stiff if share.nnz), *([(heavy, 2)] if heavy.nnz else [])):
            pull = (share @ swinging) * omega**power
            work = np.abs(np.sum(swinging * pull, axis=0))
            found.append(add(pull / np.sqrt(np.maximum(work, FAINT * omega**2))))
        changes = [(size * own, none) for size in (FAR_SUPPORT if name in structure.supports else FAR_MODULUS) if own.nnz]
        thicker = [(size * both[0] + ((1 + size) ** 3 - 1) * both[1], size * heavy) for size in FAR_THICKNESS if both]
        changes += [*thicker, *((none, size * heavy) for size in FAR if heavy.nnz)]
        K, M = (_bordered(*one, basis) for one in wholes)
        for dK, dM in changes:
            known, bent = swings(K, M)[0], common[:, :0]
            for count in range(ROUNDS + 1):
                square, shape = swings(K + _on_its_own(dK, basis), M + _on_its_own(dM, basis))
                low = np.flatnonzero((square > SMALL * top**2) & (square <= top**2))
                moved = np.abs(square[low] - known[low])
                if not moved.any():
                    break
                bent = SURE * basis @ shape[:, low] / np.sqrt(np.maximum(moved, SLIGHT * moved.max()))
                left = free.stiffness @ bent + dK @ bent - (free.mass @ bent + dM @ bent) * square[low]
                if count == ROUNDS or not add(left).size:
                    break
                K, M = (_bordered(old, one, basis) for old, (_, one) in zip((K, M), wholes, strict=True))
            found.append(bent)
        for dK, _ in thicker if answers.size else ():  # bent and stretched otherwise, as no straight line tells
            for count in range(ROUNDS + 1):
                ones = np.eye(basis.shape[1])  # A on the basis, of which `answers` are some columns
                bent = basis @ np.linalg.solve(ones + _on_its_own(dK, basis), ones[:, first : common.shape[1]])
                if count == ROUNDS or not add(A @ (answers - bent) - dK @ bent).size:
                    break
            found.append(bent)
        return new(common, np.hstack(found))

    basis = common
    ties = (*structure.supports, *structure.joints)
    for name in dict.fromkeys([*ties, *parts, *structure.sections, *structure.part_mass, *structure.geometric]):
        basis = grown(basis, new(basis, answered(name)))
    return np.hstack([shapes, top * basis[:, first:]])


def _on_its_own(share: Sparse, basis: Array) -> Array:
    """(k, k) of the share of a part on `basis` (f, k), of whose rows most are none of its."""
    found = share.tocsr()
    own = np.flatnonzero(np.diff(found.indptr))
    return _congruent(found[own][:, own], basis[own])


def _bordered(old: Array, whole: Sparse, basis: Array) -> Array:
    """`whole` on `basis` (f, k), of which `old` is it on the first columns."""
    n = len(old)
    side = basis.T @ (whole @ basis[:, n:])
    return np.block([[old, side[:n]], [side[:n].T, side[n:]]])


def _springs(share: Sparse) -> Array | None:
    """(f, m) b with share = b b^T where there are few such springs, else None."""
    own = np.flatnonzero(share.diagonal())
    if not 0 < len(own) <= 8 * FEW_SPRINGS:
        return None
    square, directions = np.linalg.eigh(share[own][:, own].toarray())
    kept = np.abs(square) > SMALL * np.abs(square).max()
    if np.sum(kept) > FEW_SPRINGS:
        return None
    found = np.zeros((share.shape[0], int(np.sum(kept))))
    found[own] = directions[:, kept] * np.sqrt(np.abs(square[kept]))
    return found


def joint_springs(structure: Structure, name: str) -> tuple[Array, Array] | None:
    """What the joint `name` carries (6, n) for a unit of each degree of freedom, and its six springs; None where its sides cannot
    be told.

    The sides are the parts that its degrees of freedom belong to, or other joints where there is no part; a spring to the ground
    tells none. A joint of one side ties it to the ground. One side moved as a rigid body gives the 6x6 stiffness, whose centre is
    where a push does not turn; springs are those along and about the axes there.
    """
    K = structure.part_stiffness[name]
    own = np.flatnonzero(K.diagonal())
    telling = [part for part in structure.part_stiffness if part not in (name, *structure.supports)]
    there = np.array([structure.part_stiffness[part].diagonal()[own] != 0 for part in telling]).reshape(-1, len(own))
    joint = np.isin(telling, structure.joints)
    there[joint] &= ~there[~joint].any(axis=0)
    kinds, side = np.unique(there, axis=1, return_inverse=True)
    if kinds.shape[1] > 2:
        return None
    moved = np.zeros_like(structure.rigid)
    one = own[side.ravel() == np.argmax(np.bincount(side.ravel()))]  # where the other is guided, it moves in fewer ways
    moved[one] = structure.rigid[one]
    loads = np.asarray(K @ moved)
    whole = symmetric(moved.T @ loads)
    turns = np.cross(np.eye(3)[:, None], np.eye(3)[None]).transpose(0, 2, 1)  # turns[i] @ u = e_i x u
    coupling = np.stack([-(whole[:3, :3] @ turn).ravel() for turn in turns], axis=1)
    size = np.abs(np.diag(whole)).max(initial=0.0)
    if not size:
        return None
    centre = np.linalg.lstsq(coupling, whole[:3, 3:].ravel(), rcond=SMALL)[0]
    R = np.linalg.inv(rigid_transformation_6(centre))
    six = np.diag(R.T @ whole @ R)
    kept = six > SMALL * np.repeat([six[:3].max(), max(six[3:].max(), LEAST)], 3)
    return np.where(kept[:, None], (loads @ R).T, 0.0), np.where(kept, six, 0.0)


# A structure with its mesh: it stands on the ground, floats, or is driven by its base.

ABOVE = 2.0
"""Modes are kept up to so far above the band, each as unsure as those in it; static answers stand for the others."""

FIRST_ASKED = 16
"""Modes that are asked for at first."""


@dataclass(frozen=True, eq=False, kw_only=True)
class ReducedStructure:
    """A structure on few coordinates.

    Attributes
    ----------
    structure : all of it, and `damping` where it is not that of its parts
    band : [Hz] where tests of it end
    matrices : about its origin; of base 0 unless it was made `on_base`
    frequency : (m,) [Hz] of the elastic modes, the first coordinates behind the base; then come rigid motions, if it floats, and
        static answers
    losses : loss factor by part; none where damping is given by mode
    basis : (N, k) displacement of all degrees of freedom for each coordinate
    swings : (N, m) what is held beside what `by_itself` or `on_base` makes; see `swinging_as`
    """

    structure: Structure
    damping: Damping | None
    band: float
    matrices: Matrices
    frequency: Array
    losses: Mapping[str, float]
    basis: Array
    swings: Array | None = None

    def at(self, positions: Sequence[str], *, anew: bool = True) -> "ReducedStructure":
        """The same made ready for effects at further `positions`, which are written as coordinates.

        Parameters
        ----------
        anew : reduced once more; else static answers there come beside the coordinates that there are, to which parts that
            change do not answer again: for what is tried, at a part of the cost

        Raises
        ------
        BadInput : outside the mesh, or no coordinates are known.
        """
        whole = with_positions(self.structure, positions)
        if anew:
            free, b = hold(whole), self.matrices.base
            moves = self.matrices.rigid[:, b:]
            moves = moves[:, : len(self.frequency) + np.count_nonzero(moves.any(axis=0))]
            shapes = self.basis[free.free, b : b + moves.shape[1]]
            made = _reduced(whole, self.band, self.damping, free, shapes, self.frequency, moves, self.matrices.cog, driven=b > 0)
            return made if self.swings is None else replace(made._beside(whole, self.swings), swings=self.swings)
        if whole is self.structure:
            return self
        free = hold(whole)
        soft = 0.1 * (2 * np.pi * self.frequency[0]) ** 2 if self.matrices.rigid.any() else 0.0
        rows = _displacement(whole, free, NOWHERE, None)
        loads = np.vstack([row for name, row in rows.items() if name not in self.structure.places]).T
        static = factorise((free.stiffness + soft * free.mass).tocsc(), definite=True).solve(loads)
        return self._beside(whole, free.expand(np.asarray(static)))

    def swinging_as(self, stiffness: Sparse, mass: Sparse) -> "ReducedStructure":
        """The same whose coordinates hold, too, how the structure swings up to the end of the band and gives at its places with
        these matrices instead of its own: whatever changed that far is then what it is to the whole structure.

        Raises
        ------
        CheckFailed : part of it swings freely, or as `fem.modes.lowest`.
        """
        free = hold(replace(self.structure, stiffness=stiffness.tocsr(), mass=mass.tocsr()))
        shift = floating_shift(free.stiffness, free.mass) if self.structure.floating else 0.0
        count, most = min(FIRST_ASKED, self.basis.shape[1]), min(self.basis.shape[1], len(free.free))
        while (pairs := lowest(free.stiffness, free.mass, count, shift=shift)).values[-1] < (REACH * 2 * np.pi * self.band) ** 2:
            if count >= most:
                break
            count = min(2 * count, most)
        rows = _displacement(self.structure, free, NOWHERE, None)
        A = (free.stiffness - shift * free.mass).tocsc()
        factor = pairs.factor or factorise(A, definite=True)
        gives = factor.solve(np.vstack([np.zeros((0, len(free.free))), *rows.values()]).T)
        both = np.hstack([each / np.sqrt(np.sum(each * (A @ each), axis=0) + LEAST) for each in (pairs.vectors, gives)])
        more = free.expand(both) if self.swings is None else np.hstack([self.swings, free.expand(both)])
        return replace(self._beside(self.structure, free.expand(both)), swings=more)

    def _beside(self, whole: Structure, more: Array) -> "ReducedStructure":
        """`whole`, which is the structure with any places, on the coordinates that there are and what is new of `more` (N, c)."""
        free, of, b = hold(whole), self.matrices, self.matrices.base
        shapes, top = self.basis[free.free, b:], 2 * np.pi * self.band
        soft = 0.1 * (2 * np.pi * self.frequency[0]) ** 2 if of.rigid[:, b:].any() else 0.0
        A = free.stiffness + soft * free.mass
        static = more[free.free]
        own, whole_energy = shapes.T @ (A @ shapes), np.sum(static * (A @ static), axis=0).max(initial=LEAST)
        for _ in range(2):  # once more, for what rounding leaves of it
            static = static - shapes @ np.linalg.solve(own, shapes.T @ (A @ static))
        energy, directions = np.linalg.eigh(static.T @ (A @ static))
        kept = energy > SMALL * whole_energy  # what is there already leaves rounding alone
        more = top * static @ (directions[:, kept] / np.sqrt(energy[kept]))
        basis, moves = np.hstack([shapes, more]), np.pad(of.rigid[:, b:], ((0, 0), (0, more.shape[1])))
        rows = _displacement(whole, free, NOWHERE, None)
        made = _on_basis(whole, self.band, self.damping, free, basis, rows, self.frequency, moves, of.cog, b > 0, of)
        return replace(made, swings=self.swings)

    def nodes(self) -> tuple[Array, Integers]:
        """(p, 3) [m] nodes that move, and (p, 3) the rows of `basis` by which they do, -1 where they are held."""
        whole = self.structure
        moving = (np.any(self.basis[whole.translations.ravel()], axis=1).reshape(-1, 3) & (whole.translations >= 0)).any(axis=1)
        return whole.points[moving], whole.translations[moving]


def by_itself(structure: Structure, band: float, *, damping: Damping | None = None) -> ReducedStructure:
    """`structure` as it stands on the ground or floats, with all modes up to twice `band` [Hz], where tests end.

    Raises
    ------
    CheckFailed : part of it swings freely, or as `fem.modes.lowest`.
    """
    free = hold(structure)
    K, M = free.stiffness, free.mass
    rigid = np.zeros((len(free.free), 0))
    shift = 0.0
    if not structure.grounded and not structure.held.size:
        square, directions = np.linalg.eigh(structure.rigid_mass)
        kept = square > SMALL * square.max()
        rigid = structure.rigid[free.free] @ (directions[:, kept] / np.sqrt(square[kept]))
        shift = floating_shift(K, M)
    count, top = FIRST_ASKED, (2 * np.pi * ABOVE * band) ** 2
    while True:
        pairs = lowest(K, M, count + rigid.shape[1], shift=shift)
        if len(pairs.values) < count + rigid.shape[1] or pairs.values[-1] > top or count >= len(free.free):
            break
        count *= 2
    left = pairs.vectors - rigid @ (rigid.T @ (M @ pairs.vectors))
    elastic = np.sum(left * (M @ left), axis=0) > 0.5  # a mode is all rigid or not at all
    values, vectors = pairs.values[elastic], left[:, elastic]
    chosen = np.arange(len(values)) < max(int(np.sum(values <= top)), 1)
    values, vectors = values[chosen], vectors[:, chosen] / np.sqrt(np.sum(vectors * (M @ vectors), axis=0))[chosen]
    strain = np.sum(np.abs(vectors) * (abs(K) @ np.abs(vectors)), axis=0)
    if np.any(values <= LOOSE * strain):
        raise CheckFailed(
            f"{np.sum(values <= LOOSE * strain)} modes beside the rigid ones have zero frequency: part of the structure swings "
            "freely. Hold it, or stiffen the joint."
        )
    frequency = np.sqrt(values) / (2 * np.pi)
    factor = None if rigid.size else pairs.factor
    del pairs, left  # of what floats the factors are others, and the first need not stay
    shapes, moves, cog = np.hstack([vectors, rigid]), np.zeros((6, len(values) + rigid.shape[1])), np.zeros(3)
    if rigid.size:
        T = np.linalg.inv(rigid_transformation_6(structure.reference_point))
        moves[:, len(values) :] = T @ directions[:, kept] / np.sqrt(square[kept])
        if structure.rigid_mass[0, 0] > 0:
            cog = Inertia.from_mass_matrix(structure.rigid_mass, structure.reference_point).about(np.zeros(3)).cog
    return _reduced(structure, band, damping, free, shapes, frequency, moves, cog, factor=factor)


def on_base(
    structure: Structure, modes: Modes, band: float, cog: npt.ArrayLike, *, damping: Damping | None = None
) -> ReducedStructure:
    """`structure` on its moving base with the `modes` of its `damping` and all of its mesh; what effects at parts and places do
    is, at any size, what they do to the whole structure."""
    free, none, at = hold(structure), np.zeros((6, modes.frequency.size)), np.asarray(cog, dtype=np.float64)
    return _reduced(structure, band, damping, free, _kept(structure, free, modes), modes.frequency, none, at, driven=True)


def _reduced(
    structure: Structure,
    band: float,
    damping: Damping | None,
    free: HeldBase,
    shapes: Array,
    frequency: Array,
    moves: Array,
    cog: Array,
    *,
    driven: bool = False,
    factor: Factor | None = None,
) -> ReducedStructure:
    """`structure` on `shapes` (f, n), first the modes of `frequency` (m,) [Hz], which it moves by `moves` (6, n) as a rigid body,
    and on what `bent_far` adds to them, and to static answers to a base that is `driven`."""
    rows = _displacement(structure, free, NOWHERE, None)
    soft = 0.1 * (2 * np.pi * frequency[0]) ** 2 if moves.any() else 0.0
    given = np.hstack([shapes, static_shapes(free.stiffness, free.mass, free.load, shapes)]) if driven else shapes
    basis = bent_far(structure, free, given, frequency, rows, band, soft, factor)
    moves = np.pad(moves, ((0, 0), (0, basis.shape[1] - moves.shape[1])))
    return _on_basis(structure, band, damping, free, basis, rows, frequency, moves, cog, driven)


def _on_basis(
    structure: Structure,
    band: float,
    damping: Damping | None,
    free: HeldBase,
    basis: Array,
    rows: Rows,
    frequency: Array,
    moves: Array,
    cog: Array,
    driven: bool = False,
    known: Matrices | None = None,
) -> ReducedStructure:
    """`structure` on the coordinates `basis` (f, k), first the modes of `frequency`; `moves` (6, k) as a rigid body. The motions
    of a base that is `driven` come before them."""
    used = damping or default_damping(structure)
    made = _on_shapes(structure, free, basis, rows, frequency, used, known=known)
    moved = _motions(structure, free, basis) if driven else free.expand(basis)
    slopes = gradients(structure, tuple(structure.places), moved)
    if driven:
        made = replace(_driven(structure, made, moved, cog=cog), gradients=slopes)
    else:
        strains = np.where(moves.any(axis=0), 0.0, 1.0)  # rounding beside a stiff joint strains rigid motions as a soft mode does
        stiffness = made.stiffness * np.outer(strains, strains)
        made = replace(made, stiffness=stiffness, cog=cog, rigid=moves, gradients=slopes)
    return ReducedStructure(
        structure=structure, damping=damping, band=band, matrices=made, frequency=frequency, losses=used.loss_factors, basis=moved
    )


SAME = 1e-5
"""Share of the size of a structure about a place that has a name within which coordinates are that place. By definition."""


def with_positions(structure: Structure, positions: Sequence[str]) -> Structure:
    """`structure` with places at `positions`, which are written as coordinates; where one has a name it is that place.

    Raises
    ------
    BadInput : outside the structure, or no coordinates are known.
    """
    new = {name: at for name in positions if name not in structure.places and (at := position(name)) is not None}
    if not new:
        return structure
    known = [(name, here) for name in structure.places if (here := position_of(structure, name)) is not None]
    near = SAME * float(np.linalg.norm(np.ptp([*structure.points, *(here for _, here in known)], axis=0))) if known else 0.0
    own = {one: structure.places[name] for one, at in new.items() for name, here in known if np.linalg.norm(here - at) <= near}
    left = [one for one in new if one not in own]
    rows = place_rows(structure, [new[one] for one in left]) if left else []
    return replace(structure, places={**structure.places, **own, **dict(zip(left, rows, strict=True))})


def lacking(structure: Structure, place: str) -> BadInput | None:
    """Why `structure` has no `place` that is written as coordinates; None where it has it."""
    try:
        with_positions(structure, [place])
    except BadInput as error:
        return error
    return None
