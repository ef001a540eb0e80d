"""What a mode is, in words: which part moves most, along what, and whether its ends go together.

Shares are those of the kinetic energy, u_i (M u)_i summed over a part's degrees of freedom; where the model says which stiffness
is whose, the part that holds most of the strain energy is named too.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from fem.modes import Modes
from fem.structure import Sparse, Structure, at_freedoms, hold
from geometry.article import Article, Box, Part
from geometry.frames import Array, Integers
from validation.flexible.model import Flexible, distance, family, nearest_part
from validation.output import entry

# How any point of an article moves in the modes of its model: on beams with their section, in solids with the nodes around it.
#
# A beam's section stays plane and rigid, so a point moves as its foot on the axis does, plus the rotation there crossed with its
# arm; between nodes the axis follows a cubic whose slopes are the rotations, as in the elements (Przemieniecki, chapter 5).


NEIGHBOURS = 4
"""Nodes of a solid model whose motions are averaged, weighted with the inverse square of their distances."""

ON_THE_AXIS = 5e-3
"""Nodes farther from a part's axis than this share of its length belong to something that is fastened to it."""


BEYOND_THE_ENDS = 0.05
"""Nodes so far beyond the ends of a part, as a share of its length, still lead it: a mast is held by the node of its flange."""


def displacement(structure: Structure, shapes: Array, article: Article | None, points: Array, parts: Integers) -> Array:
    """Displacement (n, 3, m) of `points` (n, 3) [m] in `shapes` (N, m); `parts` (n,) are their counted parts of `article`."""
    if article is None or not has_rotations(structure):
        from scipy.spatial import cKDTree

        apart, nodes = cKDTree(structure.points).query(points, k=min(NEIGHBOURS, len(structure.points)))
        apart, nodes = np.reshape(apart, (len(points), -1)), np.reshape(nodes, (len(points), -1))
        weights = 1 / np.maximum(apart, 1e-9) ** 2
        weights /= weights.sum(axis=1, keepdims=True)
        return np.asarray(np.einsum("pk,pkim->pim", weights, node_displacement(structure, shapes)[nodes]))
    moved = np.empty((len(points), 3, shapes.shape[1]))
    for number in np.unique(parts):
        there = parts == number
        moved[there] = _with_section(structure, shapes, article.counted_parts[number], points[there])
    return moved


def has_rotations(structure: Structure) -> bool:
    """Whether every point turns as well as moves, its rotations following its translations."""
    after = structure.translations + 3
    if not after.size or after.max() >= structure.rigid.shape[0]:
        return False
    turns = structure.rigid[after]
    return bool(np.allclose(turns, np.hstack([np.zeros((3, 3)), np.eye(3)])))


def node_displacement(structure: Structure, shapes: Array) -> Array:
    """Displacement (p, 3, m) of the structure's own points in `shapes` (N, m)."""
    return at_freedoms(shapes, structure.translations)


def _with_section(structure: Structure, shapes: Array, part: Part, points: Array) -> Array:
    """Motion (n, 3, m) of `points` of one part with the sections of its axis, or with the nearest node where it has none."""
    # A point of the part's axis [m], its direction, and the part's length along it [m]: of the largest solid
    largest = max(part.shape.solids, key=lambda placed: placed.primitive.volume)
    pose, primitive = part.pose @ largest.pose, largest.primitive
    if isinstance(primitive, Box):
        k = int(np.argmax(primitive.size))
        origin, axis, length = pose.position, pose.rotation[:, k], float(primitive.size[k])
    else:
        origin, axis, length = pose.position, pose.rotation[:, 2], primitive.height
    arms = structure.points - origin
    along = arms @ axis
    beside = np.linalg.norm(arms - np.outer(along, axis), axis=1)
    near = (beside <= ON_THE_AXIS * length) & (distance(part, structure.points) <= BEYOND_THE_ENDS * length)
    nodes = np.flatnonzero(near)
    if len(nodes) == 0:
        nodes = np.array([np.argmin(np.linalg.norm(structure.points - points.mean(axis=0), axis=1))])
    s, first = np.unique(np.round(along[nodes], 9), return_index=True)
    nodes = nodes[first]
    place = np.clip((points - origin) @ axis, s[0], s[-1])
    # Displacement u and rotation of the axis (n, 3, m) at `place`
    u, turned = shapes[structure.translations[nodes]], shapes[structure.translations[nodes] + 3]
    if len(s) == 1:
        moved, turned = np.repeat(u, len(place), axis=0), np.repeat(turned, len(place), axis=0)
    else:
        stretch, e = np.gradient(np.einsum("pim,i->pm", u, axis), s, axis=0), axis[None, :, None]
        slopes = np.cross(turned, e, axis=1) + stretch[:, None, :] * e
        before = np.clip(np.searchsorted(s, place, side="right") - 1, 0, len(s) - 2)
        width = (s[before + 1] - s[before])[:, None, None]
        share = (place - s[before])[:, None, None] / width
        turned = (1 - share) * turned[before] + share * turned[before + 1]
        # The cubic of each piece through both its ends with their slopes
        rest = 1 - share
        ends = rest**2 * (1 + 2 * share) * u[before] + share**2 * (1 + 2 * rest) * u[before + 1]
        moved = ends + width * share * rest * (rest * slopes[before] - share * slopes[before + 1])
    feet = structure.points[nodes[0]] + np.outer(place - s[0], axis)
    return np.asarray(moved + np.cross(turned, (points - feet)[:, :, None], axis=1))


WORTH_NAMING = 0.15
"""Share of the energy below which a second part is not mentioned."""

SLICES = 12
"""Across a part of a solid, to see whether it twists."""

STILL = 0.15
"""An end that moves less than this share of the farthest moving point stands still."""


@dataclass(frozen=True, kw_only=True)
class Described:
    """One mode.

    Attributes
    ----------
    text : both of these in words
    moving : share of the kinetic energy by part, largest first
    """

    text: str
    moving: dict[str, float] = entry("kinetic_energy_share")


def described(structure: Structure, modes: Modes, article: Article | None) -> tuple[Described, ...]:
    """Every mode of `modes` in words; `article` names the parts, without it those of the structure's stiffness are named.

    Of a structure that knows no points only the parts that are strained are named; a rigid motion strains none.
    """
    if not len(modes.shapes):
        return tuple(Described(moving={}, text="") for _ in modes.frequency)
    # Share (m,) of the strain energy of each mode by part
    strain: dict[str, Array] = {}
    omega2 = np.where(modes.frequency > 0, 2 * np.pi * modes.frequency, np.inf) ** 2
    for name, K in structure.part_stiffness.items():
        share = np.einsum("nm,nm->m", modes.shapes, K @ modes.shapes) / omega2
        strain[family(name)] = strain.get(family(name), 0.0) + share
    shares = [_sorted({name: float(share[r]) for name, share in strain.items()}) for r in range(len(modes.frequency))]
    if not len(structure.points):
        return tuple(_strained(f, one) for f, one in zip(modes.frequency, shares, strict=True))
    u = node_displacement(structure, modes.shapes)
    # Names of the parts, and for each point the index of its own: by the drawing, else by whose stiffness holds the point
    if article is not None:
        families = [family(part.name) for part in article.counted_parts]
        owners_names = list(dict.fromkeys(families))
        names = owners_names
        owner = np.array([owners_names.index(name) for name in families])[nearest_part(article, structure.points)]
    elif not structure.part_stiffness:
        names, owner = [""], np.zeros(len(structure.points), dtype=np.intp)
    else:
        diagonals = (K.diagonal() for K in structure.part_stiffness.values())
        held = np.array([at_freedoms(each, structure.translations).sum(axis=1) for each in diagonals])
        names = list(structure.part_stiffness)
        tying = np.isin(names, (*structure.supports, *structure.joints))[:, None]
        owner = np.argmax(np.where(tying & held[~tying[:, 0]].any(axis=0), 0.0, held), axis=0)
    if article is None and structure.part_mass:  # how much each part moves is known of the parts themselves
        moved = {name: modes.shapes * (M @ modes.shapes) for name, M in structure.part_mass.items()}
        names = list(dict.fromkeys((*names, *moved)))
        whole = {name: each.sum(axis=0) for name, each in moved.items()}
        along = {name: (structure.rigid[:, :3] ** 2).T @ each for name, each in moved.items()}
    else:
        energy = modes.shapes * (structure.mass @ modes.shapes)
        energies, rows = _by_point(structure, energy), at_freedoms(energy, structure.translations)
        whole = {name: energies[owner == k].sum(axis=0) for k, name in enumerate(names)}
        along = {name: rows[owner == k].sum(axis=0) for k, name in enumerate(names)}
    own = {name: owner == k for k, name in enumerate(names)}
    inner = ~structure.rigid.any(axis=1)  # generalised coordinates, of which nobody knows what they move
    unknown = np.sum((modes.shapes * (structure.mass @ modes.shapes))[inner], axis=0) > 0.5
    return tuple(
        _strained(modes.frequency[r], shares[r])
        if modes.frequency[r] == 0 or unknown[r]
        else _described(
            structure,
            own,
            _sorted({name: float(each[r]) for name, each in whole.items()}),
            {name: each[:, r] for name, each in along.items()},
            u[:, :, r],
            shares[r],
        )
        for r in range(len(modes.frequency))
    )


def _by_point(structure: Structure, energy: Array) -> Array:
    """Energy (p, m) of each point with its rotations, where it has any: all degrees of freedom up to the next point's."""
    order = np.argsort(structure.translations[:, 0])
    result = np.empty((len(order), energy.shape[1]))
    result[order] = np.add.reduceat(energy, structure.translations[order, 0])
    return result


def _strained(frequency: float, shares: dict[str, float]) -> Described:
    """A mode of which only the strain is known."""
    named = [f"{100 * share:.0f} % {name}" for name, share in shares.items() if share >= WORTH_NAMING][:3]
    text = "rigid motion" if frequency == 0 else f"strain: {', '.join(named)}" if named else ""
    return Described(moving={}, text=text)


def _described(
    structure: Structure,
    own: Mapping[str, Array],
    shares: dict[str, float],
    along: Mapping[str, Array],
    u: Array,
    strained: dict[str, float],
) -> Described:
    """A mode by the points of each part `own` (p,), the energy `shares` of each and the same `along` (3,) x, y and z."""
    named = [name for name, share in shares.items() if share >= WORTH_NAMING] or list(shares)[:1]
    moving = []
    for name in named[:3]:
        twists = _twists(structure, own[name], u, along[name].sum() / shares[name])
        how = "twists" if twists else "xyz"[int(np.argmax(along[name]))]
        moving.append(f"{100 * shares[name]:.0f} % {name} {how}" if name else how)
    first = own[named[0]]
    pattern = _pattern(structure.points[first], u[first])
    moving[0] += f", {pattern}" if pattern and "twists" not in moving[0] else ""
    # Which part is strained most, if that is another than the one that moves most
    bent_moving = named[0]
    key = next(iter(strained), bent_moving)
    bent = [f"strain: {100 * strained[key]:.0f} % {key}"] if key != bent_moving else []
    return Described(moving=shares, text="; ".join([*moving, *bent]))


def _twists(structure: Structure, own: Array, u: Array, translating: float) -> bool:
    """Whether a part turns about its own length more than it moves; `translating` is the share of its energy in translations.

    Beams have rotations of their own. In a solid the points of a slice across the part go round, and their mean stands still.
    """
    if translating < 0.5 or has_rotations(structure):
        return translating < 0.5
    points, moved = structure.points[own], u[own]
    if len(points) < 2 * SLICES:
        return False
    arms = points - points.mean(axis=0)
    along = arms @ np.linalg.svd(arms, full_matrices=False)[2][0]
    slices = np.minimum((SLICES * (along - along.min()) / max(np.ptp(along), 1e-12)).astype(int), SLICES - 1)
    counts = np.bincount(slices, minlength=SLICES)
    sums = np.stack([np.bincount(slices, weights=moved[:, i], minlength=SLICES) for i in range(3)])
    return float((sums**2 / np.maximum(counts, 1)).sum()) < 0.5 * float((moved**2).sum())


def _pattern(points: Array, u: Array) -> str:
    """Whether the two ends of a part that is longer than everything else go the same way."""
    if len(points) < 3:
        return ""
    extent = np.ptp(points, axis=0)
    k = int(np.argmax(extent))
    if k == 2:
        return ""  # a mast has one free end
    axis = int(np.argmax(np.abs(u).sum(axis=0)))
    ends = [float(u[i, axis]) for i in (np.argmin(points[:, k]), np.argmax(points[:, k]))]
    largest = float(np.abs(u[:, axis]).max())
    if max(map(abs, ends)) < STILL * largest:
        return "ends still"
    if min(map(abs, ends)) < STILL * max(map(abs, ends)):
        return "one end"
    if ends[0] * ends[1] > 0:
        return "ends together"
    return "ends opposed" if axis == 2 else "turning about z"


def _sorted(shares: dict[str, float]) -> dict[str, float]:
    return dict(sorted(shares.items(), key=lambda item: -item[1]))


# How much of an article's mass its modes can carry, and how much rides on the base.


RESIDUAL = 1e-10
"""Relative residual at which the iteration ends; mass matrices are well conditioned, a few dozen steps do."""


def movable(structure: Structure) -> Array:
    """Effective mass (6,) [kg, kg m²] of *all* fixed-base modes about the reference point: ``diag(P^T M_ff^-1 P)``, P = (M T)_f.

    What is left of the rigid mass is carried by the held degrees of freedom themselves and shows in no mode.
    """
    from scipy.sparse import diags_array
    from scipy.sparse.linalg import cg

    held = hold(structure)
    diagonal = held.mass.diagonal()
    jacobi = diags_array(1 / np.where(diagonal > 0, diagonal, 1.0))
    carried = (p @ cg(held.mass, p, rtol=RESIDUAL, M=jacobi)[0] if p.any() else 0.0 for p in held.load.T)
    return np.array(list(carried))


# The modes of two models of one article, told apart by their shapes.
#
# The modal assurance criterion is weighted with the mass of the model that has nodes all through the material, so that it is the
# share of one mode's kinetic energy that moves as the other says:
#
#     MAC_ij = (phi_i^T M psi_j)² / ((phi_i^T M phi_i) (psi_j^T M psi_j))
#
# (Allemang 2003, with mass). Modes are matched by it, not by their order. In a cluster of close frequencies any mixture of the
# shapes is a shape too; there the spaces that the shapes span are compared, by the smallest of their squared principal cosines.


CLUSTER = 0.015
"""Neighbouring frequencies closer than this share of them belong to one cluster."""

APART = 0.01
"""Relative difference of two frequencies beyond which the models are said to part: the bar of beam against solid."""

SAME_MODE = 0.9
"""MAC, or that of the spaces of a cluster, below which two shapes are not the same."""


@dataclass(frozen=True, eq=False, kw_only=True)
class ModeComparison:
    """Modes of the first model, each with its partner.

    Attributes
    ----------
    first, second : the models
    mac : (n, m) of every mode of the first with every mode of the second; (0, 0) when a model has no shapes
    partner : (n,) number of the partner, from 0; -1 for a mode that has none because the second model has fewer
    cluster : (n,) number of the cluster of each mode of the first, ascending
    space : (n,) smallest squared principal cosine between the mode's cluster and its partners, the MAC where it is alone; NaN
        without shapes
    """

    first: Flexible
    second: Flexible
    mac: Array
    partner: Integers
    cluster: Integers
    space: Array

    @property
    def difference(self) -> Array:
        """Relative difference (n,) of the frequency of the second from that of the first; NaN without a partner."""
        f, g = self.first.modes.frequency, self.second.modes.frequency
        return np.where(self.partner >= 0, g[self.partner] / f - 1, np.nan)

    @property
    def parted(self) -> Integers:
        """The modes, from 0, of which the models say different things."""
        alike = (np.abs(self.difference) <= APART) & ((self.space >= SAME_MODE) | np.isnan(self.space))
        return np.flatnonzero(~alike)


def compared(first: Flexible, second: Flexible) -> ModeComparison:
    """Match the modes of `first` with those of `second`: by their shapes, or in ascending order where a model has none."""
    a, b = first.structure, second.structure
    if a is None or b is None or not (len(first.modes.shapes) and len(second.modes.shapes)):
        n, m = len(first.modes.frequency), len(second.modes.frequency)
        order = np.arange(n)
        return ModeComparison(
            first=first,
            second=second,
            mac=np.zeros((0, 0)),
            partner=np.where(order < m, order, -1),
            cluster=clusters(first.modes.frequency),
            space=np.full(n, np.nan),
        )
    # Shapes of both on the degrees of freedom of the one that has nodes all through the material, and its mass
    if a.mass.shape == b.mass.shape and np.array_equal(a.translations, b.translations) and np.allclose(a.points, b.points):
        phi, psi, M = first.modes.shapes, second.modes.shapes, a.mass
    elif has_rotations(a) or not has_rotations(b):
        phi, psi, M = _seen_on(first, a, b), second.modes.shapes, b.mass
    else:
        phi, psi, M = first.modes.shapes, _seen_on(second, b, a), a.mass
    phi, psi = _normalised(phi, M), _normalised(psi, M)
    cross = phi.T @ (M @ psi)
    mac = cross**2
    cluster = clusters(first.modes.frequency)
    from scipy.optimize import linear_sum_assignment

    # The partner (n,) of each row such that the sum of their MAC is largest; -1 where there are too few columns
    partner = np.full(len(mac), -1, dtype=np.intp)
    rows, columns = linear_sum_assignment(-mac)
    partner[rows] = columns
    space, matched = np.zeros(len(partner)), partner.copy()
    for number in np.unique(cluster):
        own = np.flatnonzero((cluster == number) & (matched >= 0))
        if not len(own):
            continue
        one, other = _orthonormal(phi[:, own], M), _orthonormal(psi[:, matched[own]], M)
        space[own] = np.linalg.svd(one.T @ (M @ other), compute_uv=False).min() ** 2
        # In ascending order where shapes are mixed but span the same: no mode has its like, the whole has
        if space[own].min() >= SAME_MODE > mac[own, matched[own]].min():
            partner[own] = np.sort(matched[own])
    return ModeComparison(first=first, second=second, mac=mac, partner=partner, cluster=cluster, space=space)


def clusters(frequency: Array) -> Integers:
    """Number (n,) of the cluster of each of `frequency` (n,) [Hz], which ascend."""
    gaps = np.diff(frequency) > CLUSTER * frequency[:-1]
    return np.concatenate([[0], np.cumsum(gaps)]).astype(np.intp) if len(frequency) else np.zeros(0, dtype=np.intp)


def _normalised(shapes: Array, M: Sparse) -> Array:
    return np.asarray(shapes / np.sqrt(np.einsum("nm,nm->m", shapes, M @ shapes)))


def _orthonormal(shapes: Array, M: Sparse) -> Array:
    """Columns that span the same space and are orthonormal in `M`, by Cholesky of their Gram matrix."""
    return np.asarray(np.linalg.solve(np.linalg.cholesky(shapes.T @ (M @ shapes)), shapes.T).T)


def _seen_on(model: Flexible, own: Structure, other: Structure) -> Array:
    """The shapes of `model` on the degrees of freedom of `other`, which are translations of its points."""
    article = model.article_of_primitives
    parts = np.zeros(len(other.points), dtype=np.intp) if article is None else nearest_part(article, other.points)
    moved = displacement(own, model.modes.shapes, article, other.points, parts)
    shapes = np.zeros((other.mass.shape[0], moved.shape[2]))
    shapes[other.translations] = moved
    return shapes
